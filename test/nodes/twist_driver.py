"""Somebody who commands twists again and again."""

import threading

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Twist, TwistStamped


class Driver:
    """Sends one command again and again, with a stamp or without."""

    def __init__(self, graph, topic, *, stamped=True, old=None):
        self._node, self._old = graph.client, old
        self._kind = TwistStamped if stamped else Twist
        self._publisher = self._node.create_publisher(self._kind, topic, 10)
        self._lock, self._twist = threading.Lock(), None
        self._timer = self._node.create_timer(0.02, self._send)

    def command(self, x, y=0.0, turn=0.0):
        twist = Twist()
        twist.linear.x, twist.linear.y, twist.angular.z = x, y, turn
        with self._lock:
            self._twist = twist

    def silent(self):
        with self._lock:
            self._twist = None

    def _send(self):
        with self._lock:
            twist = self._twist
        if twist is None:
            return
        if self._kind is Twist:
            self._publisher.publish(twist)
            return
        message = TwistStamped(twist=twist)
        now = self._node.get_clock().now().to_msg()
        message.header.stamp = now if self._old is None else Time(sec=self._old)
        self._publisher.publish(message)
