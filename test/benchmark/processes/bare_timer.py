"""A bare rclpy timer that publishes joint states: what a cycle costs when nothing is computed.

Run by `drive_nodes.py` in a process of its own, with one executor or the other of rclpy.
"""

from __future__ import annotations

import signal
import sys
import threading

import rclpy
from controller_cycles import CONTROLLER, RATE
from rclpy.clock import Clock, ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

EXECUTORS = {"single": SingleThreadedExecutor, "events": EventsExecutor}
JOINTS = 6


def main(executor_name: str) -> None:
    """Publish at RATE until SIGINT."""
    over = threading.Event()
    signal.signal(signal.SIGINT, lambda *_: over.set())
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("bare")
    publisher = node.create_publisher(JointState, "joint_states", 10)
    node.create_subscription(
        JointTrajectory, f"{CONTROLLER}/joint_trajectory", lambda message: None, 10
    )
    message = JointState(name=[f"joint_{k}" for k in range(JOINTS)])
    message.position = message.velocity = [0.0] * JOINTS
    clock = node.get_clock()

    def tick() -> None:
        stamp = message.header.stamp
        stamp.sec, stamp.nanosec = clock.now().seconds_nanoseconds()
        publisher.publish(message)

    steady = Clock(clock_type=ClockType.STEADY_TIME)
    node.create_timer(1.0 / RATE, tick, clock=steady)
    executor = EXECUTORS[executor_name]()
    executor.add_node(node)
    while not over.is_set():
        executor.spin_once(1.0)
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv[1])
