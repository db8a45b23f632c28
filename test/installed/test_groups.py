"""Groups and named states of an SRDF, from outside: a robot with two arms, of which one moves."""

from __future__ import annotations

import numpy as np
import pytest
from moveit_msgs.msg import MoveItErrorCodes, PositionIKRequest, RobotState
from moveit_msgs.srv import GetPositionIK
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from test_suite import execute, plan_and_arrive, wait_until_the_state_is_known
from two_armed import SRDF, URDF, joints_of

from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose
from robomech_ros.robots import load_description, load_srdf

ROBOT = load_description(URDF)
SEMANTIC = load_srdf(SRDF, ROBOT)
HOME = SEMANTIC.state("right_arm", "home")


@pytest.fixture
def files(tmp_path):
    """A maker's two files."""
    urdf, srdf = tmp_path / "two armed.urdf", tmp_path / "two armed.srdf"
    urdf.write_text(URDF, encoding="utf-8")
    srdf.write_text(SRDF, encoding="utf-8")
    return str(urdf), str(srdf)


def near(goal):
    """Tell whether joints are there."""
    return lambda q: all(abs(q[name] - place) < 1e-6 for name, place in goal.items())


def test_home_of_an_srdf_is_reached_by_its_name_and_each_group_has_its_own_joints(
    suite, bringup, outsider, files
):
    urdf, srdf = files
    with bringup(
        *("--robot", urdf, "--srdf", srdf, "--group", "right_arm"),
        *("--no-servo", "--move-group", "--in-one-process"),
    ):
        outsider.wait_for_joints(near(HOME))
        plan_and_arrive(outsider, {name: place + 0.2 for name, place in HOME.items()})
        answer = suite.call("trajectory_planner/plan_joint", {"goal": {"name": ["home"]}})
        assert answer["error_code"] == 0, answer["error_msg"]
        execute(outsider)
        outsider.wait_for_joints(near(HOME))
        answer = suite.call("trajectory_planner/plan_joint", {"goal": {"name": ["open"]}})
        assert answer["error_msg"] == "posture is 'open', expected one of home"
        wait_until_the_state_is_known(outsider)
        for side in ("left", "right"):
            check_group(outsider, side)
        assert groups_heard(outsider) == list(SEMANTIC.groups)


def check_group(outsider, side):
    """Ask for a posture of one arm, and check that the other one stands."""
    at = {"torso_joint": 0.3, "finger_joint": 0.01, "thumb_joint": 0.0}
    at |= SEMANTIC.state("left_arm", "home") | HOME
    wanted = at | {name: at[name] - 0.15 for name in joints_of(side)}
    poses = ROBOT.link_poses(wanted)
    pose = np.linalg.inv(poses["right_base"]) @ poses[f"{side}_tool"]
    request = PositionIKRequest(
        group_name=f"{side}_arm",
        robot_state=RobotState(joint_state=joint_state(list(at), np.array([*at.values()]))),
        pose_stamped=stamped_pose(pose, "right_base"),
    )
    kind = GetPositionIK
    response = outsider.call(kind, "compute_ik", kind.Request(ik_request=request))
    assert response.error_code.val == MoveItErrorCodes.SUCCESS, response.error_code.message
    found = response.solution.joint_state
    assert dict(zip(found.name, found.position, strict=True)) == pytest.approx(wanted, abs=1e-7)


def groups_heard(outsider):
    """List the groups of the SRDF on the topic."""
    heard = []
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    subscription = outsider.node.create_subscription(
        String, "robot_description_semantic", heard.append, latched
    )
    outsider.wait_for_joints(lambda q: heard)
    outsider.node.destroy_subscription(subscription)
    return list(load_srdf(heard[-1].data, ROBOT).groups)
