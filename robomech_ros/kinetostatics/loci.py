"""Curves of equal condition number over two joints of an arm."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.joint_values import as_posture, check_chain
from robomech_ros.kinetostatics.conditioning import characteristic_length
from robomech_ros.kinetostatics.indices import condition_number, condition_number_gradient
from robomech_ros.kinetostatics.task_parts import PARTS
from robomech_ros.numerics.arrays import real_array, whole_number
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.spatial.arrays import as_choice, listed
from robomech_ros.typing import Array, ArrayLike

_FEWEST_STEPS, _MOST_STEPS, _REFINEMENTS = 8, 2048, 6
# Larger logarithms of the condition number on the grid count as equal.
_STEEP = 20.0
_STEEPEST = math.exp(_STEEP)


@dataclass(frozen=True, eq=False)
class ConditionLoci:
    """Curves of equal condition number.

    Parameters
    ----------
    chain : SerialChain
    joints : tuple of int
        Indices of the two joints.
    part : str
        The rows of the Jacobian that count.
    length : float or None
        Divisor of the linear rows (m).
    levels : ndarray, shape (m,)
        Condition numbers.
    curves : tuple of tuple of ndarray, shape (k, n)
        Connected pieces of each level, as values of all joints (rad or m).  The tip's
        positions are ``forward_kinematics(chain, curve)[:, :3, 3]``.
    axes : tuple of ndarray, shape (s,)
        Values of both joints on a grid (rad or m).
    grid : ndarray, shape (s, s)
        Condition numbers there, infinite in singular postures.
    """

    chain: SerialChain
    joints: tuple[int, int]
    part: str
    length: float | None
    levels: Array
    curves: tuple[tuple[Array, ...], ...]
    axes: tuple[Array, Array]
    grid: Array


def condition_loci(
    chain: SerialChain,
    levels: ArrayLike,
    *,
    joints: tuple[int, int] | None = None,
    q: ArrayLike | None = None,
    part: str = "position",
    length: float | None = None,
    steps: int = 180,
) -> ConditionLoci:
    """Trace the curves on which the Frobenius condition number has given values.

    Parameters
    ----------
    chain : SerialChain
        Chain of two joints or more.
    levels : array_like, shape (m,)
        Condition numbers above 1, and below 4.8e8; the level 1 would be isolated points.
    joints : tuple of int, optional
        Indices of two joints, from 0; default the second and the third, or both of two.  The range
        of revolute joints is a turn, that of prismatic joints is within their limits.
    q : array_like, shape (n,), optional
        Values of the other joints (rad or m); default 0.
    part : {"position", "orientation", "pose"}, optional
        Which rows of the Jacobian count.
    length : float, optional
        Divisor of the linear rows (m); default the characteristic length for "pose".
    steps : int, optional
        Cells of the grid in each direction, 8 to 2048.

    Raises
    ------
    BadValueError
        A level that is not above 1, joints that are not two different ones of the chain, or a
        prismatic joint without limits.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.8.

    Examples
    --------
    The loci of a planar arm of two joints are straight: joint 1 does not matter.

    >>> import numpy as np
    >>> from robomech_ros.kinetostatics import condition_loci, isotropic_planar_2r
    >>> loci = condition_loci(isotropic_planar_2r(1.0).chain, [1.5])
    >>> len(loci.curves[0]), float(np.ptp(loci.curves[0][0][:, 1])) < 1e-9
    (4, True)
    """
    check_chain(chain)
    part = as_choice("part", part, tuple(PARTS))
    pair = _pair(chain, joints)
    values = np.atleast_1d(real_array("levels", levels))
    if values.ndim != 1 or not ((values > 1.0) & (values < _STEEPEST)).all():
        expected = f"condition numbers above 1 and below {_STEEPEST:.3g}"
        raise BadValueError("levels", values.tolist(), expected)
    rest = np.zeros(chain.n) if q is None else as_posture(chain, q)
    expected = f"a whole number from {_FEWEST_STEPS} to {_MOST_STEPS}"
    count = whole_number("steps", steps, expected, _FEWEST_STEPS, _MOST_STEPS) + 1
    if part == "pose" and length is None:
        length = float(characteristic_length(chain, norm="frobenius"))
    axes = (_axis(chain, pair[0], count), _axis(chain, pair[1], count))
    postures = np.tile(rest, (count, count, 1))
    postures[..., pair[0]], postures[..., pair[1]] = np.meshgrid(*axes, indexing="ij")
    grid = np.asarray(condition_number(chain, postures, norm="frobenius", part=part, length=length))
    loci = ConditionLoci(chain, pair, part, length, values, (), axes, grid)
    curves = tuple(_curves(loci, rest, float(level)) for level in values)
    return ConditionLoci(chain, pair, part, length, values, curves, axes, grid)


def _pair(chain: SerialChain, joints: object) -> tuple[int, int]:
    given = ((1, 2) if chain.n > 2 else (0, 1)) if joints is None else joints
    expected = f"two different joints from 0 to {chain.n - 1}"
    pair = [
        whole_number("joints", k, expected, 0, chain.n - 1)
        for k in listed("joints", given, expected)
    ]
    if len(pair) != 2 or pair[0] == pair[1]:
        raise BadValueError("joints", given, expected)
    return pair[0], pair[1]


def _axis(chain: SerialChain, joint: int, count: int) -> Array:
    if chain.types[joint] != PRISMATIC:
        return np.linspace(-np.pi, np.pi, count)
    ends = np.array([chain.lower[joint], chain.upper[joint]])
    if not np.isfinite(ends).all():
        name = chain.joint_names[joint]
        raise BadValueError(f"range of joint '{name}'", ends.tolist(), "finite limits (m)")
    return np.linspace(ends[0], ends[1], count)


def _curves(loci: ConditionLoci, rest: Array, level: float) -> tuple[Array, ...]:
    """Trace one level on the grid, and refine its points by steps along the gradient."""
    from contourpy import LineType, contour_generator

    heights = np.minimum(np.log(loci.grid), _STEEP)
    found = contour_generator(*loci.axes, heights.T, line_type=LineType.Separate)
    return tuple(
        _refined(loci, rest, level, np.asarray(line, float)) for line in found.lines(np.log(level))
    )


def _refined(loci: ConditionLoci, rest: Array, level: float, line: Array) -> Array:
    pair = list(loci.joints)
    q = np.tile(rest, (len(line), 1))
    q[:, pair] = line
    cell = np.array([axis[1] - axis[0] for axis in loci.axes])
    given = {"norm": "frobenius", "part": loci.part, "length": loci.length}
    for _ in range(_REFINEMENTS):
        value = np.asarray(condition_number(loci.chain, q, **given))  # type: ignore[arg-type]
        slope = condition_number_gradient(loci.chain, q, **given)[:, pair]  # type: ignore[arg-type]
        slope = slope / value[:, None]
        square = np.sum(slope**2, axis=1, keepdims=True)
        step = np.log(level / value)[:, None] * slope / np.where(square > 0.0, square, np.inf)
        q[:, pair] += np.clip(np.nan_to_num(step), -cell, cell)
    return q
