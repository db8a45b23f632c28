"""Wrenches with which limbs of any kind hold a platform: those that their drives bear, and others.

For each drive those wrenches count that do no work on the other joints of its limb.  Some of them
do none on the drive, either: the limb bears them by itself, whatever its drive does, and they leave
the platform the motions that it has.  The others differ by such ones; the one with the least force
stands for them, of force 1, or, where it is a couple, the one with the least moment, of moment 1.
"""

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.tolerances import RANK
from robomech_ros.errors import BadValueError
from robomech_ros.kinetostatics import jacobian, jacobian_rate
from robomech_ros.parallel.mechanism.mobility import limb_twists
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array, BoolArray, IntArray

_TWIST, _ANGULAR = 6, 3
# How far limbs may hold the platform from the pose given (rad; of the size).
_MISS = 1e-6
# Least part of a joint's motion that is independent of those of the others of its limb.
_INDEPENDENT = 1e-10
# Parts of wrenches below which they are zero.
_NOTHING = 1e-8
# Work of wrenches on a drive below which their limb is at an end of its reach.
_AT_END = 1e-6


@dataclass(frozen=True, eq=False)
class Wrenches:
    """Load shares of the limbs of a platform, for postures (...).

    Each drive bears a wrench (..., m, 6), [moment; force] at the platform's origin.  Its work
    (..., m) is that on the drive for each rad or m, not negative but by rounding, and the lever
    (..., m) the most that this can be as the limb bends at its next joint (m or 1).  Wrenches
    (..., c, 6) are carried without drives, orthonormal for each limb after multiplication of
    forces by the size, which makes moments and forces comparable (m).  ``limbs`` (m,) are those of
    the drives, and ``carriers`` (c,) those of the wrenches borne without one, from 0.
    """

    borne: Array
    work: Array
    lever: Array
    carried: Array
    size: float
    limbs: IntArray
    carriers: IntArray

    def rows(self) -> tuple[Array, Array]:
        """Return the rows (..., m, 6) of K, of motions that the platform has, and J's diagonal."""
        units = np.repeat([1.0 / self.size, 1.0], _ANGULAR)
        S = self.motions(self.size)
        K = (self.borne * units) @ S @ np.swapaxes(S, -1, -2) / units
        return np.asarray(K), self.work

    def motions(self, length: float) -> Array:
        """Return the twists (..., 6, m) that the platform has.

        Columns are orthonormal after multiplication of the angular part by the length.  In postures
        in which it has more than m, those come first that locked drives do not hold.
        """
        count = self.borne.shape[-2]
        if count == _TWIST:
            return np.broadcast_to(np.eye(_TWIST), (*self.work.shape[:-1], _TWIST, _TWIST))
        turn = self.size / length if length > 0.0 else 1.0
        values, basis = np.linalg.svd(self.carried * np.repeat([turn, 1.0], _ANGULAR))[1:]
        S = np.array(np.swapaxes(basis[..., -count:, :], -1, -2))
        fixed = min(_TWIST - count, values.shape[-1])
        more = values[..., fixed - 1] <= RANK * values[..., 0]
        for index in map(tuple, np.argwhere(more)):
            rank = int((values[index] > RANK * values[index][0]).sum())
            free = basis[index][rank:].T
            K = self.borne[index] / np.repeat([length, 1.0], _ANGULAR) @ free
            S[index] = free @ np.linalg.svd(K)[2][::-1][:count].T
        return S


def limb_wrenches(mechanism: Mechanism, poses: Array, q: Array) -> Wrenches:
    """Find the wrenches that limbs bear in poses (..., 4, 4) with all joints q (..., n) there."""
    _check_held(mechanism, poses, q)
    return wrenches_of_limbs(mechanism, q)


def wrenches_of_limbs(mechanism: Mechanism, q: Array) -> Wrenches:
    """Find the wrenches that limbs bear, each where it holds the platform by itself.

    The loops of the joints q (..., n) need not be closed.
    """
    lead, q = q.shape[:-1], q.reshape(-1, mechanism.n)
    drives, carried, numbers = list[tuple[Array, Array, Array]](), list[Array](), list[int]()
    for i, limb in enumerate(mechanism.limbs):
        screws = jacobian(limb.chain, q[..., mechanism.loops.joints_of(i)])
        screws[..., _ANGULAR:, :] /= mechanism.size
        driven = [k for k, name in enumerate(limb.chain.joint_names) if name in limb.actuated]
        if not driven:
            carried.append(_reciprocal(screws, i))
        for k in driven:
            W = _reciprocal(np.delete(screws, k, axis=-1), i)
            along, others = _of_drive(mechanism, i, k, screws, W, q)
            if k == driven[0]:
                carried.append(others)
            prismatic = limb.chain.types == PRISMATIC
            drives.append(_borne(along, others, screws, k, prismatic, mechanism.size))
            numbers.append(i)
    units = np.repeat([1.0, 1.0 / mechanism.size], _ANGULAR)
    found = [np.stack(part, axis=1) for part in zip(*drives, strict=True)]
    found[0] *= units
    found.append(np.swapaxes(np.concatenate(carried, axis=-1), -1, -2))
    borne, work, lever, rest = (part.reshape(*lead, *part.shape[1:]) for part in found)
    carriers = np.repeat(np.arange(len(carried)), [part.shape[-1] for part in carried])
    return Wrenches(borne, work, lever, rest, mechanism.size, np.array(numbers), carriers)


def _check_held(mechanism: Mechanism, poses: Array, q: Array) -> None:
    away = np.abs(mechanism.limb_poses(q) - poses[..., None, :, :])
    away[..., :3, 3] /= mechanism.size
    worst = away.max(axis=(-2, -1))
    if not worst.size or worst.max() <= _MISS:
        return
    limb = int(np.unravel_index(int(worst.argmax()), worst.shape)[-1]) + 1
    why = "all joints that hold the platform in the pose, with closed loops"
    raise BadValueError(f"q, by which limb {limb} misses the pose by", float(worst.max()), why)


def _reciprocal(screws: Array, limb: int) -> Array:
    """Return wrenches (..., 6, k), orthonormal, that do no work on joints (..., 6, j)."""
    count = screws.shape[-1]
    sizes = np.linalg.norm(screws, axis=-2, keepdims=True)
    basis, values, _ = np.linalg.svd(screws / sizes)
    if count >= _TWIST:
        raise BadValueError(f"joints of limb {limb + 1} beside a drive", count, "up to 5")
    if count and not (values[..., -1] > _INDEPENDENT).all():
        why = "one in which no limb can move by itself: it is singular"
        what = f"independence of the passive joints of limb {limb + 1} in the posture"
        raise BadValueError(what, float(values[..., -1].min()), why)
    return np.asarray(basis[..., count:])


def _of_drive(
    mechanism: Mechanism, i: int, k: int, screws: Array, W: Array, q: Array
) -> tuple[Array, Array]:
    """Part wrenches W (..., 6, w) in the one that works on a drive, and the others.

    At an end of the reach none does: the one that begins to, as the robot moves, is taken.
    """
    c = screws[..., k]
    b = (np.swapaxes(W, -1, -2) @ c[..., None])[..., 0]
    sizes = np.linalg.norm(c, axis=-1)
    for row in np.flatnonzero(np.linalg.norm(b, axis=-1) <= _AT_END * sizes):
        b[row] = _begins(mechanism, (i, k), screws[row], W[row], q[row])
    basis = np.linalg.svd(b[..., None])[0]
    along = (W @ basis[..., :1])[..., 0]
    work = (along * c).sum(axis=-1, keepdims=True)
    return np.where(work < 0.0, -along, along), W @ basis[..., 1:]


def _begins(
    mechanism: Mechanism, joint: tuple[int, int], screws: Array, W: Array, q: Array
) -> Array:
    """Return the coordinates (w,) in W of the wrench whose work on a drive is about to begin."""
    i, k = joint
    own = mechanism.loops.joints_of(i)
    others = np.delete(screws, k, axis=-1)
    c = np.linalg.lstsq(others, screws[:, k], rcond=None)[0]
    changes = []
    for rates in _tangents(mechanism, q):
        d = jacobian_rate(mechanism.limbs[i].chain, q[own], rates[own])
        d[_ANGULAR:] /= mechanism.size
        changes.append(W.T @ (d[:, k] - np.delete(d, k, axis=1) @ c))
    return np.asarray(np.linalg.svd(np.array(changes).T)[0][:, 0])


def _tangents(mechanism: Mechanism, q: Array) -> Array:
    """Return the rates (r, n) of all joints that keep the loops closed."""
    ends = limb_twists([limb.chain for limb in mechanism.limbs], mechanism.loops, q)
    values, basis = np.linalg.svd((ends[1:] - ends[0]).reshape(-1, mechanism.n))[1:]
    rank = int((values > RANK * values[0]).sum())
    return np.asarray(basis[rank:] / mechanism.loops.weights)


def _without(x: Array, parts: Array) -> tuple[Array, Array, Array]:
    """Take from x (..., 3) what lies in the span of parts (..., 3, k).

    Returns the rest, the multiples (..., k) of the parts that were added, and those changes of
    them, (..., k, k), that change nothing.
    """
    U, s, V = np.linalg.svd(parts, full_matrices=False)
    kept = s > _NOTHING
    inverse = np.where(kept, 1.0 / np.where(kept, s, 1.0), 0.0)
    along = (np.swapaxes(U, -1, -2) @ x[..., None])[..., 0]
    multiples = -(np.swapaxes(V, -1, -2) @ (inverse * along)[..., None])[..., 0]
    idle = np.eye(parts.shape[-1]) - np.swapaxes(V, -1, -2) @ (kept[..., None] * V)
    return x + (parts @ multiples[..., None])[..., 0], multiples, idle


def _borne(
    along: Array, others: Array, screws: Array, k: int, prismatic: BoolArray, size: float
) -> tuple[Array, Array, Array]:
    """Find the wrench (..., 6), with forces over the size, its work and the most that it can be."""
    parts = np.concatenate((others, np.zeros((*along.shape, 1))), axis=-1)
    force, multiples, idle = _without(along[..., _ANGULAR:], parts[..., _ANGULAR:, :])
    wrench = along + (parts @ multiples[..., None])[..., 0]
    couples = parts[..., :_ANGULAR, :] @ idle
    moment = _without(wrench[..., :_ANGULAR], couples)[0]
    strength = np.linalg.norm(force, axis=-1, keepdims=True)
    is_force = strength > _NOTHING
    couple = np.concatenate((moment, np.zeros_like(moment)), axis=-1)
    wrench = np.where(is_force, wrench, couple)
    norm = np.where(is_force, strength / size, np.linalg.norm(moment, axis=-1, keepdims=True))
    wrench = wrench / norm
    work = (wrench * screws[..., k]).sum(axis=-1)
    return wrench, work, _lever(wrench, is_force[..., 0], screws, k, prismatic, size)


def _lever(
    wrench: Array, is_force: BoolArray, screws: Array, k: int, prismatic: BoolArray, size: float
) -> Array:
    """Return the most (...) that a wrench can work on a drive, about the joint next to it."""
    others = np.flatnonzero(~prismatic).tolist()
    turning = [j for j in others if j > k] or [j for j in others[::-1] if j < k]
    if prismatic[k] or not turning:
        return np.ones(wrench.shape[:-1])
    (e, o), (a, p) = (_axis(screws[..., j], size) for j in (k, turning[0]))
    f = wrench[..., _ANGULAR:] / size
    r = np.cross(f, wrench[..., :_ANGULAR])
    # The point of the next joint's axis nearest to the line of the force.
    across = a - f * (a * f).sum(axis=-1, keepdims=True)
    square = (across * across).sum(axis=-1, keepdims=True)
    met = square > _NOTHING
    way = ((r - p) * across).sum(axis=-1, keepdims=True) / np.where(met, square, 1.0)
    point = p + np.where(met, way, 0.0) * a
    arm = np.linalg.norm(np.cross(e, point - o), axis=-1)
    lever = np.where(is_force, arm, np.linalg.norm(np.cross(e, a), axis=-1))
    least = _NOTHING * np.where(is_force, size, 1.0)
    return np.where(lever > least, lever, np.where(is_force, size, 1.0))


def _axis(screw: Array, size: float) -> tuple[Array, Array]:
    """Return the direction of a joint's axis and its point nearest to the platform's origin."""
    e = screw[..., :_ANGULAR]
    return e, np.cross(e, screw[..., _ANGULAR:] * size)
