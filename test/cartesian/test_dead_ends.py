"""Paths that end at the boundary of the workspace: what is said of it, and how long they last."""

from dataclasses import replace

import numpy as np
import pytest

from robomech_ros.cartesian import PathStopLimits, follow_path, plan_along, waypoint_path
from robomech_ros.cartesian.dead_ends import SLOWEST
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import chain_from_dh, load_robot
from robomech_ros.trajectory import PathTrackingStatus

UR5E, UR_START = load_robot("ur5e"), np.array([0.3, -1.2, 1.4, -1.7, -1.5, 0.2])
PUMA, PUMA_START = load_robot("puma560"), np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
SLOW = PathStopLimits(condition=np.inf)


def line(chain, start, direction, steps=20):
    """A straight path of steps of 0.1 m."""
    here = forward_kinematics(chain, start)
    waypoints = np.tile(here, (steps, 1, 1))
    waypoints[:, :3, 3] += 0.1 * np.arange(1, steps + 1)[:, None] * np.array(direction)
    return waypoint_path(here, waypoints)


@pytest.mark.parametrize("chain, start", [(UR5E, UR_START), (PUMA, PUMA_START)])
def test_a_stretched_arm_is_said_with_the_waypoint(chain, start):
    path = line(chain, start, [0.0, 1.0, 0.0])
    stop = follow_path(chain, path, start, bounds=SLOW).stop
    assert stop.kind is PathTrackingStatus.LOST
    assert stop.text.startswith(f"before waypoints[{stop.index}], at s = 0.")
    assert "the elbow is straight: out of reach beyond" in stop.text
    near = follow_path(chain, path, start).stop
    assert near.kind is PathTrackingStatus.SINGULAR
    assert near.text.endswith("too near to a singularity, the elbow is nearly straight")


@pytest.mark.parametrize("robot, joint", [("panda", "panda_joint4"), ("gen3", "joint_4")])
def test_an_arm_whose_elbow_has_no_name_names_the_joint(robot, joint):
    """It said "the arm has no posture beyond", and nothing of what stretches."""
    chain = load_robot(robot)
    path = line(chain, chain.home(), [1.0, 0.0, 0.0])
    stop = follow_path(chain, path, chain.home(), bounds=SLOW).stop
    assert stop.kind is PathTrackingStatus.LOST
    assert f"joint '{joint}' turns ever faster: out of reach beyond" in stop.text
    near = follow_path(chain, path, chain.home()).stop
    assert near.text.endswith(f"too near to a singularity, joint '{joint}' turns ever faster")


def test_a_posture_on_another_branch_beyond_the_boundary_is_a_jump_with_its_unit():
    path = line(UR5E, UR_START, [0.0, 0.0, 1.0])
    stop = follow_path(UR5E, path, UR_START, bounds=SLOW).stop
    assert (stop.kind, stop.joint) == (PathTrackingStatus.JUMP, "wrist_2_joint")
    assert "the elbow is straight: out of reach beyond on this branch" in stop.text
    assert "joint 'wrist_2_joint' would have to jump by 3.12 rad; " in stop.text


@pytest.mark.parametrize(
    "direction", [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
)
def test_the_way_to_a_dead_end_is_left_where_it_is_pointless(direction):
    """Lasted 17 to 67 s before, 3 to 6 s with a bound of the condition number."""
    path = line(UR5E, UR_START, direction)
    plan = plan_along(UR5E, path, UR_START, bounds=SLOW)
    stop = plan_along(UR5E, path, UR_START)
    assert plan.fraction > stop.fraction
    assert plan.trajectory.duration < 2.0 * stop.trajectory.duration < 12.0
    assert "on which the joints allow less than 0.01 m/s, are left out" in plan.stop.text
    joints = plan.followed.joints
    rates = np.abs(joints.derivatives(joints.length)[1])
    assert (UR5E.velocity / rates).min() == pytest.approx(SLOWEST, rel=1e-6)
    points = plan.samples
    assert not points.velocities[-1].any() and not points.accelerations[-1].any()


def test_a_slow_robot_is_not_held_to_the_speed_of_others():
    path = line(UR5E, UR_START, [1.0, 0.0, 0.0])
    slow = replace(UR5E, velocity=1e-3 * UR5E.velocity)
    found = follow_path(UR5E, path, UR_START, bounds=SLOW, limits=slow)
    usual = follow_path(UR5E, path, UR_START, bounds=SLOW)
    assert found.fraction == pytest.approx(usual.fraction, abs=1e-3)


def test_a_folded_elbow_is_called_folded():
    """A forearm half as long as the upper arm keeps the wrist 0.3 m off the shoulder."""
    right = np.pi / 2.0
    arm = chain_from_dh(
        [0.0, 0.6, 0.0, 0.0, 0.0, 0.0],
        [0.5, 0.0, 0.0, 0.3, 0.0, 0.1],
        [right, 0.0, right, -right, right, 0.0],
    )
    start = np.array([0.2, 0.4, 2.0 + right, 0.3, 0.8, 0.1])
    here = forward_kinematics(arm, start)
    there = here.copy()
    wrist = here[:3, 3] - 0.1 * here[:3, 2]
    there[:3, 3] += 0.9 * ([0.0, 0.0, 0.5] - wrist)
    stop = follow_path(arm, waypoint_path(here, [there]), start, bounds=SLOW).stop
    assert "the elbow is folded: out of reach beyond" in stop.text
    assert stop.kind is PathTrackingStatus.LOST


def test_a_folded_elbow_between_parallel_axes_is_called_folded():
    turn = np.full(6, 6.28)
    arm = replace(UR5E, lower=-turn, upper=turn)
    start = np.array([0.0, -1.0, 2.8, -1.4, -1.5, 0.0])
    path = line(arm, start, [-1.0, 0.0, 0.0], steps=5)
    found = follow_path(arm, path, start, bounds=SLOW)
    assert 3.1 < found.joints.derivatives(found.joints.length)[0][2] < np.pi
    assert "the elbow is folded: the joint values change too fast" in found.stop.text
