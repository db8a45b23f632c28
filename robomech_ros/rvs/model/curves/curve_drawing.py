"""Crossing curves as SVG: axes with ticks, curves, marks, and the steps of an iteration."""

import html
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robomech_ros.rvs.model.curves.curve_problems import Axis
from robomech_ros.typing import Array

# Colours of the two curves and of the steps, for light and dark backgrounds.
COLOURS = ("#2f7fd1", "#e07b1a")
STEPS, ROOT = "#d6336c", "rgb(47,158,68)"
# The picture, and the rectangle in it that shows the plane: its left and lower edges, its width and
# height, and margin on its right.
HEIGHT = 352.0
LEFT, BOTTOM, SIDE, TOP, RIGHT = 46.0, 312.0, 306.0, 304.0, 8.0
# Least distance of drawn points of a curve.
FINE = 0.6
TICK = 4.0
MOST_TICKS = 6


class Mark(NamedTuple):
    """Mark at a point: a crossing, or the present state."""

    #: One of "root", "spurious", "here".
    kind: str
    #: Position in the plane, shape (2,).
    point: Array
    #: Text in the disc of a root.
    text: str = ""
    #: Colour of a root's disc.
    colour: str = ROOT


def draw_curves(
    axes: tuple[Axis, Axis],
    curves: Sequence[Sequence[Array]],
    marks: Sequence[Mark] = (),
    path: Array | None = None,
    on_press: str = "",
) -> str:
    """Draw two curves as SVG of the full width.

    - ``curves``: pieces of each curve, shape (k, 2).
    - ``path``: steps of an iteration, the estimate first, shape (k, 2).
    - ``on_press``: JavaScript that runs when the drawing is pressed: it may be drawn anew before a
      click ends.
    """
    lines = "".join(
        f'<path data-curve="{number}" d="{curve_line(axes, pieces)}" fill="none" '
        f'stroke="{colour}" stroke-width="1.4" stroke-linejoin="round"/>'
        for number, (pieces, colour) in enumerate(zip(curves, COLOURS, strict=True), start=1)
    )
    inside = lines + _steps(axes, path)
    return draw_plane("plot", axes, inside, "".join(_mark(axes, mark) for mark in marks), on_press)


def draw_plane(
    name: str,
    axes: tuple[Axis, Axis],
    inside: str,
    above: str = "",
    on_press: str = "",
    side: float = SIDE,
) -> str:
    """Draw axes as SVG of the full width.

    - ``name``: name of the drawing, its attribute ``data-name``.
    - ``inside``, ``above``: SVG in the plane, cut off at its edges, and above it; see
      :func:`placed_points`.
    - ``on_press``: JavaScript that runs when the drawing is pressed.
    - ``side``: width of the plane in the picture, here and in all other functions that have it.
    """
    frame = f'x="{LEFT}" y="{BOTTOM - TOP}" width="{side:.2f}" height="{TOP}"'
    return (
        f'<svg data-{name} viewBox="0 0 {LEFT + side + RIGHT:.2f} {HEIGHT:g}" '
        f'onpointerdown="{html.escape(on_press)}" '
        'style="display:block;width:100%;max-height:80vh;cursor:crosshair;font-size:10.5px" '
        'fill="currentColor" role="img">'
        f'<clipPath id="{name}-plane"><rect {frame}/></clipPath>'
        f'<rect data-plane {frame} fill="currentColor" fill-opacity="0.04" stroke="currentColor" '
        f'stroke-opacity="0.5"/>{_across(axes[0], side)}{_up(axes[1])}'
        f'<g clip-path="url(#{name}-plane)">{inside}</g>{above}</svg>'
    )


def part_of_width(side: float) -> float:
    """Return the width of a drawing as a fraction of the widest one."""
    return (LEFT + side + RIGHT) / (LEFT + SIDE + RIGHT)


def place_script(axes: tuple[Axis, Axis], side: float = SIDE) -> str:
    """Return JavaScript that sets ``text`` to the clicked coordinates; empty outside."""
    (_, _, x, right), (_, _, y, top) = axes
    return (
        "var p=new DOMPoint(event.clientX,event.clientY)"
        ".matrixTransform(this.getScreenCTM().inverse()),"
        f"u=(p.x-{LEFT})/{side!r},v=({BOTTOM}-p.y)/{TOP},"
        "text=u<0||u>1||v<0||v>1?'':"
        f"({x!r}+u*({right - x!r})).toPrecision(9)+', '+({y!r}+v*({top - y!r})).toPrecision(9);"
    )


def placed_points(axes: tuple[Axis, Axis], points: Array, side: float = SIDE) -> Array:
    """Return points (k, 2) of the plane in the picture."""
    low = np.array([axis.low for axis in axes])
    width = np.array([axis.high - axis.low for axis in axes])
    parts = (np.asarray(points, float) - low) / width
    return np.stack([LEFT + side * parts[..., 0], BOTTOM - TOP * parts[..., 1]], axis=-1)


def curve_line(axes: tuple[Axis, Axis], pieces: Sequence[Array], side: float = SIDE) -> str:
    """Return the pieces (k, 2) of a curve in the picture, as the ``d`` of a path."""
    text = []
    for piece in pieces:
        points = thinned(placed_points(axes, piece, side), FINE)
        text.append("M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points.tolist()))
    return "".join(text)


def thinned(points: Array, spacing: float) -> Array:
    """Thin the points of a line to a spacing, with its ends."""
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    kept = np.diff(np.floor(lengths / spacing), prepend=-1.0) > 0.0
    kept[-1] = True
    return points[kept]


def _steps(axes: tuple[Axis, Axis], path: Array | None) -> str:
    if path is None or not len(path):
        return ""
    points = placed_points(axes, path).tolist()
    line = "L".join(f"{x:.2f} {y:.2f}" for x, y in points)
    dots = "".join(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="2"/>' for x, y in points[1:])
    x, y = points[0]
    cross = f"M{x - 5:.2f} {y:.2f}h10M{x:.2f} {y - 5:.2f}v10"
    return (
        f'<g data-steps="{len(points) - 1}" stroke="{STEPS}" fill="{STEPS}">'
        f'<path d="M{line}" fill="none" stroke-width="1.2"/>'
        f'<path d="{cross}" stroke-width="1.6"/>{dots}</g>'
    )


def _mark(axes: tuple[Axis, Axis], mark: Mark) -> str:
    x, y = placed_points(axes, mark.point).tolist()
    at = f'cx="{x:.2f}" cy="{y:.2f}"'
    what = f'data-mark="{mark.kind}"'
    if mark.kind == "spurious":
        return (
            f'<path {what} d="M{x:.2f} {y - 4.5:.2f}l4.5 4.5l-4.5 4.5l-4.5-4.5z" '
            'fill="none" stroke="currentColor" stroke-opacity="0.75"/>'
        )
    if mark.kind == "here":
        return f'<circle {what} {at} r="9.5" fill="none" stroke="{STEPS}" stroke-width="1.8"/>'
    disc = f'<circle {what} {at} r="{6.5 if mark.text else 4.0}" fill="{mark.colour}"/>'
    if not mark.text:
        return disc
    return (
        f'{disc}<text x="{x:.2f}" y="{y + 3.2:.2f}" text-anchor="middle" fill="#fff" '
        f'font-size="9" font-weight="600" pointer-events="none">{html.escape(mark.text)}</text>'
    )


def _across(axis: Axis, side: float) -> str:
    text = []
    for value, label in _ticks(axis, MOST_TICKS * side / SIDE):
        x = LEFT + side * (value - axis.low) / (axis.high - axis.low)
        text.append(_tick_line(f"M{x:.1f} {BOTTOM}v{TICK}"))
        text.append(_words(label, f'x="{x:.1f}" y="{BOTTOM + 15:g}"'))
    return "".join([*text, _words(_title(axis), f'x="{LEFT + 0.5 * side:g}" y="{HEIGHT - 6:g}"')])


def _up(axis: Axis) -> str:
    text = []
    for value, label in _ticks(axis):
        y = BOTTOM - TOP * (value - axis.low) / (axis.high - axis.low)
        text.append(_tick_line(f"M{LEFT} {y:.1f}h{-TICK}"))
        text.append(_words(label, f'x="{LEFT - 7:g}" y="{y + 3.5:.1f}"', "end"))
    position = f'transform="translate(11 {BOTTOM - 0.5 * TOP:g}) rotate(-90)"'
    return "".join([*text, _words(_title(axis), position)])


def _words(text: str, position: str, anchor: str = "middle") -> str:
    return f'<text {position} text-anchor="{anchor}">{html.escape(text)}</text>'


def _tick_line(d: str) -> str:
    return f'<path d="{d}" stroke="currentColor" stroke-opacity="0.6"/>'


def _title(axis: Axis) -> str:
    return f"{axis.name} ({axis.unit})" if axis.unit else axis.name


def _ticks(axis: Axis, most: float = MOST_TICKS) -> list[tuple[float, str]]:
    """Return the positions and labels of an axis's ticks."""
    width = axis.high - axis.low
    if axis.unit == "rad" and math.isclose(width, 2.0 * math.pi):
        # An angle: multiples of half pi.
        first = math.ceil(axis.low / (0.5 * math.pi) - 1e-9)
        last = math.floor(axis.high / (0.5 * math.pi) + 1e-9)
        return [(0.5 * math.pi * k, _of_pi(k)) for k in range(first, last + 1)]
    least = width / most
    power = 10.0 ** math.floor(math.log10(least))
    step = next(power * k for k in (1.0, 2.0, 5.0, 10.0) if power * k >= least)
    first, last = math.ceil(axis.low / step - 1e-9), math.floor(axis.high / step + 1e-9)
    return [
        (step * k, f"{step * k:.6g}".replace("-", "\N{MINUS SIGN}")) for k in range(first, last + 1)
    ]


def _of_pi(halves: int) -> str:
    if halves == 0:
        return "0"
    sign = "\N{MINUS SIGN}" if halves < 0 else ""
    count, odd = abs(halves), abs(halves) % 2
    number = count if odd else count // 2
    return f"{sign}{'' if number == 1 else number}π{'/2' if odd else ''}"
