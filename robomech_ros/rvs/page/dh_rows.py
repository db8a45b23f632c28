"""The Denavit-Hartenberg table of an arm as HTML, with numbers to be typed."""

from __future__ import annotations

import html
from collections.abc import Sequence
from urllib.parse import quote

from robomech_ros.robots import DHTable
from robomech_ros.rvs.page.tables import SMALL
from robomech_ros.rvs.page.units import Units
from robomech_ros.rvs.serving.scripts import script_that_fills

# Label of the text field that a change is written into.
CHANGE = "Change DH"
# Parameters, what they are called, and their units.
_TITLES = (("a", "a", "m"), ("b", "b", "m"), ("alpha", "α", "rad"), ("theta", "θ", "rad"))
_CHANGED = (
    "var t=event.target,text=t.dataset.dh?t.dataset.dh+' '+t.value.trim():'';"
    f"{script_that_fills(CHANGE)}"
)
_CELL = (
    "width:100%;box-sizing:border-box;font:inherit;color:inherit;background:transparent;"
    "border:1px solid rgba(128,128,128,0.45);border-radius:3px;padding:0.1em 0.25em;"
    "text-align:right"
)
# Digits that a field has room for, and what is rounding of 0 (m or rad).
_DIGITS, _NOTHING = 6, 1e-12


def dh_rows(
    table: DHTable,
    names: Sequence[str],
    joint_units: Sequence[str],
    document: str,
    version: int,
    units: Units,
) -> str:
    """Write the table; a number that is typed goes into the text field of changes.

    Parameters
    ----------
    table : DHTable
    names, joint_units : sequence of str
        Of the joints; a joint adds its value to theta where it turns, to b where it slides.
    document : str
        What is saved.
    version : int
        Another number brings back what was typed over.
    units : Units
    """
    head = "".join(f"<th>{title} ({units.name(unit)})</th>" for _, title, unit in _TITLES)
    rows = []
    for k, (name, joint_unit) in enumerate(zip(names, joint_units, strict=True)):
        moved = "b" if joint_unit == "m" else "theta"
        cells = [
            f'<td style="padding:0.05em">{"+" if key == moved else ""}'
            f'<input data-dh="{k + 1} {key}" aria-label="{key} of joint {k + 1}" '
            f'value="{_number(units.factor(unit) * float(getattr(table, key)[k]))}" style="{_CELL}'
            f'{";width:85%" if key == moved else ""}"></td>'
            for key, _, unit in _TITLES
        ]
        rows.append(f'<tr><td title="{html.escape(name)}">{k + 1}</td>{"".join(cells)}</tr>')
    href = "data:text/yaml;charset=utf-8," + quote(document)
    return (
        f'<div style="{SMALL}" data-dh-table="{version}">'
        f'<table onchange="{_CHANGED}" style="border-collapse:collapse;width:100%">'
        f"<thead><tr><th></th>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"
        "<div>Type a number: another robot is shown at once, its bodies generated. A joint adds "
        "its value where + is.</div>"
        f'<a href="{href}" download="dh_table.yaml" style="color:#228be6">Save as YAML</a></div>'
    )


def _number(value: float) -> str:
    """Write a number so short that a field shows all of it."""
    return "0" if abs(value) < _NOTHING else f"{value:.{_DIGITS}g}"
