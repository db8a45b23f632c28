"""Inverse kinematics and plans of the other nodes, which follow the scene of move_group."""

import threading
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from move_group_client import HERE, UR5E, Client, box
from sensor_msgs.msg import JointState
from shaped_arm import shaped_ur5e
from trajectory_msgs.msg import JointTrajectoryPoint
from waiting import until

from robomech_interfaces.srv import PlanCartesian, PlanJoint, SolveIK
from robomech_ros.collision import Box, PlanningScene
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.commands.trajectory_source import waypoints_of
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.message_fields import (
    duration_from_seconds,
    seconds_from_duration,
)
from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.move_group.node import MoveGroupNode
from robomech_ros.nodes.move_group.scenes import Scenes
from robomech_ros.nodes.move_group.world import World
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.outcomes import Code
from robomech_ros.robots import DisabledCollision, load_description

# On the other side of the wall.
THERE = np.array([-1.0, *HERE[1:]])
ROBOT = {"robot_description": shaped_ur5e()}
# It does not reach the base.
WALL = box(sizes=(0.4, 0.02, 0.6), position=(0.65, 0.0, 0.3))


@pytest.fixture
def scene():
    made = PlanningScene(UR5E)
    pose = np.eye(4)
    pose[:3, 3] = 0.65, 0.0, 0.3
    made.add("wall", Box(0.4, 0.02, 0.6), pose)
    return made


def target(T):
    return PoseStamped(pose=pose_from_matrix(T))


def rows(trajectory):
    return np.array([point.positions for point in trajectory.points])


def solved(client, T, accept=lambda answer: True, **fields):
    request = SolveIK.Request(target=target(T), seed=JointState(), **fields)
    return client.graph.call_until(SolveIK, "kinematics/solve_ik", request, accept)


def test_solutions_in_contact_are_left_out(client, scene):
    client.graph.start(KinematicsNode, **ROBOT)
    T = forward_kinematics(UR5E, HERE)
    T[1, 3] = 0.12
    everywhere = solved(client, T, ignore_collisions=True)
    assert not everywhere.clearances
    assert client.apply(WALL)
    answer = solved(client, T, lambda answer: "left out" in answer.error_msg)
    found = np.array([point.positions for point in answer.solutions])
    assert 0 < len(found) < len(everywhere.solutions)
    assert "in contact and left out" in answer.error_msg and answer.error_code == Code.NONE
    assert answer.clearances == pytest.approx(scene.clearance(found).distance, abs=1e-9)


def test_a_pose_in_the_wall_names_the_pair(client):
    client.graph.start(KinematicsNode, **ROBOT)
    assert client.apply(WALL)
    T = forward_kinematics(UR5E, HERE)
    T[:3, 3] = 0.7, 0.0, 0.4
    answer = solved(client, T, lambda answer: answer.error_code != Code.NONE)
    assert answer.error_code == Code.COLLISION and not answer.solutions
    assert "'wall'" in answer.error_msg and "m" in answer.error_msg


def test_a_plan_leads_around_the_wall(client, scene):
    client.graph.start(TrajectoryPlannerNode, assume_limits=True, **ROBOT)
    assert client.apply(WALL)
    start, goal = (joint_state(UR5E.joint_names, q) for q in (HERE, THERE))
    request = PlanJoint.Request(start=start, goal=goal, profile=PlanJoint.Request.TIME_OPTIMAL)

    def led_around(answer):
        return answer.error_code == Code.NONE and scene.check_motion(rows(answer.trajectory)).free

    answer = client.graph.call_until(
        PlanJoint, "trajectory_planner/plan_joint", request, led_around
    )
    assert scene.check_motion(rows(answer.trajectory)).certified
    np.testing.assert_allclose(rows(answer.trajectory)[[0, -1]], [HERE, THERE], atol=1e-12)
    request.ignore_collisions = True
    straight = client.graph.call(PlanJoint, "trajectory_planner/plan_joint", request)
    assert not scene.check_motion(rows(straight.trajectory)).free


def test_plans_through_via_points_lead_around_the_wall_in_the_wanted_time(client, scene):
    client.graph.start(TrajectoryPlannerNode, assume_limits=True, **ROBOT)
    assert client.apply(WALL)
    start, goal = (joint_state(UR5E.joint_names, q) for q in (HERE, THERE))
    via = HERE + [0.3, -0.2, 0.0, 0.1, 0.0, 0.4]
    fields = {"start": start, "goal": goal, "profile": PlanJoint.Request.RUCKIG}
    request = PlanJoint.Request(via=[JointTrajectoryPoint(positions=via.tolist())], **fields)

    def planned(accept=lambda answer: True, **times):
        for name, seconds in times.items():
            point = request if name == "duration" else request.via[0]
            setattr(point, name, duration_from_seconds(seconds))
        return client.graph.call_until(PlanJoint, "trajectory_planner/plan_joint", request, accept)

    def led_around(answer):
        return answer.error_code == Code.NONE and scene.check_motion(rows(answer.trajectory)).free

    shortest = planned(led_around)
    seconds = seconds_from_duration(shortest.duration, "duration")
    for answer, wanted in ((shortest, seconds), (planned(duration=2 * seconds), 2 * seconds)):
        assert answer.error_code == Code.NONE, answer.error_msg
        assert seconds_from_duration(answer.duration, "duration") == pytest.approx(wanted, abs=1e-8)
        curve = waypoints_of(answer.trajectory).curve
        q = curve.sample(np.linspace(0.0, wanted, 20_000))[0]
        np.testing.assert_allclose(q[[0, -1]], [HERE, THERE], atol=1e-12)
        assert np.abs(q - via).max(axis=1).min() < 1e-3
        assert scene.is_free(q).all()
        assert max(answer.peak_velocity_ratio) <= 1.0
    answer = planned(duration=0.9 * seconds)
    assert answer.error_code == Code.LIMIT
    assert f"{seconds:.6g}" in answer.error_msg
    request.profile = PlanJoint.Request.CUBIC_SPLINE
    answer = planned(duration=4 * seconds, time_from_start=seconds)
    assert answer.error_code == Code.COLLISION and "'wall'" in answer.error_msg
    assert "leave time_from_start of all via points at 0" in answer.error_msg
    # A motion with instants that touches nothing is not refused.
    request.goal = joint_state(UR5E.joint_names, HERE + 0.05)
    request.via[0].positions = (HERE + 0.02).tolist()
    answer = planned()
    assert answer.error_code == Code.NONE, answer.error_msg
    assert scene.check_motion(waypoints_of(answer.trajectory)).certified
    curve = waypoints_of(answer.trajectory).curve
    np.testing.assert_allclose(curve.sample(seconds)[0], HERE + 0.02, atol=1e-3)


def test_what_stands_in_the_wall_is_refused(client):
    client.graph.start(TrajectoryPlannerNode, assume_limits=True, **ROBOT)
    assert client.apply(WALL)
    within = HERE.copy()
    within[0] = 0.0
    start, goal = (joint_state(UR5E.joint_names, q) for q in (HERE, within))
    request = PlanJoint.Request(start=start, goal=goal)
    answer = client.graph.call_until(
        PlanJoint,
        "trajectory_planner/plan_joint",
        request,
        lambda answer: answer.error_code != Code.NONE,
    )
    assert answer.error_code == Code.COLLISION and not answer.trajectory.points
    assert "the goal is in contact" in answer.error_msg and "deep" in answer.error_msg


def test_answers_say_once_that_nothing_is_checked(graph):
    for kind in (MoveGroupNode, KinematicsNode, TrajectoryPlannerNode):
        graph.start(kind, robot_description="ur5e")
    client, text = Client(graph), "no collisions were checked: 'ur5e' has no collision geometry"
    assert client.apply(WALL)
    T = forward_kinematics(UR5E, HERE)
    assert solved(client, T, lambda answer: answer.error_msg == text).solutions
    start, goal = (joint_state(UR5E.joint_names, q) for q in (HERE, THERE))
    T[2, 3] += 0.05
    for kind, name, fields in (
        (PlanJoint, "plan_joint", {"goal": goal}),
        (PlanCartesian, "plan_cartesian", {"waypoints": [target(T)]}),
    ):
        request, service = kind.Request(start=start, **fields), f"trajectory_planner/{name}"
        graph.call_until(kind, service, request, lambda answer: answer.error_msg == text)


def test_a_plan_leads_out_of_a_contact(client, scene):
    client.graph.start(TrajectoryPlannerNode, assume_limits=True, **ROBOT)
    assert client.apply(WALL)
    touching = HERE.copy()
    touching[0] = next(a for a in np.arange(0.6, 0.0, -0.01) if not scene.is_free([a, *HERE[1:]]))
    start, goal = (joint_state(UR5E.joint_names, q) for q in (touching, HERE))
    request = PlanJoint.Request(start=start, goal=goal)

    def judged(answer):
        # Before the node has the scene it plans straight.
        return len(answer.trajectory.points) > 0

    answer = client.graph.call_until(PlanJoint, "trajectory_planner/plan_joint", request, judged)
    assert answer.error_code == Code.NONE, answer.error_msg
    q = rows(answer.trajectory)
    np.testing.assert_allclose(q[[0, -1]], [touching, HERE], atol=1e-12)
    free = int(np.argmax(scene.is_free(q)))
    assert free > 0 and scene.check_motion(q[free:]).certified


def test_a_path_of_the_tool_ends_before_the_wall(client, scene):
    client.graph.start(TrajectoryPlannerNode, assume_limits=True, **ROBOT)
    assert client.apply(WALL)
    T = forward_kinematics(UR5E, HERE)
    T[:2, 3] += 0.15, -0.6
    request = PlanCartesian.Request(
        start=joint_state(UR5E.joint_names, HERE), waypoints=[target(T)]
    )
    answer = client.graph.call_until(
        PlanCartesian,
        "trajectory_planner/plan_cartesian",
        request,
        lambda answer: answer.error_code == Code.COLLISION,
    )
    assert 0.05 < answer.fraction < 0.95 and "would touch" in answer.stop_reason
    found = scene.check_motion(rows(answer.trajectory))
    assert found.certified and scene.clearance(rows(answer.trajectory)[-1]).distance < 0.01


def test_shapes_that_stay_are_not_read_again():
    before, after = (World("base_link", UR5E.links, str) for _ in range(2))
    before.apply_object(WALL, {"": np.eye(4)})
    known, moved = before.objects["wall"], deepcopy(before.objects["wall"].message)
    assert after.keep(moved, before) and after.objects["wall"] is known
    moved.pose.position.x = 0.8
    assert after.keep(moved, before)
    assert after.objects["wall"].shapes is known.shapes
    assert after.objects["wall"].pose[0, 3] == 0.8 and known.pose[0, 3] == 0.65
    moved.primitives[0].dimensions[1] = 0.03
    assert not after.keep(moved, before)
    moved.id = "other"
    assert not after.keep(moved, before)


def test_an_srdf_that_arrives_late_is_followed_by_the_worker(graph):
    model, worker = RobotModel(load_description(shaped_ur5e())), Worker(graph.client)
    scenes, done = Scenes(model, worker, 0.0), threading.Event()
    before = scenes.whole({})
    worker.begin(done.wait)
    disabled = DisabledCollision("upper_arm_link", "wrist_3_link", "never")
    model.learn(replace(model.semantic, disabled_collisions=(disabled,)))
    # The caller does not wait for the worker, and the earlier scene checks more pairs.
    assert all(scenes.whole({}) is before for _ in range(3))
    done.set()
    until(lambda: scenes.whole({}) is not before)
    pair = ("upper_arm_link", "wrist_3_link")
    assert pair in scenes.whole({}).ignored and pair not in before.ignored
    worker.close()
