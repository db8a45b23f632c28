"""The Denavit-Hartenberg table of the arm, of which numbers are changed, and its frames."""

from __future__ import annotations

import html
from collections.abc import Sequence
from typing import Any
from urllib.parse import quote

from robomech_ros.errors import BadValueError
from robomech_ros.robots import DHTable
from robomech_ros.rvs.model.arms.dh_editing import (
    ANGLES,
    changed_robot,
    read_change,
    table_of,
    yaml_of,
)
from robomech_ros.rvs.model.arms.dh_frames import dh_frames
from robomech_ros.rvs.page.dh_frame_nodes import DHFrameNodes
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.page.tables import SMALL
from robomech_ros.rvs.page.units import Units
from robomech_ros.rvs.serving.scripts import script_that_fills

# Label of the text field that a change is written into.
CHANGE = "Change DH"
# Label of the switch that shows the frames of the table in the scene.
FRAMES = "DH frames"
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
_DIGITS, _ROUNDING = 6, 1e-12
NO_TABLE = "No table: joints of this arm follow others (mimic)."


def dh_rows(
    table: DHTable,
    names: Sequence[str],
    joint_units: Sequence[str],
    document: str,
    version: int,
    units: Units,
) -> str:
    """Write the table; a number that is typed goes into the text field of changes.

    - ``names``: names of the joints.
    - ``joint_units``: units of the joints: the value of a joint in rad adds to theta, in m to b.
    - ``document``: the text that is saved.
    - ``version``: a new number restores the numbers that were typed over.
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
    return "0" if abs(value) < _ROUNDING else f"{value:.{_DIGITS}g}"


class DHTableLayer(Layer):
    """The layer."""

    label, order = "DH table", 15

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        # The robot that the page began with, and whether another one came from here.
        first = {"open": False, "on": {"frames": False}}
        self._saved = context.saved_values.setdefault("dh table", first)
        self.expanded = self._saved["open"]
        self._saved.setdefault("first", (context.description, context.chain))
        # The layer of the robot that this one was changed into, and whether it is gone.
        self._heir: DHTableLayer | None = None
        self._closed = False
        self._saved["layer"] = self
        self._version, self._typed, self._degrees, self._faded = 0, False, False, False
        self._known = None if context.chain.coupling is not None else table_of(context.chain)
        self._nodes = DHFrameNodes(context.space)
        if self._known is not None:
            self._switches = Switches(context, {"frames": FRAMES}, self._saved["on"])

    def show(self) -> None:
        """Bring back the numbers that were typed over and refused, and let the frames follow."""
        if self._known is not None:
            on, reach = self._switches["frames"], self._context.seen.reach
            if on != self._faded:
                self._faded = on
                self._context.fade(on)
            self._nodes.show(dh_frames(self._known, self._context.arm.q, reach) if on else None)
        if self._typed or self._degrees != self._context.units.degrees:
            self._typed = False
            self._version += 1
            self._write()

    def _fill(self, folder: Folder, gui: Any) -> None:
        self._table = folder.text()
        if self._known is None:
            self._table.content = NO_TABLE
            return
        hint = "Frames, joint axes, offsets b and common normals a of the table, in the scene"
        self._switches.add_to(folder, "frames", hint)
        hint = "Joint, parameter and number, as in: 2 a 0.5; a number typed above does it, too"
        folder.listen(gui.add_text(CHANGE, "", hint=hint), self._change)
        hint = "Back to the robot that the page began with"
        folder.button("Reset robot", lambda: self._replace(*self._saved["first"]), hint)
        self._write()

    def close(self) -> None:
        """Refuse what comes later."""
        self._closed = True

    def _write(self) -> None:
        chain = self._context.chain
        if not self.is_open or self._known is None:
            return
        table, units = self._known, self._context.units
        self._degrees = units.degrees
        document = yaml_of(chain, table)
        self._table.content = dh_rows(
            table, chain.joint_names, chain.units, document, self._version, units
        )

    def _change(self, text: str) -> None:
        def change() -> None:
            # Numbers that came before this robot was changed are numbers of the changed one.
            layer = self
            while layer._heir is not None:
                layer = layer._heir
            if not layer._closed:
                layer._take(text)

        if text.strip():
            self._context.ask(("dh table", self._cell(text)), change)

    def _cell(self, text: str) -> tuple[int, str] | None:
        """Return which number is changed: those of different cells do not displace each other."""
        try:
            return read_change(text, self._context.chain.n)[:2]
        except BadValueError:
            return None

    def _take(self, text: str) -> None:
        self._typed = True
        chain = self._context.chain
        change = read_change(text, chain.n)
        if change.parameter in ANGLES:
            change = change._replace(value=change.value / self._context.units.factor("rad"))
        self._replace(*changed_robot(chain, change))

    def _replace(self, *robot: Any) -> None:
        before = self._saved["open"]
        self._saved["open"] = True
        try:
            self._context.replace(*robot)
        except BaseException:
            self._saved["open"] = before
            raise
        self._heir = self._saved["layer"]
