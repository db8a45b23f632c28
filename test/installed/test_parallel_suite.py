"""Parallel robots by the installed suite, across processes: asked, planned, moved, and watched."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectoryPoint

from robomech_interfaces.srv import (
    AnalyzeSingularity,
    Execute,
    InverseDynamics,
    PlanJoint,
    SolveFK,
    SolveIK,
    SummarizeTorques,
)
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, stamped_pose
from robomech_ros.parallel import ParallelDynamics, load_parallel, load_tree_description

PATIENCE = 60.0
LATCHED = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.mark.parametrize(("name", "lift"), [("hexapod", 0.03), ("delta", -0.1)])
def test_a_parallel_robot_is_brought_up_and_moved_as_an_arm_is(bringup, outsider, name, lift):
    states, descriptions, frames = [], [], set()
    news, node = threading.Condition(), outsider.node

    def take(message):
        with news:
            if isinstance(message, String):
                descriptions.append(message.data)
            else:
                frames.update(one.child_frame_id for one in message.transforms)
            news.notify_all()

    node.create_subscription(JointState, "joint_states", states.append, 1000)
    node.create_subscription(String, "robot_description", take, LATCHED)
    node.create_subscription(TFMessage, "/tf_static", take, LATCHED)
    node.create_subscription(TFMessage, "/tf", take, 100)
    mechanism = load_parallel(name).mechanism
    with bringup("--robot", name, "--in-one-process"):
        first = outsider.wait_for_joints(lambda q: tuple(q) == mechanism.joint_names)
        target = mechanism.pose(first.position)
        target[2, 3] += lift
        found = outsider.call(
            SolveIK, "kinematics/solve_ik", SolveIK.Request(target=stamped_pose(target, ""))
        )
        assert found.error_code == 0, found.error_msg
        goal = JointState(name=found.joint_names, position=found.solutions[0].positions)
        planned = outsider.call(
            PlanJoint, "trajectory_planner/plan_joint", PlanJoint.Request(goal=goal)
        )
        assert planned.error_code == 0, planned.error_msg
        assert tuple(planned.trajectory.joint_names) == mechanism.actuated
        done = outsider.call(
            Execute, "trajectory_publisher/execute", Execute.Request(trajectory=planned.trajectory)
        )
        assert done.error_code == 0, done.error_msg
        wanted = dict(zip(goal.name, goal.position, strict=True))
        last = outsider.wait_for_joints(
            lambda q: all(abs(q[joint] - wanted[joint]) < 1e-9 for joint in wanted)
        )
        there = outsider.call(SolveFK, "kinematics/solve_fk", SolveFK.Request(states=[last]))
        assert there.error_code == 0, there.error_msg
        assert len(there.poses) == 1
        np.testing.assert_allclose(matrix_from_pose(there.poses[0].pose), target, atol=1e-6)
        report = outsider.call(
            AnalyzeSingularity, "kinematics/analyze_singularity", AnalyzeSingularity.Request()
        )
        assert report.error_code == 0 and report.summary.startswith("regular")
        request = SummarizeTorques.Request(trajectory=planned.trajectory)
        demand = outsider.call(SummarizeTorques, "dynamics/summarize_torques", request)
        assert demand.error_code == 0, demand.error_msg
        assert tuple(demand.joint_names) == mechanism.actuated
        posture = JointTrajectoryPoint(positions=last.position)
        request = InverseDynamics.Request(points=[posture], joint_names=last.name)
        held = outsider.call(InverseDynamics, "dynamics/inverse_dynamics", request)
        assert held.error_code == 0, held.error_msg
        holding = ParallelDynamics(mechanism).gravity(last.position)
        np.testing.assert_allclose(np.array(held.effort)[mechanism.drive_index], holding, rtol=1e-6)
        with news:
            links = len(load_tree_description(name).description.links)
            assert news.wait_for(lambda: descriptions and len(frames) == links - 1, PATIENCE)
        running = set(node.get_node_names())
    assert {"kinematics", "dynamics", "trajectory_planner"} <= running and "servo" not in running
    positions = np.array([state.position for state in states])
    velocities = np.array([state.velocity for state in states])
    assert mechanism.loop_errors(positions).max() < 1e-10
    expected, _ = mechanism.rates(positions, velocities[:, mechanism.drive_index])
    np.testing.assert_allclose(velocities, expected, atol=1e-9)
    described = load_tree_description(descriptions[-1])
    assert described.mechanism.joint_names == mechanism.joint_names
    assert frames == {link for link in described.description.links if link != "base_link"}
