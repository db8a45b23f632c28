"""Systems of nonlinear equations: Newton-Raphson and Newton-Gauss.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., appendix B.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.numerics.arrays import check_finite, real_array, real_number
from robomech_ros.numerics.linear import least_squares
from robomech_ros.typing import Array, ArrayLike

Function = Callable[[Array], ArrayLike]

# Halvings of a step that does not lessen the error before the iteration gives up.
_HALVINGS = 30
_POSITIVE = "a positive number"
# A step that takes less than this part of the error away changes its square by less than rounding.
_UNSEEN = 4.0 * float(np.sqrt(np.finfo(float).eps))
# Part of |J_j| |f| to which each J_j . f may be rounding: some sums of a few dozen terms.
_NORMAL = 32.0 * float(np.finfo(float).eps)


@dataclass(frozen=True, eq=False)
class Iteration:
    """Outcome of an iteration.

    Parameters
    ----------
    x : ndarray, shape (n,)
        The last point.
    residual : ndarray, shape (m,)
        The equations there.
    iterations : int
        Steps taken.
    converged : bool
        Whether the last step was shorter than asked for, or the residual is normal to the columns
        of the derivative up to rounding, so that no shorter step can be computed.
    path : ndarray, shape (iterations + 1, n)
        All points, from the start to the last.
    """

    x: Array
    residual: Array
    iterations: int
    converged: bool
    path: Array


def newton_raphson(
    f: Function, jacobian: Function, x: ArrayLike, *, tolerance: float = 1e-12, iterations: int = 50
) -> Iteration:
    r"""Solve as many equations as unknowns; near a regular root the error is squared by each step.

    .. math:: \Phi(x_k)\, \Delta x_k = -f(x_k), \qquad x_{k+1} = x_k + \Delta x_k

    with the derivative :math:`\Phi = \partial f / \partial x`; a step is halved until the error is
    less.

    Parameters
    ----------
    f : callable
        From x (n,) to the residual (n,).
    jacobian : callable
        From x (n,) to its derivative (n, n).
    x : array_like, shape (n,)
        Start.
    tolerance : float, optional
        Length of the last step.
    iterations : int, optional
        Steps at most.

    Raises
    ------
    WrongSizeError
        The residual is not as long as x, or x is not finite.
    BadValueError
        What should be numbers is none, or the derivative is singular at a point met.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., appendix B.3.

    Examples
    --------
    >>> from robomech_ros.numerics import newton_raphson
    >>> end = newton_raphson(lambda x: x**2 - 2.0, lambda x: [[2.0 * x[0]]], [1.0])
    >>> end.x.round(12), end.converged
    (array([1.41421356]), True)
    """
    start = _start(x)
    _check_callable("f", f)
    size = real_array("f(x)", f(start)).shape
    if size != start.shape:
        raise WrongSizeError("f(x)", size, start.shape)
    return newton_gauss(f, jacobian, start, tolerance=tolerance, iterations=iterations)


def newton_gauss(
    f: Function,
    jacobian: Function,
    x: ArrayLike,
    *,
    tolerance: float = 1e-12,
    iterations: int = 200,
) -> Iteration:
    r"""Minimise ``|f(x)|`` for at least as many equations as unknowns.

    Each step solves the linearised equations by least squares and is halved until the error is
    less.  It ends where the step vanishes, which is where the residual is normal to the columns of
    the derivative, ``jacobian^T f = 0`` (appendix B.4.2); f itself need not vanish.

    .. math::

       \Delta x_k = \arg\min_{\Delta x} |\Phi(x_k)\, \Delta x + f(x_k)|, \qquad
       x_{k+1} = x_k + \Delta x_k, \qquad \Phi^T f \to 0

    Parameters
    ----------
    f : callable
        From x (n,) to the residual (m,), m >= n.
    jacobian : callable
        From x (n,) to its derivative (m, n), of full rank at the points met.
    x : array_like, shape (n,)
        Start.
    tolerance : float, optional
        Length of the last step.
    iterations : int, optional
        Steps at most.

    Raises
    ------
    BadValueError
        What should be numbers is none, or the columns of the derivative depend on each other at a
        point met.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., appendix B.4.

    Examples
    --------
    >>> from robomech_ros.numerics import newton_gauss
    >>> def f(x):
    ...     return [x[0] ** 2 + x[1] ** 2 - 4.0, x[0] * x[1] - 1.0, x[0] - x[1] - 1.3]
    >>> def slope(x):
    ...     return [[2.0 * x[0], 2.0 * x[1]], [x[1], x[0]], [1.0, -1.0]]
    >>> end = newton_gauss(f, slope, [2.0, 0.5])
    >>> end.x.round(6), end.converged
    (array([1.916914, 0.547951]), True)
    """
    point = _start(x)
    _check_callable("f", f)
    _check_callable("jacobian", jacobian)
    if real_number("tolerance", tolerance, _POSITIVE) <= 0.0 or not np.isfinite(tolerance):
        raise BadValueError("tolerance", tolerance, _POSITIVE)
    whole = isinstance(iterations, int | np.integer) and not isinstance(iterations, bool)
    if not whole or iterations < 1:
        raise BadValueError("iterations", iterations, "a positive integer")
    residual, shortest, path = _residual(f, point), np.inf, [point]
    while len(path) <= iterations:
        slope = np.asarray(jacobian(point))
        step, _ = least_squares(slope, -residual)
        length = float(np.linalg.norm(step))
        if length < tolerance:
            return _ended(path, residual, True)
        if np.linalg.norm(slope @ step) <= _UNSEEN * np.linalg.norm(residual):
            # The error cannot show the difference any more; steps that still get shorter do.
            if length >= shortest:
                return _ended(path, residual, _is_normal(slope, residual))
            shortest = length
            point = point + step
            residual = _residual(f, point)
            path.append(point)
            continue
        for _ in range(_HALVINGS):
            trial = point + step
            found = _residual(f, trial)
            if np.linalg.norm(found) < np.linalg.norm(residual):
                break
            step = 0.5 * step
        else:
            return _ended(path, residual, _is_normal(slope, residual))
        point, residual = trial, found
        path.append(point)
    return _ended(path, residual, False)


def _ended(path: list[Array], residual: Array, converged: bool) -> Iteration:
    return Iteration(path[-1], residual, len(path) - 1, converged, np.array(path))


def _is_normal(slope: Array, residual: Array) -> bool:
    bound = _NORMAL * np.linalg.norm(slope, axis=0) * np.linalg.norm(residual)
    return bool(np.all(np.abs(slope.T @ residual) <= bound))


def _check_callable(what: str, value: object) -> None:
    if not callable(value):
        raise BadValueError(what, value, "a function of x")


def _start(x: ArrayLike) -> Array:
    start = real_array("x", x)
    if start.ndim != 1 or not start.size:
        raise WrongSizeError("x", start.shape, "(n,)")
    check_finite("x", start)
    return start.copy()


def _residual(f: Function, x: Array) -> Array:
    # Infinite where a step was too long: it is halved then.
    residual = real_array("f(x)", f(x))
    if residual.ndim != 1:
        raise WrongSizeError("f(x)", residual.shape, "(m,)")
    return residual.copy()


def bisected(
    low: Array | float, high: Array | float, holds: Callable[[Any], ArrayLike], halvings: int
) -> tuple[Any, Any]:
    """Halve intervals, numbers or arrays (k,), of which a condition holds at the low ends only."""
    for _ in range(halvings):
        middle = 0.5 * (low + high)
        below = holds(middle)
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return low, high
