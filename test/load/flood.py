"""A process that floods a topic with messages."""

from __future__ import annotations

import time
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
import rclpy
from known_robot import known_robot
from messages import MessageMaker
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from robot_watch import STRANGER

from robomech_ros.nodes.commands.message_yaml import interface_class

__all__ = ["CONTENTS", "Flood", "serve_floods"]

# What is sent: sensible messages, senseless ones, and bytes that are no message.
CONTENTS = ("sensible", "senseless", "bytes")
# Messages that are made before a flood and sent again and again.
_DIFFERENT = 100
# Bytes of a message at the most: queues keep room for as many of the largest as fit into them.
_LARGEST, _LONGEST = 50_000, 300
# Those who want latched messages hear no others; all others hear these, too.
_LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@dataclass(frozen=True)
class Flood:
    """Messages to send.

    Attributes
    ----------
    topic, kind : str
        The topic, and its type, such as ``std_msgs/msg/String``.
    way : str
        One of `CONTENTS`.
    rate : float
        Messages a second.
    seconds : float
        For how long.
    """

    topic: str
    kind: str
    way: str
    rate: float
    seconds: float


def serve_floods(pipe: Connection, robot: str, seed: int) -> None:
    """Flood topics that come by a pipe, and send back how many messages were sent."""
    rclpy.init(args=[])
    node = Node("flooder", start_parameter_services=False)
    known = known_robot(robot)
    while (flood := pipe.recv()) is not None:
        kind = interface_class(flood.kind)
        # The same messages in every flood of a kind.
        rng = np.random.default_rng([seed, *f"{flood.topic} {flood.way}".encode()])
        maker = MessageMaker(rng, known)
        publisher = node.create_publisher(kind, flood.topic, _LATCHED)
        different = [_made(maker, rng, kind, flood.way) for _ in range(_DIFFERENT)]
        if flood.topic == "/joint_states":
            for message in different:
                _mark(message)
        pipe.send(_sent(node, publisher, different, flood))
        node.destroy_publisher(publisher)
    node.destroy_node()
    rclpy.try_shutdown()


def _made(maker: MessageMaker, rng: np.random.Generator, kind: type, way: str) -> Any:
    """Make a message, or bytes."""
    share = 0.0 if way == "sensible" else None
    message = maker.make(kind, share)
    while len(serialize_message(message)) > _LARGEST:
        message = maker.make(kind, share)
    if way != "bytes":
        return message
    data = bytearray(serialize_message(message))
    # The first four bytes say how the others are to be read.
    data[4:] = rng.bytes(int(rng.integers(min(len(data), _LONGEST))))
    return bytes(data)


def _mark(message: Any) -> None:
    """Let those who watch the robot know that this is not it."""
    if hasattr(message, "header"):
        message.header.frame_id = STRANGER


def _sent(node: Node, publisher: Any, different: list[Any], flood: Flood) -> int:
    """Send as many messages as are due at each moment; gives how many."""
    began, sent = time.monotonic(), 0
    while (now := time.monotonic() - began) < flood.seconds:
        while sent < now * flood.rate:
            message = different[sent % len(different)]
            if hasattr(message, "header") and flood.way == "sensible":
                # Commands that are old are no commands.
                message.header.stamp = node.get_clock().now().to_msg()
            try:
                publisher.publish(message)
            except rclpy_implementation.RCLError:
                # The middleware does not send such bytes.
                different[sent % len(different)] = bytes(4)
            sent += 1
        time.sleep(1.0 / flood.rate)
    return sent
