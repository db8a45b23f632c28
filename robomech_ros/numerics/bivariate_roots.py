"""Equations in two unknowns: the curves on which each vanishes, where they cross, and the roots.

The curves of two equations show all of their common roots at a glance.  Where there are more
equations, a crossing of two curves is a root only where the others vanish, too; else it is
spurious.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.numerics.arrays import of_shape, real_array, real_number
from robomech_ros.numerics.grid_crossings import (
    STEP,
    Equations,
    GridProblem,
    check_callable,
    slopes_at,
)
from robomech_ros.numerics.nonlinear import Iteration, newton_gauss
from robomech_ros.typing import Array, ArrayLike, BoolArray

# A turn of both unknowns.
ANGLES = ((-np.pi, np.pi), (-np.pi, np.pi))


@dataclass(frozen=True, eq=False)
class Bivariate:
    """Result of `bivariate`.

    Parameters
    ----------
    curves : tuple of tuple of ndarray, shape (k, 2)
        The two curves, each in pieces of connected points.
    crossings : ndarray, shape (c, 2)
        Where they cross or touch, refined, by increasing first unknown.
    is_root : ndarray of bool, shape (c,)
        Whether all other equations vanish there, too.
    roots : ndarray, shape (r, 2)
        Those that are roots, refined with all equations.
    residuals : ndarray, shape (r,)
        Largest equation at each root, as part of what that equation is in the mean.
    angles : ndarray, shape (c,)
        Angle (rad) between the curves at each crossing, 0 to pi/2; 0 where they touch: there the
        root is multiple or ill-conditioned.
    """

    curves: tuple[tuple[Array, ...], ...]
    crossings: Array
    is_root: BoolArray
    roots: Array
    residuals: Array
    angles: Array


def bivariate(
    equations: Equations,
    bounds: ArrayLike = ANGLES,
    *,
    pair: tuple[int, int] = (0, 1),
    period: float | None = None,
    steps: int = 240,
    tolerance: float = 1e-9,
) -> Bivariate:
    """Find the common roots of two or more equations in two unknowns.

    Parameters
    ----------
    equations : callable
        From arrays x and y of one shape (...) to the equations, shape (m, ...), m >= 2; smooth.
    bounds : array_like, shape (2, 2), optional
        Least and greatest value of x, and of y; a turn of both by default.
    pair : tuple of int, optional
        The two equations whose curves are followed.
    period : float, optional
        With which all equations repeat in x and in y; roots that differ by it are one.  No period
        by default.
    steps : int, optional
        Cells of the grid in each direction, 8 to 4096.  Crossings that are two cells apart are
        found; nearer ones may be taken for one.
    tolerance : float, optional
        What a root leaves of each equation, as part of what that equation is in the mean.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.4.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.numerics import bivariate
    >>> found = bivariate(lambda x, y: [np.cos(x) - np.sin(y), x - y], [[-3, 3], [-3, 3]])
    >>> found.roots.round(6)
    array([[-2.356194, -2.356194],
           [ 0.785398,  0.785398]])
    """
    if not 0.0 < real_number("tolerance", tolerance, "a positive number") < np.inf:
        raise BadValueError("tolerance", tolerance, "a positive number")
    return _solved(GridProblem.of(equations, bounds, pair, period, steps), tolerance)


def _solved(problem: GridProblem, tolerance: float) -> Bivariate:
    pair = problem.pair
    starts = problem.starts()
    ends, reached = problem.refined(starts, list(pair), 4.0 * problem.cell)
    crossings = problem.distinct(ends[reached < tolerance], list(pair), tolerance)
    everything = list(range(len(problem.scale)))
    roots, left = problem.refined(crossings, everything, problem.cell)
    is_root = left < tolerance
    angles = problem.angles(crossings, pair)
    return Bivariate(problem.curves(), crossings, is_root, roots[is_root], left[is_root], angles)


def refine_root(
    equations: Equations, estimate: ArrayLike, *, tolerance: float = 1e-12, iterations: int = 100
) -> Iteration:
    """Refine a rough estimate of a root of two or more equations by Newton-Gauss.

    Parameters
    ----------
    equations : callable
        As in `bivariate`.
    estimate : array_like, shape (2,)
        Where to begin, for example where somebody has clicked.
    tolerance : float, optional
        Length of the last step.
    iterations : int, optional
        Steps at most.

    Returns
    -------
    Iteration
        With the way from the estimate in `path`.  It ends where the sum of squares is least:
        whether that is a root, its residual says.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 9.4 and B.4.
    """
    start = of_shape("estimate", real_array("estimate", estimate), (2,))
    check_callable(equations)

    def value(x: Array) -> Array:
        return real_array("equations", equations(x[:1], x[1:]))[:, 0]

    def slope(x: Array) -> Array:
        return slopes_at(equations, x[None], STEP)[0]

    return newton_gauss(value, slope, start, tolerance=tolerance, iterations=iterations)
