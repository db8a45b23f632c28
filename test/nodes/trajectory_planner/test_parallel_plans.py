"""Plans of parallel robots: drives in trajectories, one assembly mode, and why a motion ends."""

import nav_msgs.msg
import numpy as np
import pytest
from geometry_msgs.msg import Pose, PoseStamped
from sensor_msgs.msg import JointState
from trajectories import waypoints
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import PlanCartesian, PlanJoint
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, stamped_pose
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.parallel import follow_drives, load_parallel
from robomech_ros.spatial import matrix_from_rotation_vector, pose_error
from robomech_ros.trajectory import Limits, verify

ROBOTS = {name: load_parallel(name).mechanism for name in ("hexapod", "delta", "planar_3rpr")}
# A way of the platform from home (m), and one of the drives (rad or m), that nothing hinders.
WAY = {"hexapod": (0.05, 0.03, 0.06), "delta": (0.1, -0.15, 0.1)}
AWAY = {"hexapod": [0.05, 0.1, -0.03, 0.02, 0.08, 0.0], "delta": [0.4, 0.1, -0.2]}
PROFILES = ("POLY345", "RUCKIG", "TIME_OPTIMAL")


@pytest.fixture(params=WAY)
def robot(request, graph):
    graph.start(TrajectoryPlannerNode, robot_description=request.param)
    return graph, request.param, ROBOTS[request.param]


def start_of(mechanism):
    return joint_state(mechanism.joint_names, mechanism.home())


def drives(mechanism, away):
    return joint_state(mechanism.actuated, mechanism.home()[mechanism.drive_index] + away)


def plan_joint(graph, **fields):
    return graph.call(PlanJoint, "trajectory_planner/plan_joint", PlanJoint.Request(**fields))


def plan_cartesian(graph, **fields):
    request = PlanCartesian.Request(**fields)
    return graph.call(PlanCartesian, "trajectory_planner/plan_cartesian", request)


def moved(mechanism, *ways):
    """Poses of the platform beside that at home (m)."""
    poses = []
    for way in ways:
        pose = mechanism.pose(mechanism.home())
        pose[:3, 3] += way
        poses.append(stamped_pose(pose, ""))
    return poses


def followed(mechanism, response):
    """All joints along the curve that a controller follows, within the limits of the drives."""
    assert response.trajectory.joint_names == list(mechanism.actuated)
    points = waypoints(response.trajectory)
    limits = Limits.of(mechanism).only(mechanism.drive_index.tolist())
    report = verify(points, limits, start=mechanism.home()[mechanism.drive_index])
    assert report.ok, report.violation
    positions = points.curve.sample(np.linspace(0.0, points.times[-1], 400)).position
    found = follow_drives(mechanism, positions, mechanism.home())
    assert found.stop is None
    return found.q


@pytest.mark.parametrize("profile", PROFILES)
def test_drives_move_from_posture_to_posture(robot, profile):
    graph, name, mechanism = robot
    response = plan_joint(
        graph,
        start=start_of(mechanism),
        goal=drives(mechanism, AWAY[name]),
        profile=getattr(PlanJoint.Request, profile),
    )
    assert (response.error_code, response.error_msg) == (ErrorCode.NONE, "")
    assert max(response.peak_velocity_ratio) <= 1.0
    q = followed(mechanism, response)[-1]
    goal = mechanism.home()[mechanism.drive_index] + AWAY[name]
    assert np.abs(q[mechanism.drive_index] - goal).max() < 1e-9


@pytest.mark.parametrize("profile", PROFILES)
def test_the_platform_stays_on_a_line(robot, profile):
    graph, name, mechanism = robot
    response = plan_cartesian(
        graph,
        start=start_of(mechanism),
        waypoints=moved(mechanism, WAY[name]),
        profile=getattr(PlanCartesian.Request, profile),
    )
    assert (response.error_code, response.error_msg) == (ErrorCode.NONE, "")
    assert response.fraction == 1.0
    poses = mechanism.pose(followed(mechanism, response))
    here, way = mechanism.pose(mechanism.home()), np.array(WAY[name])
    off = poses[:, :3, 3] - here[:3, 3]
    off -= np.outer(off @ way, way) / (way @ way)
    assert np.linalg.norm(off, axis=1).max() < 1e-6
    assert np.abs(poses[:, :3, :3] - here[:3, :3]).max() < 1e-6
    assert np.abs(poses[-1, :3, 3] - here[:3, 3] - way).max() < 1e-7


def test_plans_are_published_with_the_way_of_the_platform(robot):
    graph, name, mechanism = robot
    poses = moved(mechanism, WAY[name])
    response = plan_cartesian(graph, start=start_of(mechanism), waypoints=poses)
    published = graph.receive(
        JointTrajectory, "trajectory_planner/planned_trajectory", LATCHED, lambda _: True
    )
    assert published == response.trajectory
    path = graph.receive(
        nav_msgs.msg.Path, "trajectory_planner/planned_path", LATCHED, lambda _: True
    )
    assert path.header.frame_id == mechanism.base_link
    assert len(path.poses) == len(response.trajectory.points)
    last = matrix_from_pose(path.poses[-1].pose)
    assert np.abs(pose_error(matrix_from_pose(poses[0].pose), last)).max() < 1e-6


def test_a_start_in_another_assembly_mode_than_the_robot_is_refused(robot):
    graph, name, mechanism = robot
    home = mechanism.home()
    other = mechanism.direct(home[mechanism.drive_index], seed=home).q[-1]
    goal = drives(mechanism, np.multiply(AWAY[name], 0.1))
    start = joint_state(mechanism.joint_names, other)
    # As long as nobody knows where the robot is, every start within its cones will do.
    expected = ErrorCode.LIMIT if name == "hexapod" else ErrorCode.NONE
    assert plan_joint(graph, start=start, goal=start).error_code == expected
    publisher = graph.client.create_publisher(JointState, "joint_states", 10)
    graph.client.create_timer(0.01, lambda: publisher.publish(start_of(mechanism)))
    request = PlanJoint.Request(start=start, goal=goal)
    refused = graph.call_until(
        PlanJoint,
        "trajectory_planner/plan_joint",
        request,
        lambda answer: answer.error_code == ErrorCode.JUMP,
    )
    assert "start is in another assembly mode" in refused.error_msg
    response = plan_joint(graph, start=start_of(mechanism), goal=start)
    assert response.error_code == ErrorCode.JUMP
    assert "goal is in another assembly mode" in response.error_msg
    assert not response.trajectory.points


def test_a_path_ends_at_a_stroke_with_leg_and_amount(graph):
    mechanism = ROBOTS["hexapod"]
    graph.start(TrajectoryPlannerNode, robot_description="hexapod")
    poses = moved(mechanism, (0.0, 0.0, 0.05), (0.0, 0.0, 0.8))
    response = plan_cartesian(graph, start=start_of(mechanism), waypoints=poses)
    assert (response.error_code, response.stop_index) == (ErrorCode.LIMIT, 1)
    longest = load_parallel("hexapod").inverse(matrix_from_pose(poses[1].pose)).max()
    assert f"{longest - 0.95:.3g} m" in response.stop_reason
    assert "_length'" in response.error_msg
    assert 0.0 < response.fraction < 1.0
    followed(mechanism, response)


def test_a_singularity_ends_a_path_and_refuses_a_motion_of_the_drives(graph):
    mechanism = ROBOTS["planar_3rpr"]
    graph.start(TrajectoryPlannerNode, robot_description="planar_3rpr")
    pose = mechanism.pose(mechanism.home())
    pose[:3, :3] = pose[:3, :3] @ matrix_from_rotation_vector([0.0, 0.0, 0.5])
    pose[0, 3] += 2.0
    response = plan_cartesian(
        graph,
        start=start_of(mechanism),
        waypoints=[stamped_pose(pose, "")],
        at_singularity=PlanCartesian.Request.SLOW,
    )
    assert response.error_code == ErrorCode.SINGULAR
    assert "hardly hold the platform against" in response.stop_reason
    followed(mechanism, response)
    goal = drives(mechanism, [-7.0, 1.0, -6.0])
    response = plan_joint(graph, start=start_of(mechanism), goal=goal)
    assert response.error_code == ErrorCode.SINGULAR
    assert "stop before point" in response.error_msg
    assert not response.trajectory.points


def test_a_start_without_a_real_pose_says_how_near_one_comes(graph):
    mechanism = ROBOTS["hexapod"]
    graph.start(TrajectoryPlannerNode, robot_description="hexapod")
    lengths = np.array([0.949, 0.949, 0.601, 0.949, 0.601, 0.601])
    start = joint_state(mechanism.actuated, lengths)
    response = plan_joint(graph, start=start, goal=start_of(mechanism))
    assert response.error_code == ErrorCode.OUT_OF_REACH
    assert "start: no real pose: the nearest one found misses the lengths" in response.error_msg


def wrong_requests():
    delta = ROBOTS["delta"]
    turned = PoseStamped(pose=Pose())
    turned.pose.orientation.x, turned.pose.orientation.w = 0.6, 0.8
    turned.pose.position.z = -1.0
    apart = delta.home()
    apart[delta.joint_names.index("leg2_elbow_tilt")] += 0.1
    return {
        "turn": ({"waypoints": [turned]}, ErrorCode.BAD_VALUE, "a turn about x"),
        "open loops": (
            {"start": joint_state(delta.joint_names, apart)},
            ErrorCode.BAD_VALUE,
            "limb 2",
        ),
        "not a number": (
            {"start": joint_state(delta.actuated, np.array([0.0, np.nan, 0.0]))},
            ErrorCode.NON_FINITE,
            "leg2_base",
        ),
        "unknown joint": (
            {"start": JointState(name=["arm"], position=[0.0])},
            ErrorCode.UNKNOWN_JOINT,
            "leg1_base",
        ),
        "too few": ({"start": JointState(position=[0.0] * 4)}, ErrorCode.WRONG_SIZE, "3"),
    }


@pytest.mark.parametrize("case", wrong_requests())
def test_wrong_requests_get_code_and_text(graph, case):
    fields, code, text = wrong_requests()[case]
    delta = ROBOTS["delta"]
    graph.start(TrajectoryPlannerNode, robot_description="delta")
    asked = {"start": start_of(delta), "waypoints": moved(delta, WAY["delta"]), **fields}
    response = plan_cartesian(graph, **asked)
    assert (response.error_code, text in response.error_msg) == (code, True), response.error_msg
    assert not response.trajectory.points
