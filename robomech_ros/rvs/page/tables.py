"""Texts of the panel: results for the pose, and the table of its postures."""

import html
import math
from collections.abc import Callable, Sequence
from functools import partial

from robomech_ros.kinematics import Status
from robomech_ros.rvs.model.draggable import DraggableRobot
from robomech_ros.rvs.model.ghosts import Rgb
from robomech_ros.rvs.model.postures import Posture
from robomech_ros.rvs.page.units import Units
from robomech_ros.rvs.serving.scripts import script_that_fills
from robomech_ros.spatial import roll_pitch_yaw_from_matrix

# Label of the text field with which a posture is taken; rows of the table write into it.
TAKE = "Take posture"

# Style of texts in folders.
SMALL = "font-size:0.8em;line-height:1.4;padding:0 0.85em 0.4em;font-variant-numeric:tabular-nums"
STYLE = "font-size:0.8em;line-height:1.35;padding:0 0.85em 0.4em;font-variant-numeric:tabular-nums"
WARN = "border-left:3px solid #d9480f;padding-left:0.6em;margin:0.3em 0"
_CLICK = (
    "var r=event.target.closest('tr[data-posture]'),text=r?r.dataset.posture:'';"
    f"{script_that_fills(TAKE)}"
)
_CELL = "padding:0.12em 0.4em;text-align:right"
# Text below the name of a struck-out posture.
_CONTACT = '<div data-contact style="color:#c92a2a;font-size:0.9em">{}</div>'
# From here on a condition number says no more than that the arm is singular.
SINGULAR = 1e6


def summary(arm: DraggableRobot) -> str:
    """Write where the tip is, and what is known of the pose, as HTML."""
    T, study = arm.tip, arm.study
    # Adding 0 makes -0 a plain 0.
    place = " ".join(f"{value:+.4f}" for value in T[:3, 3].round(4) + 0.0)
    rpy = roll_pitch_yaw_from_matrix(T[:3, :3]).round(3) + 0.0
    turn = " ".join(f"{value:+.3f}" for value in rpy)
    lines = [
        f"<div><b>{html.escape(arm.end)}</b> in {html.escape(arm.base)}: "
        f"{place} m, roll pitch yaw {turn} rad</div>"
    ]
    fine = study.postures or study.status is Status.SUCCESS
    style = "" if fine else f' style="{WARN}"'
    lines.append(f"<div{style} data-sentence>{html.escape(study.sentence)}</div>")
    touching = sum(map(bool, arm.posture_contacts))
    if touching:
        lines.append(f"<div>{touching} of them are in contact and struck out.</div>")
    if study.nearest is not None:
        lines.append(
            f"<div>The nearest posture, in grey, misses it by {study.position_error:.4g} m and "
            f"{study.orientation_error:.4g} rad.</div>"
        )
    return f'<div style="{STYLE}">{"".join(lines)}</div>'


def notice(texts: Sequence[str]) -> str:
    """Write what went wrong, as HTML; empty for nothing."""
    lines = "".join(f'<div style="{WARN}">{html.escape(text)}</div>' for text in texts)
    return f'<div style="{STYLE}" data-notice>{lines}</div>' if lines else ""


def small_text(sentences: Sequence[str], *, escaped: bool = False) -> str:
    """Write sentences, one a line, as HTML; ``escaped`` says that they are HTML already."""
    lines = (one if escaped else html.escape(one) for one in sentences)
    return f'<div style="{STYLE}">{"".join(f"<div>{line}</div>" for line in lines)}</div>'


def posture_table(
    postures: Sequence[Posture],
    colours: Sequence[Rgb],
    contacts: Sequence[str],
    joint_units: Sequence[str],
    units: Units,
) -> str:
    """Return the table of the postures as HTML; a click on a row takes its posture.

    - ``contacts``: the contact in each posture, which is then struck out; empty for none.
    """
    if not postures:
        return ""
    # Lengths of different kinds together cannot be written in degrees.
    unit = joint_units[0] if len(set(joint_units)) == 1 else "in rad or m"
    shown = units.name(unit).removeprefix("in ")
    titles = ("", "posture", f"move ({shown})", f"to limit ({shown})", "condition")
    head = "".join(
        f'<th style="{_CELL};font-weight:600{";text-align:left" if k == 1 else ""}">{title}</th>'
        for k, title in enumerate(titles)
    )
    rows = [
        _row(number, *row, partial(units.number, unit=unit, decimals=3))
        for number, row in enumerate(zip(postures, colours, contacts, strict=True), start=1)
    ]
    table = (
        f'<table onclick="{_CLICK}" style="border-collapse:collapse;width:100%">'
        f"<thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"
    )
    return f'<div style="{STYLE}" data-postures>{table}</div>'


def _row(
    number: int, posture: Posture, colour: Rgb, contact: str, write: Callable[[float], str]
) -> str:
    here = posture.is_here
    margin = "none" if math.isinf(posture.margin) else write(posture.margin)
    condition = f"{posture.condition:.1f}" if posture.condition < SINGULAR else "singular"
    swatch = (
        f'<span style="display:inline-block;min-width:1.5em;border-radius:0.7em;color:#fff;'
        f'text-align:center;background:rgb{colour}">{number}</span>'
    )
    name = html.escape(posture.name)
    if contact:
        name = f'<s style="opacity:0.55">{name}</s>{_CONTACT.format(html.escape(contact))}'
    cells = [
        f'<td style="{_CELL}">{swatch}</td>',
        f'<td style="{_CELL};text-align:left">{name}</td>',
        f'<td style="{_CELL}">{"here" if here else write(posture.distance)}</td>',
        f'<td style="{_CELL}">{margin}</td>',
        f'<td style="{_CELL}">{condition}</td>',
    ]
    weight = "600" if here else "400"
    shade = ";color:#868e96" if contact else ""
    return (
        f'<tr data-posture="{number}" title="take this posture" '
        f'style="cursor:pointer;font-weight:{weight}{shade};'
        f'border-top:1px solid rgba(128,128,128,0.25)">'
        f"{''.join(cells)}</tr>"
    )


def short_name(joint: str) -> str:
    """Leave out of the name of a joint what every joint's name has."""
    return joint.removesuffix("_joint").replace("_", " ")


def fact_table(name: str, facts: Sequence[tuple[str, str]]) -> str:
    """Write named facts as HTML; a fact with an empty name stands alone.

    - ``name``: name of the table, its attribute ``data-name``.
    - ``facts``: pairs of a name and its fact, both plain text.
    """
    rows = []
    for what, fact in facts:
        cell = html.escape(fact)
        if what:
            left = f'<td style="padding:0.1em 0.7em 0.1em 0;opacity:0.7">{html.escape(what)}</td>'
            rows.append(f'<tr style="vertical-align:top">{left}<td>{cell}</td></tr>')
        else:
            rows.append(f'<tr><td colspan="2" style="padding:0.2em 0">{cell}</td></tr>')
    table = f'<table style="border-collapse:collapse">{"".join(rows)}</table>'
    return f'<div style="{SMALL}" data-{name}>{table}</div>'
