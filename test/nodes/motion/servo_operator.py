"""Somebody who drives the simulated robot through the servo node."""

import threading
import time
from functools import partial

from geometry_msgs.msg import TwistStamped
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.msg import ServoStatus
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.servo.node import ServoNode

TIMEOUT = 30.0
QOS = QoSProfile(depth=1000)
START = [0.3, 0.6, -0.7, 0.4, 0.8, 0.2]


class Operator:
    """Somebody with a joystick, and eyes on what the servo publishes."""

    def __init__(self, arm, graph, start=None, name="servo", **parameters):
        self.arm, self.graph, client = arm, graph, graph.client
        self._twists = client.create_publisher(TwistStamped, f"{name}/delta_twist_cmds", 10)
        self._speeds = client.create_publisher(JointState, f"{name}/joint_velocity_cmds", 10)
        self.streamed, self.statuses = [], []
        self._news = threading.Condition()
        topic = "joint_trajectory_controller/joint_trajectory"
        client.create_subscription(JointTrajectory, topic, self._take(self.streamed), QOS)
        # The name of MoveIt's node is left to MoveIt's type.
        ours = f"{name}/status" if name != "servo_node" else f"{name}/servo_status"
        client.create_subscription(ServoStatus, ours, self._take(self.statuses), QOS)
        parameters.setdefault("robot_description", "puma560")
        parameters.setdefault("characteristic_length", 0.283)
        # The machine may be busy, and all nodes of a test share one process.
        parameters.setdefault("publish_rate", 50.0)
        factory = ServoNode
        if name != "servo":
            factory = partial(ServoNode, cli_args=["--ros-args", "-r", f"__node:={name}"])
        self.node = (start or graph.start)(factory, **parameters)
        self.wait_for(lambda: self._twists.get_subscription_count())
        self.wait_for(lambda: self._speeds.get_subscription_count())

    def _take(self, into):
        def take(message):
            with self._news:
                into.append((time.monotonic(), message))
                self._news.notify_all()

        return take

    def wait_for(self, condition):
        deadline = time.monotonic() + TIMEOUT
        while not condition():
            assert time.monotonic() < deadline, "it never came"
            with self._news:
                self._news.wait(0.02)

    def twist(self, linear=(0, 0, 0), angular=(0, 0, 0), frame="", stamp=None):
        message = TwistStamped()
        message.header.frame_id = frame
        if stamp is not None:
            message.header.stamp = stamp
        twist = message.twist
        twist.linear.x, twist.linear.y, twist.linear.z = map(float, linear)
        twist.angular.x, twist.angular.y, twist.angular.z = map(float, angular)
        return lambda: self._twists.publish(message)

    def speeds(self, names, velocities):
        message = JointState(name=names, velocity=velocities)
        return lambda: self._speeds.publish(message)

    def repeat(self, send, until):
        """Command again and again until something is so."""
        deadline = time.monotonic() + TIMEOUT
        while not until():
            assert time.monotonic() < deadline, f"it never came: {self.last_status()}"
            send()
            with self._news:
                self._news.wait(0.02)

    def last_status(self):
        return self.statuses[-1][1] if self.statuses else None

    def has_code(self, code, text=""):
        """Whether the last status has this code and text."""
        last = self.last_status()
        return last is not None and last.code == code and text in last.message

    def until_still(self):
        """Wait until nothing has been published for some periods and the robot stands."""
        self.wait_for(
            lambda: (
                self.streamed
                and time.monotonic() > self.streamed[-1][0] + 0.3
                and not self.arm.velocity.any()
            )
        )

    def tip(self):
        return forward_kinematics(self.arm.chain, self.arm.position)

    def pause(self, value):
        return self.graph.call(SetBool, "servo/pause_servo", SetBool.Request(data=value))
