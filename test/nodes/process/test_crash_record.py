"""Records of a killed process for the next one, and files that are no such record."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from robomech_ros.nodes.process.crash_record import LARGEST, CrashRecord
from robomech_ros.nodes.process.runtime_folder import runtime_folder

WHOSE = ("7", "/left/arm")
_WRITER = """
import os, signal
from robomech_ros.nodes.process.crash_record import CrashRecord
record = CrashRecord("place", ("7", "/left/arm"))
for i in range(1000):
    record.write(b"at %d" % i)
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))


def only_file():
    (path,) = runtime_folder().iterdir()
    return path


def kill_a_writer():
    child = subprocess.run([sys.executable, "-c", _WRITER], check=False, timeout=30)
    assert child.returncode == -signal.SIGKILL


def test_the_last_words_of_a_process_that_was_killed_are_found():
    kill_a_writer()
    record = CrashRecord("place", WHOSE)
    assert record.left.data == b"at 999" and 0.0 <= record.left.age < 30.0
    record.write(b"alive")
    record.close()
    assert not list(runtime_folder().iterdir())
    assert CrashRecord("place", WHOSE).left is None


@pytest.mark.parametrize("other", [("8", "/left/arm"), ("7", "/right/arm"), ("7", "/left/", "arm")])
def test_other_domains_namespaces_and_robots_never_mix(other):
    kill_a_writer()
    assert CrashRecord("place", other).left is None
    assert CrashRecord("place", WHOSE).left.data == b"at 999"


def test_one_process_at_a_time_keeps_a_record():
    first = CrashRecord("place", WHOSE)
    with pytest.raises(BlockingIOError):
        CrashRecord("place", WHOSE)
    first.close()
    first.close()
    CrashRecord("place", WHOSE).close()


def test_more_than_fits_and_what_comes_after_the_end_is_refused():
    record = CrashRecord("place", WHOSE)
    with pytest.raises(ValueError, match="65537 bytes, allowed are 65536"):
        record.write(bytes(LARGEST + 1))
    record.close()
    with pytest.raises(ValueError, match="in an open record"):
        record.write(b"late")


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: data[:20],
        lambda data: data[:-1],
        lambda data: data[:-1] + b"8",
        lambda data: b"x" * len(data),
        lambda data: data[:8] + bytes(32) + data[40:],
    ],
)
def test_what_is_no_record_is_named_and_written_over(damage):
    kill_a_writer()
    path = only_file()
    path.write_bytes(damage(path.read_bytes()))
    record = CrashRecord("place", WHOSE)
    assert record.left is None and str(path) in record.fault
    record.write(b"new")
    assert b"new" in path.read_bytes()


def a_link(path, elsewhere):
    path.symlink_to(elsewhere)


def a_second_name(path, elsewhere):
    path.hardlink_to(elsewhere)


def a_pipe(path, elsewhere):
    os.mkfifo(path, 0o600)


def one_for_all(path, elsewhere):
    path.touch()
    path.chmod(0o666)


@pytest.mark.parametrize("plant", [a_link, a_second_name, a_pipe, one_for_all])
def test_planted_files_are_refused_and_left_alone(plant, tmp_path):
    elsewhere = tmp_path / "precious"
    elsewhere.write_text("precious")
    elsewhere.chmod(0o600)
    first = CrashRecord("place", WHOSE)
    path = only_file()
    first.close()
    plant(path, elsewhere)
    with pytest.raises(OSError) as refused:
        CrashRecord("place", WHOSE)
    assert Path(refused.value.filename) == path
    assert elsewhere.read_text() == "precious"


@pytest.mark.parametrize("open_to", [0o777, 0o770])
def test_a_folder_that_others_can_write_to_is_refused(open_to):
    runtime_folder().chmod(open_to)
    with pytest.raises(OSError, match="can be written by its group or by others"):
        CrashRecord("place", WHOSE)


def test_a_link_in_the_place_of_the_folder_is_refused(tmp_path):
    folder = runtime_folder()
    folder.rmdir()
    (tmp_path / "elsewhere").mkdir(mode=0o700)
    folder.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(OSError, match="not a folder"):
        CrashRecord("place", WHOSE)


def test_without_a_runtime_directory_it_is_in_the_temporary_folder(tmp_path, monkeypatch):
    for session in ("", "relative", str(tmp_path / "missing")):
        monkeypatch.setenv("XDG_RUNTIME_DIR", session)
        monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
        assert runtime_folder() == tmp_path / f"robomech_ros-{os.getuid()}"
