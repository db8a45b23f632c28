"""The section of a workspace as SVG, with regions coloured by their number of postures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robomech_ros.rvs.model.curve_drawing import (
    curve_line,
    draw_plane,
    place_script,
    placed_points,
)
from robomech_ros.rvs.model.workspace_views import SectionView

__all__ = ["colour_of_count", "draw_section", "here_rule", "section_legend"]

Array = NDArray[np.float64]

# Of one posture, two, three, four, and more; told apart on light and dark ground.
COLOURS = ("#8ecae6", "#2a9d8f", "#e9c46a", "#f4853a", "#9d4edd")
_HERE = (
    '<circle data-workspace-here r="6" fill="none" stroke="#d6336c" stroke-width="2" '
    'pointer-events="none"/>'
)
_WIDTHS = {"outer": 1.8, "inner": 1.8, "interior": 0.8}
_SWATCH = (
    '<span style="white-space:nowrap;margin-right:0.9em"><span style="display:inline-block;'
    'width:0.9em;height:0.9em;background:{colour};vertical-align:-0.1em;margin-right:0.35em">'
    "</span>{text}</span>"
)


def colour_of_count(count: int) -> str:
    """Give the colour of a number of postures, from 1."""
    return COLOURS[min(count, len(COLOURS)) - 1]


def draw_section(view: SectionView, on_press: str = "") -> str:
    """Draw a section as SVG; a ring is in it, which :func:`here_rule` places.

    Parameters
    ----------
    view : SectionView
    on_press : str, optional
        JavaScript that runs when the drawing is pressed, with ``text`` of the place.
    """
    regions = "".join(
        f'<path data-count="{count}" d="{_squares(view, count)}" '
        f'fill="{colour_of_count(count)}" shape-rendering="crispEdges"/>'
        for count in range(1, int(view.counts.max()) + 1)
    )
    curves = "".join(
        f'<path data-role="{curve.role}" d="{curve_line(view.axes, [curve.points])}" fill="none" '
        f'stroke="currentColor" stroke-width="{_WIDTHS[curve.role]}" stroke-linejoin="round"/>'
        for curve in view.space.curves
    )
    script = place_script(view.axes) + on_press
    return draw_plane("section", view.axes, regions + curves, _HERE, script)


def here_rule(view: SectionView, coordinates: Array) -> str:
    """Place the ring at coordinates (2,) (m), as HTML beside the picture."""
    x, y = placed_points(view.axes, coordinates).tolist()
    return f"<style>[data-workspace-here]{{transform:translate({x:.2f}px,{y:.2f}px)}}</style>"


def section_legend(view: SectionView) -> str:
    """Write what the colours are, as HTML."""
    entries = []
    for count in np.unique(view.counts[view.counts > 0]).tolist():
        text = f"{count} posture{'s' if count > 1 else ''}"
        entries.append(_SWATCH.format(colour=colour_of_count(count), text=text))
    return "".join(entries)


def _squares(view: SectionView, count: int) -> str:
    """Give the squares with a number of postures as the ``d`` of a path, columns of them as one."""
    (x, y), text = view.edges, []
    for column, counts in enumerate(view.counts):
        same = np.concatenate([[False], counts == count, [False]])
        changes = np.flatnonzero(same[1:] != same[:-1])
        for first, last in changes.reshape(-1, 2).tolist():
            corners = np.array([[x[column], y[first]], [x[column + 1], y[last]]])
            (left, low), (right, high) = placed_points(view.axes, corners).tolist()
            text.append(f"M{left:.1f} {low:.1f}V{high:.1f}H{right:.1f}V{low:.1f}z")
    return "".join(text)
