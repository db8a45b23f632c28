"""The best conditioned posture inside the joint limits."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.kinetostatics import indices as kernels
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinematics.posture_samples import sample_postures
from robomech_ros.kinetostatics.conditioning import CharacteristicLength, characteristic_length
from robomech_ros.kinetostatics.indices import as_length, condition_number
from robomech_ros.kinetostatics.task_parts import TaskPart, task_part
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array

# Powers of the Schatten norms that lead from the Frobenius norm to the 2-norm.
_POWERS = tuple(2.0 * 4.0**k for k in range(8))
# Postures that are looked at; how many of them a descent starts from, and how many of its ends are
# followed to the 2-norm; and steps without derivatives at the end.
_POSTURES, _STARTS, _FOLLOWED = 2048, 16, 4
_POLISHING = 2000
# Value for the logarithm of the condition number of a singular posture.
_SINGULAR = 1e3


class BestPosture(NamedTuple):
    """A posture inside the joint limits.

    Attributes
    ----------
    condition_number : float
        Condition number of its Jacobian, in the 2-norm.
    q : ndarray, shape (n,)
        Joint values (rad or m).
    """

    condition_number: float
    q: Array


def best_conditioned_posture(chain: SerialChain, *, length: float | None = None) -> BestPosture:
    """Search for the posture of least condition number inside the joint limits.

    Many postures all over what the joints can take are looked at, and from the best ones the search
    descends; there may be a better one, though none was found in tests.

    Parameters
    ----------
    chain : SerialChain
        Chain of one joint or more.
    length : float, optional
        What the linear rows of the Jacobian are divided by (m); default the characteristic length.

    See Also
    --------
    characteristic_length : its posture is the best one whether inside the limits or not.
    condition_number : of any posture.

    Examples
    --------
    >>> from robomech_ros.kinetostatics import best_conditioned_posture
    >>> from robomech_ros.robots import load_robot
    >>> arm = load_robot("puma560")
    >>> best = best_conditioned_posture(arm, length=0.283)
    >>> bool((arm.lower <= best.q).all() and (best.q <= arm.upper).all())
    True
    """
    check_chain(chain)
    known = None
    if length is None:
        known = length = characteristic_length(chain)
    metres = as_length(length)
    task, weights = task_part(chain, "pose"), np.repeat((1.0, 1.0 / metres), 3)
    starts = _starts(chain, task, weights, known)
    if not starts:
        raise BadValueError("chain", chain.name, "one that is regular in some posture")
    ends = [_descended(chain, task, weights, q, _POWERS[:1]) for q in starts[:_STARTS]]
    ends.sort(key=lambda q: _condition(chain, q, metres))
    ends = [_descended(chain, task, weights, q, _POWERS[1:]) for q in ends[:_FOLLOWED]] + ends[:1]
    best = min([*starts[:1], *ends], key=lambda q: _condition(chain, q, metres))
    best = _polished(chain, best, metres)
    return BestPosture(_condition(chain, best, metres), best)


def _condition(chain: SerialChain, q: Array, length: float) -> float:
    return float(condition_number(chain, q, length=length))


def _starts(
    chain: SerialChain, task: TaskPart, weights: Array, known: CharacteristicLength | None
) -> list[Array]:
    """Return regular postures inside the limits, the one nearest to that of all postures first."""
    q = np.ascontiguousarray(sample_postures(chain, _POSTURES))
    out = np.empty((_POSTURES, kernels.COUNT))
    kernels.indices(task.packed, q, weights, task.rows, 2.0, out)
    values = out[:, kernels.SCHATTEN]
    ranked = [q[k] for k in np.argsort(values) if np.isfinite(values[k])]
    return ranked if known is None else [_inside(chain, known.q), *ranked]


def _inside(chain: SerialChain, q: Array) -> Array:
    """Return the posture inside the limits that is nearest, angles being those within a turn."""
    turns = np.ceil((chain.lower - q) / (2.0 * np.pi))
    wound = q + 2.0 * np.pi * np.where(np.isfinite(turns) & (q < chain.lower), turns, 0.0)
    turns = np.ceil((wound - chain.upper) / (2.0 * np.pi))
    wound = wound - 2.0 * np.pi * np.where(np.isfinite(turns) & (wound > chain.upper), turns, 0.0)
    wound = np.where(chain.turns, wound, q)
    return np.clip(wound, chain.lower, chain.upper)


def _descended(
    chain: SerialChain, task: TaskPart, weights: Array, q: Array, powers: tuple[float, ...]
) -> Array:
    """Descend inside the limits by the Schatten norm of each of these powers."""
    from scipy.optimize import minimize  # a second and 40 MB that few need

    values, gradient = np.empty((1, kernels.COUNT)), np.empty((1, chain.n + 1))

    def logarithm(x: Array, power: float) -> tuple[float, Array]:
        row = np.ascontiguousarray(x[None])
        index = kernels.SCHATTEN
        kernels.index_gradients(
            task.packed, row, weights, task.rows, power, index, values, gradient
        )
        value = float(values[0, index])
        if not np.isfinite(value):
            return _SINGULAR, np.zeros(chain.n)
        return float(np.log(value)), gradient[0, :-1] / value

    bounds = list(zip(chain.lower, chain.upper, strict=True))
    for power in powers:
        q = minimize(logarithm, q, (power,), "L-BFGS-B", True, bounds=bounds).x
    return np.clip(q, chain.lower, chain.upper)


def _polished(chain: SerialChain, q: Array, length: float) -> Array:
    """Improve a posture without derivatives, which the 2-norm has not everywhere."""
    from scipy.optimize import minimize

    bounds = list(zip(chain.lower, chain.upper, strict=True))
    end = minimize(
        lambda x: _condition(chain, x, length), q, method="Nelder-Mead", bounds=bounds,
        options={"maxiter": _POLISHING, "xatol": 1e-9, "fatol": 1e-12},
    )  # fmt: skip
    better: Array = end.x if end.fun < _condition(chain, q, length) else q
    return np.clip(better, chain.lower, chain.upper)
