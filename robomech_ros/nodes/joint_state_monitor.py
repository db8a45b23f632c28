"""The present positions of the joints, by name, from the topic ``joint_states``.

Messages are taken from the middleware only when somebody asks: a node that listens to a fast
robot spends nothing while it is idle.
"""

from array import array
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState

from robomech_ros.nodes.error_codes import NoStateError

__all__ = ["JointStateMonitor"]

TOPIC = "joint_states"
# Enough for several publishers of different rates between two looks.
_DEPTH = 50
_QOS = QoSProfile(
    depth=_DEPTH, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.BEST_EFFORT
)


class _Unattended(CallbackGroup):
    """Keeps a subscription out of the executor: its messages are taken by hand."""

    def can_execute(self, entity: Any) -> bool:
        return False

    def beginning_execution(self, entity: Any) -> bool:
        return False

    def ending_execution(self, entity: Any) -> None:
        """Nothing was begun."""


class JointStateMonitor:
    """Knows the latest position of every joint that was ever published on ``joint_states``.

    Parameters
    ----------
    node : Node
        Owner of the subscription.
    """

    def __init__(self, node: Node) -> None:
        self._positions: dict[str, float] = {}
        self._subscription = node.create_subscription(
            JointState, TOPIC, self._store, _QOS, callback_group=_Unattended(), raw=True
        )

    def positions(self, joint_names: Sequence[str]) -> NDArray[np.float64] | None:
        """Give the present positions (rad or m), shape (n,); None while one is not known."""
        self._take_all(joint_names)
        try:
            return np.array([self._positions[name] for name in joint_names], dtype=np.float64)
        except KeyError:
            return None

    def require(self, joint_names: Sequence[str]) -> NDArray[np.float64]:
        """Give the present positions (rad or m), shape (n,).

        Raises
        ------
        NoStateError
            The position of a joint is not known; it is named.
        """
        positions = self.positions(joint_names)
        if positions is None:
            missing = [name for name in joint_names if name not in self._positions]
            raise NoStateError(missing, self._subscription.topic_name)
        return positions

    def _take_all(self, joint_names: Sequence[str]) -> None:
        # Newest first, until every joint ever heard of was seen: most messages stay packed.
        wanted = {*joint_names, *self._positions}
        seen: dict[str, float] = {}
        for data in reversed(list(self._waiting())):
            for name, position in _valid(deserialize_message(data, JointState)):
                seen.setdefault(name, position)
            if seen.keys() >= wanted:
                break
        self._positions.update(seen)

    def _waiting(self) -> Iterator[bytes]:
        subscription = self._subscription
        with subscription.handle:
            for _ in range(_DEPTH):
                taken = subscription.handle.take_message(JointState, True)
                if taken is None:
                    return
                yield taken[0]

    def _store(self, data: bytes) -> None:
        """Keep one message; serves executors that do not honour callback groups."""
        self._positions.update(_valid(deserialize_message(data, JointState)))


def _valid(message: JointState) -> Iterator[tuple[str, float]]:
    """List the joints of a message with finite positions; none if its lengths disagree."""
    positions: array[float] = message.position
    if len(message.name) != len(positions):
        return
    for name, position in zip(message.name, positions, strict=True):
        if position - position == 0.0:
            yield name, position
