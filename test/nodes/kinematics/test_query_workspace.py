"""Which poses can be reached, over real DDS, while others are served."""

import math

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import Marker, MarkerArray

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import AnalyzeSingularity, QueryWorkspace, SolveFK
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import jacobian, reach_limits, workspace_boundary
from robomech_ros.kinetostatics.workspace.boundary import positioning_boundary
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.robots import load_robot

PUMA = load_robot("puma560")
Q = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])


def query(graph, poses, **fields):
    return graph.ask(QueryWorkspace, "kinematics/query_workspace", poses=poses, **fields)


def test_poses_are_judged(graph):
    graph.start(KinematicsNode, robot_description="puma560")
    T = np.stack([forward_kinematics(PUMA, Q)] * 3)
    T[1, :3, 3] = 2.0, 0.0, 0.0
    # Inside the limits of one joint, outside those of another: behind the robot.
    T[2, :3, 3] = -0.5, 0.0, 0.0
    answer = query(graph, [stamped_pose(pose, "") for pose in T])
    assert answer.error_code == ErrorCode.NONE, answer.error_msg
    expected = [inverse_kinematics(PUMA, pose) for pose in T]
    assert list(answer.solution_count) == [len(result) for result in expected]
    assert list(answer.reachable) == [len(result) > 0 for result in expected]
    assert list(answer.reason) == [int(result.status) for result in expected]
    assert list(answer.reachable)[:2] == [True, False]
    assert answer.reason[1] == ErrorCode.OUT_OF_REACH
    assert 1.0 < answer.condition_numbers[0] < 1e3
    assert math.isinf(answer.condition_numbers[1])
    # The wrist centre of this robot is the origin of its tip.
    distances = workspace_boundary(PUMA).distance(T[:, :3, 3])
    assert list(answer.boundary_distances) == pytest.approx(distances.tolist())
    assert answer.boundary_distances[0] > 0.0 > answer.boundary_distances[1]
    assert (answer.least_reach, answer.greatest_reach) == pytest.approx(reach_limits(PUMA))
    assert answer.least_reach < np.linalg.norm(T[0, :3, 3]) < answer.greatest_reach
    # The position alone, however the hand stands.
    turned = T[:1].copy()
    turned[0, :3, :3] = np.diag((1.0, -1.0, -1.0)) @ turned[0, :3, :3]
    mask = [True, True, True, False, False, False]
    assert list(query(graph, [stamped_pose(turned[0], "")], task_mask=mask).reachable) == [True]
    # Half-planes with the boundary are shown, too.
    shown = graph.receive(MarkerArray, "kinematics/markers", LATCHED, lambda m: len(m.markers) > 1)
    strips = [marker for marker in shown.markers if marker.ns == "workspace"]
    assert len(strips) >= 8
    assert {strip.type for strip in strips} == {Marker.LINE_STRIP}
    assert all(strip.header.frame_id == PUMA.base for strip in strips)
    ends = np.array([[p.x, p.y, p.z] for strip in strips for p in (strip.points[0],)])
    assert np.linalg.norm(ends, axis=1).max() <= workspace_boundary(PUMA).greatest_reach + 1e-6
    # The cloud of what was judged last is there for those who come later, too.
    cloud = graph.receive(PointCloud2, "kinematics/workspace", LATCHED, lambda c: c.width == 1)
    assert cloud.header.frame_id == PUMA.base
    numbers = np.frombuffer(cloud.data, np.float32)
    assert numbers[:3] == pytest.approx(turned[0, :3, 3])
    empty = query(graph, [])
    assert (empty.error_code, list(empty.reachable)) == (0, [])
    assert empty.greatest_reach == answer.greatest_reach


def test_an_arm_without_a_positioning_part_and_others_meanwhile(graph):
    ur5e = load_robot("ur5e")
    graph.start(KinematicsNode, robot_description="ur5e")
    pose = stamped_pose(forward_kinematics(ur5e, np.full(6, 0.4)), "")
    request = QueryWorkspace.Request(poses=[pose] * 2000)
    waiting = graph.start_call(QueryWorkspace, "kinematics/query_workspace", request)
    served = graph.call(
        SolveFK,
        "kinematics/solve_fk",
        SolveFK.Request(states=[joint_state(ur5e.joint_names, np.full(6, 0.4))]),
    )
    assert served.error_code == 0
    assert not waiting.done()
    answer = graph.wait_for(waiting)
    assert answer.error_code == 0
    assert all(answer.reachable)
    assert np.isnan(answer.boundary_distances).all()


def test_ellipsoids_and_lost_directions_are_shown(graph):
    graph.start(KinematicsNode, robot_description="puma560")
    q = Q.copy()
    q[4] = 0.0  # the wrist is stretched
    request = AnalyzeSingularity.Request(state=joint_state(PUMA.joint_names, q))
    answer = graph.call(AnalyzeSingularity, "kinematics/analyze_singularity", request)
    assert answer.error_code == 0
    shown = graph.receive(MarkerArray, "kinematics/markers", LATCHED, lambda m: len(m.markers) > 1)
    assert shown.markers[0].action == Marker.DELETEALL
    by_name = {marker.ns: marker for marker in shown.markers[1:]}
    velocity, force = by_name["velocity_ellipsoid"], by_name["force_ellipsoid"]
    values = np.linalg.svd(jacobian(PUMA, q)[3:], compute_uv=False)
    drawn = np.array([velocity.scale.x, velocity.scale.y, velocity.scale.z])
    assert drawn / drawn[0] == pytest.approx(values / values[0])
    turned = np.array([force.scale.x, force.scale.y, force.scale.z])
    assert turned * drawn == pytest.approx(np.full(3, turned[0] * drawn[0]))
    position = forward_kinematics(PUMA, q)[:3, 3]
    arrow = by_name["lost_directions"]
    start, end = (np.array([p.x, p.y, p.z]) for p in arrow.points)
    assert start == pytest.approx(position)
    lost = answer.lost_directions[0].twist.angular
    direction = (end - start) / np.linalg.norm(end - start)
    assert abs(direction @ [lost.x, lost.y, lost.z]) == pytest.approx(
        np.linalg.norm([lost.x, lost.y, lost.z]), rel=1e-6
    )


def test_the_boundary_is_shown_to_who_listens(graph):
    """Nobody has to ask for anything before; of a planar arm it is in its plane."""
    graph.start(KinematicsNode, robot_description="planar3r")
    shown = graph.receive(MarkerArray, "kinematics/markers", LATCHED, lambda m: len(m.markers) > 1)
    strips = shown.markers[1:]
    assert {strip.ns for strip in strips} == {"workspace"}
    points = np.array([[p.x, p.y, p.z] for strip in strips for p in strip.points])
    space = positioning_boundary(load_robot("planar3r"))
    assert np.abs(points[:, 2]).max() < 1e-12
    assert np.abs(space.distance(points)).max() < 1e-4


def nan_pose():
    pose = PoseStamped()
    pose.pose.position.x = math.nan
    return pose


def bad_quaternion():
    pose = PoseStamped()
    pose.pose.orientation.w = 0.0
    return pose


def unknown_frame():
    pose = PoseStamped()
    pose.header.frame_id = "moon"
    return pose


def test_bad_requests_are_refused(graph):
    graph.start(KinematicsNode, robot_description="puma560", max_batch_size=5)
    for poses, code, text in (
        ([PoseStamped(), nan_pose()], ErrorCode.NON_FINITE, "poses[1].pose.position.x"),
        ([bad_quaternion()], ErrorCode.BAD_QUATERNION, "poses[0].pose.orientation"),
        ([unknown_frame()], ErrorCode.FRAME_UNAVAILABLE, "moon"),
        ([PoseStamped()] * 6, ErrorCode.WRONG_SIZE, "max_batch_size"),
    ):
        refused = query(graph, poses)
        assert refused.error_code == code
        assert text in refused.error_msg
        assert list(refused.reachable) == []
