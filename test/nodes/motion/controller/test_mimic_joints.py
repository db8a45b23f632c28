"""Joints that mimic others, in joint_states and on /tf."""

import numpy as np
from action_msgs.msg import GoalStatus
from gripper_cases import PALLETISER, poses_by_frames, poses_by_pinocchio
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

from robomech_interfaces.srv import SolveFK
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.robots import load_description

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def test_joints_that_mimic_those_of_the_chain_follow(drive):
    arm = drive(robot_description=PALLETISER, publish_frames="always", initial_positions=[0.2, 0.4])
    assert arm.states[-1].name == ["shoulder", "elbow", "level_joint", "bar_joint"]
    start = arm.states[-1].position
    np.testing.assert_allclose(start, [0.2, 0.4, 0.3 - 0.5 * 0.3, 0.3], atol=1e-15)
    trajectory = arm.trajectory((0.5, np.array([0.5, -0.3])), start=np.array([0.2, 0.4]))
    assert arm.execute(trajectory)[0] == GoalStatus.STATUS_SUCCEEDED
    goal = np.array([0.7, 0.1, 0.3 - 0.5 * 0.8, 0.8])
    arm.until_at(goal)
    for state in arm.states:
        shoulder, _, level, bar = np.array([state.position, state.velocity]).T
        np.testing.assert_allclose(bar, shoulder + [0.1, 0.0], atol=1e-12)
        np.testing.assert_allclose(level, -0.5 * bar + [0.3, 0.0], atol=1e-12)
    fixed = arm.graph.receive(TFMessage, "/tf_static", LATCHED, lambda message: True)
    moving = arm.graph.receive(TFMessage, "/tf", 100, lambda message: True)
    positions = dict(zip(arm.states[-1].name, goal, strict=True))
    ours, by_frames = load_description(PALLETISER), poses_by_frames(fixed, moving)
    for link, pose in poses_by_pinocchio(PALLETISER, positions).items():
        np.testing.assert_allclose(by_frames.get(link, np.eye(4)), pose, atol=1e-12)
        leading = {name: positions[name] for name in ("shoulder", "elbow")}
        np.testing.assert_allclose(ours.link_poses(leading)[link], pose, atol=1e-12)
    assert set(by_frames) == set(ours.links) - {"base_link"}


def test_forward_kinematics_of_links_behind_joints_that_mimic_others(drive):
    arm = drive(robot_description=PALLETISER, initial_positions=[0.2, 0.4])
    arm.graph.start(KinematicsNode, robot_description=PALLETISER)
    links = ["level", "bar", "tool0", "base_link"]
    leading = joint_state(["elbow", "shoulder"], np.array([0.4, 0.2]))
    expected = poses_by_pinocchio(
        PALLETISER, {"shoulder": 0.2, "elbow": 0.4, "bar_joint": 0.3, "level_joint": 0.15}
    )
    # From the joints that lead, from all of them, and from where the robot is.
    for states in ([leading], [arm.states[-1]], []):
        request = SolveFK.Request(states=states, links=links)
        answer = arm.graph.call(SolveFK, "kinematics/solve_fk", request)
        assert answer.error_code == 0, answer.error_msg
        for link, stamped in zip(links, answer.poses, strict=True):
            pose = matrix_from_pose(stamped.pose, link)
            np.testing.assert_allclose(pose, expected[link], atol=1e-12, err_msg=link)
    unnamed = SolveFK.Request(states=[joint_state((), np.array([0.2]))], links=["bar"])
    answer = arm.graph.call(SolveFK, "kinematics/solve_fk", unnamed)
    assert answer.error_code == 0, answer.error_msg
    np.testing.assert_allclose(
        matrix_from_pose(answer.poses[0].pose, "bar"), expected["bar"], atol=1e-12
    )
