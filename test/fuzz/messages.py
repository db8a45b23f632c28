"""Messages made from their definitions: sensible ones, wild ones, and all between."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any

import numpy as np
from known_robot import KnownRobot

from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix

__all__ = ["SHARES", "MessageMaker"]

_LIST = re.compile(r"sequence<(?P<entry>.+?)(, (?P<bound>\d+))?>|(?P<of>.+)\[(?P<size>\d+)\]")
_INTEGER = re.compile(r"(?P<unsigned>u?)int(?P<bits>8|16|32|64)")
_WILD_NUMBERS = (
    np.nan, np.inf, -np.inf, 1e308, -1e308, 1e155, 1e30, 1e9, -1e9, 5e-324, 1e-12, 0.0, -0.0, np.pi,
)  # fmt: skip
_WILD_TEXTS = (
    "", " ", "/", "//", "a" * 10_000, "ä\u202e\u0000b", "../../etc/passwd", "%s%n", "'\"`;", "\n",
)  # fmt: skip
_WILD_LENGTHS = (0, 1, 2, 7, 64, 1000)
# What the names of fields contain that negative numbers mean nothing for.
_POSITIVE = (
    "scale", "speed", "step", "threshold", "tolerance", "period", "limit", "mass", "effort", "time",
    "friction", "torsional", "length",
)  # fmt: skip
# Entries that are messages themselves: a thousand would only be slow.
_MOST_NESTED = 20
# How far points are from the origin of their frame (m).
_SPREAD = 0.1
# How many leaves of a message are wild: none, a few, many, all.
SHARES = (0.0, 0.0, 0.03, 0.03, 0.3, 1.0)


class MessageMaker:
    """Makes messages of any type for one robot.

    Parameters
    ----------
    rng : numpy.random.Generator
        The same seed makes the same messages.
    robot : KnownRobot
        Whose joints and links sensible messages name.
    shares : sequence of float, optional
        How many leaves of a message are wild, one of these by chance.
    """

    def __init__(
        self, rng: np.random.Generator, robot: KnownRobot, shares: Sequence[float] = SHARES
    ) -> None:
        self._rng, self._robot, self._shares = rng, robot, shares
        self._share, self._count = 0.0, 0
        self._sensible: dict[str, Callable[[Any], None]] = {
            "JointState": self._joint_state,
            "JointTrajectory": self._trajectory,
            "Pose": self._pose,
            "Quaternion": self._quaternion,
            "Point": self._point,
            "Duration": self._duration,
            "Time": lambda message: None,
        }

    def make(self, kind: type, share: float | None = None) -> Any:
        """Make a message of a type; `share` of its leaves is wild, by default any share."""
        self._share = float(self._rng.choice(self._shares)) if share is None else share
        # Lists of one message mostly belong together.
        self._count = self._random_count()
        return self._filled(kind())

    def _filled(self, message: Any) -> Any:
        sensible = self._sensible.get(type(message).__name__)
        if sensible is not None and self._rng.random() >= self._share:
            sensible(message)
            return message
        for name, form in message.get_fields_and_field_types().items():
            setattr(message, name, self._value(name, form))
        return message

    def _value(self, name: str, form: str) -> Any:
        found = _LIST.fullmatch(form)
        if found is None:
            return self._entry(name, form)
        entry = found["entry"] or found["of"]
        count = int(found["size"]) if found["size"] else self._length(entry)
        if found["bound"]:
            count = min(count, int(found["bound"]))
        if entry == "boolean" and self._rng.random() > max(self._share, 0.3):
            # The default of a mask, which serves every robot.
            return [False] * count
        values = [self._entry(name, entry) for _ in range(count)]
        return bytes(values) if entry == "octet" else values

    def _length(self, entry: str) -> int:
        if self._rng.random() < self._share:
            count = int(self._rng.choice(_WILD_LENGTHS))
        else:
            count = self._count if self._rng.random() < 0.8 else self._random_count()
        return min(count, _MOST_NESTED) if "/" in entry else count

    def _random_count(self) -> int:
        return int(self._rng.choice([0, 1, 2, 3, self._robot.n]))

    def _entry(self, name: str, form: str) -> Any:
        if "/" in form:
            package, kind = form.split("/")
            return self._filled(getattr(import_module(f"{package}.msg"), kind)())
        wild = self._rng.random() < self._share
        if form == "boolean":
            return bool(self._rng.random() < 0.5)
        if form in ("double", "float"):
            value = self._rng.choice(_WILD_NUMBERS) if wild else self._number(name)
            # Rounding to single precision must not overflow with a warning.
            return float(np.clip(value, -3e38, 3e38)) if form == "float" else float(value)
        if form.startswith(("string", "wstring")):
            return self._text(name, wild)
        if form == "octet":
            return int(self._rng.integers(256)).to_bytes(1, "big") if wild else b"\0"
        return self._integer(form, wild)

    def _number(self, name: str) -> float:
        """Return a number that a field of this name may have; 0 is the default of many."""
        if any(part in name for part in _POSITIVE):
            return float(self._rng.choice([0.0, self._rng.uniform(0.1, 1.0)]))
        return float(self._rng.normal())

    def _text(self, name: str, wild: bool) -> str:
        if wild:
            return str(self._rng.choice(_WILD_TEXTS))
        if name in self._robot.words:
            return str(self._rng.choice(self._robot.words[name]))
        if "joint" in name or name == "name":
            return str(self._rng.choice(self._robot.joint_names))
        if "link" in name or "frame" in name:
            return str(self._rng.choice(self._robot.links))
        return ""

    def _integer(self, form: str, wild: bool) -> int:
        found = _INTEGER.fullmatch(form)
        bits, signed = (int(found["bits"]), not found["unsigned"]) if found else (8, False)
        low, high = (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if signed else (0, 2**bits - 1)
        if wild:
            return int(self._rng.choice(np.array([low, high, 0, 1, high // 2], dtype=object)))
        # Mostly one of the first values of an enumeration.
        return int(self._rng.choice(4, p=[0.5, 0.3, 0.1, 0.1]))

    def _joint_state(self, message: Any) -> None:
        if self._rng.random() < 0.3:
            return
        order = self._rng.permutation(self._robot.n)
        positions = self._robot.positions(self._rng, 1.1).tolist()
        message.name = [self._robot.joint_names[k] for k in order]
        message.position = [positions[k] for k in order]
        if self._rng.random() < 0.3:
            message.velocity = self._rng.normal(size=self._robot.n).tolist()
            message.effort = self._rng.normal(size=self._robot.n).tolist()

    def _trajectory(self, message: Any) -> None:
        from trajectory_msgs.msg import JointTrajectoryPoint

        message.joint_names = list(self._robot.joint_names)
        count = int(self._rng.integers(1, 5))
        times = np.cumsum(self._rng.uniform(0.1, 1.0, count))
        start = self._robot.home
        for time in times:
            point = JointTrajectoryPoint()
            point.positions = (start + 0.02 * self._rng.normal(size=self._robot.n)).tolist()
            self._duration(point.time_from_start, float(time))
            message.points.append(point)

    def _pose(self, message: Any) -> None:
        pose = pose_from_matrix(self._robot.pose(self._rng))
        message.position, message.orientation = pose.position, pose.orientation

    def _point(self, message: Any) -> None:
        message.x, message.y, message.z = (_SPREAD * self._rng.normal(size=3)).tolist()

    def _quaternion(self, message: Any) -> None:
        q = self._rng.normal(size=4)
        message.x, message.y, message.z, message.w = (q / np.linalg.norm(q)).tolist()

    def _duration(self, message: Any, seconds: float | None = None) -> None:
        given = self._rng.choice([0.0, 0.1, 1.0, 3.0]) if seconds is None else seconds
        message.sec = int(given)
        message.nanosec = int(given % 1.0 * 1e9)
