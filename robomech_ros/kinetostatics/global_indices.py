"""Indices of an arm as a whole: averages over its workspace."""

from __future__ import annotations

import math

import numpy as np

from robomech_ros._kernels.kinetostatics import indices as kernels
from robomech_ros.errors import BadValueError, MissingLimitsError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinetostatics.conditioning import characteristic_length
from robomech_ros.kinetostatics.indices import NORMS, as_length, evaluate
from robomech_ros.kinetostatics.task_parts import PARTS
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.robots.entry_checks import whole_number
from robomech_ros.spatial.arrays import as_choice, as_flag
from robomech_ros.typing import Array

# Independent shifts of the points, from which the standard error comes; their seed; and how many
# postures are evaluated at once.
_SHIFTS = 16
_SEED = 1991
_BLOCK = 1 << 13
_FEWEST, _MOST = 1 << 8, 1 << 26


class GlobalIndex(float):
    """An average over the workspace.

    Attributes
    ----------
    standard_error : float
        Standard error of the average, by how much estimates from different points differ.
    postures : int
        How many were evaluated.
    length : float
        What the linear rows of the Jacobian were divided by (m).
    """

    standard_error: float
    postures: int
    length: float


def global_conditioning_index(
    chain: SerialChain,
    *,
    norm: str = "2",
    part: str = "pose",
    length: float | None = None,
    respect_limits: bool = True,
    postures: int = 1 << 16,
) -> GlobalIndex:
    """Average the reciprocal of the condition number over the workspace of an arm.

    ``integral of (1 / kappa) dW / integral of dW``, from 0 to 1, where 1 is an arm that is
    isotropic everywhere.  dW is the volume of the workspace of the chosen part: of positions, of
    orientations, or of both.  It is integrated over the joint values, where
    ``dW = sqrt(det(J J^T)) dq``; so a pose that several postures take counts once for each, with
    the condition number of that posture.  For a redundant arm the self-motion at a pose takes the
    place of a sum over postures, and for one with fewer joints than conditions dW is the volume of
    the surface that its poses form, ``sqrt(det(J^T J)) dq``.

    The points are a Sobol sequence, shifted 16 times by numbers that are the same in every call.

    Parameters
    ----------
    chain : SerialChain
        Chain of one joint or more.
    norm : {"2", "frobenius"}, optional
        Of the condition number, as for :func:`condition_number`.
    part : {"pose", "position", "orientation"}, optional
        Which rows of the Jacobian count.
    length : float, optional
        What the linear rows are divided by (m); default the characteristic length where positions
        and orientations both count, else 1 m, on which nothing depends.
    respect_limits : bool, optional
        Whether revolute joints keep to their limits; else, and where they have none or a turn and
        more, one turn counts.  Prismatic joints always keep to theirs.
    postures : int, optional
        From 256 to 2^26; rounded up to 16 times a power of two.

    Returns
    -------
    GlobalIndex
        A float with the attributes ``standard_error``, ``postures`` and ``length``.

    Raises
    ------
    BadValueError
        An arm that is singular in every posture.
    MissingLimitsError
        A prismatic joint without limits.

    References
    ----------
    Gosselin and Angeles, A global performance index for the kinematic optimization of robotic
    manipulators, ASME J. of Mechanical Design 113(3), 1991.
    """
    check_chain(chain)
    index = NORMS[as_choice("norm", norm, tuple(NORMS))]
    rows = as_choice("part", part, tuple(PARTS))
    count = _as_count(postures)
    lower, upper = _ranges(chain, as_flag("respect_limits", respect_limits))
    if length is not None:
        metres = as_length(length)
    else:
        metres = float(characteristic_length(chain)) if rows == "pose" else 1.0
    sums = np.array(
        [_sums(chain, lower + points * (upper - lower), rows, metres, index)
         for points in _shifted(chain.n, count)]
    )  # fmt: skip
    if not sums[:, 0].any():
        expected = f"one that is regular in some posture as to its {rows}"
        raise BadValueError("chain", chain.name, expected)
    result = _ratio(*sums.T)
    result.postures, result.length = _SHIFTS * count, metres
    return result


def _ratio(above: Array, below: Array) -> GlobalIndex:
    """Divide two sums, each known once for every shift, and estimate the error of the ratio."""
    result = GlobalIndex(above.sum() / below.sum())
    residuals = above - float(result) * below
    spread = math.sqrt(residuals @ residuals / (_SHIFTS * (_SHIFTS - 1)))
    result.standard_error = spread / below.mean()
    return result


def _as_count(postures: int) -> int:
    """Check a number of postures; gives the power of two that each shift has of them."""
    expected = f"a whole number from {_FEWEST} to {_MOST}"
    whole_number("postures", postures, _FEWEST, _MOST, expected)
    return 1 << math.ceil(math.log2(postures / _SHIFTS))


def _ranges(chain: SerialChain, respect_limits: bool) -> tuple[Array, Array]:
    """Return the ranges of the joints, each posture once (rad or m)."""
    slides = chain.types == PRISMATIC
    open_slides = slides & ~np.isfinite(chain.upper - chain.lower)
    if open_slides.any():
        names = [
            name for name, is_open in zip(chain.joint_names, open_slides, strict=True) if is_open
        ]
        raise MissingLimitsError("position", names)
    whole = ~slides & (~(chain.upper - chain.lower < 2.0 * math.pi) | (not respect_limits))
    return np.where(whole, -math.pi, chain.lower), np.where(whole, math.pi, chain.upper)


def _shifted(dimensions: int, count: int) -> list[Array]:
    """Spread points in the unit cube, as many times anew as there are shifts."""
    from scipy.stats import qmc  # a second and 40 MB that few need

    points = qmc.Sobol(dimensions, scramble=False).random_base2(count.bit_length() - 1)
    shifts = np.random.default_rng(_SEED).random((_SHIFTS, dimensions))
    return [(points + shift) % 1.0 for shift in shifts]


def _sums(chain: SerialChain, q: Array, part: str, length: float, index: int) -> tuple[float, ...]:
    """Sum volume over condition number, and volume, over the postures q (m, n)."""
    above = below = 0.0
    for first in range(0, len(q), _BLOCK):
        values = evaluate(chain, q[first : first + _BLOCK], part, length)
        volume = values[:, kernels.MANIPULABILITY]
        above += float((volume / values[:, index]).sum())
        below += float(volume.sum())
    return above, below
