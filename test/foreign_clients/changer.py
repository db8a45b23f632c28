"""Objects that come and go at 50 Hz around a robot, as MoveIt's clients announce them."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from geometry_msgs.msg import Pose
from moveit_msgs.msg import CollisionObject
from rclpy.node import Node
from shape_msgs.msg import SolidPrimitive

PERIOD = 0.02
# Objects that stay for about this time (s), and so many that come and go.
_STAY, _LASTING, _BRIEF = 3.0, 6, 6
# Places of the objects: distance from the axis of the base, angle, height; and their lengths (m).
_PLACES = (0.35, 0.9), (-1.6, 1.2), (0.05, 0.8)
_SIZES = 0.04, 0.15


@dataclass
class Standing:
    """A box that stood somewhere, from when to when (ROS time, s)."""

    sizes: tuple[float, float, float]
    position: tuple[float, float, float]
    since: float
    until: float = np.inf


class Changer:
    """Adds or removes one object each period, on the topic collision_object.

    Parameters
    ----------
    node : Node
        It spins.
    random : Generator
    """

    def __init__(self, node: Node, random: Any) -> None:
        self._random = random
        self._publisher = node.create_publisher(CollisionObject, "collision_object", 100)
        self._now: dict[int, Standing] = {}
        self.history: list[Standing] = []
        self.count = 0
        self.timer = node.create_timer(PERIOD, self._change)

    @property
    def names(self) -> set[str]:
        """Names of the objects that stand now."""
        return {f"box_{slot}" for slot in self._now}

    def _change(self) -> None:
        lasting = self._random.random() < PERIOD * _LASTING / _STAY
        first, many = (0, _LASTING) if lasting else (_LASTING, _BRIEF)
        slot = first + int(self._random.integers(many))
        message = CollisionObject(id=f"box_{slot}")
        message.header.frame_id = "base_link"
        if slot in self._now:
            message.operation = CollisionObject.REMOVE
            # The robot may pass from now on, and not before.
            self._now.pop(slot).until = time.time()
        else:
            one = self._now[slot] = self._new()
            shape = SolidPrimitive(type=SolidPrimitive.BOX, dimensions=list(one.sizes))
            message.primitives, message.pose = [shape], Pose()
            position = message.pose.position
            position.x, position.y, position.z = one.position
            self.history.append(one)
        self._publisher.publish(message)
        self.count += 1

    def _new(self) -> Standing:
        distance, angle, height = (float(self._random.uniform(*ends)) for ends in _PLACES)
        place = distance * np.cos(angle), distance * np.sin(angle), height
        sizes = self._random.uniform(*_SIZES, 3).tolist()
        return Standing(tuple(sizes), tuple(map(float, place)), time.time())
