"""The curves of a motion as a picture in the page: SVG of our own, light or dark like the page."""

import html
from collections.abc import Sequence

import numpy as np

from robomech_ros.rvs.model.ghosts import PALETTE
from robomech_ros.rvs.model.motions.motion_curves import MotionCurves, Quantity
from robomech_ros.rvs.page.tables import STYLE, short_name
from robomech_ros.rvs.page.units import RADIANS, Units
from robomech_ros.typing import Array

# Instead of the name of one quantity.
ALL = "all"
# Size of a picture in its own units, and its height on the page (px), alone and among others.
WIDTH, HEIGHT = 1000, 200
ALONE, AMONG_OTHERS = 170, 92
# A curve has at most so many points.
POINTS = 400
# Limits farther from the curves than this, in parts of their span, are left out; the rest of the
# picture is around them.
FARTHEST, MARGIN = 0.6, 0.06
_FAINT = "opacity:0.7;font-size:0.92em"
_CURSOR = (
    '<div data-cursor style="position:absolute;top:0;bottom:0;width:0;margin-left:-1px;'
    'border-left:2px solid #e8590c;pointer-events:none"></div>'
)


def curves_picture(
    joints: Sequence[str], curves: MotionCurves, shown: str, units: Units = RADIANS
) -> str:
    """Draw curves of a motion as HTML; a cursor is in it, which :func:`cursor_rule` places.

    - ``joints``: their names.
    - ``shown``: the name of a quantity, or ``ALL``.
    """
    chosen = [one for one in curves.quantities if shown in (ALL, one.name)]
    height = AMONG_OTHERS if len({one.name for one in chosen}) > 1 else ALONE
    parts = [_legend(joints)]
    parts += [_panel(one, curves.times, height, units) for one in chosen]
    if chosen:
        parts.append(
            f'<div style="display:flex;justify-content:space-between;{_FAINT}">'
            f"<span>0 s</span><span>{curves.times[-1]:.2f} s</span></div>"
        )
    if shown in (ALL, "torque"):
        parts += [f"<div>{html.escape(sentence)}</div>" for sentence in curves.missing]
    return f'<div style="{STYLE}" data-curves="{html.escape(shown)}">{"".join(parts)}</div>'


def cursor_rule(part: float) -> str:
    """Place the cursors at a part (0 to 1) of the motion's time, as HTML beside the picture.

    A rule of style, so that nothing is drawn anew while the cursor moves.
    """
    return f"<style>[data-cursor]{{left:{100.0 * part:.3f}%}}</style>"


def _legend(joints: Sequence[str]) -> str:
    entries = "".join(
        f'<span style="white-space:nowrap;margin-right:0.9em"><span style="display:inline-block;'
        f'width:1em;border-top:3px solid {_colour(k)};vertical-align:middle;margin-right:0.35em">'
        f"</span>{html.escape(short_name(name))}</span>"
        for k, name in enumerate(joints)
    )
    return f'<div style="line-height:1.5;padding-bottom:0.2em">{entries}</div>'


def _panel(quantity: Quantity, times: Array, height: int, units: Units) -> str:
    low, high, limits = _range(quantity)
    span = max(float(times[-1]), 1e-9)
    chosen = np.unique(np.linspace(0, len(times) - 1, POINTS).astype(np.int64))
    if len(times) <= POINTS:
        chosen = np.arange(len(times))
    x = WIDTH * times[chosen] / span

    def y(values: Array) -> Array:
        return HEIGHT * (high - values) / (high - low)

    lines = [_level(float(y(np.array(0.0))), "currentColor", "", 0.35)] if low < 0 < high else []
    for k, joint in enumerate(quantity.joints):
        colour = _colour(joint)
        for limit in {float(quantity.lower[k]), float(quantity.upper[k])}:
            if low < limit < high:
                lines.append(_level(float(y(np.array(limit))), colour, "7 5", 0.75))
        lines.append(_polyline(x, y(quantity.values[chosen, k]), colour, joint))
    unit, factor = units.name(quantity.unit), units.factor(quantity.unit)
    head = f"<b>{quantity.name}</b> ({html.escape(unit)})"
    return (
        f'<div style="display:flex;justify-content:space-between"><span>{head}</span>'
        f'<span style="{_FAINT}">{factor * low:.3g} to {factor * high:.3g}{limits}</span></div>'
        f'<div style="position:relative;height:{height}px;margin-bottom:0.25em;'
        f'border:1px solid rgba(128,128,128,0.45);border-radius:3px" data-quantity='
        f'"{quantity.name}"><svg viewBox="0 0 {WIDTH} {HEIGHT}" preserveAspectRatio="none" '
        f'style="display:block;width:100%;height:100%">{"".join(lines)}</svg>{_CURSOR}</div>'
    )


def _range(quantity: Quantity) -> tuple[float, float, str]:
    """Return what is drawn, the curves and the limits near them, and what is said of limits."""
    low, high = float(quantity.values.min()), float(quantity.values.max())
    span = max(high - low, 1e-3 * max(abs(low), abs(high)), 1e-6)
    limits = np.concatenate([quantity.lower, quantity.upper])
    limits = limits[np.isfinite(limits)]
    near = limits[(limits > low - FARTHEST * span) & (limits < high + FARTHEST * span)]
    low, high = min([low, *near.tolist()]), max([high, *near.tolist()])
    margin = MARGIN * max(high - low, span)
    drawn = "; limits dashed" if len(near) else ""
    left_out = "; limits outside" if not len(near) else ", some outside"
    return low - margin, high + margin, drawn + (left_out if len(near) < len(limits) else "")


def _polyline(x: Array, y: Array, colour: str, joint: int) -> str:
    points = " ".join(f"{a:.0f},{b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))
    return (
        f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.8" '
        f'stroke-linejoin="round" vector-effect="non-scaling-stroke" data-joint="{joint}"/>'
    )


def _level(y: float, colour: str, dashes: str, opacity: float) -> str:
    return (
        f'<line x1="0" x2="{WIDTH}" y1="{y:.1f}" y2="{y:.1f}" stroke="{colour}" '
        f'stroke-dasharray="{dashes}" opacity="{opacity}" vector-effect="non-scaling-stroke"/>'
    )


def _colour(joint: int) -> str:
    return f"rgb{PALETTE[joint % len(PALETTE)]}"
