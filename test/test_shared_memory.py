"""Fast DDS files of killed processes are found and removed; those in use stay."""

import fcntl
import mmap
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from robomech_ros import shared_memory
from robomech_ros.shared_memory import Leftover, leftovers, ports_of_domain, remove_leftovers

PORT, SEGMENT = "fastdds_port7011", "fastdds_0123456789abcdef"
SENDER = """
import mmap, sys
with open(sys.argv[1], "r+b") as file:
    mapped = mmap.mmap(file.fileno(), 0)
print("mapped", flush=True)
sys.stdin.readline()
"""


@pytest.fixture
def folder(monkeypatch):
    """A folder for files as Fast DDS makes them, in shared memory as those are."""
    with tempfile.TemporaryDirectory(dir="/dev/shm") as name:
        monkeypatch.setattr(shared_memory, "_FOLDER", Path(name))
        yield Path(name)


def left_port(folder, name=PORT, locks=("_el",)):
    for file in (name, f"sem.{name}_mutex", *(f"{name}{end}" for end in locks)):
        (folder / file).write_bytes(bytes(100))


def files(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("locks", [(), ("_el",), ("_sl",), ("_el", "_sl")])
def test_what_nobody_uses_is_listed_and_removed(folder, locks):
    left_port(folder, locks=locks)
    before = files(folder)
    found = [Leftover(PORT, 7011, 100)]
    assert leftovers() == found
    assert files(folder) == before
    assert remove_leftovers() == found
    assert files(folder) == []
    assert leftovers() == remove_leftovers() == []


@pytest.mark.parametrize("end", ["_el", "_sl"])
@pytest.mark.parametrize("way", [fcntl.LOCK_EX, fcntl.LOCK_SH])
def test_a_port_that_is_listened_to_stays(folder, end, way):
    left_port(folder, locks=(end,))
    before = files(folder)
    with (folder / f"{PORT}{end}").open() as lock:
        fcntl.flock(lock, way)
        assert leftovers() == remove_leftovers() == []
        assert files(folder) == before
    assert len(remove_leftovers()) == 1


@pytest.mark.parametrize("file", [PORT, f"sem.{PORT}_mutex"])
def test_a_port_that_a_process_has_mapped_stays(folder, file):
    """Its messages would go into a file that nobody finds."""
    left_port(folder)
    before = files(folder)
    command = [sys.executable, "-c", SENDER, str(folder / file)]
    sender = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert sender.stdout.readline() == "mapped\n"
    assert leftovers() == remove_leftovers() == []
    assert files(folder) == before
    sender.kill()
    sender.communicate()
    assert len(remove_leftovers()) == 1


def test_a_port_that_is_mapped_between_the_look_and_the_removal_stays(folder, monkeypatch):
    left_port(folder)
    held = []
    rename = Path.rename

    def mapped_at_once(path, aside):
        with path.open("r+b") as file:
            held.append(mmap.mmap(file.fileno(), 0))
        return rename(path, aside)

    monkeypatch.setattr(Path, "rename", mapped_at_once)
    number = (folder / PORT).stat().st_ino
    assert remove_leftovers() == []
    assert (folder / PORT).stat().st_ino == number
    assert files(folder) == [PORT, f"sem.{PORT}_mutex"]
    held.pop().close()


def test_nobody_begins_to_listen_while_a_port_is_removed(folder, monkeypatch):
    left_port(folder, locks=())
    taken = []
    rename = Path.rename

    def locked_at_once(path, aside):
        with (folder / f"{PORT}_el").open() as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                taken.append(path)
        return rename(path, aside)

    monkeypatch.setattr(Path, "rename", locked_at_once)
    assert len(remove_leftovers()) == len(taken) == 1


def test_segments_ports_and_nothing_else(folder):
    left_port(folder, "fastdds_port7400")
    left_port(folder, "fastdds_port57911")
    for name in (SEGMENT, f"{SEGMENT}_el", "fastdds_portal", "sem.precious", "precious"):
        (folder / name).touch()
    (folder / "fastdds_port7500").mkdir()
    (folder / "fastdds_port7600").symlink_to(folder / "precious")
    assert [one.port for one in leftovers(ports_of_domain(0))] == [7400]
    assert [one.name for one in remove_leftovers(ports_of_domain(202))] == ["fastdds_port57911"]
    assert [one.name for one in remove_leftovers()] == ["fastdds_port7400", SEGMENT]
    kept = ["fastdds_port7500", "fastdds_port7600", "fastdds_portal", "precious", "sem.precious"]
    assert files(folder) == kept


def test_planted_locks_hold_nobody_up(folder):
    left_port(folder, locks=())
    os.mkfifo(folder / f"{PORT}_el")
    assert len(remove_leftovers()) == 1
    left_port(folder, locks=())
    (folder / "precious").write_text("kept")
    (folder / f"{PORT}_el").symlink_to(folder / "precious")
    assert leftovers() == remove_leftovers() == []
    assert (folder / "precious").read_text() == "kept"


def test_where_there_is_no_shared_memory(monkeypatch, tmp_path):
    monkeypatch.setattr(shared_memory, "_FOLDER", tmp_path / "none")
    assert leftovers() == remove_leftovers() == []
