"""Cache of compiled kernels, whose failures never stop a program."""

import os
import subprocess
import sys
import tempfile

import pytest

from robomech_ros._kernels.compiling import cache

CODE = """
import numpy as np
from robomech_ros._kernels.compiling import cache
{before}
from robomech_ros._kernels.compiling.jit import kernel
from robomech_ros._kernels.compiling.types import IN1, f8

@kernel(f8(IN1))
def largest(values):
    found = values[0]
    for value in values:
        found = max(found, value)
    return found

assert largest(np.array([1.0, 3.0, 2.0])) == 3.0
print(cache.cache_directory())
{after}
"""


def run(folder, before="", after="", **environment):
    """Use a kernel of a file in this folder, in its own process; return its cache directory."""
    folder.mkdir(exist_ok=True)
    program = folder / "program.py"
    program.write_text(CODE.format(before=before, after=after))
    inherited = {
        name: value
        for name, value in os.environ.items()
        if name not in ("ROBOMECH_CACHE_DIR", "XDG_CACHE_HOME")
    }
    done = subprocess.run(
        [sys.executable, str(program)],
        env={**inherited, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.fixture(scope="module")
def filled(tmp_path_factory):
    """A cache that one process has filled."""
    root = tmp_path_factory.mktemp("cache")
    return root, run(tmp_path_factory.mktemp("here"), ROBOMECH_CACHE_DIR=str(root))


def compiled(root):
    return {path: path.stat().st_mtime_ns for path in root.rglob("*.nbc")}


@pytest.mark.slow
def test_a_second_process_loads_what_the_first_compiled(filled, tmp_path):
    """From another installation of the same sources, too."""
    root, directory = filled
    assert directory.startswith(f"{root}/")
    before = compiled(root)
    assert before
    assert run(tmp_path / "there", ROBOMECH_CACHE_DIR=str(root)) == directory
    assert compiled(root) == before
    assert os.stat(directory).st_mode & 0o077 == 0


def test_a_change_of_the_kernel_leads_to_another_file(filled, tmp_path):
    root, directory = filled
    before = compiled(root)
    changed = run(tmp_path / "changed", before="limit = 1.0", ROBOMECH_CACHE_DIR=str(root))
    assert changed == directory
    assert len(compiled(root)) == len(before) + 1


def test_a_damaged_cache_costs_time_only(filled, tmp_path):
    root, directory = filled
    for path in root.rglob("*.nb[ci]"):
        path.write_bytes(b"damaged")
    assert run(tmp_path, ROBOMECH_CACHE_DIR=str(root)) == directory


@pytest.mark.slow
def test_a_place_that_cannot_be_used_is_passed_over(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    found = run(
        tmp_path / "program", ROBOMECH_CACHE_DIR=str(blocked / "cache"), TMPDIR=str(elsewhere)
    )
    assert found.startswith(f"{elsewhere}/robomech_ros-")
    elsewhere = tmp_path / "open"
    (elsewhere / f"robomech_ros-{os.getuid()}").mkdir(parents=True)
    (elsewhere / f"robomech_ros-{os.getuid()}").chmod(0o777)
    found = run(
        tmp_path / "program", ROBOMECH_CACHE_DIR=str(blocked / "cache"), TMPDIR=str(elsewhere)
    )
    assert found == "None"


@pytest.mark.parametrize("mode", [0o770, 0o702, 0o777])
@pytest.mark.parametrize("level", ["", "above", "above/cache"])
def test_a_place_that_others_can_write_is_refused_at_every_level(
    tmp_path, tmp_path_factory, monkeypatch, level, mode
):
    def found():
        return str(cache.cache_directory.__wrapped__())

    place = tmp_path / "above" / "cache"
    place.mkdir(mode=0o700, parents=True)
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (tmp_path / level).chmod(mode)
    monkeypatch.setenv("ROBOMECH_CACHE_DIR", str(place))
    monkeypatch.setattr(tempfile, "tempdir", str(elsewhere))
    assert found().startswith(f"{elsewhere}/robomech_ros-")
    (tmp_path / level).chmod(0o700)
    assert found().startswith(f"{place}/")


def test_a_link_leads_to_the_folder_that_is_judged(tmp_path):
    there, elsewhere = tmp_path / "open" / "there", tmp_path / "elsewhere"
    for folder in (there, elsewhere):
        folder.mkdir(mode=0o700, parents=True)
    (tmp_path / "open").chmod(0o777)
    (tmp_path / "link").symlink_to(there)
    program = tmp_path / "program"
    found = run(program, ROBOMECH_CACHE_DIR=str(tmp_path / "link"), TMPDIR=str(elsewhere))
    assert found.startswith(f"{elsewhere}/robomech_ros-")


def test_it_works_without_compilation(tmp_path):
    run(tmp_path, NUMBA_DISABLE_JIT="1", ROBOMECH_CACHE_DIR=str(tmp_path))


def test_numba_keeps_its_own_setting(tmp_path):
    run(
        tmp_path,
        before="import numba; numba.config.CACHE_DIR = 'mine'",
        after="assert numba.config.CACHE_DIR == 'mine'",
        ROBOMECH_CACHE_DIR=str(tmp_path),
    )
    assert compiled(tmp_path)
