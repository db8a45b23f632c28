"""Groups and named states of a node: what it says of an SRDF, and which one counts."""

import pytest
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import Trigger
from two_armed import SRDF, URDF

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import SolveFK
from robomech_ros.errors import BadValueError, RobotDescriptionError
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.kinematics.node import KinematicsNode

ROSOUT = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
FOREIGN = """<robot name="other">
  <group name="arm"><chain base_link="other_base" tip_link="other_tool"/></group>
</robot>"""
OPTIONS = {"robot_description": URDF, "base_link": "left_base", "tip_link": "left_tool"}


def said(graph, part):
    """Wait until a node logs something."""
    return graph.receive(Log, "/rosout", ROSOUT, lambda log: part in log.msg).msg


def posture(graph, name):
    """Ask where the tip is at a named posture."""
    return graph.ask(SolveFK, "kinematics/solve_fk", states=[JointState(name=[name])])


def test_what_is_wrong_with_a_state_is_said_at_once_and_refused_when_used(graph):
    graph.start(KinematicsNode, robot_description_semantic=SRDF, **OPTIONS)
    said(graph, "group_state 'far' of group 'left_arm': joint 'left_joint_1' is at 3.5")
    assert posture(graph, "home").error_code == 0
    response = posture(graph, "far")
    assert response.error_code == ErrorCode.BAD_VALUE
    assert "state 'far' of group 'left_arm': joint 'left_joint_1' is at 3.5" in response.error_msg


def test_an_srdf_of_another_robot_is_said_and_the_one_before_stays(graph):
    graph.start(KinematicsNode, **OPTIONS)
    publisher = graph.client.create_publisher(String, "robot_description_semantic", LATCHED)
    known = SRDF.replace('name="far"', 'name="there"').replace('"3.5"', '"0.5"')
    publisher.publish(String(data=known))
    for _ in range(1000):
        if not posture(graph, "there").error_code:
            break
    publisher.publish(String(data=FOREIGN))
    said(graph, "unusable SRDF on '/robot_description_semantic', ignored: SRDF string: line 1")
    assert posture(graph, "there").error_code == 0


def test_an_unusable_srdf_that_is_repeated_is_said_once(graph, capfd):
    graph.start(KinematicsNode, **OPTIONS)
    publisher = graph.client.create_publisher(String, "robot_description_semantic", LATCHED)
    bad = [FOREIGN, "no document"]
    for document in bad:
        publisher.publish(String(data=document))
        said(graph, "ignored: it is no XML" if document == bad[1] else "ignored: SRDF string")
    for _ in range(20):
        for document in bad:
            publisher.publish(String(data=document))
            # The answer comes behind what was heard before.
            graph.ask(Trigger, "kinematics/ready")
    known = SRDF.replace('name="far"', 'name="there"').replace('"3.5"', '"0.5"')
    publisher.publish(String(data=known))
    for _ in range(1000):
        if not posture(graph, "there").error_code:
            break
    assert posture(graph, "there").error_code == 0
    # Each once a second; without that there are 42.
    assert capfd.readouterr().err.count("unusable SRDF") < 21


@pytest.mark.parametrize("first", ["robot_description", "robot_description_semantic"])
def test_robot_and_groups_may_both_come_by_topics_in_any_order(graph, first):
    graph.start(KinematicsNode, group="right_arm")
    texts = {"robot_description": URDF, "robot_description_semantic": SRDF}
    topics = sorted(texts, key=lambda topic: topic != first)
    publishers = [graph.client.create_publisher(String, topic, LATCHED) for topic in topics]
    publishers[0].publish(String(data=texts[topics[0]]))
    missing = "the SRDF with group 'right_arm'" if first == "robot_description" else "the robot"
    said(graph, f"waiting for {missing} on topic '/{topics[1]}'")
    for _ in range(1000):
        ready = graph.ask(Trigger, "kinematics/ready")
        if missing in ready.message:
            break
    assert not ready.success and missing in ready.message
    publishers[1].publish(String(data=texts[topics[1]]))
    said(graph, "ready: two_armed, right_base to right_tool, 6 joints")
    assert graph.ask(Trigger, "kinematics/ready").success
    assert posture(graph, "home").error_code == 0


def test_an_srdf_of_another_robot_does_not_keep_this_one_from_starting(graph):
    graph.start(KinematicsNode, base_link="left_base", tip_link="left_tool")
    groups, robot = (
        graph.client.create_publisher(String, topic, LATCHED)
        for topic in ("robot_description_semantic", "robot_description")
    )
    groups.publish(String(data=FOREIGN))
    said(graph, "waiting for the robot on topic '/robot_description'")
    robot.publish(String(data=URDF))
    said(graph, "ready: two_armed, left_base to left_tool")
    said(graph, "unusable SRDF on '/robot_description_semantic', ignored: SRDF string: line 1")
    assert posture(graph, "home").error_code == 0


@pytest.mark.parametrize(
    ("given", "error", "text"),
    [
        ({"robot_description_semantic": "no.srdf"}, RobotDescriptionError, "No such file"),
        ({"robot_description_semantic": SRDF, "group": "legs"}, BadValueError, "one of left_arm"),
        ({"groups": ["arm:left_tool", "arm:right_tool"]}, BadValueError, "each name once"),
        ({"groups": ["arm"]}, BadValueError, "entry of groups is 'arm', expected name:tip_link"),
    ],
)
def test_parameters_that_do_not_fit_end_the_start(graph, given, error, text):
    with pytest.raises(error, match=text):
        graph.start(KinematicsNode, **OPTIONS, **given)


def test_one_bad_group_is_said_once_and_refused_where_it_is_named(graph, capfd):
    bad = SRDF.replace("</robot>", '<group name="legs"><joint name="knee"/></group></robot>')
    graph.start(KinematicsNode, robot_description_semantic=bad, **OPTIONS)
    said(graph, "joint 'knee': name is 'knee'")
    assert posture(graph, "home").error_code == 0
    assert capfd.readouterr().err.count("joint 'knee'") == 1
    with pytest.raises(RobotDescriptionError, match="group 'legs': .*name is 'knee'"):
        graph.start(KinematicsNode, robot_description_semantic=bad, group="legs", **OPTIONS)


def test_a_bad_joint_beside_the_arm_is_said_once(graph, capfd):
    text = URDF.replace('lower="0" upper="0.04"', 'lower="0.04" upper="0"')
    graph.start(KinematicsNode, **{**OPTIONS, "robot_description": text})
    said(graph, "joint 'finger_joint': lower limit 0.04 is above upper limit 0")
    assert posture(graph, "home").error_code == 0
    assert capfd.readouterr().err.count("lower limit 0.04 is above") == 1
    reply = graph.call(
        SolveFK,
        "kinematics/solve_fk",
        SolveFK.Request(states=[JointState(name=["home"])], links=["/left_tool", "left_tool"]),
    )
    assert reply.error_code == 0, reply.error_msg
    assert reply.poses[0].pose == reply.poses[1].pose
