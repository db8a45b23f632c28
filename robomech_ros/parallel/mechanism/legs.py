"""Legs that extend between a universal joint on the base and a spherical one on the platform."""

import math

import numpy as np

from robomech_ros.parallel.joint_cones import JointCones
from robomech_ros.parallel.mechanism.limb import Axis, Limb, LimbBranches, chain_of_axes
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array

_HALF = 0.5 * math.pi


def extending_legs(
    name: str,
    base_points: Array,
    platform_points: Array,
    strokes: Array | None,
    home: Array,
    cones: tuple[JointCones | None, JointCones | None],
) -> list[Limb]:
    """Make the limbs U P S of a platform on legs that extend.

    Their passive joints are at zero where legs are in the middle of their cones; without cones,
    where the platform is at home.

    Points (k, 3) are in the frames of base and platform (m), strokes (k, 2) least and greatest
    lengths (m).  At home, ``T_base_platform`` (m), no leg has length 0.  The cones are those of the
    joints on the base and on the platform.
    """
    return [
        _leg(
            name,
            i,
            (a, b),
            (0.0, math.inf) if strokes is None else tuple(strokes[i]),
            _frames(a, b, home, *((None if cone is None else cone.axes[i]) for cone in cones)),
            [None if cone is None else float(cone.angles[i]) for cone in cones],
        )
        for i, (a, b) in enumerate(zip(base_points, platform_points, strict=True))
    ]


def _frames(
    a: Array, b: Array, home: Array, on_base: Array | None, on_platform: Array | None
) -> tuple[Array, Array]:
    """Return a leg's frame in the base (3, 3), and the platform's in it, joints at zero."""
    along = home[:3, :3] @ b + home[:3, 3] - a
    F = _upright(along / np.linalg.norm(along) if on_base is None else on_base)
    if on_platform is None:
        return F, F.T @ home[:3, :3]
    side = home[:3, :3].T @ F[:, 1]
    x = np.cross(side, -on_platform)
    if np.linalg.norm(x) < 1e-6:
        x = _upright(-on_platform)[:, 0]
    x /= np.linalg.norm(x)
    return F, np.stack((x, np.cross(-on_platform, x), -on_platform))


def _leg(
    name: str,
    i: int,
    anchors: tuple[Array, Array],
    stroke: tuple[float, ...],
    frames: tuple[Array, Array],
    angles: list[float | None],
) -> Limb:
    leg, (a, b), (F, B) = f"leg{i + 1}", anchors, frames
    wide = [(-x, x) if x is not None and x < _HALF else (-math.inf, math.inf) for x in angles]
    narrow = [(max(low, -_HALF), min(high, _HALF)) for low, high in wide]
    axes = [
        Axis(f"{leg}_base_x", f"{leg}_base_cross", F[:, 0], a, limits=wide[0]),
        Axis(f"{leg}_base_y", f"{leg}_cylinder", F[:, 1], a, limits=narrow[0]),
        Axis(f"{leg}_length", f"{leg}_rod", F[:, 2], a, True, (stroke[0], stroke[1])),
        Axis(f"{leg}_platform_x", f"{leg}_platform_cross", F[:, 0], a, limits=wide[1]),
        Axis(f"{leg}_platform_y", f"{leg}_platform_ring", F[:, 1], a, limits=narrow[1]),
        Axis(f"{leg}_platform_z", f"{leg}_platform_stud", F[:, 2], a),
    ]
    T = assembled(F @ B, a - F @ B @ b)
    tip = "platform" if i == 0 else f"{leg}_end"
    chain = chain_of_axes(name, axes, T, tip)
    bending = zip((f"{leg}_base_x", f"{leg}_platform_x"), angles, strict=True)
    cones = [(joint, angle) for joint, angle in bending if angle is not None]

    def solve(T: Array, _: Array | None) -> LimbBranches:
        way = F.T @ (T[:3, :3] @ b + T[:3, 3] - a)
        length = float(np.linalg.norm(way))
        if length == 0.0:
            return LimbBranches(np.empty((0, 6)), (), continuum=True)
        x, y = _cardan(way / length)[:2]
        leg_turned = F @ _turned(x, y)
        S = leg_turned.T @ T[:3, :3] @ B.T
        u, v, z = _cardan(S[:, 2], S[0])
        return LimbBranches(np.array([[x, y, length, u, v, z]]), ("0",))

    return Limb(chain, (f"{leg}_length",), solve, cones)


def _upright(z: Array) -> Array:
    """Return axes (3, 3), one a column, of which x is horizontal."""
    x = np.cross((0.0, 0.0, 1.0), z) if abs(z[2]) < 0.999999 else np.array([0.0, 1.0, 0.0])
    y = np.cross(z, x / np.linalg.norm(x))
    y /= np.linalg.norm(y)
    return np.stack((np.cross(y, z), y, z), axis=1)


def _cardan(z: Array, row: Array | None = None) -> tuple[float, float, float]:
    """Return angles of turns about x, y and z, from the third column and the first row."""
    x = math.atan2(-z[1], z[2]) if math.hypot(z[1], z[2]) > 0.0 else 0.0
    y = math.atan2(z[0], math.hypot(z[1], z[2]))
    return x, y, 0.0 if row is None else math.atan2(-row[1], row[0])


def _turned(x: float, y: float) -> Array:
    """Turn about x, then about the new y."""
    cx, sx, cy, sy = math.cos(x), math.sin(x), math.cos(y), math.sin(y)
    return np.array([[cy, 0.0, sy], [sx * sy, cx, -sx * cy], [-cx * sy, sx, cx * cy]])
