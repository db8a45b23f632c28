"""Poses of a platform on limbs of any kind, and its axes of motion in a pose."""

from collections.abc import Callable

import numpy as np

from robomech_ros.kinematics.posture_samples import reach_bound
from robomech_ros.outcomes import Code
from robomech_ros.parallel.kinetostatics.limb_wrenches import limb_wrenches
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector
from robomech_ros.typing import Array

_TWIST, _ANGULAR = 6, 3
# Parts of unit twists below which they are zero.
_ROUNDING = 1e-9
# A step (rad; of the size) that the platform makes if it has a motion, not only the tangent of one.
_STEP = 1e-2
# Outcomes of limbs that hold a pose.
_HELD = (Code.NONE, Code.SINGULAR_CONTINUUM)
# Robots with slides that have no end: how far they are looked at, of their size.
_FARTHEST = 4.0
# A move of a joint (rad; of the size) in one step that may be a jump to another branch, the parts
# of the step that decide it, and how near to a limit the joint stands that cannot go on.
_JUMP, _PARTS, _AT_LIMIT = 0.3, 8, 1e-3


def exclusion(mechanism: Mechanism, pose: Array, near: Array) -> tuple[str, float, Array]:
    """Return the reason that excludes a pose, the excess, and all joints (n,) nearest to one."""
    found = mechanism.postures(pose, seed=near)
    if found.status == Code.NONE:
        return "", 0.0, np.array(found.q[0])
    nowhere = np.full(mechanism.n, np.nan)
    if found.status == Code.SINGULAR_CONTINUUM:
        return found.reason, 0.0, nowhere
    limb = int(np.argmax(found.excess))
    joint = found.blocking[limb]
    why = f"limits of {joint}" if joint else "out of reach"
    return f"limb {limb + 1}: {why}", float(found.excess[limb]), nowhere


def followed(
    mechanism: Mechanism, pose_at: Callable[[float], Array], begin: float, end: float, q: Array
) -> tuple[str, float, Array]:
    """Return :func:`exclusion` of a pose at the end of a way, in the branches of its beginning.

    The way gives a pose (4, 4) at each place; q (n,) are all joints at its beginning.
    """
    found = exclusion(mechanism, pose_at(end), q)
    if found[0] or _moved(mechanism, q, found[2]).max() <= _JUMP:
        return found
    for place in np.linspace(begin, end, _PARTS + 1)[1:]:
        found = exclusion(mechanism, pose_at(float(place)), q)
        if found[0]:
            return found
        moved = _moved(mechanism, q, found[2])
        if moved.max() > _JUMP:
            return _stop(mechanism, q, int(moved.argmax())), float(moved.max()), found[2] * np.nan
        q = found[2]
    return found


def _moved(mechanism: Mechanism, q: Array, there: Array) -> Array:
    return np.asarray(np.abs(there - q) * mechanism.loops.weights)


def _stop(mechanism: Mechanism, q: Array, joint: int) -> str:
    limb = int(np.searchsorted(mechanism.loops.starts, joint, side="right")) - 1
    left = np.minimum(q - mechanism.lower, mechanism.upper - q) * mechanism.loops.weights
    own = mechanism.loops.joints_of(limb)
    nearest = int(own.start) + int(left[own].argmin())
    at_limit = left[nearest] <= _AT_LIMIT
    why = f"limits of {mechanism.joint_names[nearest]}" if at_limit else "out of reach"
    return f"limb {limb + 1}: {why}"


def free_axes(mechanism: Mechanism, pose: Array, q: Array, *, turns: bool) -> Array:
    """Return axes (3, d) along which the platform moves without turning, or turns about its origin.

    Only motions that it goes on with count: a platform that shifts as it tilts does not tilt at its
    place.
    """
    if mechanism.dof == _TWIST:
        return np.eye(3)
    motions = limb_wrenches(mechanism, pose, q).motions(mechanism.size)
    own, others = motions[:_ANGULAR], motions[_ANGULAR:]
    if not turns:
        own, others = others, own
    values, basis = np.linalg.svd(others)[1:]
    idle = own @ basis[int((values > _ROUNDING).sum()) :].T
    axes = np.linalg.svd(idle, full_matrices=False)[0] if idle.size else idle
    found = list[Array]()
    # The axes of the base first, as far as the platform has them.
    for axis in (axes @ axes.T).T:
        rest = axis - sum((one * (one @ axis) for one in found), np.zeros(3))
        size = float(np.linalg.norm(rest))
        if size > _STEP and _goes_on(mechanism, pose, rest / size, turns):
            found.append(rest / size)
    return np.array(found).reshape(-1, 3).T


def _goes_on(mechanism: Mechanism, pose: Array, axis: Array, turns: bool) -> bool:
    for step in (_STEP, -_STEP):
        there = pose.copy()
        if turns:
            there[:3, :3] = matrix_from_rotation_vector(step * axis) @ pose[:3, :3]
        else:
            there[:3, 3] += step * mechanism.size * axis
        if mechanism.postures(there, ignore_limits=True).status in _HELD:
            return True
    return False


def side_of_mechanism(mechanism: Mechanism, poses: Array, q: Array, centre: Array) -> Array:
    """Return on which side (k,) of a singularity of type 2 poses are, with all their joints (k, n).

    It is the sign of the determinant of K for the motions that the platform has, in the order and
    with the signs of those in the posture ``centre`` (n,).
    """
    size = mechanism.size
    limbs = limb_wrenches(mechanism, poses, q)
    here = limb_wrenches(mechanism, mechanism.pose(centre), centre).motions(size)
    motions = limbs.motions(size)
    K = limbs.borne / np.repeat([size, 1.0], _ANGULAR) @ motions
    return np.asarray(np.sign(np.linalg.det(K) * np.linalg.det(here.T @ motions)))


def platform_span(mechanism: Mechanism) -> float:
    """Return how far the platform can be from the base (m); of endless slides, some sizes."""
    chains = [limb.chain for limb in mechanism.limbs]
    bounds = [
        reach_bound(chain)
        for chain in chains
        if np.isfinite(np.stack((chain.lower, chain.upper))[:, chain.types == PRISMATIC]).all()
    ]
    return min(bounds, default=_FARTHEST * mechanism.size)
