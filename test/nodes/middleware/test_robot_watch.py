"""The watch of `make fuzz` sees every state that a robot cannot be in."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "fuzz"))

from known_robot import known_robot
from robot_watch import StateWatch

PERIOD = 0.01
ROBOTS = ["puma560", "hexapod", "delta", "phantomx", "swerve", "three_fingered"]


@pytest.fixture(params=ROBOTS)
def joints(request):
    return known_robot(request.param).published


def looked(joints, *rows, rates=None, span=PERIOD):
    """Let a watch look at positions, so long (s) apart, of joints in another order."""
    watch, order = StateWatch(joints), np.arange(len(joints.names))[::-1]
    names = [joints.names[k] for k in order]
    velocity = np.zeros(len(names)) if rates is None else rates
    for k, row in enumerate(rows):
        watch.look(names, 1e9 + k * span, row[order], velocity[order])
    assert watch.seen == len(rows)
    return watch


def moved(joints, k, way):
    """Return home with one joint elsewhere, on the side where its limits leave more room."""
    q = joints.home.copy()
    q[k] += way if joints.upper[k] - q[k] > q[k] - joints.lower[k] else -way
    return q


def test_home_and_a_reset_are_no_faults(joints):
    elsewhere = np.clip(joints.home + 1.0, joints.lower, joints.upper)
    assert not looked(joints, joints.home, joints.home).fault
    if joints.gaps is None:
        assert not looked(joints, elsewhere, joints.home).fault


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
