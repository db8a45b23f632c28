"""Start posture of all joints of a robot with several groups, and its gripper joints."""

import pytest
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from two_armed import SRDF, URDF, joints_of

from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.robots import load_description, load_srdf

SEMANTIC = load_srdf(SRDF, load_description(URDF))
OPTIONS = {"robot_description": URDF, "group": "left_arm"}


def started(graph, **options):
    """Start the robot, and give where its joints are."""
    graph.start(JointTrajectoryControllerNode, **OPTIONS, **options)
    state = graph.receive(JointState, "joint_states", QoSProfile(depth=10), lambda message: True)
    return dict(zip(state.name, state.position, strict=True))


def test_every_joint_begins_at_home_of_its_group(graph):
    at = started(graph, robot_description_semantic=SRDF)
    arms = SEMANTIC.state("left_arm", "home") | SEMANTIC.state("right_arm", "home")
    hand = {"finger_joint": 0.02, "thumb_joint": -0.01}
    assert at == pytest.approx({"torso_joint": 0.0} | arms | hand, abs=1e-12)
    assert list(at)[:6] == list(joints_of("left"))


@pytest.mark.parametrize(
    ("group", "joints"),
    [
        ('<joint name="finger_joint"/><joint name="thumb_joint"/>', "finger_joint, thumb_joint"),
        ('<joint name="finger_joint"/>', "finger_joint"),
    ],
)
def test_the_gripper_consists_of_the_joints_of_the_end_effector(graph, group, joints):
    hand = '<joint name="finger_joint"/><joint name="thumb_joint"/>'
    semantic = SRDF.replace(f'<group name="hand">{hand}', f'<group name="hand">{group}')
    with pytest.raises(ParameterError, match=f"allowed is one of {joints}, or empty"):
        started(graph, robot_description_semantic=semantic, gripper_joint="elbow")
