"""Paths of which only some components are held: on them, inside limits, with the least motion."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomech_ros.cartesian import follow_path, plan_along, serial_arm, waypoint_path
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import load_robot
from robomech_ros.trajectory import Limits, TipSpeeds, along_path, verify

FIVE = load_robot(Path(__file__).parents[1] / "data" / "five_joints.urdf")
POSITION, TOOL_AXIS = (True,) * 3 + (False,) * 3, (True,) * 5 + (False,)
START = {
    "puma560": [0.1, -0.5, 0.4, 0.3, 0.8, 0.2],
    "panda": [0.2, -0.4, 0.3, -1.8, 0.2, 1.7, 0.4],
    "vx300": [0.2, -0.3, 0.5, 0.4, 0.3],
    "scara": [0.4, 0.9, 0.1, -0.3],
}
FIVE_START = np.array([0.4, -0.4, 0.7, 0.3, 0.2])


def beside(chain, q, step, turn=(0.0, 0.0, 0.0)):
    """Straight path from a posture to where the tip is displaced (m) and turned (rad)."""
    here = forward_kinematics(chain, q)
    there = here.copy()
    there[:3, 3] += step
    there[:3, :3] = Rotation.from_rotvec(turn).as_matrix() @ here[:3, :3]
    return waypoint_path(here, [there])


def limits_of(chain, acceleration=10.0):
    return Limits(
        chain.joint_names,
        chain.velocity,
        acceleration,
        lower=chain.lower,
        upper=chain.upper,
        units=chain.units,
    )


def held_errors(chain, path, joints, mask, count=200):
    """Largest held components of what the tip is off the path, (6,): x y z rx ry rz."""
    s = np.linspace(0.0, joints.length, count)
    poses, tips = path.sample(s).pose, forward_kinematics(chain, joints.derivatives(s)[0])
    axes = np.swapaxes(poses[:, :3, :3], 1, 2)
    moved = (axes @ (tips - poses)[:, :3, 3:])[:, :, 0]
    turned = Rotation.from_matrix(axes @ tips[:, :3, :3]).as_rotvec()
    return np.where(mask, np.abs(np.hstack([moved, turned])).max(axis=0), 0.0)


def test_an_arm_of_five_joints_moves_its_tip_with_free_orientation():
    path = beside(FIVE, FIVE_START, [0.05, 0.0, 0.0])
    limits = limits_of(FIVE)
    plan = plan_along(
        FIVE, path, FIVE_START, task_mask=POSITION, limits=limits, profile="time_optimal"
    )
    assert (plan.fraction, plan.stop) == (1.0, None)
    assert verify(plan.samples, limits, start=FIVE_START).ok
    tips = forward_kinematics(FIVE, plan.samples.positions)[:, :3, 3]
    np.testing.assert_allclose(tips[:, 1:], np.tile(tips[0, 1:], (len(tips), 1)), atol=1e-6)
    assert tips[-1, 0] - tips[0, 0] == pytest.approx(0.05, abs=1e-6)


def test_the_joints_move_least():
    # Away from limits: least rates, integrated here by 2000 small steps of the midpoint rule.
    path, q = beside(FIVE, FIVE_START, [0.05, 0.0, 0.0]), FIVE_START.copy()
    joints = follow_path(FIVE, path, FIVE_START, task_mask=POSITION).joints
    count, velocity = 2000, np.array([1.0, 0.0, 0.0])
    for _ in range(count):
        h = path.length / count
        first = np.linalg.pinv(jacobian(FIVE, q)[3:]) @ velocity
        q = q + h * (np.linalg.pinv(jacobian(FIVE, q + 0.5 * h * first)[3:]) @ velocity)
    np.testing.assert_allclose(joints.derivatives(joints.length)[0], q, atol=1e-4)


@pytest.mark.parametrize("name", sorted(START))
@pytest.mark.parametrize("mask", [POSITION, TOOL_AXIS, (1, 1, 0, 0, 0, 1), (0, 1, 1, 1, 0, 0)])
def test_what_is_held_stays_on_the_path_and_what_is_free_does_not(name, mask):
    chain, q = load_robot(name), np.array(START[name])
    turn = (0.0, 0.0, 0.3) if name == "scara" else (0.1, 0.3, -0.2)
    path = beside(chain, q, [0.04, -0.05, 0.03], turn if chain.n > 5 else (0.0, 0.0, 0.0))
    followed = follow_path(chain, path, q, task_mask=mask)
    assert followed.fraction == 1.0, followed.stop
    assert held_errors(chain, path, followed.joints, mask).max() < 2e-7
    free = held_errors(chain, path, followed.joints, np.logical_not(mask))
    assert free.max() > 1e-3


def test_a_tool_axis_is_that_of_the_path_also_after_more_than_half_a_turn():
    # The path turns the tool by 4 rad about its own axis; the arm need not turn it at all.
    chain, q = load_robot("puma560"), np.array(START["puma560"])
    here = forward_kinematics(chain, q)
    poses = [here.copy() for _ in range(3)]
    for k, pose in enumerate(poses):
        turn = Rotation.from_rotvec([0.0, 0.0, 2.0 * (k + 1)])
        pose[:3, :3] = here[:3, :3] @ turn.as_matrix()
        pose[0, 3] += 0.02 * (k + 1)
    path = waypoint_path(here, poses)
    joints = follow_path(chain, path, q, task_mask=TOOL_AXIS).joints
    assert joints.length == path.length
    assert held_errors(chain, path, joints, TOOL_AXIS).max() < 2e-7
    ends = joints.derivatives([0.0, joints.length])[0]
    assert np.abs(ends[1] - ends[0]).max() < 0.5


def test_orientations_of_waypoints_count_as_far_as_they_are_held():
    q = np.array(START["puma560"])
    here = forward_kinematics(load_robot("puma560"), q)
    there = here.copy()
    there[0, 3] += 0.05
    # Opposite orientations, between which a full path could not choose its way.
    there[:3, :3] = here[:3, :3] @ np.diag([-1.0, -1.0, 1.0])
    with pytest.raises(BadValueError, match="opposite orientations"):
        waypoint_path(here, [there])
    for mask in (POSITION, TOOL_AXIS):
        poses = waypoint_path(here, [there], task_mask=mask).sample(np.linspace(0.0, 0.05, 9)).pose
        np.testing.assert_allclose(poses[:, :3, :3], np.tile(here[:3, :3], (9, 1, 1)), atol=1e-9)
    tilted = there.copy()
    tilted[:3, :3] = there[:3, :3] @ Rotation.from_rotvec([0.0, 0.4, 0.0]).as_matrix()
    end = waypoint_path(here, [tilted], task_mask=TOOL_AXIS).waypoints[0]
    np.testing.assert_allclose(end[:3, 2], tilted[:3, 2], atol=1e-12)
    turned = Rotation.from_matrix(here[:3, :3].T @ end[:3, :3]).magnitude()
    assert turned == pytest.approx(0.4, abs=1e-9)


def test_a_singularity_of_what_is_free_does_not_end_a_path():
    chain, q = load_robot("puma560"), np.array([0.1, -0.5, 0.4, 0.3, 0.0, 0.2])  # wrist straight
    path = beside(chain, q, [0.05, 0.0, 0.0])
    assert follow_path(chain, path, q).stop.kind.name == "SINGULAR"
    assert follow_path(chain, path, q, task_mask=POSITION).stop is None


def test_joints_near_their_limits_leave_the_motion_to_others():
    chain, q = load_robot("panda"), np.array([0.2, -0.4, 0.3, -1.8, 0.2, 1.7, 0.4])
    free = follow_path(chain, beside(chain, q, [0.0, 0.12, 0.0]), q, task_mask=POSITION)
    first, last = free.joints.derivatives([0.0, free.joints.length])[0]
    joint = int(np.argmax(np.abs(last - first)))
    # A limit half-way of the joint that moves most: it stops short of it, and the tip arrives.
    lower, upper = chain.lower.copy(), chain.upper.copy()
    bound = upper if last[joint] > first[joint] else lower
    bound[joint] = first[joint] + 0.5 * (last[joint] - first[joint])
    narrow = replace(chain, lower=lower, upper=upper)
    found = follow_path(narrow, beside(chain, q, [0.0, 0.12, 0.0]), q, task_mask=POSITION)
    assert found.stop is None
    values = found.joints.derivatives(np.linspace(0.0, found.joints.length, 100))[0]
    assert (values >= lower).all()
    assert (values <= upper).all()


def test_angular_speed_limits_hold_for_the_tip_itself():
    path = beside(FIVE, FIVE_START, [0.05, 0.0, 0.0])
    plan = plan_along(
        FIVE,
        path,
        FIVE_START,
        task_mask=POSITION,
        limits=limits_of(FIVE),
        profile="time_optimal",
        speeds=TipSpeeds(0.2, 0.3),
    )
    t = np.linspace(0.0, plan.trajectory.duration, 500)
    sample = plan.trajectory.sample(t)
    rates = np.einsum("mij,mj->mi", jacobian(FIVE, sample.position), sample.velocity)
    angular, linear = (np.linalg.norm(part, axis=1).max() for part in (rates[:, :3], rates[:, 3:]))
    assert angular == pytest.approx(0.3, rel=1e-2)
    assert angular <= 0.3 * (1.0 + 1e-6)
    assert linear <= 0.2 * (1.0 + 1e-6)


def test_along_path_takes_an_arm_with_a_mask():
    path = beside(FIVE, FIVE_START, [0.05, 0.0, 0.0])
    arm = serial_arm(FIVE, POSITION)
    motion = along_path(path, arm, limits=limits_of(FIVE), start=FIVE_START)
    assert (motion.fraction, motion.reason) == (1.0, "")
    there = forward_kinematics(FIVE, motion.sample(motion.duration).position)
    np.testing.assert_allclose(there[:3, 3], path.sample(path.length).pose[:3, 3], atol=1e-6)


def test_where_the_held_components_cannot_be_reached_the_path_ends_and_says_so():
    path = beside(FIVE, FIVE_START, [0.5, 0.0, 0.0])
    followed = follow_path(FIVE, path, FIVE_START, task_mask=POSITION)
    assert 0.0 < followed.fraction < 1.0
    assert followed.stop.kind.name in ("SINGULAR", "LOST")


def test_full_masks_and_wrong_ones():
    chain, q = load_robot("puma560"), np.array(START["puma560"])
    path = beside(chain, q, [0.05, 0.0, 0.0])
    plain = follow_path(chain, path, q).joints.pieces.coefficients
    for mask in ((False,) * 6, (True,) * 6):
        masked = follow_path(chain, path, q, task_mask=mask).joints.pieces.coefficients
        np.testing.assert_array_equal(masked, plain)
    with pytest.raises(WrongSizeError, match="task_mask"):
        follow_path(chain, path, q, task_mask=(True,) * 5)
    with pytest.raises(BadValueError, match=r"task_mask\[0\]"):
        follow_path(chain, path, q, task_mask=("x",) * 6)
