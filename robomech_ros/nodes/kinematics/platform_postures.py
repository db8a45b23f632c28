"""All postures of a parallel robot for poses of its platform, as services answer them."""

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.kinematics.kinematic_results import distances_between
from robomech_ros.outcomes import Code
from robomech_ros.parallel import Mechanism
from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class PlatformSolutions:
    """Data for `encode_result`: k postures of n joints, nearest to the seed first.

    - ``seed_distance``: distance from the seed by the requested metric (rad or m), shape (k,).
    - ``position_error``, ``orientation_error``: greatest deviation of a limb from the pose (m,
      rad), shape (k,).
    - ``condition_number``: condition number of the twists of the drives in SI units, shape (k,).
    - ``limit_margin``: distance of a joint from its nearest limit, or from the end of its cone (rad
      or m), the least of all joints, shape (k,).
    """

    q: Array  #: All joints, limb by limb (rad or m), shape (k, n).
    branches: tuple[str, ...]  #: Branch of each posture, one sign per limb.
    seed_distance: Array
    position_error: Array
    orientation_error: Array
    condition_number: Array
    limit_margin: Array
    complete: bool  #: Whether the postures are provably all, before any cut.
    status: Code
    reason: str
    #: Joints whose limits exclude the pose, one of each limb that cannot reach it.
    blocking_joints: tuple[str, ...]
    blocking_excess: Array  #: How far each exceeds its limit (rad or m).
    family: str = "parallel"


def platform_solutions(
    mechanism: Mechanism,
    T: Array,
    seed: Array,
    *,
    respect_limits: bool = True,
    metric: str = "linf",
    max_solutions: int | None = None,
) -> PlatformSolutions:
    """Solve all limbs for a pose, shape (4, 4), and sort by the distance from a seed, (n,).

    Raises BadValueError: no platform of this kind can have the pose.
    """
    found = mechanism.postures(T, seed=seed, ignore_limits=not respect_limits)
    away = np.abs(found.q - seed)
    distance = np.sqrt((away**2).sum(axis=1)) if metric == "l2" else away.max(axis=1, initial=0.0)
    order = np.argsort(distance, kind="stable")[:max_solutions]
    q = found.q[order]
    position, orientation = limb_errors(mechanism, q, T)
    blocked = [k for k, name in enumerate(found.blocking) if name]
    # The inverse kinematics of a limb without a solver of its own may be a search.
    listed = all(limb.solver is not None for limb in mechanism.limbs)
    return PlatformSolutions(
        q=q,
        branches=tuple(found.branches[k] for k in order),
        seed_distance=distance[order],
        position_error=position,
        orientation_error=orientation,
        condition_number=conditions(mechanism, q),
        limit_margin=mechanism.limit_margin(q).min(axis=1, initial=np.inf),
        complete=listed and found.status is not Code.SINGULAR_CONTINUUM,
        status=found.status,
        reason=found.reason,
        blocking_joints=tuple(found.blocking[k] for k in blocked),
        blocking_excess=found.excess[blocked],
    )


def conditions(mechanism: Mechanism, q: Array, length: float = 1.0) -> Array:
    """Return condition numbers of the twists of the drives, (k,), infinite where singular.

    - ``q``: all joints (rad or m), loops closed, shape (k, n).
    - ``length``: length by which linear rows are divided (m); by default they stay in SI units.
    """
    out = np.full(len(q), np.inf)
    for k, row in enumerate(q):
        try:
            twists = mechanism.twist_matrix(row)
        except BadValueError:  # singular
            continue
        twists[3:] /= length
        values = np.linalg.svd(twists, compute_uv=False)
        if values[-1] > 0.0:
            out[k] = values[0] / values[-1]
    return out


def limb_errors(mechanism: Mechanism, q: Array, T: Array) -> tuple[Array, Array]:
    """Return how far (m, rad) the worst limb in postures (k, n) is from poses, (k,) each."""
    position, angle = distances_between(T[..., None, :, :], mechanism.limb_poses(q))
    return position.max(axis=-1, initial=0.0), angle.max(axis=-1, initial=0.0)
