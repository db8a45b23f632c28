"""A node whose turns are longer than the period of a topic does not fall behind."""

import time

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from std_msgs.msg import Int32
from waiting import until

from robomech_ros.nodes.middleware.drained_subscription import create_drained_subscription

COUNT = 150


def test_waiting_messages_are_handled_in_their_order_in_few_turns(graph):
    node, taken, turns = graph.client, [], []

    async def take(message):
        taken.append(message.data)

    def block():
        turns.append(len(taken))
        time.sleep(0.02)

    group = MutuallyExclusiveCallbackGroup()
    create_drained_subscription(node, Int32, "numbers", take, 2 * COUNT, group)
    publisher = node.create_publisher(Int32, "numbers", 2 * COUNT)
    until(lambda: publisher.get_subscription_count())
    timer = node.create_timer(0.001, block)
    until(lambda: turns)
    first = len(turns)
    for number in range(COUNT):
        publisher.publish(Int32(data=number))
    until(lambda: len(taken) == COUNT)
    timer.cancel()
    assert taken == list(range(COUNT))
    assert len(turns) - first < COUNT / 3
