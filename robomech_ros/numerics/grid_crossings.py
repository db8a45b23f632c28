"""Two equations on a grid: the curves on which each vanishes, and their crossings, refined."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from operator import index

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.numerics.arrays import (
    check_finite,
    real_array,
    real_number,
    shaped_array,
    whole_number,
)
from robomech_ros.typing import Array, ArrayLike, BoolArray

Equations = Callable[[Array, Array], ArrayLike]

# Parts of the width: the step of central differences, and what two ends of one root differ by,
# always and at most.
STEP = 1e-6
_SAME = 1e-7
_ONE_ROOT = 1e-3
_ITERATIONS = 60
# Damping of steps: at first, after a failure, and after a success.
_DAMPING, _MORE, _LESS = 1e-6, 10.0, 0.1
_LEAST_DAMPING, _GREATEST_DAMPING = 1e-18, 1e6
# Damps where an equation depends on nothing.
_FLAT = 1e-200
# Part of the greatest value that is rounding.
_ROUNDING = 1e-12
_FEWEST, _MOST = 8, 4096


def shared_cells(first: Array, second: Array, *, wrap: bool) -> BoolArray:
    """Tell which cells of a grid, or their neighbours, two curves may both run through.

    Cell (i, j) lies between points i and i + 1, j and j + 1; `wrap` tells whether the last row and
    column are followed by the first.
    """
    shared = np.ones(first.shape, dtype=bool)
    for values in (first, second):
        padded = np.pad(values, ((1, 2), (1, 2)), mode="wrap" if wrap else "edge")
        views = np.lib.stride_tricks.sliding_window_view(padded, (4, 4))
        # A curve that runs along the rim of the grid is seen only up to rounding.
        rounding = _ROUNDING * np.abs(values).max()
        shared &= (views.min((2, 3)) <= rounding) & (views.max((2, 3)) >= -rounding)
    return shared


def check_callable(equations: object) -> None:
    """Refuse what is no function, by BadValueError."""
    if not callable(equations):
        raise BadValueError("equations", equations, "a function of x and y")


def slopes_at(equations: Equations, points: Array, step: float | Array) -> Array:
    """Return the derivatives (n, m, 2) at points (n, 2) by central differences."""
    x, y = points.T
    h, k = np.broadcast_to(step, 2)
    by_x = np.subtract(equations(x + h, y), equations(x - h, y)) / (2.0 * h)
    by_y = np.subtract(equations(x, y + k), equations(x, y - k)) / (2.0 * k)
    return np.stack([by_x.T, by_y.T], axis=-1)


@dataclass(frozen=True, eq=False)
class GridProblem:
    """The equations on a grid."""

    equations: Equations
    low: Array
    width: Array
    period: float | None
    pair: tuple[int, int]
    axes: tuple[Array, Array]
    values: Array
    scale: Array

    @classmethod
    def of(
        cls,
        equations: Equations,
        bounds: ArrayLike,
        pair: tuple[int, int],
        period: float | None,
        steps: int,
    ) -> GridProblem:
        """Check what a caller of `bivariate` gives, and evaluate the equations on the grid."""
        check_callable(equations)
        low, high = _bounds(bounds).T
        if (
            period is not None
            and not 0.0 < real_number("period", period, "a positive number") < np.inf
        ):
            raise BadValueError("period", period, "a positive number")
        expected = f"a whole number from {_FEWEST} to {_MOST}"
        count = whole_number("steps", steps, expected, _FEWEST, _MOST)
        axes = np.linspace(low, high, count + 1).T
        x, y = np.meshgrid(*axes, indexing="ij")
        values = real_array("equations", equations(x, y))
        if values.ndim != 3 or values.shape[1:] != x.shape or len(values) < 2:
            raise WrongSizeError(
                "equations", values.shape, f"(m, {x.shape[0]}, {x.shape[1]}), m at least 2"
            )
        check_finite("equations", values)
        scale = np.abs(values).max(axis=(1, 2))
        both = _pair(pair, scale)
        scale[scale == 0.0] = 1.0
        # Squares of the values themselves could be infinite, or vanish.
        scale *= np.sqrt(np.mean((values / scale[:, None, None]) ** 2, axis=(1, 2)))
        scale[scale == 0.0] = 1.0
        return cls(equations, low, high - low, period, both, (axes[0], axes[1]), values, scale)

    @property
    def cell(self) -> Array:
        """Width of a cell in x and in y."""
        return self.width / (len(self.axes[0]) - 1)

    def curves(self) -> tuple[tuple[Array, ...], ...]:
        """Follow the two curves on the grid."""
        from contourpy import LineType, contour_generator

        found = (
            contour_generator(*self.axes, self.values[k].T, line_type=LineType.Separate).lines(0.0)
            for k in self.pair
        )
        return tuple(tuple(np.asarray(line, float) for line in lines) for lines in found)

    def starts(self) -> Array:
        """Return the middles of the cells that both curves may run through, shape (n, 2)."""
        first, second = (self.values[k] for k in self.pair)
        cells = shared_cells(first, second, wrap=False)[:-1, :-1]
        return self.low + (np.argwhere(cells) + 0.5) * self.cell

    def part(self, points: Array, chosen: list[int]) -> Array:
        """Return some equations at points (n, 2) in parts of their scale, shape (n, m)."""
        x, y = points.T
        values = np.asarray(self.equations(x, y), float)[chosen]
        return (values / self.scale[chosen, None]).T

    def refined(self, starts: Array, chosen: list[int], reach: Array) -> tuple[Array, Array]:
        """Refine points (n, 2) within a reach by damped steps; gives them and what is left."""
        points, damping = starts.copy(), np.full(len(starts), _DAMPING)
        if not len(points):
            return points, np.empty(0)
        value = self.part(points, chosen)
        for _ in range(_ITERATIONS):
            slope = (
                slopes_at(self.equations, points, STEP * self.width)[:, chosen]
                / self.scale[chosen, None]
            )
            slope = slope * self.width
            left, size, right = np.linalg.svd(slope, full_matrices=False)
            damped = size / np.maximum(size**2 + damping[:, None] * size[:, :1] ** 2, _FLAT)
            moved = np.einsum("nka,nk,nmk,nm->na", right, damped, left, -value)
            trial = np.clip(points + moved * self.width, starts - reach, starts + reach)
            found = self.part(trial, chosen)
            better = np.linalg.norm(found, axis=1) < np.linalg.norm(value, axis=1)
            points[better], value[better] = trial[better], found[better]
            damping *= np.where(better, _LESS, _MORE)
            damping = np.clip(damping, _LEAST_DAMPING, _GREATEST_DAMPING)
            if not better.any() and (damping > 1.0).all():
                break
        return points, np.abs(value).max(axis=1)

    def distinct(self, points: Array, chosen: list[int], tolerance: float) -> Array:
        """Leave one of each group of points that are one, within the bounds, by increasing x."""
        if self.period is not None:
            points = self.low + (points - self.low) % self.period
        inside = (points >= self.low - _SAME * self.width) & (
            points <= self.low + self.width * (1.0 + _SAME)
        )
        points = points[inside.all(axis=1)]
        if not len(points):
            return points
        from scipy.sparse import coo_array  # a second and 40 MB that few need
        from scipy.sparse.csgraph import connected_components

        near = self._near(points)
        a, b = near.T
        between = points[a] + 0.5 * self._apart(points[b] - points[a])
        same = (
            np.abs(self._apart(points[b] - points[a]) / self.width).max(axis=1, initial=0.0) < _SAME
        )
        same |= np.abs(self.part(between, chosen)).max(axis=1, initial=0.0) < tolerance
        links = coo_array((np.ones(same.sum()), (a[same], b[same])), shape=(len(points),) * 2)
        _, group = connected_components(links, directed=False)
        left = np.abs(self.part(points, chosen)).max(axis=1)
        best = [
            np.flatnonzero(group == g)[np.argmin(left[group == g])] for g in range(group.max() + 1)
        ]
        chosen_points = points[best]
        return chosen_points[np.lexsort(chosen_points.T[::-1])]

    def _near(self, points: Array) -> NDArray[np.intp]:
        """Return the pairs of points that may be one, shape (k, 2)."""
        from scipy.spatial import cKDTree

        scaled = (points - self.low) / self.width
        box = None if self.period is None else self.period / self.width
        tree = cKDTree(scaled if box is None else scaled % box, boxsize=box)
        return tree.query_pairs(_ONE_ROOT, output_type="ndarray")

    def _apart(self, difference: Array) -> Array:
        if self.period is None:
            return difference
        half = 0.5 * self.period
        return (difference + half) % self.period - half

    def angles(self, points: Array, pair: tuple[int, int]) -> Array:
        """Return the angles (rad) between the two curves at points (n, 2)."""
        if not len(points):
            return np.empty(0)
        slopes = slopes_at(self.equations, points, STEP * self.width)[:, list(pair)]
        # Angles are those of lines of any length.
        length = np.abs(slopes).max(axis=2, keepdims=True)
        slopes = slopes / np.where(length > 0.0, length, 1.0)
        (a, b), (c, d) = slopes[:, 0].T, slopes[:, 1].T
        return np.arctan2(np.abs(a * d - b * c), np.abs(a * c + b * d))


def _bounds(bounds: ArrayLike) -> Array:
    ends = shaped_array("bounds", bounds, (2, 2))
    if (ends[:, 1] <= ends[:, 0]).any():
        raise BadValueError("bounds", bounds, "a least value and a greater one for each unknown")
    return ends


def _pair(pair: object, scale: Array) -> tuple[int, int]:
    expected = f"two different numbers of equations from 0 to {len(scale) - 1}"
    try:
        first, second = (index(k) for k in pair)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise BadValueError("pair", pair, expected) from None
    if first == second or not all(0 <= k < len(scale) for k in (first, second)):
        raise BadValueError("pair", pair, expected)
    for k in (first, second):
        if not scale[k]:
            raise BadValueError(
                f"equations[{k}]", 0.0, "an equation that does not vanish everywhere"
            )
    return first, second
