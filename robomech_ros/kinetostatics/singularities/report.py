"""How far a posture is from a singularity, what is lost there, and why."""

import functools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.kinetostatics.posture_report import (
    FACTOR_ZERO,
    FACTORS,
    MOVING,
    posture_report,
)
from robomech_ros.errors import WrongSizeError
from robomech_ros.kinematics.joint_values import as_joint_values, raise_not_finite
from robomech_ros.kinetostatics.point_jacobians import TIP, as_point
from robomech_ros.kinetostatics.singularities.determinant_factors import NamedParts, named_parts
from robomech_ros.kinetostatics.singularities.generic_rank import generic_motions, scaling_length
from robomech_ros.robots.chain import SerialChain

__all__ = ["SingularityReport", "singularity_report"]

Array = NDArray[np.float64]

_report = direct(posture_report)


@dataclass(frozen=True, eq=False)
class SingularityReport:
    """What the Jacobian of a posture says.

    Attributes
    ----------
    singular_values : ndarray, shape (k,)
        Of the Jacobian with its linear rows divided by the length, largest first; k is the smaller
        of 6 and the number of joints.
    rank : int
        How many of them are more than 1e-6 of the largest.
    length : float
        By which linear rows are divided (m).
    manipulability : float
        Product of the singular values of the Jacobian in SI units.
    condition_number : float
        Of the Jacobian in SI units; infinite where singular.
    normalised_condition_number : float
        Largest over least of ``singular_values``; infinite where singular.
    lost_directions : ndarray, shape (r, 6)
        Twists at the point in base axes that no joint rates give, as an orthonormal basis after
        division of their linear part by the length, angular first (rad/s and m/s).
    idle_wrenches : ndarray, shape (r, 6)
        Wrenches at the point in base axes that load no joint, a basis, moment first (N m and N),
        orthonormal after division of the moment by the length.
    self_motions : ndarray, shape (s, n)
        Joint rates that do not move the tip, an orthonormal basis (rad/s and m/s).
    factors : dict
        From the name of a part of the arm, such as "elbow", to its factor of the determinant, 0
        where that part is singular.
    kinds : tuple of str
        The parts that are singular here; where none has a name, the joints whose axes depend on
        each other.
    """

    singular_values: Array
    rank: int
    length: float
    manipulability: float
    condition_number: float
    normalised_condition_number: float
    lost_directions: Array
    idle_wrenches: Array
    self_motions: Array
    factors: dict[str, float]
    kinds: tuple[str, ...]

    @property
    def singular(self) -> bool:
        """Whether the tip has lost a motion that the arm has in other postures."""
        return bool(self.kinds)


class _GenericFacts(NamedTuple):
    """What of an arm is the same in every posture.

    Attributes
    ----------
    rank : int
        Of the Jacobian in nearly all postures.
    motions : ndarray, shape (r, 6)
        Twists that span all that it has in one posture or another (1 and m).
    parts : NamedParts
    """

    rank: int
    motions: Array
    parts: NamedParts


@functools.lru_cache(maxsize=64)
def _generic_facts(chain: SerialChain) -> _GenericFacts:
    return _GenericFacts(*generic_motions(chain), named_parts(chain))


def singularity_report(
    chain: SerialChain,
    q: ArrayLike,
    *,
    point: ArrayLike = TIP,
    length: float | None = None,
) -> SingularityReport:
    """Say what the tip can do in a posture, and what not.

    Parameters
    ----------
    chain : SerialChain
        Of one joint or more.
    q : array_like, shape (n,)
        Joint values (rad or m).
    point : array_like, shape (3,), optional
        Of the tip link, in its frame (m), whose motion is judged; default the tip's origin.
    length : float, optional
        What makes linear and angular motions comparable (m); default the characteristic length,
        which takes a second or so to find and is kept, or the size of an arm that has none.

    Returns
    -------
    SingularityReport

    Raises
    ------
    BadValueError, WrongSizeError, NonFiniteError
        q is not an array of n finite real numbers or the point of three up to 1e6 m, the length
        is not from 1e-9 to 1e9 m, or the chain has no joint.

    See Also
    --------
    nearest_singular_posture : the singular posture that is nearest.
    singularity_free : a proof for whole intervals.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 5.4 and 5.8.

    Examples
    --------
    >>> from robomech_ros.kinetostatics import singularity_report
    >>> from robomech_ros.robots import load_robot
    >>> puma = load_robot("puma560")
    >>> report = singularity_report(puma, [0.3, 0.5, -1.2, 0.4, 0.0, 0.2], length=0.283)
    >>> report.rank, report.kinds
    (5, ('wrist',))
    """
    q = as_joint_values(chain, q)
    if q.ndim != 1:
        raise WrongSizeError("q", q.shape, (chain.n,))
    arm, metres, n = as_point(point), scaling_length(chain, length), chain.n
    rank, motions, parts = _generic_facts(chain)
    values, numbers = np.empty(min(6, n)), np.empty(MOVING + n)
    twists, free = np.empty((2, 6, 6)), np.empty((n, n))
    constants = (parts.joints, parts.size, motions, rank)
    found = (values, numbers, twists, free)
    status, here, count = _report(chain.packed, q, arm, metres, *constants, *found)
    if status:
        raise_not_finite(chain, q)
    singular = here < rank
    manipulability, condition, normalised, *others = numbers.tolist()
    factors, moving = others[: MOVING - FACTORS], others[MOVING - FACTORS :]
    named = dict(zip(parts.names, factors, strict=False))
    return SingularityReport(
        singular_values=values,
        rank=here,
        length=metres,
        manipulability=manipulability,
        condition_number=math.inf if singular else condition,
        normalised_condition_number=math.inf if here < len(values) else normalised,
        lost_directions=twists[0, :count],
        idle_wrenches=twists[1, here:],
        self_motions=free[here:],
        factors=named,
        kinds=_kinds(chain, named, moving) if singular else (),
    )


def _kinds(chain: SerialChain, factors: dict[str, float], moving: list[float]) -> tuple[str, ...]:
    """Name the parts that are singular, or else the joints that depend on each other."""
    zero = tuple(name for name, value in factors.items() if abs(value) < FACTOR_ZERO)
    if zero:
        return zero
    pairs = zip(chain.joint_names, moving, strict=True)
    names = [name for name, most in pairs if most > FACTOR_ZERO]
    return (f"joints {', '.join(names)} depend on each other",)
