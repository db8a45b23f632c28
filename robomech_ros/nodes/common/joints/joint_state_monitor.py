"""The present state of the joints, by name, from the topic ``joint_states``.

Messages are taken from the middleware on demand: a node that subscribes to a fast
robot spends nothing while it is idle.
"""

import math
import time
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from rclpy.node import Node
from sensor_msgs.msg import JointState

from robomech_ros.errors import format_value
from robomech_ros.errors.formatting import counted
from robomech_ros.nodes.common.cooperative_wait import pause
from robomech_ros.nodes.common.messages.error_codes import NoStateError, RobotMovesError
from robomech_ros.nodes.middleware.polled_subscription import Inbox, UnreadableMessageError, unpack
from robomech_ros.typing import Array

TOPIC = "joint_states"
# Enough for several publishers of different rates between two looks.
_DEPTH = 50
# Number of remembered joints, of all publishers.
_MOST_JOINTS = 1000
_MOST_LISTED = 10


class _JointSample(NamedTuple):
    """Position and velocity of a joint from a message (rad or m, and per s); NaN if missing."""

    position: float
    velocity: float


class JointStateMonitor:
    """Latest state of every joint published on ``joint_states``."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._states: dict[str, _JointSample] = {}
        self._looks = 0
        self._updated_in: dict[str, int] = {}
        self._fault = ""
        self._inbox = Inbox(node, JointState, TOPIC, _DEPTH)

    def positions(self, joint_names: Sequence[str]) -> Array | None:
        """Return the present positions (rad or m), shape (n,); None if one is unknown."""
        self._take_all(joint_names)
        states = self._states
        if any(name not in states for name in joint_names):
            return None
        return np.array([states[name].position for name in joint_names], dtype=np.float64)

    def known_positions(self, joint_names: Sequence[str]) -> dict[str, float]:
        """Return the present positions (rad or m) of the known joints."""
        self._take_all(joint_names)
        return {n: self._states[n].position for n in joint_names if n in self._states}

    def velocities(self, joint_names: Sequence[str]) -> Array:
        """Return the velocities (rad/s or m/s), shape (n,), as of the last look at positions.

        A joint of unknown velocity counts as at rest.
        """
        unknown = _JointSample(math.nan, math.nan)
        speeds = np.array([self._states.get(name, unknown).velocity for name in joint_names])
        return np.where(np.isfinite(speeds), speeds, 0.0)

    def update_count(self, joint_names: Sequence[str]) -> int:
        """Return a counter of newer states of all these joints, as of the last look."""
        return min((self._updated_in.get(name, 0) for name in joint_names), default=0)

    def forget(self) -> None:
        """Discard all joint states: their publisher may be gone."""
        self._inbox.take_packed()
        self._states.clear()

    def require(self, joint_names: Sequence[str]) -> Array:
        """Return the present positions (n,) (rad or m); NoStateError names an unknown joint."""
        positions = self.positions(joint_names)
        if positions is None:
            missing = [name for name in joint_names if name not in self._states]
            raise NoStateError(missing, self._inbox.topic, self._received_text())
        return positions

    def _received_text(self) -> str:
        """Describe the received joint states, for an error about missing ones."""
        refused = f" (and what could not be used: {self._fault})" if self._fault else ""
        if not self._states:
            return f"nothing received{refused}"
        names = list(self._states)
        more = ", ..." if len(names) > _MOST_LISTED else ""
        return f"only {', '.join(names[:_MOST_LISTED])}{more} received{refused}"

    async def wait_for(
        self,
        joint_names: Sequence[str],
        patience: float,
        tolerance: float = math.inf,
        units: Mapping[str, str] | None = None,
    ) -> Array:
        """Return the positions (n,) (rad or m) once all joints are known and at rest.

        - ``joint_names``: the n joints.
        - ``patience``: how long to wait for that at the most (s).
        - ``tolerance``: greatest speed of a joint at rest, rad/s or m/s; default any. A joint whose
          velocity is not published stands.
        - ``units``: ``"rad"`` or ``"m"`` by joint, where that is known.

        Raises NoStateError: the position of a joint is not known. RobotMovesError: a joint moves;
        the fastest is named with its speed.
        """
        deadline = time.monotonic() + patience
        while time.monotonic() < deadline:
            known = self.positions(joint_names) is not None
            if known and self._fastest(joint_names)[1] <= tolerance:
                break
            await pause(self._node)
        positions = self.require(joint_names)
        joint, speed = self._fastest(joint_names)
        if speed > tolerance:
            raise RobotMovesError(joint, speed, tolerance, (units or {}).get(joint, ""))
        return positions

    def _fastest(self, joint_names: Sequence[str]) -> tuple[str, float]:
        """Find the fastest of joints that are known, and its speed (rad/s or m/s).

        Without joints, as for a fixed link, it is a nameless state at rest.
        """
        if not joint_names:
            return "", 0.0
        # NaN stands for a joint at rest.
        speeds = np.fmax(np.abs([self._states[name].velocity for name in joint_names]), 0.0)
        fastest = int(np.argmax(speeds))
        return joint_names[fastest], float(speeds[fastest])

    def _take_all(self, joint_names: Sequence[str]) -> None:
        packed = self._inbox.take_packed()
        if not packed:
            return
        # Newest first, until every known joint has a state: most messages stay packed.
        wanted = {*joint_names, *self._states}
        seen: dict[str, _JointSample] = {}
        newest_fault = ""
        for data in reversed(packed):
            states, fault = _read(data)
            newest_fault = newest_fault or fault
            for name, state in states.items():
                seen.setdefault(name, state)
            if seen.keys() >= wanted:
                break
        self._looks += 1
        self._fault = newest_fault or self._fault
        for name, state in seen.items():
            if name in self._states or len(self._states) < _MOST_JOINTS:
                self._states[name], self._updated_in[name] = state, self._looks


def _read(data: bytes) -> tuple[dict[str, _JointSample], str]:
    """Return the states of joints with a finite position in a message, and its faults."""
    try:
        message = unpack(data, JointState)
    except UnreadableMessageError as error:
        return {}, str(error)
    names, positions, velocities = message.name, message.position, message.velocity
    if len(names) != len(positions):
        return {}, f"{counted(len(positions), 'position')} for {counted(len(names), 'name')}"
    if len(set(names)) < len(names):
        twice = next(name for i, name in enumerate(names) if name in names[:i])
        return {}, f"{format_value(twice)} is in it twice"
    if len(velocities) != len(positions):
        velocities = [math.nan] * len(positions)
    usable, fault = dict[str, _JointSample](), ""
    for name, position, velocity in zip(names, positions, velocities, strict=True):
        if math.isfinite(position):
            usable[name] = _JointSample(position, velocity)
        else:
            fault = f"the position of {format_value(name)} is {position}"
    return usable, fault
