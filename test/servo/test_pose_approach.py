"""The tip goes to poses on straight lines, stands there, and follows poses that move."""

import numpy as np
import pytest
from servo_drives import TIMEOUT, Drive

from robomech_ros.errors import NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.servo.commands import PoseCommand
from robomech_ros.servo.report import ServoCondition
from robomech_ros.spatial import matrix_from_rotation_vector, rotation_vector_from_matrix

POSTURES = {
    "puma560": [0.3, 0.6, -0.7, 0.4, 0.8, 0.2],
    "ur5e": [0.0, -1.2, 1.5, -1.57, -1.57, 0.0],
    "panda": [0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.7],
}


def go_to(drive, target, seconds, linear=0.4, angular=0.8):
    for _ in range(round(seconds / drive.period)):
        drive.servo.take(PoseCommand(target(drive.time), linear, angular, drive.time + TIMEOUT))
        drive.step(every_plan=False)


def turned(T, vector):
    after = T.copy()
    after[:3, :3] = matrix_from_rotation_vector(np.array(vector)) @ T[:3, :3]
    return after


@pytest.mark.parametrize(
    ("way", "turn", "speed"),
    [(0.15, 0.0, 0.4), (0.1, 0.3, 1.0), (0.005, 0.0, 0.4), (0.0, 0.6, 0.4)],
)
@pytest.mark.parametrize("robot", POSTURES)
def test_a_pose_is_reached_on_a_straight_line_and_held(robot, way, turn, speed):
    rng = np.random.default_rng(7)
    drive = Drive(robot, POSTURES[robot], lead=2)
    first = forward_kinematics(drive.chain, drive.start)
    along, axis = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
    target = turned(first, turn * axis)
    target[:3, 3] += way * along
    go_to(drive, lambda now: target, 2.5, linear=speed)
    tips = forward_kinematics(drive.chain, drive.path())
    np.testing.assert_allclose(tips[-1], target, atol=1e-5)
    assert drive.servo.motion.at_rest
    moved = tips[:, :3, 3] - first[:3, 3]
    assert np.abs(moved - np.outer(moved @ along, along)).max() < 1e-5
    # The tip turns about one axis, and does not go too far.
    assert (moved @ along).max() < way + 1e-5
    turns = rotation_vector_from_matrix(tips[:, :3, :3] @ first[:3, :3].T)
    assert np.linalg.norm(np.cross(turns, axis), axis=1).max() < 1e-4
    drive.assert_limits(plans_too=False)


def test_a_pose_that_moves_is_followed():
    drive = Drive("puma560", POSTURES["puma560"], lead=2)
    first = forward_kinematics(drive.chain, drive.start)

    def target(now):
        after = first.copy()
        after[0, 3] += 0.05 * np.sin(2.0 * now)
        after[1, 3] += 0.05 * (1.0 - np.cos(2.0 * now))
        return after

    go_to(drive, target, 3.0)
    tips = forward_kinematics(drive.chain, drive.path())[:, :3, 3]
    wanted = np.array([target(k * drive.period)[:3, 3] for k in range(len(tips))])
    # At 0.1 m/s it is behind by the time constant of its end and of the limits.
    assert np.linalg.norm(tips - wanted, axis=1)[100:].max() < 0.03
    drive.wait(1.0)
    assert drive.servo.motion.at_rest
    drive.assert_limits(plans_too=False)


def test_a_pose_out_of_reach_is_approached_until_there_is_a_reason_to_stand():
    drive = Drive("ur5e", POSTURES["ur5e"], lead=2)
    target = forward_kinematics(drive.chain, drive.start)
    target[0, 3] += 2.0
    go_to(drive, lambda now: target, 6.0)
    assert not drive.velocities[-1].any()
    last = drive.reports[-1]
    assert last.condition is ServoCondition.SINGULARITY
    assert "singularity" in last.text


def test_what_is_no_pose_is_refused():
    servo = Drive("ur5e", POSTURES["ur5e"]).servo
    with pytest.raises(WrongSizeError, match="target"):
        servo.take(PoseCommand(np.eye(3), 0.1, 0.1, 1.0))
    with pytest.raises(NonFiniteError, match="target"):
        servo.take(PoseCommand(np.full((4, 4), np.nan), 0.1, 0.1, 1.0))
