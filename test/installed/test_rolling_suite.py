"""A rolling robot that is brought up, driven and watched across processes."""

import pytest
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry


def test_a_mecanum_base_is_brought_up_and_driven(bringup, outsider):
    node = outsider.node
    publisher = node.create_publisher(TwistStamped, "mobile_base/reference", 10)
    places = []

    def send():
        message = TwistStamped()
        message.header.stamp = node.get_clock().now().to_msg()
        message.twist.linear.x, message.twist.linear.y = 0.3, 0.2
        publisher.publish(message)

    node.create_subscription(Odometry, "mobile_base/odometry", places.append, 100)
    with bringup("--robot", "mecanum", "--ros-args", "-p", "reference_timeout:=1.0"):
        node.create_timer(0.05, send)
        state = outsider.wait_for_joints(lambda q: q["front_right"] > 2.0)
    assert list(state.name) == ["front_left", "front_right", "rear_right", "rear_left"]
    last = places[-1].pose.pose.position
    # The way goes straight along the command.
    assert last.x > 0.0 and last.y == pytest.approx(last.x * 2.0 / 3.0, abs=1e-9)
