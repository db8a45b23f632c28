"""Limbs of the planar, the spherical and the Delta robots, solved in closed form.

Those of planar robots are R P R and R R R, all axes of turning along z, those of spherical ones
R R R, all axes through the centre.  Those of a Delta robot are a driven arm, and a forearm between
two universal joints: with parallel axes it lets the platform translate as two parallel rods do.
"""

import math
from functools import partial

import numpy as np

from robomech_ros._kernels.parallel.delta import delta_angles
from robomech_ros.parallel.argument_checks import rotation_only, translation_only
from robomech_ros.parallel.limbs import planar_limb, turning_limb, wrapped
from robomech_ros.parallel.mechanism.limb import Axis, Limb, LimbBranches, chain_of_axes
from robomech_ros.robots import SerialChain
from robomech_ros.robots.joint import rotation_from_z
from robomech_ros.spatial.poses import assembled
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector
from robomech_ros.typing import Array

_X, _Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
# Branches whose joints differ by no more than this (rad) are one.
_SAME = 1e-7
_HALF = 0.5 * math.pi


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
    return _one_or_two(np.array(rows))


def _one_or_two(rows: Array) -> LimbBranches:
    """Name the branches - and +, or 0 where both are one, or there is one only."""
    if len(rows) == 1:
        return LimbBranches(rows, ("0",))
    apart = np.abs(np.remainder(rows[1] - rows[0] + np.pi, 2.0 * np.pi) - np.pi)
    if apart.max() <= _SAME:
        return LimbBranches(rows[:1], ("0",))
    return LimbBranches(rows, ("-", "+"))


def spherical_limbs(
    name: str,
    base_axes: Array,
    middle_axes: Array,
    platform_axes: Array,
    distal: Array,
    limits: Array,
) -> list[Limb]:
    """Make the limbs R R R of unit axes (3, 3) and distal arcs (3,), rad.

    Where the elbow is at zero, the distal arc goes on in the plane of the proximal one.
    """
    limbs = []
    for i in range(3):
        leg, w, m, v = f"leg{i + 1}", base_axes[i], middle_axes[i], platform_axes[i]
        normal = np.cross(w, m)
        normal /= np.linalg.norm(normal)
        u = matrix_from_rotation_vector(float(distal[i]) * normal) @ m
        R = rotation_from_z(u)[:3, :3] @ rotation_from_z(v)[:3, :3].T
        low, high = limits[i].tolist()
        centre = np.zeros(3)
        axes = [
            Axis(f"{leg}_base", f"{leg}_proximal", w, centre, limits=(low, high)),
            Axis(f"{leg}_elbow", f"{leg}_distal", m, centre),
            Axis(f"{leg}_platform", f"{leg}_stud", u, centre),
        ]
        tip = "platform" if i == 0 else f"{leg}_end"
        chain = chain_of_axes(name, axes, assembled(R, centre), tip)
        limbs.append(Limb(chain, (f"{leg}_base",), partial(_turned, (w, m, v, u, R))))
    return limbs


def _turned(
    limb: tuple[Array, Array, Array, Array, Array], T: Array, drives: Array | None
) -> LimbBranches:
    """Solve a limb of axes w, m, v and u and a rotation R0, all joints at zero there."""
    R, (w, m, v, u, R0) = rotation_only(T), limb
    angle = math.atan2(float(np.linalg.norm(np.cross(m, u))), float(m @ u))
    found = turning_limb(w, m, R @ v, angle)
    angles = found.angles if drives is None else drives.tolist()
    if not angles:
        return LimbBranches(np.empty((0, 3)), (), found.excess, found.any_angle)
    rows, across = [], np.cross(u, m)
    for base in angles:
        one = matrix_from_rotation_vector(base * w)
        elbow = _turn_about(m, u, one.T @ R @ v)
        turned = one @ matrix_from_rotation_vector(elbow * m)
        rows.append([base, elbow, _turn_about(u, across, turned.T @ R @ R0.T @ across)])
    return _one_or_two(np.array(rows))


def _turn_about(axis: Array, start: Array, end: Array) -> float:
    """Return the angle (rad) by which one direction turns into another about an axis."""
    start = start - float(axis @ start) * axis
    return math.atan2(float(np.cross(start, end) @ axis), float(start @ end))


def delta_limbs(name: str, geometry: Array, azimuths: Array, limits: Array) -> list[Limb]:
    """Make the limbs R U U at azimuths (3,) about z (rad), with limits (3, 2) of the arms (rad).

    The geometry (4,) is the radius of base and platform, arm and forearm (m).
    """
    base, platform, arm, forearm = geometry.tolist()
    limbs = []
    for i, azimuth in enumerate(azimuths.tolist()):
        leg = f"leg{i + 1}"
        r = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
        across = np.array([-r[1], r[0], 0.0])
        elbow = (base + arm) * r
        ankle = elbow - [0.0, 0.0, forearm]
        low, high = limits[i].tolist()
        # With all joints at zero the arm is level and the forearm hangs down.
        axes = [
            Axis(f"{leg}_base", f"{leg}_arm", across, base * r, limits=(low, high)),
            Axis(f"{leg}_elbow_swing", f"{leg}_elbow_cross", across, elbow),
            Axis(f"{leg}_elbow_tilt", f"{leg}_forearm", r, elbow, limits=(-_HALF, _HALF)),
            Axis(f"{leg}_platform_tilt", f"{leg}_platform_cross", r, ankle, limits=(-_HALF, _HALF)),
            Axis(f"{leg}_platform_swing", f"{leg}_stud", across, ankle),
        ]
        T = assembled(np.eye(3), ankle - platform * r)
        tip = "platform" if i == 0 else f"{leg}_end"
        chain = chain_of_axes(name, axes, T, tip)
        limbs.append(Limb(chain, (f"{leg}_base",), partial(_delta_solved, geometry, azimuths, i)))
    return limbs


def _delta_solved(
    geometry: Array, azimuths: Array, limb: int, T: Array, drives: Array | None
) -> LimbBranches:
    point, angles, excess = translation_only(T), np.empty((3, 2)), np.empty(3)
    if drives is None:
        if delta_angles(geometry, azimuths, point, angles, excess) < 0:
            return LimbBranches(np.empty((0, 5)), (), continuum=True)
        if excess[limb]:
            return LimbBranches(np.empty((0, 5)), (), float(excess[limb]))
        drives = angles[limb]
    base, platform, arm, _ = geometry.tolist()
    azimuth = float(azimuths[limb])
    r = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    rows = []
    for q in drives.tolist():
        elbow = (base + arm * math.cos(q)) * r - [0.0, 0.0, arm * math.sin(q)]
        way = point + platform * r - elbow
        out, down = float(way @ r), -float(way[2])
        swing = math.atan2(-out, down)
        tilt = math.atan2(way[1] * r[0] - way[0] * r[1], math.hypot(out, down))
        turn = math.atan2(math.sin(swing - q), math.cos(swing - q))
        rows.append([q, turn, tilt, -tilt, -swing])
    return _one_or_two(np.array(rows))
