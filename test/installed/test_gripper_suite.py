"""The gripper of the installed suite, by the messages of control_msgs, while the arm moves."""

from __future__ import annotations

import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from control_msgs.action import FollowJointTrajectory, GripperCommand, ParallelGripperCommand
from rclpy.action import ActionClient
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "nodes" / "motion"))

from gripper_cases import panda_with_hand, poses_by_frames, poses_by_pinocchio

from robomech_interfaces.srv import SolveFK
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose

PATIENCE = 60.0
LATCHED = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
ARM = [f"panda_joint{k}" for k in range(1, 8)]
HAND = ["panda_leftfinger", "panda_rightfinger"]
FINGERS = ["panda_finger_joint1", "panda_finger_joint2"]
TURN = 0.4


class Actions:
    """Clients of actions, whose calls are made in the thread that spins their node."""

    def __init__(self, outsider) -> None:
        self._outsider = outsider

    def client(self, kind, name):
        client = ActionClient(self._outsider.node, kind, name)
        assert client.wait_for_server(PATIENCE), f"no {name}"
        return client

    def send(self, client, goal):
        handle = self._wait(lambda: client.send_goal_async(goal))
        assert handle.accepted
        return handle

    def result(self, handle):
        answer = self._wait(handle.get_result_async)
        return answer.status, answer.result

    def _wait(self, ask):
        return self._done(self._done(self._outsider.node.executor.create_task(ask)))

    @staticmethod
    def _done(future):
        over = threading.Event()
        future.add_done_callback(lambda _: over.set())
        assert over.wait(PATIENCE), "no answer"
        return future.result()


def arm_trajectory(start):
    rows = np.array([start, np.add(start, [TURN, 0, 0, 0, 0, 0, -TURN])])
    points = [JointTrajectoryPoint(positions=row.tolist(), velocities=[0.0] * 7) for row in rows]
    points[1].time_from_start.sec = 3
    trajectory = JointTrajectory(joint_names=ARM, points=points)
    return FollowJointTrajectory.Goal(trajectory=trajectory)


def test_a_gripper_is_closed_and_opened_while_the_arm_moves(bringup, outsider, tmp_path):
    urdf, parameters = tmp_path / "panda_with_hand.urdf", tmp_path / "gripper.yaml"
    urdf.write_text(panda_with_hand(), encoding="utf-8")
    parameters.write_text(
        "/**: {ros__parameters: {gripper_object_width: 0.05, gripper_stall_timeout: 0.3, "
        "gripper_goal_tolerance: 0.001, publish_frames: always, "
        "gripper_controller: panda_hand_controller}}",
        encoding="utf-8",
    )
    tree, seen = [], []
    for topic, qos in (("/tf_static", LATCHED), ("/tf", 100)):
        outsider.node.create_subscription(TFMessage, topic, tree.append, qos)
    outsider.node.create_subscription(JointState, "joint_states", seen.append, 1000)
    robot = ("--robot", str(urdf), "--tip-link", "panda_hand_tcp", "--no-servo")
    with bringup(*robot, "--params-file", str(parameters), "--in-one-process"):
        state = outsider.wait_for_joints(lambda q: set(q) == {*ARM, *FINGERS})
        assert state.name == [*ARM, *FINGERS]
        actions = Actions(outsider)
        arm = actions.client(
            FollowJointTrajectory, "joint_trajectory_controller/follow_joint_trajectory"
        )
        hand = actions.client(GripperCommand, "panda_hand_controller/gripper_cmd")
        parallel = actions.client(ParallelGripperCommand, "parallel_gripper_controller/gripper_cmd")
        moving = actions.send(arm, arm_trajectory(state.position[:7]))
        opened = GripperCommand.Goal()
        opened.command.position = 0.04
        status, result = actions.result(actions.send(hand, opened))
        assert (status, result.reached_goal) == (GoalStatus.STATUS_SUCCEEDED, True)
        closed = ParallelGripperCommand.Goal()
        closed.command = JointState(name=FINGERS[:1], position=[0.0], effort=[8.0])
        status, result = actions.result(actions.send(parallel, closed))
        assert (status, result.stalled) == (GoalStatus.STATUS_ABORTED, True)
        assert result.state.position[0] == pytest.approx(0.025, abs=1e-9)
        assert list(result.state.effort) == [-8.0]
        assert actions.result(moving)[0] == GoalStatus.STATUS_SUCCEEDED

        def arrived(q):
            return abs(q[ARM[0]] - state.position[0] - TURN) < 1e-9

        last = outsider.wait_for_joints(arrived)
        assert any(len(s.name) == 9 and s.velocity[0] and s.velocity[7] for s in seen)
        positions = dict(zip(last.name, last.position, strict=True))
        expected = poses_by_pinocchio(panda_with_hand(), positions)
        request = SolveFK.Request(states=[last], links=["panda_hand_tcp", *HAND])
        answer = outsider.call(SolveFK, "kinematics/solve_fk", request)
        assert answer.error_code == 0, answer.error_msg
        for link, stamped in zip(request.links, answer.poses, strict=True):
            found = matrix_from_pose(stamped.pose, link)
            np.testing.assert_allclose(found, expected[link], atol=1e-9, err_msg=link)
        arrives = threading.Event()
        outsider.node.create_subscription(TFMessage, "/tf", lambda _: arrives.set(), 100)
        assert arrives.wait(PATIENCE)
        frames = poses_by_frames(*tree)
        for link, pose in expected.items():
            np.testing.assert_allclose(frames.get(link, np.eye(4)), pose, atol=1e-9, err_msg=link)
