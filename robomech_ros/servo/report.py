"""Servo report on a period: executed fraction of the command, and its limiting causes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from robomech_ros.servo.limits import ServoLimits
from robomech_ros.servo.motion import Advance
from robomech_ros.servo.twist_resolver import Resolution
from robomech_ros.typing import Array

# Changes of velocity that take longer than this many periods are worth a word.
_NEARLY_ONE = 1.0 - 1e-6
# The part of a twist that turns the tip, or shifts it, is named if it is this part of the other.
_NOTICED = 0.05


class ServoCondition(Enum):
    """Cause that limits the motion."""

    NO_WARNING = "no warning"
    APPROACHING_SINGULARITY = "approaching a singularity"
    SINGULARITY = "singularity"
    LEAVING_SINGULARITY = "leaving a singularity"
    APPROACHING_CONTACT = "approaching contact"
    CONTACT = "contact"
    JOINT_BOUND = "joint bound"
    RATE_BOUND = "rate bound"
    IMPOSSIBLE = "impossible"
    STALE_COMMAND = "stale command"
    PAUSED = "paused"


@dataclass(frozen=True, eq=False)
class ServoReport:
    """Execution of the command in one period: what limits the motion, which joints, and in words.

    The motion is carried out at a scale of the commanded speed, 0 to 1; 1 without command. The
    condition number is that of the Jacobian over the characteristic length. The text is empty where
    nothing limits the motion.
    """

    condition: ServoCondition
    scale: float
    condition_number: float
    joints: tuple[str, ...] = ()
    text: str = ""


def motion_report(
    limits: ServoLimits,
    found: Resolution,
    share: tuple[float, int],
    advance: Advance,
    velocity: Array,
) -> ServoReport:
    """Say what limits a motion most.

    ``found`` are the resulting rates, ``share`` how much of them the velocity limits allow, and
    which joint needs that most; ``advance`` is what became of them in the period, and ``velocity``
    (n,) that at its end (rad/s or m/s).
    """
    number, (speed, fastest) = found.condition_number, share
    carried = _carried(found.rates, velocity)
    if not found.possible:
        text = "the arm cannot move in the direction of the twist, whatever its posture"
        return ServoReport(ServoCondition.IMPOSSIBLE, 0.0, number, (), text)
    if min(speed, found.scale) == 0.0:
        text = f"the motion leads into a singularity (condition number {number:.4g}), "
        text += f"where the tip cannot move {_in_words(found.lost)}"
        return ServoReport(ServoCondition.SINGULARITY, carried, number, (), text)
    near = ServoCondition.APPROACHING_SINGULARITY
    leaving = ServoCondition.LEAVING_SINGULARITY
    if advance.bound and advance.allowed < _NEARLY_ONE:
        text = f"{', '.join(advance.bound)} near the end of the range"
        return ServoReport(ServoCondition.JOINT_BOUND, carried, number, advance.bound, text)
    if found.scale < min(speed, _NEARLY_ONE):
        where = "on the way out of" if found.leaving else "before"
        text = f"slowed down to {found.scale:.3g} {where} a singularity"
        text += f" (condition number {number:.4g})"
        return ServoReport(leaving if found.leaving else near, carried, number, (), text)
    if speed < _NEARLY_ONE:
        name, limit = limits.joint_names[fastest], float(limits.velocity[fastest])
        unit = f" {limits.units[fastest]}/s"
        rate = abs(float(found.rates[fastest]))
        text = f"{name} would move at {rate:.4g}{unit}, it can {limit:.4g}{unit}"
        what = leaving if found.leaving else ServoCondition.RATE_BOUND
        return ServoReport(what, carried, number, (name,), text)
    if advance.followed < _NEARLY_ONE:
        text = "the acceleration limits are used up"
        return ServoReport(ServoCondition.RATE_BOUND, carried, number, (), text)
    return ServoReport(ServoCondition.NO_WARNING, carried, number)


def _in_words(twist: Array) -> str:
    sizes = [float(np.abs(part).max()) for part in (twist[:3], twist[3:])]
    words = [
        f"{word} ({', '.join(f'{x / size + 0.0:.2f}' for x in part.round(12))})"
        for word, part, size in zip(("about", "along"), (twist[:3], twist[3:]), sizes, strict=True)
        if size > _NOTICED * max(sizes)
    ]
    return " and ".join(words)


def _carried(rates: Array, velocity: Array) -> float:
    """Return what part of the commanded rates the joints have now."""
    largest = float(np.abs(rates).max())
    if largest == 0.0:
        return 1.0
    # Not their square, which would overflow.
    along = rates / largest
    part = float(velocity @ along) / float(along @ along) / largest
    return min(max(part, 0.0), 1.0)
