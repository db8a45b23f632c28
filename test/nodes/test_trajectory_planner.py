"""The trajectory planner: plans that keep what they promise, over real DDS."""

import numpy as np
import pytest
from nav_msgs.msg import Path
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import PlanJoint
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.conversions import (
    duration_from_seconds,
    joint_state,
    matrix_from_pose,
    seconds_from_duration,
)
from robomech_ros.nodes.trajectory_planner_node import TrajectoryPlannerNode
from robomech_ros.robots import load_description, load_robot
from robomech_ros.trajectory import Waypoints, point_to_point, verify

PUMA = load_robot("puma560")
START = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
GOAL = np.array([-1.2, 0.8, -1.5, 1.5, -0.4, 2.7])
PROFILES = {"poly345": PlanJoint.Request.POLY345, "ruckig": PlanJoint.Request.RUCKIG}
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def puma(graph):
    graph.start(TrajectoryPlannerNode, robot_description="puma560")
    return graph


@pytest.fixture(params=sorted(PROFILES))
def profile(request):
    return request.param


def plan(graph, **fields):
    request = {
        "start": joint_state(PUMA.joint_names, START),
        "goal": joint_state(PUMA.joint_names, GOAL),
    } | fields
    return graph.call(PlanJoint, "trajectory_planner/plan_joint", PlanJoint.Request(**request))


def waypoints(trajectory):
    seconds = [seconds_from_duration(point.time_from_start, "time") for point in trajectory.points]
    states = (
        np.array([getattr(point, name) for point in trajectory.points])
        for name in ("positions", "velocities", "accelerations")
    )
    return Waypoints(np.array(seconds), *states)


def check(response, chain=PUMA, start=START, goal=GOAL):
    """Check what every plan promises; returns its waypoints."""
    assert (response.error_code, response.error_msg) == (ErrorCode.NONE, "")
    assert response.trajectory.joint_names == list(chain.joint_names)
    assert response.trajectory.header.frame_id == ""
    assert response.trajectory.header.stamp.sec == 0
    points = waypoints(response.trajectory)
    report = verify(points, chain, start=start, start_tolerance=0.0)
    assert report.ok, report.violation
    np.testing.assert_array_equal(points.positions[-1], goal)
    assert not points.velocities[-1].any()
    assert not points.accelerations[-1].any()
    assert response.duration == response.trajectory.points[-1].time_from_start
    for rate in ("velocity", "acceleration", "jerk"):
        ratio = np.array(getattr(response, f"peak_{rate}_ratio"))
        np.testing.assert_allclose(ratio, getattr(report, f"peak_{rate}_ratio"), rtol=1e-6)
        assert ratio.max() <= 1.0
    return points


def test_a_plan_is_as_fast_as_the_limits_allow(puma, profile):
    response = plan(puma, profile=PROFILES[profile])
    points = check(response)
    fastest = point_to_point(START, GOAL, limits=PUMA, profile=profile)
    assert points.times[-1] == pytest.approx(fastest.duration, rel=1e-4)
    np.testing.assert_allclose(points.positions, fastest.sample(points.times).position, atol=1e-4)
    assert np.diff(points.times).max() <= 0.01 + 1e-9
    peaks = (
        response.peak_velocity_ratio,
        response.peak_acceleration_ratio,
        response.peak_jerk_ratio,
    )
    assert max(map(max, peaks)) == pytest.approx(1.0, rel=1e-4)


def test_a_wanted_duration_and_a_wanted_period(puma, profile):
    response = plan(
        puma,
        profile=PROFILES[profile],
        duration=duration_from_seconds(7.25),
        sample_period=0.125,
    )
    points = check(response)
    assert points.times[-1] == 7.25
    steps = np.diff(points.times)
    assert 0.1 < steps.max() <= 0.125 + 1e-9


def test_scales_are_parts_of_the_limits(puma, profile):
    full = plan(puma, profile=PROFILES[profile])
    response = plan(
        puma,
        profile=PROFILES[profile],
        velocity_scale=0.5,
        acceleration_scale=0.25,
        jerk_scale=0.125,
    )
    check(response)
    assert max(response.peak_velocity_ratio) <= 0.5
    assert max(response.peak_acceleration_ratio) <= 0.25
    assert max(response.peak_jerk_ratio) <= 0.125
    seconds = [seconds_from_duration(answer.duration, "") for answer in (full, response)]
    assert seconds[1] == pytest.approx(2.0 * seconds[0], rel=1e-3)


def test_names_in_any_order_and_without_names(puma):
    expected = plan(puma)
    check(expected)
    order = [3, 0, 5, 1, 4, 2]
    shuffled = joint_state([PUMA.joint_names[k] for k in order], GOAL[order])
    assert plan(puma, goal=shuffled) == expected
    assert plan(puma, goal=JointState(position=GOAL.tolist())) == expected
    assert plan(puma, start=JointState(position=START.tolist())) == expected


def test_a_motion_of_no_length(puma, profile):
    response = plan(puma, goal=joint_state(PUMA.joint_names, START), profile=PROFILES[profile])
    points = check(response, goal=START)
    assert len(points.times) >= 2
    assert points.times[-1] <= 0.01


def test_an_empty_start_is_the_present_state(puma):
    response = plan(puma, start=JointState())
    assert response.error_code == ErrorCode.NO_STATE
    assert "waist" in response.error_msg
    publisher = puma.client.create_publisher(JointState, "joint_states", 10)
    backwards = joint_state(PUMA.joint_names[::-1], START[::-1])
    timer = puma.client.create_timer(0.01, lambda: publisher.publish(backwards))
    for _ in range(1000):
        response = plan(puma, start=JointState())
        if response.error_code == ErrorCode.NONE:
            break
    timer.cancel()
    check(response)


def test_plans_and_paths_are_published_and_latched(puma, profile):
    response = plan(puma, profile=PROFILES[profile])
    published = puma.receive(
        JointTrajectory, "trajectory_planner/planned_trajectory", LATCHED, lambda _: True
    )
    assert published == response.trajectory
    path = puma.receive(Path, "trajectory_planner/planned_path", LATCHED, lambda _: True)
    assert path.header.frame_id == PUMA.base
    points = waypoints(response.trajectory)
    assert len(path.poses) == len(points.times)
    poses = np.array([matrix_from_pose(stamped.pose) for stamped in path.poses])
    np.testing.assert_allclose(poses, forward_kinematics(PUMA, points.positions), atol=1e-12)
    assert {stamped.header.frame_id for stamped in path.poses} == {PUMA.base}


def test_the_same_request_twice_gives_the_same_answer(puma, profile):
    assert plan(puma, profile=PROFILES[profile]) == plan(puma, profile=PROFILES[profile])


@pytest.mark.parametrize("robot", ["ur5e", "panda", "stanford", "scara", "planar3r"])
def test_other_robots(graph, robot, profile):
    chain = load_robot(robot)
    graph.start(TrajectoryPlannerNode, robot_description=robot)
    middle = chain.midrange()
    start = np.clip(middle - 0.4, chain.lower, chain.upper)
    goal = np.clip(middle + 0.6, chain.lower, chain.upper)
    response = graph.call(
        PlanJoint,
        "trajectory_planner/plan_joint",
        PlanJoint.Request(
            start=joint_state(chain.joint_names, start),
            goal=joint_state(chain.joint_names, goal),
            profile=PROFILES[profile],
        ),
    )
    check(response, chain, start, goal)


def test_the_robot_may_come_from_the_latched_topic(graph):
    graph.start(TrajectoryPlannerNode)
    assert not graph.client.create_client(
        PlanJoint, "trajectory_planner/plan_joint"
    ).wait_for_service(0.1)
    publisher = graph.client.create_publisher(String, "robot_description", LATCHED)
    with open(load_description("ur5e").where, encoding="utf-8") as file:
        publisher.publish(String(data=file.read()))
    chain = load_robot("ur5e")
    response = graph.call(
        PlanJoint,
        "trajectory_planner/plan_joint",
        PlanJoint.Request(
            start=JointState(position=[0.0] * 6), goal=JointState(position=[1.0] * 6)
        ),
    )
    assert response.error_code == ErrorCode.MISSING_LIMITS  # a URDF has no acceleration limits
    assert chain.joint_names[0] in response.error_msg


def test_period_and_number_of_points_are_parameters(graph):
    graph.start(
        TrajectoryPlannerNode, robot_description="puma560", sample_period=0.1, max_points=50
    )
    points = check(plan(graph))
    assert 0.05 < np.diff(points.times).max() <= 0.1
    response = plan(graph, sample_period=0.01)
    assert response.error_code == ErrorCode.BAD_VALUE
    assert "may have 50 points" in response.error_msg
