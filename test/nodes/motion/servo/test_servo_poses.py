"""Poses as targets of the servo node, and what MoveIt's servo has beside topics."""

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped

from robomech_interfaces.msg import ServoStatus
from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix
from robomech_ros.nodes.servo.status import status_topic


class Poser:
    """Somebody who sends target poses."""

    def __init__(self, hand, name="servo"):
        self._hand, topic = hand, f"{name}/pose_target_cmds"
        self._poses = hand.graph.client.create_publisher(PoseStamped, topic, 10)
        hand.wait_for(self._poses.get_subscription_count)

    def sender(self, target, frame=""):
        message = PoseStamped(pose=pose_from_matrix(target))
        message.header.frame_id = frame
        return lambda: self._poses.publish(message)

    def tell(self, message):
        self._poses.publish(message)


def test_the_tip_goes_to_a_pose_and_stops_when_no_poses_come(operator):
    hand = operator()
    poser, target = Poser(hand), hand.tip()
    target[:3, 3] += [0.0, 0.1, 0.05]
    send = poser.sender(target)
    hand.repeat(send, lambda: np.abs(hand.tip() - target).max() < 1e-4)

    def stands_without_a_warning():
        code = hand.last_status().code
        return not hand.arm.velocity.any() and code == ServoStatus.NO_WARNING

    # On a busy machine a command may be stale for a moment.
    hand.repeat(send, stands_without_a_warning)
    # It stands on the way where the sender falls silent.
    target[1, 3] -= 0.2
    hand.repeat(poser.sender(target), lambda: abs(hand.tip()[1, 3] - target[1, 3]) < 0.19)
    hand.wait_for(lambda: hand.has_code(ServoStatus.STALE_COMMAND, "stale"))
    hand.wait_for(lambda: not hand.arm.velocity.any())
    assert hand.tip()[1, 3] > target[1, 3] + 0.01


def test_a_pose_in_the_frame_of_a_link_and_poses_that_are_none(operator):
    hand = operator()
    poser, before = Poser(hand), hand.tip()
    message = PoseStamped()
    message.pose.orientation.w = 0.0
    text = "pose.orientation: all zero"
    hand.repeat(lambda: poser.tell(message), lambda: hand.has_code(ServoStatus.INVALID, text))
    message.pose.orientation.w = 1.0
    message.header.frame_id = "no_such"
    text = "pose_target_cmds' refused: frame 'no_such'"
    hand.repeat(lambda: poser.tell(message), lambda: hand.has_code(ServoStatus.INVALID, text))
    message.pose.position.x = np.nan
    text = "pose.position.x is nan"
    hand.repeat(lambda: poser.tell(message), lambda: hand.has_code(ServoStatus.INVALID, text))
    assert np.abs(hand.tip() - before).max() < 1e-9
    # A target ahead of the tip moves away with it.
    ahead = np.eye(4)
    ahead[2, 3] = 0.02
    send = poser.sender(ahead, hand.arm.chain.tip)
    hand.repeat(send, lambda: np.linalg.norm((hand.tip() - before)[:3, 3]) > 0.03)
    way = before[:3, :3].T @ (hand.tip() - before)[:3, 3]
    assert way[2] > 0.02 and np.abs(way[:2]).max() < 0.05 * way[2]


@pytest.mark.parametrize("name", ["servo", "servo_node"])
def test_the_kind_of_commands_is_chosen_as_for_moveit_and_the_status_is_there(operator, name):
    messages = pytest.importorskip("moveit_msgs.msg")
    services = pytest.importorskip("moveit_msgs.srv")
    hand = operator(name=name)
    kind, seen = services.ServoCommandType, []
    client = hand.graph.client
    client.create_subscription(messages.ServoStatus, "servo_node/status", seen.append, 1000)

    def choose(number):
        request = kind.Request(command_type=number)
        return hand.graph.call(kind, f"{name}/switch_command_type", request).success

    assert not choose(7)
    assert choose(kind.Request.JOINT_JOG)
    twist = hand.twist((0, 0.1, 0))
    text = "delta_twist_cmds' refused: switch_command_type has chosen another kind"
    hand.repeat(twist, lambda: hand.has_code(ServoStatus.INVALID, text))
    assert not hand.streamed
    hand.wait_for(lambda: any(status.code == messages.ServoStatus.INVALID for status in seen))
    assert text in next(s for s in seen if s.code == messages.ServoStatus.INVALID).message
    assert choose(kind.Request.TWIST)
    hand.repeat(twist, lambda: len(hand.streamed) > 10)
    del seen[:]
    hand.repeat(twist, lambda: seen and hand.has_code(ServoStatus.NO_WARNING))
    assert all(-1 <= status.code <= 6 for status in seen)
    assert choose(kind.Request.POSE)
    # It brakes at once, and twists are refused.
    hand.repeat(twist, lambda: not hand.arm.velocity.any())
    target = hand.tip()
    target[1, 3] += 0.03
    poser = Poser(hand, name)
    hand.repeat(poser.sender(target), lambda: np.abs(hand.tip() - target).max() < 1e-4)
    # Whoever shows the servo finds ours.
    assert hand.graph.client.count_publishers(status_topic(client, name)) == 1
