"""Twists and poses of which some directions are free: the others hold, and joints move least."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from servo_drives import Drive, robot_of

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_robot
from robomech_ros.servo.commands import PoseCommand
from robomech_ros.servo.report import ServoCondition
from robomech_ros.servo.twist_resolver import TwistResolver

FIVE = load_robot(Path(__file__).parents[1] / "data" / "five_joints.urdf")
POSITION, TOOL_AXIS = (True,) * 3 + (False,) * 3, (True,) * 5 + (False,)
START = {
    "five": [0.4, -0.4, 0.7, 0.3, 0.2],
    "puma560": [0.1, -0.5, 0.4, 0.3, 0.8, 0.2],
    "panda": [0.2, -0.4, 0.3, -1.8, 0.2, 1.7, 0.4],
    "vx300": [0.2, -0.3, 0.5, 0.4, 0.3],
}
STEP = np.array([0.04, 0.03, 0.02])


def drive_of(name, mask):
    chain = FIVE if name == "five" else robot_of(name)
    drive = Drive(name, START[name], chain=chain, length=0.25)
    drive.servo.hold(mask)
    return drive


def tips(drive):
    return forward_kinematics(drive.chain, np.array(drive.positions))


@pytest.mark.parametrize("mask", [POSITION, TOOL_AXIS])
@pytest.mark.parametrize("name", sorted(START))
def test_the_tip_follows_its_line_while_what_is_free_drifts(name, mask):
    drive = drive_of(name, mask)
    drive.twist([0.0, 0.0, 0.0, *STEP], 1.0)
    drive.wait(0.5)
    poses = tips(drive)
    moved = poses[:, :3, 3] - poses[0, :3, 3]
    along = moved @ STEP / np.linalg.norm(STEP)
    beside = moved - np.outer(along, STEP) / np.linalg.norm(STEP)
    assert along[-1] > 0.9 * np.linalg.norm(STEP)
    assert np.abs(beside).max() < 1e-6
    angles = np.arccos(np.clip(poses[:, :3, 2] @ poses[0, :3, 2], -1.0, 1.0))
    assert angles.max() < 1e-6 if mask == TOOL_AXIS else angles.max() > 1e-2
    turned = Rotation.from_matrix(poses[0, :3, :3].T @ poses[-1, :3, :3]).magnitude()
    assert turned > 1e-3
    assert np.abs(np.array(drive.velocities)).max(axis=0).max() <= drive.chain.velocity.max()


def test_the_joints_of_a_free_orientation_move_less_than_those_of_the_full_pose():
    ways = []
    for mask in ((False,) * 6, POSITION):
        drive = drive_of("puma560", mask)
        drive.twist([0.0, 0.0, 0.0, *STEP], 1.0)
        ways.append(np.linalg.norm(np.diff(drive.positions, axis=0), axis=1).sum())
    assert ways[1] < 0.9 * ways[0]


@pytest.mark.parametrize("mask", [POSITION, TOOL_AXIS])
def test_a_pose_is_reached_but_for_what_is_free(mask):
    drive = drive_of("vx300", mask)
    here = tips(drive)[0]
    target = here.copy()
    target[:3, 3] += STEP
    # Turned a lot about the axis of the tool.
    target[:3, :3] = here[:3, :3] @ Rotation.from_rotvec([0.0, 0.0, 2.5]).as_matrix()
    for _ in range(250):
        drive.servo.take(PoseCommand(target, 0.2, 0.5, drive.time + 0.1))
        drive.step()
    last = tips(drive)[-1]
    np.testing.assert_allclose(last[:3, 3], target[:3, 3], atol=5e-6)
    if mask == TOOL_AXIS:
        np.testing.assert_allclose(last[:3, 2], target[:3, 2], atol=5e-6)
    assert np.abs(drive.velocities[-1]).max() < 1e-3


def test_a_tool_axis_is_brought_to_that_of_the_target():
    drive = drive_of("puma560", TOOL_AXIS)
    here = tips(drive)[0]
    target = here.copy()
    turn = Rotation.from_rotvec([0.3, 0.2, 0.0]) * Rotation.from_rotvec([0.0, 0.0, 1.5])
    target[:3, :3] = here[:3, :3] @ turn.as_matrix()
    for _ in range(300):
        drive.servo.take(PoseCommand(target, 0.2, 0.5, drive.time + 0.1))
        drive.step()
    last = tips(drive)[-1]
    np.testing.assert_allclose(last[:3, 2], target[:3, 2], atol=5e-6)
    np.testing.assert_allclose(last[:3, 3], target[:3, 3], atol=5e-6)
    assert last[:3, 0] @ target[:3, 0] < 0.9


def test_what_is_free_changes_in_motion():
    drive = drive_of("puma560", (False,) * 6)
    drive.twist([0.0, 0.0, 0.0, *STEP], 0.5)
    drive.servo.hold(POSITION)
    begun = len(drive.positions)
    drive.twist([0.0, 0.0, 0.0, *STEP], 1.0)
    drive.servo.hold((False,) * 6)
    kept = len(drive.positions)
    drive.twist([0.0, 0.0, 0.0, *STEP], 0.5)
    poses = tips(drive)
    turned = [
        Rotation.from_matrix(poses[a, :3, :3].T @ poses[b - 1, :3, :3]).magnitude()
        for a, b in ((0, begun), (begun, kept))
    ]
    assert turned[0] < 1e-6
    assert turned[1] > 1e-2
    moved = poses[:, :3, 3] - poses[0, :3, 3]
    beside = moved - np.outer(moved @ STEP, STEP) / (STEP @ STEP)
    assert np.abs(beside).max() < 1e-3
    steps = np.abs(np.diff(drive.velocities, axis=0)).max(axis=0)
    assert (steps <= drive.servo.limits.acceleration * drive.period * (1.0 + 1e-6)).all()


def test_a_singularity_of_what_is_free_is_none():
    straight = [0.1, -0.5, 0.4, 0.3, 0.0, 0.2]
    found = []
    for mask in ((False,) * 6, POSITION):
        drive = Drive("puma560", straight, length=0.25)
        drive.servo.hold(mask)
        found.append(drive.twist([0.0, 0.0, 0.0, *STEP], 0.3)[-1])
    assert found[0].condition_number > 1e3
    assert found[1].condition_number < 10.0
    assert found[1].condition == ServoCondition.NO_WARNING


@pytest.mark.parametrize("mask", [POSITION, TOOL_AXIS, (True, False, True, False, True, False)])
def test_the_rate_of_the_jacobian_is_its_derivative(mask):
    chain, q = robot_of("puma560"), np.array(START["puma560"])
    resolver = TwistResolver(chain, 30.0, 90.0, 1.0, 0.25)
    resolver.hold(mask)
    rates, h = np.array([0.3, -0.2, 0.5, 0.4, -0.6, 0.7]), 1e-6
    ahead, behind = (resolver.jacobian(q + x * rates) for x in (h, -h))
    np.testing.assert_allclose(resolver.change(q, rates), (ahead - behind) / (2.0 * h), atol=1e-8)


def test_wrong_masks_are_refused():
    drive = drive_of("puma560", POSITION)
    with pytest.raises(WrongSizeError, match="task_mask"):
        drive.servo.hold((True,) * 5)
    with pytest.raises(BadValueError, match=r"task_mask\[5\]"):
        drive.servo.hold((True,) * 5 + ("z",))
