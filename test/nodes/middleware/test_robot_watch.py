"""The watch of `make fuzz` sees every state that a robot cannot be in."""

import sys
import time
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "fuzz"))

from known_robot import known_robot
from robot_watch import Resets, StateWatch

PERIOD = 0.01
ROBOTS = ["puma560", "hexapod", "delta", "phantomx", "swerve", "three_fingered"]


@pytest.fixture(params=ROBOTS)
def joints(request):
    return known_robot(request.param).published


def looked(joints, *rows, rates=None, span=PERIOD, began=1e9, resets=None):
    """Let a watch look at positions, so long (s) apart, of joints in another order."""
    watch, order = StateWatch(joints, resets), np.arange(len(joints.names))[::-1]
    names = [joints.names[k] for k in order]
    velocity = np.zeros(len(names)) if rates is None else rates
    for k, row in enumerate(rows):
        watch.look(names, began + k * span, row[order], velocity[order])
    assert watch.seen == len(rows)
    return watch


def moved(joints, k, way):
    """Return home with one joint elsewhere, on the side where its limits leave more room."""
    q = joints.home.copy()
    q[k] += way if joints.upper[k] - q[k] > q[k] - joints.lower[k] else -way
    return q


def elsewhere(joints, way=1.0):
    """Give another posture, whose loops may be open."""
    return np.clip(joints.home + way, joints.lower, joints.upper)


@pytest.fixture
def clock(monkeypatch):
    """Set the time of resets."""
    return lambda now: monkeypatch.setattr(time, "time", lambda: now)


def jumped(joints, clock, *resets, to=None):
    """Let a robot jump, home by default, and tell if it was too fast; resets are begin and end.

    The states are from 10.0 s and 10.01 s; a reset without an answer ends at None.
    """
    known = Resets()
    for began, ended in resets:
        clock(began)
        end = known.begin()
        if ended is not None:
            clock(ended)
            end()
    rows = elsewhere(joints), joints.home if to is None else to
    watch = looked(joints, *rows, span=0.01, began=10.0, resets=known)
    return watch.velocity > 1.01


def test_home_is_no_fault(joints):
    watch = looked(joints, joints.home, joints.home)
    assert not watch.fault and watch.wrong == 0


@pytest.mark.parametrize(
    "reset",
    [(10.004, 10.006), (9.0, 11.0), (9.0, 10.005), (10.005, 11.0), (9.0, None), (10.005, None)],
)
def test_a_reset_may_be_asked_for_or_answered_between_two_states(joints, clock, reset):
    assert not jumped(joints, clock, (1.0, 2.0), reset, (20.0, None))


@pytest.mark.parametrize(
    "resets", [(), [(9.0, 9.99)], [(10.02, None)], [(1.0, 9.99), (10.02, 11.0)]]
)
def test_a_jump_home_without_a_reset_is_seen(joints, clock, resets):
    """Every jump home counted as a reset."""
    if np.isfinite(joints.velocity).any():
        assert jumped(joints, clock, *resets)


def test_a_reset_goes_home_and_nowhere_else(joints, clock):
    if np.isfinite(joints.velocity).any():
        assert jumped(joints, clock, (10.005, 10.006), to=elsewhere(joints, -1.0))


def test_a_robot_leaves_home_no_faster_after_a_reset(joints, clock):
    for k in np.flatnonzero(np.isfinite(joints.velocity)):
        for share, fast in ((0.9, False), (1.2, True)):
            # From 10.005 s on, less the 2 ms by which stamps may be off.
            way = moved(joints, k, share * 0.007 * joints.velocity[k])
            assert jumped(joints, clock, (10.005, 10.006), to=way) == fast


def test_a_stamp_that_goes_back_is_no_reset(joints):
    if np.isfinite(joints.velocity).any():
        assert looked(joints, elsewhere(joints), joints.home, span=-PERIOD).velocity > 1e3
    assert not looked(joints, joints.home, joints.home, span=-PERIOD).fault


def test_every_state_that_is_wrong_counts(joints):
    outside = joints.home.copy()
    outside[0] = np.nan
    assert looked(joints, joints.home, outside, outside).wrong == 2


def test_joints_outside_their_limits_are_seen(joints):
    for limit, sign in ((joints.lower, -1.0), (joints.upper, 1.0)):
        for k in np.flatnonzero(np.isfinite(limit)):
            q = joints.home.copy()
            q[k] = limit[k] + 1e-5 * sign
            assert "outside its limits" in looked(joints, q).fault


def test_numbers_that_are_none_are_seen(joints):
    q = joints.home.copy()
    q[-1] = np.nan
    assert "is at nan" in looked(joints, q).fault


@pytest.mark.parametrize("span", [PERIOD, 0.002, 0.2])
def test_jumps_are_seen_by_the_stamps(joints, span):
    for k in np.flatnonzero(np.isfinite(joints.velocity)):
        for share in (0.99, 1.01):
            q = moved(joints, k, share * span * joints.velocity[k])
            watch = looked(joints, joints.home, q, span=span)
            assert watch.velocity == pytest.approx(share, rel=1e-3)
            assert watch.fault if share > 1.0 else "times its limit" not in watch.fault


def test_velocities_are_seen(joints):
    fast = np.where(np.isfinite(joints.velocity), 1.001 * joints.velocity, 0.0)
    assert ("velocity of" in looked(joints, joints.home, rates=fast).fault) == fast.any()


@pytest.mark.parametrize("name", ["hexapod", "delta"])
def test_open_loops_are_seen(name):
    joints = known_robot(name).published
    assert "loops are open by" in looked(joints, moved(joints, 1, 1e-4)).fault
