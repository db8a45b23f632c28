"""Least and greatest distance of the tip of any arm from its first joint."""

from __future__ import annotations

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.forward import forward_kinematics
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinematics.posture_samples import sample_postures
from robomech_ros.kinetostatics.jacobians import jacobian
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array

_STARTS = 256
# Starts for a chain with mimic joints; each descent takes some milliseconds.
_STARTS_IN_DRIVES = 12
_SWEEPS = 300
# Sweeps end when no distance changes by more, over the arm's reach.
_SETTLED = 1e-13


def reach_limits(chain: SerialChain) -> tuple[float, float]:
    """Find how near to its first joint an arm can bring its tip, and how far away.

    The square of the distance is of first order in cosine and sine of every angle, and of second
    in a displacement, so that the best value of one joint inside its limits is found at once; one
    joint after the other is moved there, from many postures.

    Parameters
    ----------
    chain : SerialChain
        Chain of one joint or more.

    Returns
    -------
    least, greatest : float
        Distances between the origins of the first joint's frame and of the tip (m), inside the
        joint limits; the greatest is infinite where a slide has no end.
    """
    check_chain(chain)
    if not chain.n:
        raise BadValueError("number of joints", 0, "at least 1")
    endless = (chain.types == PRISMATIC) & ~np.isfinite(chain.upper - chain.lower)
    least = _descended(chain, 1.0)
    return least, np.inf if endless.any() else _descended(chain, -1.0)


def _descended(chain: SerialChain, sign: float) -> float:
    """Return the least distance (sign 1) or the greatest (-1)."""
    if chain.coupling is not None:
        return _descended_in_drives(chain, sign)
    C = chain.transforms
    turns = chain.types != PRISMATIC
    q = sample_postures(chain, _STARTS)
    distance = np.full(_STARTS, np.inf)
    for _ in range(_SWEEPS):
        before = distance
        # For every joint: the tip beyond it, then the origin before it.
        tips = [np.broadcast_to(C[-1][:3, 3], (_STARTS, 3))]
        for j in range(chain.n - 1, 0, -1):
            moved = moved_by_joint(turns[j], q[:, j], tips[0])
            tips.insert(0, moved @ C[j][:3, :3].T + C[j][:3, 3])
        origin = np.zeros((_STARTS, 3))
        for j in range(chain.n):
            if j:
                origin = (origin - C[j][:3, 3]) @ C[j][:3, :3]
            limits = chain.lower[j], chain.upper[j]
            q[:, j] = (_angle if turns[j] else _slide)(q[:, j], origin, tips[j], limits, sign)
            origin = moved_by_joint(turns[j], -q[:, j], origin)
        distance = np.linalg.norm(origin - tips[-1], axis=1)
        scale = distance.max() + 1e-300
        if np.abs(distance - before).max() <= _SETTLED * scale:
            break
    return float((sign * distance).min() * sign)


def _descended_in_drives(chain: SerialChain, sign: float) -> float:
    """Return the same of a chain on which joints follow others: each drive moves several."""
    from scipy.optimize import minimize  # a second and 40 MB that few need

    origin = chain.packed[0, 10:13]
    bounds = list(zip(chain.lower, chain.upper, strict=True))

    def square(q: Array) -> tuple[float, Array]:
        away = forward_kinematics(chain, q)[:3, 3] - origin
        return sign * float(away @ away), sign * 2.0 * (away @ jacobian(chain, q)[3:])

    options = {"ftol": 1e-13, "gtol": 1e-9, "maxiter": 200}
    ends = [
        minimize(square, q, jac=True, bounds=bounds, method="L-BFGS-B", options=options).fun
        for q in sample_postures(chain, _STARTS_IN_DRIVES)
    ]
    return float(np.sqrt(max(sign * min(ends), 0.0)))


def moved_by_joint(turns: bool, value: Array, points: Array) -> Array:
    """Turn points (k, 3) about z by values (k,) (rad), or slide them along it (m)."""
    x, y, z = points.T
    if not turns:
        return np.column_stack((x, y, z + value))
    c, s = np.cos(value), np.sin(value)
    return np.column_stack((c * x - s * y, s * x + c * y, z))


def _angle(
    now: Array, origin: Array, tip: Array, limits: tuple[float, float], sign: float
) -> Array:
    """Return the angles that bring the tips nearest to the origins, or farthest away."""
    along = origin[:, 0] * tip[:, 0] + origin[:, 1] * tip[:, 1]
    across = origin[:, 1] * tip[:, 0] - origin[:, 0] * tip[:, 1]
    best = np.arctan2(sign * across, sign * along)
    best = np.where(np.hypot(along, across) > 0.0, best, now)
    lower, upper = limits
    if not upper - lower < 2.0 * np.pi:
        return best
    middle = 0.5 * (lower + upper)
    best = middle + np.remainder(best - middle + np.pi, 2.0 * np.pi) - np.pi
    ends = np.array((lower, upper))
    # The value at an end of the range falls with its angle from the best.
    nearest = np.cos(ends[:, None] - best).argmax(axis=0)
    inside = (best >= lower) & (best <= upper)
    return np.where(inside, best, ends[nearest])


def _slide(
    now: Array, origin: Array, tip: Array, limits: tuple[float, float], sign: float
) -> Array:
    """Return the displacements that do so."""
    best = origin[:, 2] - tip[:, 2]
    lower, upper = limits
    if sign > 0.0:
        return np.clip(best, lower, upper)
    far_up = np.abs(upper - best) >= np.abs(lower - best)
    return np.where(far_up, upper, lower)
