"""Fingers: commands, what stops them, and their limits, without ROS."""

from functools import partial

import numpy as np
import pytest

from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.follower import TrajectoryFollower
from robomech_ros.execution.controller.simulated_joints import Faults, SimulatedJoints
from robomech_ros.execution.controller.trajectory_goal import End
from robomech_ros.execution.gripper.finger_motion import FingerCommand, FingerEnd, complete_limits
from robomech_ros.execution.gripper.finger_plant import Contact, FingerPlant
from robomech_ros.execution.gripper.fingers import Fingers, GripSettings
from robomech_ros.execution.joints import Joints
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.trajectory import Limits
from robomech_ros.trajectory.waypoints import Waypoints

PERIOD = 0.002
LIMITS = Limits(
    ["left", "right"],
    velocity=0.2,
    acceleration=2.0,
    jerk=40.0,
    lower=0.0,
    upper=0.04,
    units=["m", "m"],
)
STRONGEST = np.array([20.0, 20.0])
ANY = Tolerances(np.full(2, np.inf), np.full(2, 0.001), np.full(2, np.inf), 0.1)
OBJECT = Contact(np.array([0.015, 0.015]), np.array([-1.0, -1.0]))


class Rig:
    """Two fingers that open from 0 to 0.04 m, and what they have done."""

    def __init__(self, position=(0.04, 0.04), **settings):
        self.plant = FingerPlant(np.array(position), LIMITS, STRONGEST)
        self.simulated = SimulatedJoints(np.array(position), 0.0, self.plant)
        joints = Joints(LIMITS, np.zeros(2, dtype=bool))
        self.follower = TrajectoryFollower(joints, self.simulated)
        self.fingers = Fingers(self.follower, self.plant, LIMITS, GripSettings(**settings))
        self.now = 0.0
        self.seen = []
        self.ends = []

    def move(self, position, velocity=np.inf, effort=10.0):
        command = FingerCommand(
            np.broadcast_to(position, 2).astype(float), np.full(2, velocity), np.full(2, effort)
        )
        return self.fingers.move(command, self.now, lambda *end: self.ends.append(end))

    def follow(self, goal, duration=0.5, start=None):
        start = self.position if start is None else start
        still = np.zeros((2, 2))
        rows = np.array([np.broadcast_to(start, 2), np.broadcast_to(goal, 2)], dtype=float)
        points = Waypoints(np.array([0.0, duration]), rows, still, still)
        results = []
        start = partial(self.follower.start, points, ANY, self.now, 0.0, results.append)
        self.fingers.follow(start, "a trajectory")
        return results

    def run(self, seconds):
        for _ in range(round(seconds / PERIOD)):
            self.now += PERIOD
            self.follower.advance(self.now)
            self.fingers.look()
            self.seen.append(np.array(self.follower.actual.position))

    @property
    def position(self):
        return self.follower.actual.position

    def peaks(self):
        """Largest speed, acceleration and jerk of what was seen."""
        rows = np.array(self.seen)
        rates = [np.diff(rows, k, axis=0) / PERIOD**k for k in (1, 2, 3)]
        return [float(np.abs(rate).max()) for rate in rates]


def test_a_command_is_reached_within_the_limits():
    rig = Rig(goal_tolerance=0.001)
    rig.move(0.0)
    rig.run(1.0)
    assert rig.ends == [(FingerEnd.REACHED, "")]
    np.testing.assert_allclose(rig.position, 0.0, atol=1e-12)
    speed, push, jerk = rig.peaks()
    assert 0.15 < speed <= 0.2 + 1e-9
    assert 1.5 < push <= 2.0 + 1e-6
    assert jerk <= 40.0 * (1.0 + 1e-6)


def test_a_slow_command():
    rig = Rig()
    rig.move(0.0, velocity=0.02)
    rig.run(1.5)
    assert rig.ends == []
    rig.run(1.0)
    assert rig.ends[0][0] is FingerEnd.REACHED
    assert 0.0199 < rig.peaks()[0] <= 0.02 + 1e-9


def test_one_joint_of_two():
    rig = Rig()
    rig.move([np.nan, 0.01])
    rig.run(1.0)
    np.testing.assert_allclose(rig.position, [0.04, 0.01], atol=1e-12)
    assert rig.ends[0][0] is FingerEnd.REACHED


@pytest.mark.parametrize("after", [0.05, 0.1, 0.15, 0.2])
@pytest.mark.parametrize("goal", [0.0, 0.02, 0.04])
def test_a_newer_command_takes_over_within_the_limits(after, goal):
    rig = Rig()
    rig.move(0.0)
    rig.run(after)
    assert rig.ends == []
    rig.move(goal)
    assert rig.ends == [(FingerEnd.ABORTED, "preempted by a newer command to the gripper")]
    rig.run(1.0)
    assert rig.ends[1:] == [(FingerEnd.REACHED, "")]
    np.testing.assert_allclose(rig.position, goal, atol=1e-12)
    speed, push, jerk = rig.peaks()
    assert speed <= 0.2 + 1e-9 and push <= 2.0 + 1e-6 and jerk <= 40.0 * (1.0 + 1e-5)


def test_a_goal_outside_the_limits_is_refused_and_changes_nothing():
    rig = Rig()
    rig.move(0.01)
    rig.run(0.1)
    with pytest.raises(RobomechError, match=r"'left'.*0\.05"):
        rig.move(0.05)
    rig.run(1.0)
    assert rig.ends == [(FingerEnd.REACHED, "")]
    np.testing.assert_allclose(rig.position, 0.01, atol=1e-12)


def test_an_object_stops_the_fingers_with_the_effort_that_was_allowed():
    rig = Rig(stall_timeout=0.3)
    rig.plant.contact = OBJECT
    rig.move(0.0, effort=7.0)
    rig.run(0.35)
    assert rig.ends == []
    np.testing.assert_array_equal(rig.position, [0.015, 0.015])
    np.testing.assert_array_equal(rig.simulated.effort, [-7.0, -7.0])
    rig.run(0.3)
    assert rig.ends == [(FingerEnd.STALLED, "joint 'left' stands at 0.015 m, its goal is 0 m")]
    rig.run(0.5)
    np.testing.assert_array_equal(rig.simulated.effort, [-7.0, -7.0])
    assert min(np.array(rig.seen).ravel()) >= 0.015 - 1e-9


def test_fingers_open_at_once_from_an_object():
    rig = Rig(stall_timeout=0.1)
    rig.plant.contact = OBJECT
    rig.move(0.0)
    rig.run(1.0)
    rig.move(0.04)
    rig.seen.clear()
    rig.run(0.02)
    assert (rig.position > 0.015).all()
    rig.run(1.0)
    assert rig.ends[-1] == (FingerEnd.REACHED, "")
    assert not rig.simulated.effort.any()
    assert rig.peaks()[1] <= 2.0 + 1e-6


def test_an_object_that_is_taken_away_lets_the_fingers_go_on_within_their_limits():
    rig = Rig(stall_timeout=0.1)
    rig.plant.contact = OBJECT
    rig.move(0.0)
    rig.run(0.5)
    rig.seen.clear()
    rig.plant.contact = None
    rig.run(0.5)
    np.testing.assert_allclose(rig.position, 0.0, atol=1e-9)
    speed, push, _ = rig.peaks()
    assert speed <= 0.2 + 1e-9
    assert push <= 2.0 + 1e-6


def test_an_object_does_not_stop_fingers_that_are_closed_already():
    rig = Rig(position=(0.0, 0.0))
    rig.plant.contact = OBJECT
    rig.move(0.04)
    rig.run(1.0)
    assert rig.ends == [(FingerEnd.REACHED, "")]
    rig.move(0.0)
    rig.run(0.5)
    np.testing.assert_array_equal(rig.position, [0.015, 0.015])


def test_within_the_tolerance_a_goal_behind_a_surface_is_reached():
    rig = Rig(goal_tolerance=0.01)
    rig.plant.contact = OBJECT
    rig.move(0.01)
    rig.run(1.0)
    assert rig.ends == [(FingerEnd.REACHED, "")]


def test_cancelled_fingers_slow_down_and_hold():
    rig = Rig()
    motion = rig.move(0.0)
    rig.run(0.1)
    rig.fingers.cancel(motion, "by the client")
    assert rig.ends == []
    rig.run(0.5)
    assert rig.ends == [(FingerEnd.CANCELLED, "by the client")]
    assert (rig.position > 0.01).all()
    assert rig.peaks()[1] <= 2.0 * 1.001


def test_a_cancelled_grip_lets_go():
    rig = Rig(stall_timeout=100.0)
    rig.plant.contact = OBJECT
    motion = rig.move(0.0)
    rig.run(1.0)
    rig.fingers.cancel(motion, "by the client")
    assert rig.ends == [(FingerEnd.CANCELLED, "by the client")]
    rig.run(0.1)
    assert not rig.simulated.effort.any()
    np.testing.assert_array_equal(rig.position, [0.015, 0.015])


def test_a_trajectory_takes_over_and_presses_with_all_that_the_joint_has():
    rig = Rig(stall_timeout=100.0)
    rig.plant.contact = OBJECT
    rig.move(0.0)
    rig.run(1.0)
    results = rig.follow(0.0)
    assert rig.ends == [(FingerEnd.ABORTED, "preempted by a trajectory")]
    rig.run(0.3)
    np.testing.assert_array_equal(rig.simulated.effort, [-20.0, -20.0])
    rig.run(0.5)
    (result,) = results
    assert result.end is End.ABORTED
    assert "joint 'left' is 0.015 m off its goal, the tolerance is 0.001 m" in result.text
    assert "joint 'left' was at its effort limit for 0." in result.text


def test_a_trajectory_that_is_refused_leaves_the_grip():
    rig = Rig(stall_timeout=0.1)
    rig.plant.contact = OBJECT
    rig.move(0.0, effort=5.0)
    rig.run(1.0)
    with pytest.raises(RobomechError, match="starts with joint 'left' at 0.04"):
        rig.follow(0.0, start=0.04)
    rig.run(0.1)
    np.testing.assert_array_equal(rig.simulated.effort, [-5.0, -5.0])


def test_a_stuck_finger_stalls():
    rig = Rig(stall_timeout=0.2)
    stuck = np.array([False, True])
    rig.simulated.inject(Faults(stuck=stuck, offset=np.zeros(2)))
    rig.move(0.0)
    rig.run(1.0)
    assert rig.ends == [(FingerEnd.STALLED, "joint 'right' stands at 0.04 m, its goal is 0 m")]
    np.testing.assert_array_equal(rig.simulated.effort, [0.0, -10.0])


def test_limits_that_are_not_known_are_estimated():
    bare = complete_limits(Limits(["slide", "hinge"], lower=[0.0, None], upper=[0.04, None]))
    np.testing.assert_allclose(bare.velocity, [0.04, 1.0])
    np.testing.assert_allclose(bare.acceleration, [0.16, 4.0])
    np.testing.assert_allclose(bare.jerk, [1.6, 40.0])
    known = complete_limits(LIMITS)
    for rate in ("velocity", "acceleration", "jerk"):
        np.testing.assert_array_equal(getattr(known, rate), getattr(LIMITS, rate))
