"""The section of a workspace as SVG, with regions coloured by their number of postures."""

import numpy as np

from robomech_ros.errors.formatting import counted
from robomech_ros.rvs.model.curves.curve_drawing import (
    SIDE,
    curve_line,
    draw_plane,
    part_of_width,
    place_script,
    placed_points,
)
from robomech_ros.rvs.model.workspace.workspace_views import SectionView
from robomech_ros.typing import Array

# Colours of one posture, two, three, four, and more, for light and dark backgrounds.
COLOURS = ("#8ecae6", "#2a9d8f", "#e9c46a", "#f4853a", "#9d4edd")
_HERE = (
    '<circle data-workspace-here r="6" fill="none" stroke="#d6336c" stroke-width="2" '
    'pointer-events="none"/>'
)
_WIDTHS = {"outer": 1.8, "inner": 1.8, "interior": 0.8}
_SWATCH = (
    '<div style="white-space:nowrap"><span style="display:inline-block;'
    "width:0.9em;height:0.9em;box-sizing:border-box;vertical-align:-0.1em;margin-right:0.35em;"
    '{style}">'
    "</span>{text}</div>"
)


def colour_of_count(count: int) -> str:
    """Return the colour of a number of postures, from 1."""
    return COLOURS[min(count, len(COLOURS)) - 1]


def draw_section(view: SectionView, on_press: str = "") -> str:
    """Draw a section to scale, as SVG, with its legend at the side, or below a wide one.

    :func:`here_rule` places the ring in it.

    - ``on_press``: JavaScript that runs when the drawing is pressed, with ``text`` of the place.
    """
    side = _side(view)
    regions = "".join(
        f'<path data-count="{count}" d="{_squares(view, count)}" '
        f'fill="{colour_of_count(count)}" shape-rendering="crispEdges"/>'
        for count in range(1, int(view.counts.max()) + 1)
    )
    curves = "".join(
        f'<path data-role="{curve.role}" d="{curve_line(view.axes, [curve.points], side)}" '
        f'fill="none" stroke="currentColor" stroke-width="{_WIDTHS[curve.role]}" '
        'stroke-linejoin="round"/>'
        for curve in view.space.curves
    )
    script = place_script(view.axes, side) + on_press
    picture = draw_plane("section", view.axes, regions + curves, _HERE, script, side)
    return (
        '<div style="display:flex;flex-wrap:wrap;align-items:center;gap:0.2em 0.8em">'
        f'<div style="flex:0 0 {100.0 * part_of_width(side):.1f}%">{picture}</div>'
        f'<div style="font-size:0.8em;line-height:1.6">{section_legend(view)}</div></div>'
    )


def here_rule(view: SectionView, coordinates: Array) -> str:
    """Place the ring at coordinates (2,) (m), as HTML beside the picture."""
    x, y = section_points(view, coordinates).tolist()
    return f"<style>[data-workspace-here]{{transform:translate({x:.2f}px,{y:.2f}px)}}</style>"


def section_points(view: SectionView, coordinates: Array) -> Array:
    """Convert coordinates (..., 2) (m) to the picture."""
    return placed_points(view.axes, coordinates, _side(view))


def _side(view: SectionView) -> float:
    x, y = view.axes
    return SIDE * (x.high - x.low) / (y.high - y.low)


def section_legend(view: SectionView) -> str:
    """Return the legend of the colours, as HTML."""
    entries = []
    for count in np.unique(view.counts[view.counts > 0]).tolist():
        text = counted(count, "posture")
        entries.append(_SWATCH.format(style=f"background:{colour_of_count(count)}", text=text))
    ring = "border:2px solid #d6336c;border-radius:50%"
    return "".join([*entries, _SWATCH.format(style=ring, text="where it is now")])


def _squares(view: SectionView, count: int) -> str:
    """Return the squares with a number of postures as the ``d`` of a path, columns joined."""
    (x, y), text = view.edges, []
    for column, counts in enumerate(view.counts):
        same = np.concatenate([[False], counts == count, [False]])
        changes = np.flatnonzero(same[1:] != same[:-1])
        for first, last in changes.reshape(-1, 2).tolist():
            corners = np.array([[x[column], y[first]], [x[column + 1], y[last]]])
            (left, low), (right, high) = section_points(view, corners).tolist()
            text.append(f"M{left:.1f} {low:.1f}V{high:.1f}H{right:.1f}V{low:.1f}z")
    return "".join(text)
