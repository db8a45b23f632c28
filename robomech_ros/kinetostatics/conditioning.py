"""Best conditioning of an arm, and the characteristic length that achieves it."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.kinetostatics import indices as kernels
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinematics.posture_samples import low_discrepancy_strides
from robomech_ros.kinetostatics.indices import NORMS
from robomech_ros.kinetostatics.task_parts import PARTS, TaskPart, task_part
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.robots.dh import chain_from_dh
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array

# Powers of the Schatten norms that lead from the Frobenius norm to the 2-norm.
_POWERS = tuple(2.0 * 4.0**k for k in range(1, 12))
# Postures that are looked at, with how many lengths (of the reach, from, to, count) each; how many
# of them a descent starts from; and how many of its ends are followed through the first powers, and
# how many from there on.
_POSTURES = 1024
_LENGTHS = (1.0, 1.0 / 32.0, 8)
_STARTS = 16
_FOLLOWED = ((_POWERS[:4], 6), (_POWERS[4:], 2))
# Lengths whose logarithm is further from that of the arm's size are not looked at: with fewer
# joints than conditions positions alone, or orientations, can be best, and there would be no end.
_FARTHEST = math.log(1e3)
# The first of the linear rows of the Jacobian.
_LINEAR = 3
# Minima whose condition numbers differ by less (relative) are one.
_SAME = 1e-9
# Value for the logarithm of the condition number of a singular posture.
_SINGULAR = 1e3
_OPTIONS = {"gtol": 1e-9, "maxiter": 300}
# Trust-region method: it quarters its radius where rounding keeps it from a smaller
# gradient: after 300 steps nothing would be left of it.
_FEWER = {"gtol": 1e-9, "maxiter": 100}
# Step over which second derivatives are taken; they grow with the power.
_STEP = 1e-3
# Step of finite differences over design parameters (relative to the size, or rad); part of the
# greatest second derivative that counts as zero; largest part of the length in a flat direction.
_DESIGN_STEP, _FLAT, _FREE = 1e-5, 1e-6, 1e-3
# Second derivatives below this are rounding.
_ROUNDED = 1e-9


class CharacteristicLength(float):
    """A length in m, with the posture that it belongs to.

    Attributes
    ----------
    condition_number : float
        The least that any posture has with any length.
    q : ndarray, shape (n,)
        A posture that has it (rad from -pi to pi, or m).
    """

    condition_number: float
    q: Array

    @property
    def conditioning_index(self) -> float:
        """100 over the condition number, the kinetostatic conditioning index in percent."""
        return 100.0 / self.condition_number


class ConditioningIndex(float):
    """100 over the least condition number of an arm, in percent, with the posture that has it.

    Attributes
    ----------
    condition_number : float
        The least of all postures.
    q : ndarray, shape (n,)
        A posture that has it (rad from -pi to pi, or m).
    """

    condition_number: float
    q: Array


def characteristic_length(chain: SerialChain, *, norm: str = "2") -> CharacteristicLength:
    r"""Find the length with which the arm's best posture is as well conditioned as possible.

    Linear rows of the Jacobian are divided by it.  Length and posture together make the condition
    number least, over all postures whether within the limits of revolute joints or not, and lengths
    of a thousandth of the arm's size to a thousand times it; arms of few joints can be best at an
    end of these.  Where nothing depends on it, as of a wrist alone, it may be any of them.

    .. math::

       L = \arg\min_{L} \min_{q}\, \kappa\!\left( \begin{bmatrix} A(q) \\ B(q) / L \end{bmatrix}
       \right), \qquad J = \begin{bmatrix} A \\ B \end{bmatrix}

    Parameters
    ----------
    chain : SerialChain
        Chain of one joint or more.
    norm : {"2", "frobenius"}, optional
        Of the condition number, as for :func:`condition_number`.

    Returns
    -------
    CharacteristicLength
        A float (m) with the attributes ``condition_number``, ``conditioning_index`` and ``q``.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 5.8.3 and 5.8.4.

    Examples
    --------
    >>> from robomech_ros.kinetostatics import characteristic_length
    >>> from robomech_ros.robots import load_robot
    >>> length = characteristic_length(load_robot("fanuc_arcmate"))
    >>> round(float(length), 4), round(length.condition_number, 3)
    (0.3573, 2.589)
    >>> round(length.conditioning_index, 2)
    38.63
    """
    x, condition = _best(chain, norm, "pose")
    result = CharacteristicLength(_length(chain, x))
    result.q = _within_a_turn(chain, x[:-1])
    result.condition_number = condition
    return result


@dataclass(frozen=True, eq=False)
class LengthGradient:
    """The characteristic length of a design, and its derivatives with respect to the parameters.

    Parameters
    ----------
    length : CharacteristicLength
        By the Frobenius norm (m).
    a, b : ndarray, shape (n,)
        Derivatives with respect to link lengths and offsets (1); 0 for the offset of a prismatic
        joint, which is the joint's variable.
    alpha : ndarray, shape (n,)
        Derivatives with respect to link twists (m/rad).  NaN: there is no derivative.
    """

    length: CharacteristicLength
    a: Array
    b: Array
    alpha: Array


def characteristic_length_gradient(chain: SerialChain) -> LengthGradient:
    r"""Differentiate the characteristic length with respect to Denavit-Hartenberg parameters.

    The best posture and the logarithm of the length, x, solve
    :math:`\nabla_x \ln \kappa_F(x, p) = 0` for the parameters p, so

    .. math:: \frac{dx}{dp} = -H^{-1} \frac{\partial}{\partial p} \nabla_x \ln \kappa_F

    with the second derivatives H.  The Frobenius norm is used: it is smooth where the 2-norm is
    not, as in an isotropic posture.  For revolute joints without a tool the length is proportional
    to the arm, so the sum of all lengths and offsets times their derivatives is the length.
    If several postures are best, as for a symmetric arm, the derivatives hold for the posture
    ``length.q``; the length itself has a kink there.  A derivative is NaN if the parameter makes a
    joint matter that did not before: for example, it moves the tip off the last axis.

    Parameters
    ----------
    chain : SerialChain
        With a Denavit-Hartenberg table.

    Raises
    ------
    BadValueError
        The chain has coupled joints, or any length is a characteristic length.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.8.4.

    Examples
    --------
    >>> from robomech_ros.kinetostatics import characteristic_length_gradient, isotropic_planar_3r
    >>> design = isotropic_planar_3r(1.0)
    >>> found = characteristic_length_gradient(design.chain)
    >>> bool(abs(found.a @ design.a - found.length) < 1e-6)
    True
    """
    check_chain(chain)
    chain.require_uncoupled()
    table = chain.dh
    x, condition = _best(chain, "frobenius", "pose")
    assert table is not None
    task = task_part(chain, "pose")
    H = _second_derivatives(x, chain, task, 2.0)
    values, directions = np.linalg.eigh(H)
    flat = np.abs(values) <= max(_FLAT * np.abs(values).max(), _ROUNDED)
    if np.abs(directions[-1, flat]).max(initial=0.0) > _FREE:
        expected = "one whose condition number depends on the length of its linear rows"
        raise BadValueError("chain", chain.name, expected)
    # The last entry of dx is that of ln L: the negative last row of the inverse, without flat
    # directions.
    row = directions[:, ~flat] @ (directions[-1, ~flat] / values[~flat])
    length = CharacteristicLength(_length(chain, x))
    length.q, length.condition_number = _within_a_turn(chain, x[:-1]), condition
    design = np.stack((table.a, table.b, table.alpha))
    units = np.array([length_scale(chain), length_scale(chain), 1.0])
    out = np.zeros((3, chain.n))

    def gradient(k: int, i: int, step: float) -> Array:
        changed = design.copy()
        changed[k, i] += step
        a, b, alpha = changed
        kinds = table.types.tolist()
        arm = chain_from_dh(a, b, alpha, table.theta, types=kinds, tool=table.tool)
        other = np.concatenate((task.packed[:1], arm.packed[1:]))
        return _logarithm(x, chain, TaskPart(other, task.rows), 2.0)[1]

    for k, i in np.ndindex(out.shape):
        if k == 1 and chain.types[i] == PRISMATIC:
            continue
        h = float(_DESIGN_STEP * units[k])
        change = (gradient(k, i, h) - gradient(k, i, -h)) / (2.0 * h)
        free = np.abs(change @ directions[:, flat]).max(initial=0.0)
        kink = free > _FREE * np.linalg.norm(change) and free > _FLAT / units[k]
        out[k, i] = np.nan if kink else -length * row @ change
    return LengthGradient(length, *out)


def conditioning_index(
    chain: SerialChain, *, part: str = "pose", norm: str = "2"
) -> ConditioningIndex:
    r"""Compute the kinetostatic conditioning index: 100 % for an arm with an isotropic posture.

    The arm's positioning part, such as the first three joints, is the chain to the link that
    carries the wrist centre: ``chain.with_tip(link)`` with part "position".

    .. math:: \mathrm{KCI} = \frac{100}{\min_q \kappa(q)}\ \%

    Parameters
    ----------
    chain : SerialChain
        Chain of one joint or more.
    part : {"pose", "position", "orientation"}, optional
        Which rows of the Jacobian count; for "pose" the linear ones are divided by the
        characteristic length.  Directions that the arm has in no posture, such as those out of the
        plane of a planar one, do not count.
    norm : {"2", "frobenius"}, optional
        Of the condition number, as for :func:`condition_number`.

    Returns
    -------
    ConditioningIndex
        A float (percent) with the attributes ``condition_number`` and ``q``.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.8.

    Examples
    --------
    >>> from robomech_ros.kinetostatics import conditioning_index
    >>> from robomech_ros.robots import chain_from_dh
    >>> arm = chain_from_dh(a=[2.0**0.5, 1.0], b=[0.0, 0.0], alpha=[0.0, 0.0])
    >>> round(float(conditioning_index(arm, part="position")), 3)
    100.0
    """
    x, condition = _best(chain, norm, as_choice("part", part, tuple(PARTS)))
    result = ConditioningIndex(100.0 / condition)
    result.q = _within_a_turn(chain, x[:-1])
    result.condition_number = condition
    return result


def _best(chain: SerialChain, norm: str, part: str) -> tuple[Array, float]:
    """Return joint values and the logarithm of the length (n + 1,) of least condition, and that."""
    check_chain(chain)
    index = NORMS[as_choice("norm", norm, tuple(NORMS))]
    task = task_part(chain, part)
    starts = _starts(chain, task)
    if not starts:
        raise BadValueError("chain", chain.name, "one that is regular in some posture")
    found = _distinct(chain, task, [_descent(chain, task, start) for start in starts])
    if index == kernels.CONDITION:
        for powers, count in _FOLLOWED:
            found = [_followed(chain, task, x, powers) for x in found[:count]]
            found.sort(key=lambda x: _evaluate(chain, task, x, 2.0, index)[0])
    return found[0], _evaluate(chain, task, found[0], 2.0, index)[0]


def _within_a_turn(chain: SerialChain, q: Array) -> Array:
    """Return the same posture with its angles from -pi to pi."""
    wrapped: Array = q - 2.0 * math.pi * np.round(q / (2.0 * math.pi))
    return np.where(chain.turns, wrapped, q)


def _distinct(chain: SerialChain, task: TaskPart, ends: list[Array]) -> list[Array]:
    """Return the ends of descents, the best first, each minimum once."""
    ranked = sorted(
        (_evaluate(chain, task, x, 2.0, kernels.SCHATTEN)[0], k) for k, x in enumerate(ends)
    )
    values = [value for value, _ in ranked]
    return [
        ends[k]
        for (value, k), before in zip(ranked, [0.0, *values], strict=False)
        if value > before * (1.0 + _SAME)
    ]


def _evaluate(
    chain: SerialChain, task: TaskPart, x: Array, power: float, index: int
) -> tuple[float, Array]:
    """Return an index at x, joint values and the logarithm of the length, and its gradient."""
    values, gradient = np.empty((1, kernels.COUNT)), np.empty((1, chain.n + 1))
    q, weights = np.ascontiguousarray(x[None, :-1]), _weights(_length(chain, x))
    kernels.index_gradients(task.packed, q, weights, task.rows, power, index, values, gradient)
    if not abs(x[-1] - math.log(length_scale(chain))) < _FARTHEST:
        gradient[0, -1] = 0.0
    return float(values[0, index]), gradient[0]


def _length(chain: SerialChain, x: Array) -> float:
    """Return the length (m) whose logarithm ends x (n + 1,), or the last one looked at."""
    middle = math.log(length_scale(chain))
    return math.exp(min(max(x[-1], middle - _FARTHEST), middle + _FARTHEST))


@functools.lru_cache(maxsize=64)
def length_scale(chain: SerialChain) -> float:
    """Return how far the tip can be from the first joint at the most, 1 m where that is nothing."""
    lengths = np.linalg.norm(chain.packed[1:, 10:13], axis=1)
    travel = np.maximum(np.abs(chain.lower), np.abs(chain.upper))[chain.types == PRISMATIC]
    return float(lengths.sum() + travel[np.isfinite(travel)].sum()) or 1.0


def _weights(length: float) -> Array:
    return np.repeat((1.0, 1.0 / length), 3)


def _logarithm(x: Array, chain: SerialChain, task: TaskPart, power: float) -> tuple[float, Array]:
    """Return the logarithm of the condition number by the Schatten norm of this power at x."""
    value, gradient = _evaluate(chain, task, x, power, kernels.SCHATTEN)
    if not math.isfinite(value):
        return _SINGULAR, np.zeros_like(x)
    return math.log(value), gradient / value


def _second_derivatives(x: Array, chain: SerialChain, task: TaskPart, power: float) -> Array:
    steps = _STEP / power * np.eye(len(x))
    ahead, behind = (
        np.array([_logarithm(x + sign * step, chain, task, power)[1] for step in steps])
        for sign in (1.0, -1.0)
    )
    H = (ahead - behind) * (power / (2.0 * _STEP))
    return 0.5 * (H + H.T)


def _descent(chain: SerialChain, task: TaskPart, start: Array) -> Array:
    from scipy.optimize import minimize  # a second and 40 MB that few need

    given = (chain, task, 2.0)
    return minimize(_logarithm, start, given, "BFGS", True, options=_OPTIONS).x


def _followed(chain: SerialChain, task: TaskPart, x: Array, powers: Sequence[float]) -> Array:
    """Follow a minimum from power to power, where the valley becomes ever narrower."""
    from scipy.optimize import minimize

    for power in powers:
        given = (chain, task, power)
        x = minimize(
            _logarithm, x, given, "trust-exact", True, _second_derivatives, options=_FEWER
        ).x
    return x


def _starts(chain: SerialChain, task: TaskPart) -> list[Array]:
    """Return the best conditioned of many postures and lengths, none of them singular."""
    size = length_scale(chain)
    half = np.where(chain.types == PRISMATIC, size, math.pi)
    cube = np.arange(1, _POSTURES + 1)[:, None] * low_discrepancy_strides(chain.n) % 1.0
    q = np.ascontiguousarray((2.0 * cube - 1.0) * half)
    out = np.empty((_POSTURES, kernels.COUNT))
    ranked = []
    # Rows of one kind are conditioned alike with any length.
    mixed = task.rows[0] < _LINEAR <= task.rows[-1]
    lengths = size * np.geomspace(*_LENGTHS) if mixed else [1.0]
    for length in lengths:
        kernels.indices(task.packed, q, _weights(length), task.rows, 2.0, out)
        for k in np.argsort(out[:, kernels.SCHATTEN])[:_STARTS]:
            ranked.append((out[k, kernels.SCHATTEN], np.append(q[k], math.log(length))))
    ranked.sort(key=lambda start: start[0])
    return [x for value, x in ranked[:_STARTS] if math.isfinite(value)]
