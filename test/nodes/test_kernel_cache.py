"""The cache of kernels: what earlier states of the same installation left is taken away."""

import os
import re
import shutil

import pytest

from robomech_ros._kernels.chain.serial import forward_one
from robomech_ros.cli.kernel_cache import KEPT, prune

STATES = [f"{i:016x}" for i in range(8)]


@pytest.fixture
def cache(tmp_path):
    """Make states with kernels that installations used, the later in the list the longer ago."""
    elsewhere = tmp_path / "elsewhere"

    def make(states, installation, note=""):
        for age, name in enumerate(states):
            state = tmp_path / name
            state.mkdir(exist_ok=True)
            (state / "kernel.nbi").write_text("code")
            # A note of this installation, as it stands in a state of its own.
            own = elsewhere / STATES[0]
            own.mkdir(parents=True)
            prune(own, installation)
            (written,) = (own / "used_by").iterdir()
            (state / "used_by").mkdir(exist_ok=True)
            placed = shutil.copy(written, state / "used_by")
            if note:
                (state / "used_by" / written.name).write_text(note)
            made = os.stat(placed).st_mtime - 100.0 * age
            os.utime(placed, (made, made))
            shutil.rmtree(elsewhere)
        return [tmp_path / name for name in states]

    return make


def test_the_latest_states_are_kept(cache, tmp_path):
    states = cache(STATES, tmp_path / "here")
    assert set(prune(states[0], tmp_path / "here")) == set(states[1 + KEPT :])
    assert sorted(p.name for p in tmp_path.iterdir()) == STATES[: 1 + KEPT]
    assert all((state / "kernel.nbi").exists() for state in states[: 1 + KEPT])
    assert prune(states[0], tmp_path / "here") == []


def test_what_is_of_others_is_left_alone(cache, tmp_path):
    (mine,) = cache(STATES[:1], tmp_path / "here")
    others = cache(STATES[1:], tmp_path / "there")
    (strange,) = cache(["not-a-state"], tmp_path / "here")
    (tmp_path / "ffffffffffffffff").symlink_to(tmp_path / "not-a-state")
    assert prune(mine, tmp_path / "here") == []
    assert all((one / "kernel.nbi").exists() for one in [*others, strange])


def test_what_other_versions_made_is_left_alone(cache, tmp_path):
    states = cache(STATES, tmp_path / "here", note="Python 3.10")
    assert prune(states[0], tmp_path / "here") == []
    assert all((one / "kernel.nbi").exists() for one in states)


def test_a_shared_state_goes_when_nobody_uses_it_any_more(cache, tmp_path):
    later = [f"{i:016x}" for i in range(8, 8 + KEPT)]
    states = cache(STATES, tmp_path / "here")
    cache([STATES[0], *later, STATES[-1]], tmp_path / "there")
    assert states[-1] not in prune(states[0], tmp_path / "here")
    assert (states[-1] / "kernel.nbi").exists()
    assert prune(states[0], tmp_path / "there") == [states[-1]]
    assert all((tmp_path / name / "kernel.nbi").exists() for name in later)


def test_a_place_that_is_no_state_is_left_alone(cache, tmp_path):
    cache(STATES[1:2], tmp_path / "here")
    (strange,) = cache(["no-state"], tmp_path / "here")
    assert prune(strange, tmp_path / "here") == []
    assert prune(tmp_path / STATES[0], tmp_path / "here") == []


def test_the_kernels_in_use_lie_where_they_are_looked_for():
    state = os.path.basename(forward_one.stats.cache_path)
    assert re.fullmatch(r"[0-9a-f]{16}", state)
