"""Messages of attacked nodes: finite numbers, and no motion by corrupt commands."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from findings import unexpected_number
from messages import MessageMaker
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data

from robomech_ros.nodes.commands.message_yaml import interface_class

__all__ = ["OutputWatch", "commands_of", "why_it_does_not_drive", "why_it_moved"]

# Topics that tell of the attackers, too.
_SHARED = ("/parameter_events", "/rosout", "/joint_states")
# Kinds of commands that a robot on wheels or legs takes.
_TWISTS = ("Twist", "TwistStamped")
# A robot that moves is faster than this, and one that stands slower (m/s, rad/s).
_MOVES, _STANDS = 0.01, 1e-9
_SPEED = 0.05
PATIENCE = 60.0
# Spoilt commands of each topic, and how long is looked whether they move the robot (s).
_SPOILT, _LOOKED = 100, 2.0
# By so much joints may differ that stand (rad or m).
_SAME = 1e-9
# How a pose or a twist is spoilt.
_NO_NUMBERS = (np.nan, np.inf, -np.inf)
Spin = Callable[[float], None]


class OutputWatch:
    """Looks at all that nodes publish for numbers that are none.

    Parameters
    ----------
    node : Node
        Who looks.
    names : sequence of str
        The nodes that are looked at.
    attacker : str
        The node whose topics are passed over.

    Attributes
    ----------
    faults : list of str
        The first fault of each topic.
    seen : int
        How many messages were looked at.
    latest : dict
        By topic the message that came last.
    """

    def __init__(self, node: Node, names: Sequence[str], attacker: str) -> None:
        self.faults: list[str] = []
        self.seen, self.latest = 0, dict[str, Any]()
        self._bad = set[str]()
        own = node.get_namespace()
        # What the attacker itself sends is not theirs.
        sent = dict(node.get_publisher_names_and_types_by_node(attacker, own))
        for name in names:
            for topic, kinds in node.get_publisher_names_and_types_by_node(name, own):
                if topic in self.latest or topic in sent or topic in _SHARED or "/_" in topic:
                    continue
                self.latest[topic] = None
                look = partial(self._look, topic, kinds[0])
                kind = interface_class(kinds[0])
                node.create_subscription(kind, topic, look, qos_profile_sensor_data)

    def _look(self, topic: str, kind: str, message: Any) -> None:
        self.seen += 1
        self.latest[topic] = message
        fault = unexpected_number(message, kind)
        if fault and topic not in self._bad:
            self._bad.add(topic)
            self.faults.append(f"{topic}: {fault}")

    def odometry(self) -> Any:
        """Return the message of the odometry that came last; None for none."""
        return next((one for one in self.latest.values() if type(one).__name__ == "Odometry"), None)


def commands_of(topics: Sequence[tuple[Any, Any]]) -> list[tuple[Any, Any]]:
    """Keep of kinds and their publishers those that command a robot on wheels or legs."""
    kinds = (*_TWISTS, "Pose", "String")
    return [one for one in topics if one[0].__name__ in kinds]


def why_it_moved(
    commands: Sequence[tuple[Any, Any]], maker: MessageMaker, watch: OutputWatch, spin: Spin
) -> str:
    """Send commands that are spoilt; say how the robot moved, empty for not at all."""
    _wait(spin, lambda: watch.odometry() is not None)
    first = watch.odometry()
    if first is None:
        return "no odometry"
    for turn in range(_SPOILT):
        for kind, publisher in commands:
            publisher.publish(_spoilt(maker.make(kind, 0.0), turn))
            spin(0.0)
            if why := _moved(first, watch.odometry()):
                return why
    until = time.monotonic() + _LOOKED
    while time.monotonic() < until:
        spin(0.05)
    return _moved(first, watch.odometry())


def _spoilt(message: Any, turn: int) -> Any:
    """Spoil one number of a command, or its text."""
    kind, bad = type(message).__name__, _NO_NUMBERS[turn % len(_NO_NUMBERS)]
    if kind == "String":
        message.data = ("", "run", "tripod\0", "a" * 10_000)[turn % 4]
        return message
    if kind == "Pose":
        parts = (message.position, message.orientation)
        if turn % 4 == 0:
            message.position.z = 10.0
            return message
    else:
        twist = message if kind == "Twist" else message.twist
        parts = (twist.linear, twist.angular)
    part = parts[turn // 3 % 2]
    setattr(part, "xyz"[turn // 6 % 3], bad)
    return message


def _moved(first: Any, now: Any) -> str:
    twist = now.twist.twist
    fastest = max(abs(getattr(part, k)) for part in (twist.linear, twist.angular) for k in "xyz")
    before, after = first.pose.pose.position, now.pose.pose.position
    way = max(abs(getattr(before, k) - getattr(after, k)) for k in "xyz")
    if fastest <= _STANDS and way <= _SAME:
        return ""
    return f"spoilt commands moved it by {way:.3g} m, at up to {fastest:.3g}"


def why_it_does_not_drive(topics: Sequence[tuple[Any, Any]], watch: OutputWatch, spin: Spin) -> str:
    """Drive forward and let commands time out; empty where that works."""
    kind, publisher = next(one for one in topics if one[0].__name__ == "Twist")
    # An attack may have slowed a controller down.
    factors = [one for one in topics if one[0].__name__ == "SpeedScalingFactor"]
    forward = kind()
    forward.linear.x = _SPEED

    def drives() -> bool:
        for factor, slower in factors:
            slower.publish(factor(factor=1.0))
        publisher.publish(forward)
        spin(0.05)
        return watch.odometry().twist.twist.linear.x > _MOVES

    if not _wait(spin, drives):
        return "it does not follow a twist"
    if not _wait(spin, lambda: not _moved(watch.odometry(), watch.odometry())):
        return "it does not stop when commands time out"
    return ""


def _wait(spin: Spin, condition: Callable[[], bool]) -> bool:
    until = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > until:
            return False
        spin(0.05)
    return True
