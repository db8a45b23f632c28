"""Limbs of planar platforms: R P R and R R R, all axes of turning along z."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from robomech_ros.parallel.limbs import planar_limb, wrapped
from robomech_ros.parallel.mechanism.limb import Axis, Limb, LimbBranches, chain_of_axes
from robomech_ros.robots import SerialChain
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array

_X, _Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
_SAME = 1e-7


def sliding_limbs(
    name: str, base_points: Array, platform_points: Array, strokes: Array | None
) -> list[Limb]:
    """Make the limbs R P R of points (3, 2), in m; their lengths have drives."""
    limbs = []
    for i, (a, b) in enumerate(zip(base_points, platform_points, strict=True)):
        leg = f"leg{i + 1}"
        low, high = (0.0, math.inf) if strokes is None else strokes[i].tolist()
        point = np.array([*a, 0.0])
        axes = [
            Axis(f"{leg}_base", f"{leg}_cylinder", _Z, point),
            Axis(f"{leg}_length", f"{leg}_rod", _X, point, True, (low, high)),
            Axis(f"{leg}_platform", f"{leg}_stud", _Z, point),
        ]
        chain = _chain(name, i, axes, a, b)
        limbs.append(Limb(chain, (f"{leg}_length",), partial(_slid, a, b)))
    return limbs


def folding_limbs(
    name: str,
    base_points: Array,
    platform_points: Array,
    proximal: Array,
    distal: Array,
    limits: Array,
) -> list[Limb]:
    """Make the limbs R R R of points (3, 2) and links (3,), in m; the first joints have drives."""
    limbs = []
    for i, (a, b) in enumerate(zip(base_points, platform_points, strict=True)):
        leg, one, two = f"leg{i + 1}", float(proximal[i]), float(distal[i])
        points = [np.array([a[0] + far, a[1], 0.0]) for far in (0.0, one, one + two)]
        low, high = limits[i].tolist()
        axes = [
            Axis(f"{leg}_base", f"{leg}_proximal", _Z, points[0], limits=(low, high)),
            Axis(f"{leg}_elbow", f"{leg}_distal", _Z, points[1]),
            Axis(f"{leg}_platform", f"{leg}_stud", _Z, points[2]),
        ]
        chain = _chain(name, i, axes, points[2][:2], b)
        limbs.append(Limb(chain, (f"{leg}_base",), partial(_folded, a, b, (one, two))))
    return limbs


def _chain(name: str, i: int, axes: list[Axis], corner: Array, b: Array) -> SerialChain:
    """Make the chain whose platform has its point b at a corner, and is not turned."""
    T = assembled(np.eye(3), np.array([*(corner - b), 0.0]))
    return chain_of_axes(name, axes, T, "platform" if i == 0 else f"leg{i + 1}_end")


def _slid(a: Array, b: Array, T: Array, _: Array | None) -> LimbBranches:
    x, y = (T[:2, :2] @ b + T[:2, 3] - a).tolist()
    if x == 0.0 and y == 0.0:
        return LimbBranches(np.empty((0, 3)), (), continuum=True)
    angle = math.atan2(y, x)
    turn = wrapped(math.atan2(T[1, 0], T[0, 0]) - angle)
    return LimbBranches(np.array([[angle, math.hypot(x, y), turn]]), ("0",))


def _folded(
    a: Array, b: Array, links: tuple[float, float], T: Array, drives: Array | None
) -> LimbBranches:
    x, y = (T[:2, :2] @ b + T[:2, 3] - a).tolist()
    found = planar_limb(x, y, *links)
    angles = found.angles if drives is None else drives.tolist()
    if not angles:
        return LimbBranches(np.empty((0, 3)), (), found.excess, found.any_angle)
    rows = []
    for base in angles:
        second = math.atan2(y - links[0] * math.sin(base), x - links[0] * math.cos(base))
        turn = math.atan2(T[1, 0], T[0, 0])
        rows.append([base, wrapped(second - base), wrapped(turn - second)])
    return one_or_two(np.array(rows))


def one_or_two(rows: Array) -> LimbBranches:
    """Name the branches - and +, or 0 where both are one, or there is one only."""
    if len(rows) == 1:
        return LimbBranches(rows, ("0",))
    apart = np.abs(np.remainder(rows[1] - rows[0] + np.pi, 2.0 * np.pi) - np.pi)
    if apart.max() <= _SAME:
        return LimbBranches(rows[:1], ("0",))
    return LimbBranches(rows, ("-", "+"))
