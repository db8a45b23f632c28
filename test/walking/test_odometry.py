"""The way of the trunk from joints and contacts alone, against the walk that was commanded."""

import numpy as np
import pinocchio
import pytest

from robomech_ros.errors import RobomechError
from robomech_ros.walking import Walker, leg_odometry, load_legged

ROBOTS = {"wave": "phantomx", "ripple": "phantomx", "tripod": "phantomx", "crawl": "go1"}


def walk(gait, seconds=8.0):
    """Return a walk on a bend, with the trunk raised and turned on the way."""
    walker = Walker(load_legged(ROBOTS[gait]), gait=gait, timeout=1e9)
    walker.command(walker.fastest * [0.3, 0.5, 0.2])
    walker.command_pose([0.002, 0.001, 0.003, 0.01, -0.01, 0.02], 2.0)
    return walker.robot, [walker.update() for _ in range(round(seconds / walker.period))]


@pytest.mark.parametrize(
    ("gait", "off"), [("wave", 1e-9), ("ripple", 1e-9), ("crawl", 1e-9), ("tripod", 1e-4)]
)
def test_the_trunk_is_found_where_it_was_walked(gait, off):
    """A tripod lifts its feet in the moment in which others land: their first motion counts."""
    robot, updates = walk(gait)
    q = np.array([update.q for update in updates])
    contacts = np.array([update.contacts for update in updates])
    trunk, slip = leg_odometry(robot, q, contacts, start=updates[0].trunk)
    told = np.array([update.trunk for update in updates])
    assert np.abs(trunk - told).max() <= off and slip.max() <= off
    assert np.hypot(*(told[-1] - told[0])[:2, 3]) > 0.02


def test_two_feet_tell_the_way_of_a_trunk_that_stays_level():
    walker = Walker(load_legged("go1"), gait="trot", timeout=1e9)
    walker.command(walker.fastest * [0.3, 0.5, 0.2])
    updates = [walker.update() for _ in range(1600)]
    q = np.array([update.q for update in updates])
    contacts = [update.contacts for update in updates]
    trunk, slip = leg_odometry(walker.robot, q, contacts, start=updates[0].trunk)
    assert np.abs(trunk - [update.trunk for update in updates]).max() < 2e-4
    assert slip.max() < 1e-4 and min(map(sum, contacts)) == 2


def test_a_foot_that_slips_shows():
    robot, updates = walk("wave", 0.5)
    q = np.array([update.q for update in updates])
    q[50:, 1] += 0.01
    slip = leg_odometry(robot, q, [update.contacts for update in updates])[1]
    assert slip.argmax() == 50 and slip[50] > 5e-4 and np.delete(slip, 50).max() < 1e-5


def test_a_trunk_that_moves_over_feet_at_rest_is_found_whatever_way_it_goes():
    """The oracle: poses of the trunk by Pinocchio, joints by inverse kinematics of each leg."""
    robot, rng = load_legged("go1"), np.random.default_rng(5)
    places, rows, poses = robot.feet(robot.home), [robot.home], [np.eye(4)]
    for _ in range(20):
        twist = pinocchio.Motion(rng.uniform(-0.01, 0.01, 3), rng.uniform(-0.02, 0.02, 3))
        pose = pinocchio.exp6(twist).homogeneous
        at = (places - pose[:3, 3]) @ pose[:3, :3]
        legs = zip(robot.leg_names, at, rows[-1].reshape(-1, 3), strict=True)
        rows.append(np.concatenate([robot.postures(leg, p, seed=s).q[0] for leg, p, s in legs]))
        poses.append(pose)
    trunk, slip = leg_odometry(robot, rows, np.ones((21, 4), dtype=bool))
    assert np.abs(trunk - poses).max() < 1e-9 and slip.max() < 1e-9


def test_wrong_requests_name_what_is_wrong():
    robot = load_legged("go1")
    q, all_down = np.tile(robot.home, (2, 1)), np.ones((2, 4), dtype=bool)
    one = np.tile([True, False, False, False], (2, 1))
    cases = [
        (lambda: leg_odometry("go1", q, all_down), "a LeggedRobot"),
        (lambda: leg_odometry(robot, q[0], all_down), "q"),
        (lambda: leg_odometry(robot, q[:, :5], all_down), "q"),
        (lambda: leg_odometry(robot, q * np.nan, all_down), "q"),
        (lambda: leg_odometry(robot, q, [[1.0] * 4] * 2), "contacts"),
        (lambda: leg_odometry(robot, q, all_down[:1]), "contacts"),
        (lambda: leg_odometry(robot, q, [[True], [True, False]]), "contacts"),
        (lambda: leg_odometry(robot, q, one), "feet that stand at sample 1 is ['FL']"),
        (lambda: leg_odometry(robot, q, all_down, start=np.ones((4, 4))), "last row of pose"),
    ]
    for call, text in cases:
        with pytest.raises(RobomechError) as caught:
            call()
        assert text in str(caught.value)
