"""Branches of revolute limbs, put together to postures of all actuated joints."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.outcomes import Code
from robomech_ros.parallel.argument_checks import actuated
from robomech_ros.parallel.result import LimbPostures
from robomech_ros.typing import Array, ArrayLike

# Rounding of a cosine at the end of a limb's reach, and of a length that vanishes (of the size).
_ROUNDING = 1e-14
# Branches nearer to each other than this (rad) are one, of a stretched limb.
_SAME = 1e-7
_WITHIN = 1e-12


@dataclass(frozen=True)
class Limb:
    """Solutions of one limb for a pose.

    Parameters
    ----------
    angles : tuple of float
        Angles of its actuated joint (rad): the branches ``-`` and ``+``; equal where they meet.
    excess : float
        By how much it misses the pose (m or rad), 0 where it does not.
    any_angle : bool
        Whether every angle will do.
    """

    angles: tuple[float, ...]
    excess: float = 0.0
    any_angle: bool = False


def planar_limb(x: float, y: float, proximal: float, distal: float) -> Limb:
    """Solve a limb of two links for a point (m) seen from its first joint."""
    size, reach = proximal + distal, math.hypot(x, y)
    if reach <= _ROUNDING * size:
        if abs(proximal - distal) <= _ROUNDING * size:
            return Limb((), any_angle=True)
        return Limb((), abs(proximal - distal))
    cosine = (reach * reach + proximal * proximal - distal * distal) / (2.0 * reach * proximal)
    if abs(cosine) > 1.0 + _ROUNDING:
        return Limb((), max(reach - size, abs(proximal - distal) - reach))
    half, middle = _acos(cosine), math.atan2(y, x)
    return Limb((wrapped(middle - half), wrapped(middle + half)))


def turning_limb(base: Array, middle: Array, target: Array, angle: float) -> Limb:
    """Solve a limb of two arcs: a middle axis turned about the base's, at an angle to a target.

    All three are unit vectors, the middle one where the joint is zero.
    """
    along = float(base @ middle)
    a = float((middle - along * base) @ target)
    b = float(np.cross(base, middle) @ target)
    d = math.cos(angle) - along * float(base @ target)
    size = math.hypot(a, b)
    if size <= _ROUNDING:
        if abs(d) <= 1e-12:
            return Limb((), any_angle=True)
        return Limb((), abs(_acos(along * float(base @ target)) - angle))
    if abs(d) > size + _ROUNDING:
        first, second = _acos(along), _acos(float(base @ target))
        far = min(first + second, 2.0 * math.pi - first - second)
        return Limb((), max(abs(first - second) - angle, angle - far))
    half, centre = _acos(d / size), math.atan2(b, a)
    return Limb((wrapped(centre - half), wrapped(centre + half)))


def _acos(cosine: float) -> float:
    return math.acos(max(-1.0, min(1.0, cosine)))


def wrapped(angle: float) -> float:
    """Return an angle within half a turn of zero."""
    return math.atan2(math.sin(angle), math.cos(angle))


def into_limits(angle: float, low: float, high: float) -> tuple[float, float]:
    """Return an angle, turned by whole turns into limits where that can be, and what it is off."""
    turns = math.ceil((low - _WITHIN - angle) / (2.0 * math.pi))
    best = angle + 2.0 * math.pi * turns
    if best <= high + _WITHIN:
        return best, 0.0
    below = best - 2.0 * math.pi
    return (best, best - high) if best - high < low - below else (below, low - below)


def postures(
    limbs: Sequence[Limb], limits: Array, seed: ArrayLike | None, unit: str = "m"
) -> LimbPostures:
    """Put the branches of all limbs together, within limits (n, 2), nearest to a seed first."""
    near = None if seed is None else actuated("seed", seed, len(limbs))
    n = len(limbs)
    nothing = np.empty((0, n))
    excess = np.array([limb.excess for limb in limbs])
    if excess.any():
        worst = int(np.argmax(excess))
        reason = f"limb {worst + 1} misses the pose by {excess[worst]:.3g} {unit}"
        return LimbPostures(nothing, (), Code.OUT_OF_REACH, reason, excess)
    loose = [i for i, limb in enumerate(limbs) if limb.any_angle]
    if loose:
        reason = f"any angle of limb {loose[0] + 1} holds this pose"
        return LimbPostures(nothing, (), Code.SINGULAR_CONTINUUM, reason, excess)
    choices = []
    for i, limb in enumerate(limbs):
        named = list(zip(limb.angles, "-+", strict=True))
        if abs(wrapped(limb.angles[1] - limb.angles[0])) <= _SAME:
            named = [(limb.angles[0], "0")]
        placed = [(*into_limits(angle, *limits[i].tolist()), sign) for angle, sign in named]
        inside = [(angle, sign) for angle, off, sign in placed if off == 0.0]
        if not inside:
            excess[i] = min(off for _, off, _ in placed)
        choices.append(inside)
    if excess.any():
        worst = int(np.argmax(excess))
        reason = (
            f"the joint of limb {worst + 1} would be {excess[worst]:.3g} rad outside its limits"
        )
        return LimbPostures(nothing, (), Code.LIMITS_EXCLUDE_ALL, reason, excess)
    found = list(itertools.product(*choices))
    q = np.array([[angle for angle, _ in row] for row in found])
    names = ["".join(sign for _, sign in row) for row in found]
    if near is not None:
        order = np.argsort(np.abs(q - near).max(axis=1), kind="stable")
        q, names = q[order], [names[i] for i in order]
    return LimbPostures(q, tuple(names), Code.NONE, "", excess)
