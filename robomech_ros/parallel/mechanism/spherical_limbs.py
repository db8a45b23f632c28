"""Limbs of spherical platforms: R R R, all axes through the centre."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from robomech_ros.parallel.argument_checks import rotation_only
from robomech_ros.parallel.limbs import turning_limb
from robomech_ros.parallel.mechanism.limb import Axis, Limb, LimbBranches, chain_of_axes
from robomech_ros.parallel.mechanism.planar_limbs import one_or_two
from robomech_ros.robots.joint import rotation_from_z
from robomech_ros.spatial.poses import assembled
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector
from robomech_ros.typing import Array


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
    return one_or_two(np.array(rows))


def _turn_about(axis: Array, start: Array, end: Array) -> float:
    """Return the angle (rad) by which one direction turns into another about an axis."""
    start = start - float(axis @ start) * axis
    return math.atan2(float(np.cross(start, end) @ axis), float(start @ end))
