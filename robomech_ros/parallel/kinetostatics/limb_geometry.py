"""Attachment points of the limbs on the platform of a parallel robot, and their motion.

A limb keeps a point of the platform at a distance from a centre that its drive moves, or extends
this distance; a limb of the spherical robot keeps an angle between two axes.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.parallel.argument_checks import platform_poses, pose_about_z
from robomech_ros.parallel.delta import Delta
from robomech_ros.parallel.kinetostatics.limb_wrenches import Wrenches, limb_wrenches
from robomech_ros.parallel.library import AnyParallelRobot, ParallelRobot
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.planar import Planar3RPR, Planar3RRR
from robomech_ros.parallel.spherical import Spherical3RRR
from robomech_ros.parallel.stewart_gough import StewartGough
from robomech_ros.spatial.arrays import as_finite, of_shape, real_array
from robomech_ros.spatial.poses import assembled
from robomech_ros.spatial.rotations.axis_angle import matrix_from_axis_angle
from robomech_ros.typing import Array, ArrayLike

# By how much drives may miss a pose (of the size), and a pose the motions of its platform.
_MISS, _OFF = 1e-6, 1e-6
# Parts of unit twists below which they are zero.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Legs:
    """Limbs that keep a distance between a centre and a point of the platform, or drive it.

    The arms (..., m, 3) go from the platform's origin to its joints (m), zero where it does not
    turn, and the legs (..., m, 3) from the centres to these joints.  The first and second
    derivatives of the centres by the drives are zero for drives that extend the legs.  The lever
    (m,) is the length of the first ones, 1 for drives that extend the legs.
    """

    arms: Array
    legs: Array
    first: Array
    second: Array
    lever: Array
    extends: bool

    def rows(self) -> tuple[Array, Array]:
        """Return the rows (..., m, 6) of K and the diagonal (..., m) of J."""
        n = _unit(self.legs)
        K = np.concatenate((np.cross(self.arms, n), n), axis=-1)
        return K, np.ones(n.shape[:-1]) if self.extends else (n * self.first).sum(axis=-1)

    def row_rates(self, twist: Array, rates: Array) -> tuple[Array, Array]:
        """Return the time derivatives of both, for twists (..., 6) and drive rates (..., m)."""
        n = _unit(self.legs)
        lengths = np.linalg.norm(self.legs, axis=-1, keepdims=True)
        turned = np.cross(twist[..., None, :3], self.arms)
        moved = twist[..., None, 3:] + turned - self.first * rates[..., None]
        dn = (moved - n * (n * moved).sum(axis=-1, keepdims=True)) / lengths
        dK = np.concatenate((np.cross(turned, n) + np.cross(self.arms, dn), dn), axis=-1)
        dJ = (dn * self.first).sum(axis=-1) + (n * self.second).sum(axis=-1) * rates
        return dK, dJ


@dataclass(frozen=True, eq=False)
class Arcs:
    """Limbs that keep the angle between an axis of the platform and one that their drive turns.

    Unit vectors (..., m, 3) are the axes of the drives, those between the arcs, and those on the
    platform.  The sines (m,) are those of the angle between middle and platform axes, the lever
    (m,) the sine of that between base and middle axes.
    """

    base: Array
    middle: Array
    platform: Array
    sines: Array
    lever: Array

    def rows(self) -> tuple[Array, Array]:
        """Return the rows (..., m, 6) of K and the diagonal (..., m) of J."""
        c = np.cross(self.platform, self.middle) / self.sines[:, None]
        return np.concatenate((c, np.zeros_like(c)), axis=-1), (self.base * c).sum(axis=-1)

    def row_rates(self, twist: Array, rates: Array) -> tuple[Array, Array]:
        """Return the time derivatives of both, for twists (..., 6) and drive rates (..., m)."""
        dv = np.cross(twist[..., None, :3], self.platform)
        dw = np.cross(self.base, self.middle) * rates[..., None]
        dc = (np.cross(dv, self.middle) + np.cross(self.platform, dw)) / self.sines[:, None]
        return np.concatenate((dc, np.zeros_like(dc)), axis=-1), (self.base * dc).sum(axis=-1)


Limbs = Legs | Arcs | Wrenches


def motions_of(robot: AnyParallelRobot) -> tuple[int, ...]:
    """Return the columns of a twist [angular; linear] that the platform has."""
    if type(robot) not in _KNOWN:
        names = ", ".join(kind.__name__ for kind in _KNOWN)
        raise BadValueError("robot", type(robot).__name__, f"one of {names}")
    return _KNOWN[type(robot)][0]


def motion_basis(robot: AnyParallelRobot, limbs: Limbs) -> Array:
    """Return twists (..., 6, m) that span those that the platform has (rad/s and m/s)."""
    if isinstance(limbs, Wrenches):
        return np.asarray(limbs.motions(limbs.size) / np.repeat([limbs.size, 1.0], 3)[:, None])
    return np.eye(6)[:, list(motions_of(robot))]


def motion_entries(robot: AnyParallelRobot, limbs: Limbs) -> tuple[int, ...]:
    """Return the entries of a twist [angular; linear] that the platform has."""
    if not isinstance(limbs, Wrenches):
        return motions_of(robot)
    sizes = np.abs(limbs.motions(limbs.size)).reshape(-1, 6, limbs.work.shape[-1])
    return tuple(int(k) for k in np.flatnonzero(sizes.max(axis=(0, 2)) > _ROUNDING))


def poses_of(robot: AnyParallelRobot, T: ArrayLike) -> Array:
    """Check poses (..., 4, 4), or a shorter form as :func:`velocity_matrices` takes it.

    All motions in them must be such as the platform has; those of a mechanism depend on its joints.
    """
    if isinstance(robot, Mechanism):
        return platform_poses(T)
    motions, given = motions_of(robot), real_array("pose", T)
    poses = platform_poses(given if given.shape[-2:] == (4, 4) else _short_form(robot, given))
    off = np.concatenate((_turns_off(poses, motions), poses[..., :3, 3]), axis=-1)
    worst = float(np.abs(off[..., ~np.isin(range(6), motions)]).max(initial=0.0))
    if worst > _OFF:
        what = "motion in the pose that the platform does not have"
        raise BadValueError(what, worst, "0 rad and m")
    return poses


def _short_form(robot: ParallelRobot, given: Array) -> Array:
    if isinstance(robot, Spherical3RRR):
        R = as_finite("pose", given, (3, 3))
        return assembled(R, np.zeros(R.shape[:-1]))
    if isinstance(robot, StewartGough):
        raise WrongSizeError("pose", given.shape, "(..., 4, 4)")
    values = as_finite("pose", given, (3,))
    if isinstance(robot, Delta):
        return assembled(np.broadcast_to(np.eye(3), (*values.shape[:-1], 3, 3)), values)
    return pose_about_z(values.reshape(-1, 3)).reshape(*values.shape[:-1], 4, 4)


def _turns_off(poses: Array, motions: tuple[int, ...]) -> Array:
    """Return how far rotations (..., 3) are from those about z, or from none."""
    off = np.abs(poses[..., :3, :3] - np.eye(3))
    if 2 in motions:
        off = off[..., 2, :]
    return np.repeat(off.reshape(*poses.shape[:-2], -1).max(axis=-1, keepdims=True), 3, axis=-1)


def drive_values(robot: AnyParallelRobot, poses: Array, q: ArrayLike | None) -> Array | None:
    """Check values of the drives (..., m), or of all joints of a mechanism, for poses."""
    count = robot.n if isinstance(robot, Mechanism) else len(motions_of(robot))
    if q is None and isinstance(robot, Mechanism):
        raise BadValueError("q", None, "the positions of all joints of the mechanism in a pose")
    if q is None:
        if isinstance(robot, StewartGough | Planar3RPR):
            return None
        raise BadValueError("q", None, "the angles of the drives: limbs have branches in a pose")
    return of_shape("q", as_finite("q", q, (count,)), (*poses.shape[:-2], count))


def limbs_at(robot: AnyParallelRobot, poses: Array, q: Array | None) -> Limbs:
    """Find where the limbs hold the platform, for checked poses (..., 4, 4) and drives."""
    if isinstance(robot, Mechanism):
        return limb_wrenches(robot, poses, np.asarray(q))
    return _KNOWN[type(robot)][1](robot, poses, q)


def limbs_holding(robot: AnyParallelRobot, T: ArrayLike, q: ArrayLike | None) -> Limbs:
    """Check poses and drives, and find where the limbs hold the platform."""
    poses = poses_of(robot, T)
    return limbs_at(robot, poses, drive_values(robot, poses, q))


def leg_lengths(robot: StewartGough | Planar3RPR, poses: Array) -> Array:
    """Return the lengths (..., legs) of legs that extend, for poses (..., 4, 4) (m)."""
    if isinstance(robot, StewartGough):
        return robot.inverse(poses)
    found = limbs_at(robot, poses, None)
    assert isinstance(found, Legs)
    return np.asarray(np.linalg.norm(found.legs, axis=-1))


def _unit(vectors: Array) -> Array:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    if not (lengths > 0.0).all():
        leg = int(np.argwhere(~(lengths[..., 0] > 0.0))[0][-1]) + 1
        raise BadValueError(f"length of leg {leg}", 0.0, "legs that are longer than 0 m")
    return np.asarray(vectors / lengths)


def _check_held(q: Array | None, missed: Array, size: float, unit: str) -> None:
    """Refuse drives that miss a pose (..., m), m or rad."""
    worst = np.abs(missed)
    if q is None or not worst.size or worst.max() <= _MISS * size:
        return
    index = np.unravel_index(int(worst.argmax()), worst.shape)
    why = f"one that holds the pose, which is missed by {worst[index]:.3g} {unit}"
    raise BadValueError(f"drive {int(index[-1]) + 1}", float(q[index]), why)


def _embedded(points: Array) -> Array:
    """Put points or vectors of a plane (..., 2) into space."""
    return np.concatenate((points, np.zeros((*points.shape[:-1], 1))), axis=-1)


def _extending(robot: StewartGough | Planar3RPR, poses: Array, q: Array | None) -> Legs:
    a, b = robot.base_points, robot.platform_points
    if a.shape[1] == 2:
        a, b = _embedded(a), _embedded(b)
    arms = b @ np.swapaxes(poses[..., :3, :3], -1, -2)
    legs = poses[..., None, :3, 3] + arms - a
    if q is not None:
        size = float(max(np.abs(a).max(), np.abs(b).max()))
        _check_held(q, np.linalg.norm(legs, axis=-1) - q, size, "m")
    nothing = np.zeros_like(legs)
    return Legs(arms, legs, nothing, nothing, np.ones(len(a)), True)


def _planar_rrr(robot: Planar3RRR, poses: Array, q: Array) -> Legs:
    arms = _embedded(robot.platform_points) @ np.swapaxes(poses[..., :3, :3], -1, -2)
    out = robot.proximal[:, None] * _embedded(np.stack((np.cos(q), np.sin(q)), axis=-1))
    legs = poses[..., None, :3, 3] + arms - _embedded(robot.base_points) - out
    size = float((robot.proximal + robot.distal).max())
    _check_held(q, np.linalg.norm(legs, axis=-1) - robot.distal, size, "m")
    first = np.stack((-out[..., 1], out[..., 0], out[..., 2]), axis=-1)
    return Legs(arms, legs, first, -out, robot.proximal, False)


def _delta(robot: Delta, poses: Array, q: Array) -> Legs:
    c, s = np.cos(robot.azimuths), np.sin(robot.azimuths)
    outward = np.stack((c, s, np.zeros(3)), axis=1)
    down = np.array([0.0, 0.0, -1.0])
    arm = robot.arm * (np.cos(q)[..., None] * outward + np.sin(q)[..., None] * down)
    first = robot.arm * (np.cos(q)[..., None] * down - np.sin(q)[..., None] * outward)
    inward = (robot.base_radius - robot.platform_radius) * outward
    legs = poses[..., None, :3, 3] - inward - arm
    size = robot.arm + robot.forearm
    _check_held(q, np.linalg.norm(legs, axis=-1) - robot.forearm, size, "m")
    return Legs(np.zeros_like(legs), legs, first, -arm, np.full(3, robot.arm), False)


def _spherical(robot: Spherical3RRR, poses: Array, q: Array) -> Arcs:
    turns = matrix_from_axis_angle(np.broadcast_to(robot.base_axes, (*q.shape, 3)), q)
    w = (turns @ robot.middle_axes[:, :, None])[..., 0]
    v = robot.platform_axes @ np.swapaxes(poses[..., :3, :3], -1, -2)
    angles = np.arctan2(np.linalg.norm(np.cross(v, w), axis=-1), (v * w).sum(axis=-1))
    _check_held(q, angles - robot.distal, 1.0, "rad")
    base = np.broadcast_to(robot.base_axes, w.shape)
    lever = np.linalg.norm(np.cross(robot.base_axes, robot.middle_axes), axis=1)
    return Arcs(base, w, v, np.sin(robot.distal), lever)


# Columns of a twist [angular; linear] that a platform has, and what finds its limbs.
_KNOWN: dict[type, tuple[tuple[int, ...], Callable[..., Legs | Arcs]]] = {
    StewartGough: ((0, 1, 2, 3, 4, 5), _extending),
    Delta: ((3, 4, 5), _delta),
    Planar3RPR: ((2, 3, 4), _extending),
    Planar3RRR: ((2, 3, 4), _planar_rrr),
    Spherical3RRR: ((0, 1, 2), _spherical),
}
