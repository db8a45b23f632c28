"""Systems of nonlinear equations: Newton-Raphson and Newton-Gauss.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., appendix B.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.numerics.arrays import real_array, real_number
from robomech_ros.numerics.linear import least_squares

__all__ = ["Iteration", "newton_gauss", "newton_raphson"]

Array = NDArray[np.float64]
Function = Callable[[Array], ArrayLike]

# Halvings of a step that does not lessen the error before the iteration gives up.
_HALVINGS = 30
_POSITIVE = "a positive number"


@dataclass(frozen=True, eq=False)
class Iteration:
    """How an iteration ended.

    Parameters
    ----------
    x : ndarray, shape (n,)
        The last point.
    residual : ndarray, shape (m,)
        The equations there.
    iterations : int
        Steps taken.
    converged : bool
        Whether the last step was shorter than asked for.
    """

    x: Array
    residual: Array
    iterations: int
    converged: bool


def newton_raphson(
    f: Function,
    jacobian: Function,
    x: ArrayLike,
    *,
    tolerance: float = 1e-12,
    iterations: int = 50,
) -> Iteration:
    """Solve as many equations as unknowns; near a regular root the error is squared by each step.

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

    Returns
    -------
    Iteration

    Raises
    ------
    WrongSizeError, NonFiniteError
        The residual is not as long as x, or x is not finite.
    BadValueError
        What should be numbers is none, or the derivative is singular at a point met.
    """
    start = _start(x)
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
    """Minimise ``|f(x)|`` for at least as many equations as unknowns.

    Each step solves the linearised equations by least squares and is halved until the error is
    less.  It ends where the step vanishes, which is where ``jacobian^T f = 0``; f itself need not.

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

    Returns
    -------
    Iteration

    Raises
    ------
    WrongSizeError, NonFiniteError
        Shapes that do not fit, or x is not finite.
    BadValueError
        What should be numbers is none, or the columns of the derivative depend on each other at a
        point met.
    """
    point = _start(x)
    if real_number("tolerance", tolerance, _POSITIVE) <= 0.0 or not np.isfinite(tolerance):
        raise BadValueError("tolerance", tolerance, _POSITIVE)
    if not isinstance(iterations, int | np.integer) or iterations < 1:
        raise BadValueError("iterations", iterations, "a positive integer")
    residual = _residual(f, point)
    for count in range(iterations):
        step, _ = least_squares(jacobian(point), -residual)
        length = float(np.linalg.norm(step))
        if length < tolerance:
            return Iteration(point, residual, count, True)
        for _ in range(_HALVINGS):
            trial = point + step
            found = _residual(f, trial)
            if np.linalg.norm(found) < np.linalg.norm(residual):
                break
            step = 0.5 * step
        else:
            # No step lessens the error any more: this is its minimum, up to rounding.
            return Iteration(point, residual, count, length < np.sqrt(tolerance))
        point, residual = trial, found
    return Iteration(point, residual, iterations, False)


def _start(x: ArrayLike) -> Array:
    start = real_array("x", x)
    if start.ndim != 1 or not start.size:
        raise WrongSizeError("x", start.shape, "(n,)")
    if not np.isfinite(start).all():
        raise NonFiniteError("x", start)
    return start.copy()


def _residual(f: Function, x: Array) -> Array:
    # Infinite where a step was too long: it is halved then.
    residual = real_array("f(x)", f(x))
    if residual.ndim != 1:
        raise WrongSizeError("f(x)", residual.shape, "(m,)")
    return residual.copy()
