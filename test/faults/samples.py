"""Joint states as they come, and how far they are within the limits of the robot."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState

from robomech_ros.nodes.middleware.polled_subscription import ManualSubscription
from robomech_ros.typing import Array, IntArray

__all__ = ["TOLERANCE", "Jump", "Limits", "Ratios", "Samples"]


# How far differences may be beyond a limit: stamps follow the setting of the system's clock, by up
# to 0.1 % of the time.
TOLERANCE = 0.01
_DEPTH = 5000
# How often it is looked for new states, s.
_LOOK = 0.01
_NANO = 1e-9


@dataclass(frozen=True)
class Limits:
    """Names of n joints, and limits of velocity and acceleration (rad/s or m/s, and per s)."""

    names: tuple[str, ...]
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class Jump:
    """A jump of the clock: the time before (ns), and by how much it jumped (s)."""

    before: int
    by: float

    def step(self, stamps: IntArray) -> int:
        """Find the step of stamps (ns) in which it is: on, over what was not, or back."""
        later = stamps > self.before
        steps = later[1:] & ~later[:-1] if self.by > 0.0 else np.diff(stamps) < 0
        return int(np.flatnonzero(steps)[0])


@dataclass(frozen=True)
class Ratios:
    """Used fractions of the limits, by differences of neighbouring states.

    Attributes
    ----------
    velocity, acceleration : float
        The largest parts of the limits, of all joints.
    states : int
        How many there were.
    """

    velocity: float
    acceleration: float
    states: int

    @property
    def kept(self) -> bool:
        """Whether the limits were kept."""
        return max(self.velocity, self.acceleration) <= 1.0 + TOLERANCE


class Samples:
    """Keeps all joint states; they are unpacked only when they are looked at.

    Parameters
    ----------
    node : Node
        Owner of the subscription.
    limits : Limits
        Of the joints that are looked at.
    """

    def __init__(self, node: Node, limits: Limits) -> None:
        self.limits = limits
        self._packed: list[bytes] = []
        self._heard_at = 0.0
        # The executor would take one message a turn, and fall behind on a busy machine.
        self._subscription = node.create_subscription(
            JointState,
            "joint_states",
            lambda packed: None,
            QoSProfile(depth=_DEPTH),
            callback_group=ManualSubscription(),
            raw=True,
        )
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._take, daemon=True)
        self._thread.start()

    def _take(self) -> None:
        handle = self._subscription.handle
        while not self._over.wait(_LOOK):
            with handle:
                while (taken := handle.take_message(JointState, True)) is not None:
                    self._packed.append(taken[0])
                    self._heard_at = time.monotonic()

    def close(self) -> None:
        """Take no more; to be called before the node is destroyed."""
        self._over.set()
        self._thread.join()

    @property
    def count(self) -> int:
        """How many states have come."""
        return len(self._packed)

    @property
    def silent(self) -> float:
        """For how long none has come, s."""
        return time.monotonic() - self._heard_at

    def latest(self) -> tuple[Array, Array]:
        """Return position and velocity (n,) of the last state."""
        _, position, velocity = self._read(self._packed[-1])
        return position, velocity

    @property
    def stands(self) -> bool:
        """Whether the last state is one of rest."""
        return bool(self._packed) and not self.latest()[1].any()

    def ratios(self, first: int, resets: Sequence[int], jump: Jump | None) -> Ratios:
        """Compare with the limits.

        Parameters
        ----------
        first : int
            Which state is the first.
        resets : sequence of int
            Which are the first ones of a robot that begins elsewhere.
        jump : Jump or None
            Of the clock in the meantime: it is no time for a motion.
        """
        rows = [self._read(packed) for packed in self._packed[first:]]
        stamps, position, velocity = (np.array(part) for part in zip(*rows, strict=True))
        passed = _NANO * np.diff(stamps)
        if jump is not None:
            step = jump.step(stamps)
            # The cycle of a jump is as long as any.
            passed[step] = max(passed[step] - jump.by, float(np.median(passed)))
        went, gained = np.abs(np.diff(position, axis=0)), np.abs(np.diff(velocity, axis=0))
        for index in resets:
            if 0 < index - first < len(rows):
                went[index - first - 1] = gained[index - first - 1] = 0.0
        passed = np.maximum(passed, _NANO)
        speeds = went / passed[:, None] / self.limits.velocity
        rates = gained / passed[:, None] / self.limits.acceleration
        told = np.abs(velocity) / self.limits.velocity
        return Ratios(max(float(speeds.max()), float(told.max())), float(rates.max()), len(rows))

    def _read(self, packed: bytes) -> tuple[int, Array, Array]:
        message = deserialize_message(packed, JointState)
        assert set(self.limits.names) <= set(message.name), "joint_states of another robot came"
        at = [message.name.index(name) for name in self.limits.names]
        stamp = message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec
        return stamp, np.array(message.position)[at], np.array(message.velocity)[at]
