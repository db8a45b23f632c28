"""Cartesian plans: on the path, within the limits, told where and why they end."""

import math
from pathlib import Path

import numpy as np
import pytest
from geometry_msgs.msg import Pose, PoseStamped, Quaternion
from sensor_msgs.msg import JointState
from trajectories import waypoints

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import PlanCartesian
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.robots import load_robot
from robomech_ros.trajectory import verify

PUMA = load_robot("puma560")
START = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
HERE = forward_kinematics(PUMA, START)
NODE = "trajectory_planner/plan_cartesian"


@pytest.fixture
def puma(shared):
    return shared(TrajectoryPlannerNode, robot_description="puma560")


def shifted(*steps, of=HERE):
    """Poses beside one another: each displaced from the first by a vector (m)."""
    poses = []
    for step in steps:
        pose = of.copy()
        pose[:3, 3] += step
        poses.append(stamped_pose(pose, ""))
    return poses


def plan(graph, poses, chain=PUMA, start=START, **fields):
    request = PlanCartesian.Request(
        start=joint_state(chain.joint_names, start), waypoints=poses, **fields
    )
    return graph.call(PlanCartesian, NODE, request)


def dense(response, chain=PUMA, count=2000):
    """Poses of the tip along the curve that a controller follows."""
    points = waypoints(response.trajectory)
    q = points.curve.sample(np.linspace(0.0, points.times[-1], count)).position
    return points, forward_kinematics(chain, q)


def off_the_line(points, a, b):
    """Distances of points from the segment from a to b (m)."""
    along = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
    return np.linalg.norm(points - a - along[:, None] * (b - a), axis=1)


def keeps_to(points, chain, start):
    report = verify(points, chain, start=start, start_tolerance=1e-6)
    assert report.ok, report.violation
    assert not points.velocities[-1].any() and not points.accelerations[-1].any()


FIVE_START = np.array([0.4, -0.4, 0.7, 0.3, 0.2])


@pytest.fixture
def five(graph, tmp_path):
    """An arm of five joints, which no straight line with full orientation suits."""
    file = Path(__file__).parents[2] / "data" / "five_joints.urdf"
    chain = load_robot(file)
    limits = tmp_path / "joint_limits.yaml"
    rows = (
        f"  {name}: {{has_acceleration_limits: true, max_acceleration: 5.0}}\n"
        for name in chain.joint_names
    )
    limits.write_text("joint_limits:\n" + "".join(rows), encoding="utf-8")
    options = {"robot_description": str(file), "joint_limits": str(limits)}
    return chain, lambda **more: graph.start(TrajectoryPlannerNode, **options, **more)


@pytest.mark.parametrize("mask", [[True] * 3 + [False] * 3, [True] * 5 + [False]])
def test_what_the_mask_frees_need_not_follow_the_path(graph, five, mask):
    chain, start = five
    start()
    here = forward_kinematics(chain, FIVE_START)
    poses = shifted([0.05, 0.0, 0.0], of=here)
    response = plan(graph, poses, chain, FIVE_START, task_mask=mask)
    assert (response.error_code, response.fraction) == (ErrorCode.NONE, 1.0), response.error_msg
    points, tips = dense(response, chain)
    keeps_to(points, chain, FIVE_START)
    moved = tips[:, :3, 3] - here[:3, 3]
    np.testing.assert_allclose(moved[:, 1:], 0.0, atol=1e-6)
    np.testing.assert_allclose(moved[-1], [0.05, 0.0, 0.0], atol=1e-6)
    angles = np.arccos(np.clip(tips[:, :3, 2] @ here[:3, 2], -1.0, 1.0))
    assert angles.max() < 1e-6 if mask[3] else angles.max() > 1e-2


PROFILES = ("POLY345", "POLY4567", "CYCLOIDAL", "CUBIC_SPLINE", "RUCKIG", "TIME_OPTIMAL")


@pytest.mark.parametrize("profile", PROFILES)
def test_straight_lines_are_straight(puma, profile):
    steps = np.array([[0.1, 0.0, 0.0], [0.1, 0.1, 0.05]])
    response = plan(puma, shifted(*steps), profile=getattr(PlanCartesian.Request, profile))
    assert (response.error_code, response.error_msg) == (ErrorCode.NONE, "")
    assert (response.fraction, response.stop_index, response.stop_reason) == (1.0, 2, "")
    points, poses = dense(response)
    keeps_to(points, PUMA, START)
    corners = HERE[:3, 3] + np.vstack([np.zeros(3), steps])
    off = np.minimum(
        off_the_line(poses[:, :3, 3], *corners[:2]), off_the_line(poses[:, :3, 3], *corners[1:])
    )
    assert off.max() < 1e-6
    np.testing.assert_allclose(poses[-1][:3, 3], corners[-1], atol=1e-7)
    np.testing.assert_allclose(poses[:, :3, :3], np.tile(HERE[:3, :3], (2000, 1, 1)), atol=1e-6)


def test_arcs_and_splines_pass_their_waypoints(puma):
    steps = [[0.05, 0.05, 0.0], [0.1, 0.0, 0.0]]
    arc = plan(puma, shifted(*steps), path=PlanCartesian.Request.ARC)
    assert arc.error_code == ErrorCode.NONE, arc.error_msg
    points, poses = dense(arc)
    keeps_to(points, PUMA, START)
    centre = HERE[:3, 3] + [0.05, 0.0, 0.0]
    radii = np.linalg.norm(poses[:, :3, 3] - centre, axis=1)
    np.testing.assert_allclose(radii, 0.05, atol=1e-6)
    spline = plan(puma, shifted(*steps), path=PlanCartesian.Request.SPLINE)
    points, poses = dense(spline)
    keeps_to(points, PUMA, START)
    for step in steps:
        apart = np.linalg.norm(poses[:, :3, 3] - HERE[:3, 3] - step, axis=1)
        assert apart.min() < 1e-4


@pytest.mark.parametrize("profile", PROFILES[3:])
def test_splines_and_speeds_by_the_profiles_that_are_no_polynomials(puma, profile):
    poses = shifted([0.05, 0.05, 0.0], [0.1, 0.0, 0.0])
    options = {"path": PlanCartesian.Request.SPLINE, "max_linear_speed": 0.1}
    response = plan(puma, poses, profile=getattr(PlanCartesian.Request, profile), **options)
    assert (response.error_code, response.error_msg) == (ErrorCode.NONE, "")
    points, tips = dense(response)
    keeps_to(points, PUMA, START)
    speeds = np.linalg.norm(np.diff(tips[:, :3, 3], axis=0), axis=1) * 1999 / points.times[-1]
    assert 0.09 < speeds.max() < 0.1001


def test_a_plan_of_too_many_points_is_sampled_coarser(graph):
    graph.start(TrajectoryPlannerNode, robot_description="puma560", max_points=400)
    response = plan(graph, shifted([0.2, 0.0, 0.0]), max_linear_speed=0.01)
    assert (response.error_code, response.error_msg) == (ErrorCode.NONE, "")
    points, tips = dense(response)
    keeps_to(points, PUMA, START)
    assert points.times[-1] == pytest.approx(37.5, rel=1e-4) and 200 < len(points.times) <= 400
    assert off_the_line(tips[:, :3, 3], HERE[:3, 3], HERE[:3, 3] + [0.2, 0, 0]).max() < 1e-5


def test_limits_of_a_trajectory_are_told(graph):
    options = {"robot_description": "puma560", "max_points": 10, "max_duration": 3.0}
    graph.start(TrajectoryPlannerNode, **options)
    few = plan(graph, shifted([0.2, 0.0, 0.0]))
    assert few.error_code == ErrorCode.BAD_VALUE and not few.trajectory.points
    assert "expected at most 10, the parameter max_points" in few.error_msg
    long = plan(graph, shifted([0.2, 0.0, 0.0]), max_linear_speed=0.01)
    assert long.error_code == ErrorCode.BAD_VALUE and not long.trajectory.points
    assert "expected at most 3 s, the parameter max_duration" in long.error_msg


def test_a_margin_below_the_limits_is_kept_along_paths(graph):
    graph.start(TrajectoryPlannerNode, robot_description="puma560", limit_margin=0.1)
    response = plan(graph, shifted([0.2, 0.0, 0.0]), profile=PlanCartesian.Request.TIME_OPTIMAL)
    points = waypoints(response.trajectory)
    report = verify(points, PUMA, start=START, start_tolerance=1e-6)
    assert 0.85 < max(report.peak_velocity_ratio.max(), report.peak_acceleration_ratio.max()) <= 0.9


def test_the_tool_keeps_its_speed(puma):
    response = plan(puma, shifted([0.2, 0.0, 0.0]), max_linear_speed=0.05)
    points, poses = dense(response)
    speeds = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1) * 1999 / points.times[-1]
    assert 0.0499 < speeds.max() < 0.0501
    assert points.times[-1] == pytest.approx(0.2 / 0.05 * 15 / 8, rel=1e-4)


def test_a_path_out_of_reach_ends_where_the_arm_does(puma):
    response = plan(puma, shifted([0.1, 0.0, 0.0], [2.0, 0.0, 0.0]))
    assert response.error_code in (ErrorCode.IK_LOST, ErrorCode.SINGULAR)
    assert 0.05 < response.fraction < 0.9 and response.stop_index == 1
    assert response.stop_reason and response.stop_reason in response.error_msg
    points, poses = dense(response)
    keeps_to(points, PUMA, START)
    assert off_the_line(poses[:, :3, 3], HERE[:3, 3], HERE[:3, 3] + [2.0, 0, 0]).max() < 1e-5


def test_a_joint_limit_ends_the_path_with_its_name(puma):
    low = START.copy()
    low[0] = PUMA.upper[0] - 0.05
    here = forward_kinematics(PUMA, low)
    turned = forward_kinematics(PUMA, low + [0.3, 0, 0, 0, 0, 0])
    response = plan(puma, [stamped_pose(turned, "")], start=low)
    assert response.error_code == ErrorCode.LIMIT
    assert f"joint '{PUMA.joint_names[0]}' would leave its limits" in response.stop_reason
    assert 0.0 < response.fraction < 1.0 and response.stop_index == 0
    points, poses = dense(response)
    keeps_to(points, PUMA, low)
    np.testing.assert_allclose(poses[0], here, atol=1e-9)


def test_singular_postures_end_the_path_or_are_passed_slowly(puma):
    """The wrist is nearly stretched half way along."""
    q = np.array([0.3, 0.4, -0.6, 0.0, 0.3, 0.0])
    start = forward_kinematics(PUMA, q)
    end = forward_kinematics(PUMA, [0.3, 0.4, -0.6, 0.0, -0.3, 0.0])
    end[:3, 3] += [0.0, 0.004, 0.0]
    stop = plan(puma, [stamped_pose(end, "")], start=q)
    assert stop.error_code == ErrorCode.SINGULAR and 0.2 < stop.fraction < 0.8
    assert "condition number" in stop.stop_reason
    slow = plan(
        puma,
        [stamped_pose(end, "")],
        start=q,
        at_singularity=PlanCartesian.Request.SLOW,
        revolute_jump_threshold=4.0,
    )
    assert slow.error_code in (ErrorCode.NONE, ErrorCode.LIMIT, ErrorCode.JUMP), slow.error_msg
    assert slow.fraction > stop.fraction
    keeps_to(waypoints(slow.trajectory), PUMA, q)
    assert not np.allclose(start, end)


def test_a_low_threshold_is_a_jump(puma):
    response = plan(puma, shifted([0.2, 0.0, 0.0]), revolute_jump_threshold=1e-4, max_step=0.01)
    assert response.error_code == ErrorCode.JUMP
    assert "over the threshold of a jump, 0.0001" in response.stop_reason
    assert response.fraction < 0.1


def test_a_redundant_arm_follows_a_path(graph):
    panda = load_robot("panda")
    graph.start(TrajectoryPlannerNode, robot_description="panda")
    q = np.array([0.1, -0.3, 0.2, -1.8, 0.1, 1.6, 0.5])
    here = forward_kinematics(panda, q)
    response = plan(graph, shifted([0.1, 0.0, 0.0], [0.1, 0.1, 0.0], of=here), panda, q)
    assert response.error_code == ErrorCode.NONE, response.error_msg
    points, poses = dense(response, panda)
    keeps_to(points, panda, q)
    np.testing.assert_allclose(poses[-1][:3, 3], here[:3, 3] + [0.1, 0.1, 0.0], atol=1e-6)


CASES = {
    "no waypoints": ({"waypoints": []}, ErrorCode.WRONG_SIZE, ["waypoints has size 0"]),
    "the start again": (
        {"waypoints": shifted([0, 0, 0])},
        ErrorCode.BAD_VALUE,
        ["waypoints is '1 pose equal to the start', expected at least one other pose"],
    ),
    "an arc through the start": (
        {"path": 2, "waypoints": shifted([0, 0, 0], [0.1, 0.1, 0])},
        ErrorCode.BAD_VALUE,
        ["position of waypoints[0] is", "expected apart from that of the start"],
    ),
    "an arc back to the start": (
        {"path": 2, "waypoints": shifted([0.1, 0, 0], [0, 0, 0])},
        ErrorCode.BAD_VALUE,
        ["position of waypoints[1] is", "expected apart from that of the start"],
    ),
    "a second arc to the same place": (
        {"path": 2, "waypoints": shifted([0.1, 0, 0], [0.1, 0.1, 0], [0.1, 0.2, 0], [0.1, 0.2, 0])},
        ErrorCode.BAD_VALUE,
        ["position of waypoints[3] is", "expected apart from that of waypoints[2]"],
    ),
    "opposite orientations": (
        {"waypoints": shifted([0.1, 0, 0], of=HERE @ np.diag([-1.0, -1.0, 1.0, 1.0]))},
        ErrorCode.BAD_VALUE,
        ["angle (rad) from the start to waypoints[0] is 3.14159"],
    ),
    "opposite orientations on an arc": (
        {
            "path": 2,
            "waypoints": shifted([0.1, 0, 0], [0.1, 0.1, 0], of=HERE @ np.diag([-1, -1, 1, 1])),
        },
        ErrorCode.BAD_VALUE,
        ["angle (rad) from the start to waypoints[0] is 3.14159"],
    ),
    "fast beyond sense": (
        {"max_linear_speed": 1e7},
        ErrorCode.BAD_VALUE,
        ["max_linear_speed is 10000000.0, expected at most 1e+06"],
    ),
    "turning beyond sense": (
        {"max_angular_speed": 1e300},
        ErrorCode.BAD_VALUE,
        ["max_angular_speed is 1e+300, expected at most 1e+06"],
    ),
    "half an arc": ({"path": 2}, ErrorCode.WRONG_SIZE, ["pairs of poses"]),
    "an arc on a line": (
        {"path": 2, "waypoints": shifted([0.1, 0, 0], [0.2, 0, 0])},
        ErrorCode.BAD_VALUE,
        ["positions of the start, waypoints[0], waypoints[1]", "three points not on a line"],
    ),
    "a spline straight back": (
        {"path": 1, "waypoints": shifted([0, 0, 0], [0.1, 0, 0], [0.05, 0, 0])},
        ErrorCode.BAD_VALUE,
        ["waypoints[1]", "need not go straight back", "a straight path rests there"],
    ),
    "unknown path": ({"path": 9}, ErrorCode.BAD_VALUE, ["STRAIGHT (0), SPLINE (1), ARC (2)"]),
    "unknown profile": (
        {"profile": 77},
        ErrorCode.BAD_VALUE,
        ["profile is 77", "POLY345 (0), POLY4567 (1)", "TIME_OPTIMAL (5)"],
    ),
    "unknown end": ({"at_singularity": 5}, ErrorCode.BAD_VALUE, ["STOP (0), SLOW (1)"]),
    "quaternion": (
        {"waypoints": [PoseStamped(pose=Pose(orientation=Quaternion(w=0.0)))]},
        ErrorCode.BAD_QUATERNION,
        ["waypoints[0]"],
    ),
    "frame": ({"waypoints": [stamped_pose(HERE, "moon")]}, ErrorCode.FRAME_UNAVAILABLE, ["moon"]),
    "negative speed": ({"max_linear_speed": -1.0}, ErrorCode.BAD_VALUE, ["max_linear_speed"]),
    "speed is none": ({"max_angular_speed": math.nan}, ErrorCode.NON_FINITE, ["max_angular"]),
    "infinite step": ({"max_step": math.inf}, ErrorCode.NON_FINITE, ["max_step"]),
    "slow beyond sense": ({"max_linear_speed": 1e-300}, ErrorCode.BAD_VALUE, ["at least 1e-06"]),
    "fine beyond memory": ({"max_step": 1e-300}, ErrorCode.BAD_VALUE, ["at least 1e-05"]),
    "too many": (
        {"waypoints": shifted(*[[0.001 * k, 0, 0] for k in range(201)])},
        ErrorCode.WRONG_SIZE,
        ["waypoints", "201", "at most 200, the parameter max_waypoints"],
    ),
    "too far": (
        {"waypoints": shifted([1e300, 0, 0])},
        ErrorCode.BAD_VALUE,
        ["waypoints[0].position is 1e+300, expected coordinates of at most 1e+06 m"],
    ),
    "condition": ({"condition_limit": -2.0}, ErrorCode.BAD_VALUE, ["condition_limit"]),
    "start of another size": (
        {"start": JointState(position=[0.0] * 5)},
        ErrorCode.WRONG_SIZE,
        ["start"],
    ),
    "start outside its limits": (
        {"start": JointState(position=[9.0, -0.4, 0.2, 0.5, 0.6, -0.7])},
        ErrorCode.SEED_OUTSIDE_LIMITS,
        ["start", "waist", "9"],
    ),
}


def test_every_bad_request_is_refused_and_the_node_goes_on_serving(puma):
    good = {"start": joint_state(PUMA.joint_names, START), "waypoints": shifted([0.1, 0, 0])}
    for name, (fields, code, parts) in CASES.items():
        response = puma.call(PlanCartesian, NODE, PlanCartesian.Request(**(good | fields)))
        assert response.error_code == code, (name, response.error_msg)
        for part in parts:
            assert part in response.error_msg, (name, response.error_msg)
        assert not response.trajectory.points, name
    after = puma.call(PlanCartesian, NODE, PlanCartesian.Request(**good))
    assert after.error_code == ErrorCode.NONE
