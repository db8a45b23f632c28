"""The cache of kernels: what earlier states of the same installation left is taken away."""

import os
import re

import pytest

from robomech_ros._kernels.serial import forward_one
from robomech_ros.nodes.kernel_cache import KEPT, prune

STATES = [f"{i:016x}" for i in range(8)]


@pytest.fixture
def cache(tmp_path):
    """Make a folder of kernels, so many seconds old."""

    def make(state, installation="_kernels_here", age=0.0, note=""):
        folder = tmp_path / state / installation
        folder.mkdir(parents=True)
        (folder / "kernel.nbi").write_text("code")
        if note:
            (folder / "made_with.txt").write_text(note)
        made = folder.stat().st_mtime - age
        os.utime(folder, (made, made))
        return folder

    return make


def test_the_latest_states_are_kept(cache, tmp_path):
    folders = [cache(state, age=100.0 * i) for i, state in enumerate(STATES)]
    assert set(prune(folders[0])) == set(folders[1 + KEPT :])
    assert sorted(p.name for p in tmp_path.iterdir()) == STATES[: 1 + KEPT]
    assert all((folder / "kernel.nbi").exists() for folder in folders[: 1 + KEPT])
    assert prune(folders[0]) == []


def test_what_is_of_others_is_left_alone(cache, tmp_path):
    mine = cache(STATES[0])
    elsewhere = [cache(state, "_kernels_there", age=1000.0) for state in STATES[1:]]
    versions = [cache(state, age=1000.0, note="Python 3.10") for state in STATES[1:]]
    strange = cache("not-a-state", age=1000.0)
    (tmp_path / "ffffffffffffffff").symlink_to(tmp_path / "not-a-state")
    assert prune(mine) == []
    assert all((one / "kernel.nbi").exists() for one in [*elsewhere, *versions, strange])


def test_a_shared_state_keeps_the_other_installation(cache):
    mine = cache(STATES[0])
    old = [cache(state, age=100.0 * i) for i, state in enumerate(STATES[1:], start=1)]
    other = cache(STATES[-1], "_kernels_there")
    assert old[-1] in prune(mine)
    assert not old[-1].exists()
    assert (other / "kernel.nbi").exists()


def test_a_place_that_is_no_state_is_left_alone(cache, tmp_path):
    cache(STATES[1])
    assert prune(cache("elsewhere")) == []
    assert prune(tmp_path / STATES[0] / "missing") == []


def test_the_kernels_in_use_lie_where_they_are_looked_for():
    state = os.path.basename(os.path.dirname(forward_one.stats.cache_path))
    assert re.fullmatch(r"[0-9a-f]{16}", state)
