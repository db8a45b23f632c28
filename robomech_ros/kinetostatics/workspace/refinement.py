"""Vertices of curves in the joint plane: back onto the curve, and enough for a smooth image."""

from collections.abc import Callable

import numpy as np

from robomech_ros.kinetostatics.workspace.section import WorkspaceSection
from robomech_ros.numerics.nonlinear import bisected as halved
from robomech_ros.typing import Array, BoolArray

_PROJECTIONS = 12
# Images: longest chord, and farthest that a chord may be from the curve, over the arm's size.
_CHORD = 1.0 / 400.0
_SAGITTA = 1e-6
_HALVINGS = 14
_MOST_VERTICES = 60_000


def onto_zeros(
    gradient: Callable[[Array, Array], tuple[Array, Array, Array]],
    rows: Array,
    steps: int = _PROJECTIONS,
) -> Array:
    """Move points (k, 2) of the joint plane onto the zeros of a function, along its gradient.

    ``gradient`` returns its value and its derivatives by the two joint values.
    """
    rows = rows.copy()
    for _ in range(steps):
        f, fu, fv = gradient(rows[:, 0], rows[:, 1])
        square = fu * fu + fv * fv
        share = np.divide(f, square, out=np.zeros_like(f), where=square > 0.0)
        rows[:, 0] -= share * fu
        rows[:, 1] -= share * fv
    return rows


def bisected(
    positive: Callable[[Array], BoolArray], low: Array, high: Array, steps: int = 52
) -> tuple[Array, Array]:
    """Halve segments, from low to high (k, 2), of which a function is positive at one end only."""
    start = positive(low)
    return halved(low, high, lambda rows: (positive(rows) == start)[:, None], steps)


def refined(
    section: WorkspaceSection, curve: Array, onto: Callable[[Array], Array] | None
) -> Array:
    """Add vertices to a curve (k, 2) of joint values until chords of its image are short and near.

    ``onto`` puts points between vertices back on the curve; None where straight lines are.
    """
    chord, sagitta = _CHORD * section.size, _SAGITTA * section.size
    settled = np.zeros(len(curve) - 1, dtype=bool)
    for _ in range(_HALVINGS):
        if settled.all() or len(curve) > _MOST_VERTICES:
            break
        open_ = np.flatnonzero(~settled)
        a, b = curve[open_], curve[open_ + 1]
        middle = 0.5 * (a + b)
        if onto is not None:
            middle = onto(middle)
        lengths = np.linalg.norm(b - a, axis=1)
        astray = np.linalg.norm(middle - 0.5 * (a + b), axis=1) > 0.6 * lengths
        x, y, m = (section.image(rows[:, 0], rows[:, 1]) for rows in (a, b, middle))
        long = np.linalg.norm(y - x, axis=1) > chord
        bent = np.linalg.norm(m - 0.5 * (x + y), axis=1) > sagitta
        split = (long | bent) & ~astray
        settled[open_[~split]] = True
        where = open_[split] + 1
        curve = np.insert(curve, where, middle[split], axis=0)
        settled = np.insert(settled, where - 1, False)
    return curve
