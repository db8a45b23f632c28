"""Workspace of an arm: its boundary by a section, and maps of points."""

import html
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.kinetostatics import ReachMap
from robomech_ros.rvs.layers.camera import fit_view
from robomech_ros.rvs.model.curves.curve_problems import pair_of_numbers
from robomech_ros.rvs.model.workspace.reach_points import (
    DENSITIES,
    MEASURES,
    ORIENTATIONS,
    ReachPoints,
    computed_map,
    reach_points,
    scale_colours,
)
from robomech_ros.rvs.model.workspace.section_drawing import draw_section, here_rule
from robomech_ros.rvs.model.workspace.workspace_views import (
    SectionView,
    section_view,
    why_no_section,
)
from robomech_ros.rvs.page.clients import Controls
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.page.tables import SMALL, small_text
from robomech_ros.rvs.page.workspace_nodes import WorkspaceNodes
from robomech_ros.rvs.serving.scripts import script_that_fills
from robomech_ros.rvs.serving.worker import Worker
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array

# Colours of the bar of a legend.
STEPS = 9
# Switches, and their labels.
LABELS = {"boundary": "boundary", "reach_map": "reach map", "cut": "cut open"}
# Switches that surround the robot, and so a camera near it.
AROUND = ("boundary", "reach_map")
# So many joints take any orientation somewhere.
ALL_ORIENTATIONS = 6
# Label of the text field with a point of the section; clicks on the section write into it.
POINT = "Point of section"
_HINT = "Two numbers in m, as 0.5, 0.2; a click on the section writes them. The tip goes there"


@dataclass
class Choices:
    """Map options; the next robot starts with the same."""

    orientations: str = ORIENTATIONS[0]
    density: str = "medium"
    measure: str = MEASURES[0]


class _MapCancelledError(Exception):
    """The computed map is no longer wanted."""


class WorkspaceLayer(Layer):
    """The layer."""

    label, order = "Workspace", 20

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        usual = ORIENTATIONS[context.chain.n < ALL_ORIENTATIONS]
        # The next robot shows the same, but for the map, which is of one robot.
        self._chosen: Choices = context.saved_values.setdefault("map", Choices(orientations=usual))
        self._on: dict[str, bool] = context.saved_values.setdefault(
            "workspace", {"boundary": False, "reach_map": False, "cut": True}
        )
        # A map may take minutes, in which the boundary is not to wait.
        self._mapper = Worker()
        self._nodes = WorkspaceNodes(context.space, self._clicked)
        self._view: SectionView | None = None
        self._refused, self._asked = "", False
        self._map: ReachMap | None = None
        self._said = ""
        self._shown: ReachPoints | None = None
        # The map that is wanted, counted from 1; one that is computed for another is left off.
        self._wanted, self._running = 0, False
        self._drawn: dict[str, Any] = {}
        self._client: Any = None
        # Whether the eye is to move back, as soon as what was switched on is drawn around it.
        self._around_eye = False
        context.extents["workspace"] = self._extent
        self._switches = Switches(context, LABELS, self._on, self._switched)

    # Calls of the page.

    def show(self) -> None:
        """Follow the arm."""
        if self._on["boundary"] and not self._asked:
            self._asked = True
            self.find("section", self._found, self._know)
        self._show_boundary()
        self._show_points()
        self._write()
        if self._around_eye and self.is_open and len(self._nodes.extent):
            self._around_eye = False
            fit_view(self._context, self._client)

    def controls(self, client: Any) -> Controls:
        """Add the folder "Workspace" to a browser."""
        self._client, self._around_eye = client, False
        self._drawn.pop("plot", None)
        return super().controls(client)

    def _fill(self, folder: Folder, gui: Any) -> None:
        hint = "Where the number of postures changes, as a section and as a surface"
        self._switches.add_to(folder, "boundary", hint)
        self._plot, self._ring = folder.text(), folder.text()
        self._point = folder.listen(gui.add_text(POINT, "", hint=_HINT), self._typed)
        self._text = folder.text()
        hint = "What the tip reaches, at points of a grid; a click on a point takes it there"
        self._switches.add_to(folder, "reach_map", hint)
        choices = {
            "orientations": ("orientations", ORIENTATIONS),
            "points": ("density", tuple(DENSITIES)),
            "coloured by": ("measure", MEASURES),
        }
        self._choices = []
        for label, (name, values) in choices.items():
            choose = partial(setattr, self._chosen, name)
            choice = folder.dropdown(label, values, getattr(self._chosen, name), choose)
            self._choices.append(choice)
        self._compute = folder.button("Compute the map", self._begin_map)
        self._cancel = folder.button("Cancel", self._cancel_map)
        self._legend = folder.text()
        self._switches.add_to(folder, "cut", "Leave a sector open, so that one sees inside")
        self._see = folder.button("See all of it", partial(fit_view, self._context, self._client))

    def close(self) -> None:
        """Stop what runs."""
        self._wanted += 1
        self._mapper.close(wait=False)
        super().close()

    # Requests of browsers.

    def _switched(self, name: str, asked: bool) -> None:
        self._around_eye |= asked and self._on[name] and name in AROUND
        if not self._on["reach_map"]:
            self._leave_off()

    def _typed(self, text: Any) -> None:
        if str(text).strip():
            self.ask("point", self._go_to_section, text)

    def _go_to_section(self, text: Any) -> None:
        if self._view is None:
            raise BadValueError(POINT, text, "nothing: there is no section")
        self._context.arm.drag(self._view.target(_pair(text), self._context.arm.tip))

    def _clicked(self, client: Any, point: Array) -> None:
        """Take a point of the map as the tip's target, with the present orientation."""
        if self.is_open and client.client_id == self._client.client_id:
            self.ask("point", self._go_to_point, point)

    def _go_to_point(self, point: Array) -> None:
        arm = self._context.arm
        arm.drag(assembled(arm.tip[:3, :3], point))

    def _begin_map(self) -> None:
        if not self._on["reach_map"]:
            raise RobomechError("Turn on the reach map before computing it.")
        self._leave_off()
        chosen, T, wanted = self._chosen, self._context.arm.tip, self._wanted
        how = (chosen.orientations, chosen.density)
        self._running, self._said = True, "Beginning ..."
        self._around_eye = True
        self._mapper.submit("map", lambda: self._compute_map(how, T, wanted))

    def _cancel_map(self) -> None:
        if self._running:
            self._leave_off()
            self._said = "Cancelled."

    def _extent(self) -> Array:
        """Return points (k, 3) in the root around what is shown (m)."""
        T = self._context.seen.tree.link_poses()[self._context.chain.base]
        return self._nodes.extent @ T[:3, :3].T + T[:3, 3]

    def _leave_off(self) -> None:
        self._wanted += 1
        if self._running:
            self._running, self._said = False, ""

    # Slow work, on threads of this layer.

    def _found(self) -> tuple[SectionView | None, str]:
        try:
            return section_view(self._context.chain), ""
        except RobomechError as error:
            return None, why_no_section(self._context.chain, error)

    def _know(self, found: tuple[SectionView | None, str]) -> None:
        self._view, self._refused = found

    def _compute_map(self, chosen: tuple[str, str], T: Array, wanted: int) -> None:
        def progress(done: int, total: int) -> None:
            if wanted != self._wanted:
                raise _MapCancelledError
            self._report(wanted, f"{done} of {total} points ...", True)

        try:
            found = computed_map(self._context.chain, *chosen, T, progress)
        except _MapCancelledError:
            return
        except RobomechError as error:
            self._report(wanted, f"No map: {error}", False)
            return
        self._report(wanted, "", False, found)

    def _report(self, *progress: Any) -> None:
        self.ask("progress", self._show_progress, *progress)

    def _show_progress(
        self, wanted: int, text: str, running: bool, found: ReachMap | None = None
    ) -> None:
        if wanted == self._wanted:
            self._said, self._running = text, running
            self._map = found or self._map

    # Drawing, on the thread of the page.

    def _show_boundary(self) -> None:
        view = self._view
        if view is None or not self._on["boundary"]:
            if self._drawn.pop("boundary", None) is not None:
                self._nodes.hide_boundary()
            return
        if self._drawn.get("boundary") != self._on["cut"]:
            self._drawn["boundary"] = self._on["cut"]
            self._nodes.show_boundary(view, cut=self._on["cut"])
        self._nodes.place_section(view.plane(self._context.arm.tip))

    def _show_points(self) -> None:
        found, measure = self._map, self._chosen.measure
        if found is None or not self._on["reach_map"]:
            if self._drawn.pop("points", None) is not None:
                self._nodes.hide_points()
                self._shown = None
            return
        wanted = (found, measure, self._on["cut"])
        if self._drawn.get("points") != wanted:
            self._drawn["points"] = wanted
            shown = reach_points(found, measure, cut=self._on["cut"])
            self._nodes.show_points(shown)
            self._shown = shown

    def _write(self) -> None:
        if not self.is_open:
            return
        view, on = self._view, self._on
        section = view if on["boundary"] else None
        if self._drawn.get("plot", self) is not section:
            self._drawn["plot"] = section
            fill = script_that_fills(POINT)
            self._plot.content = "" if section is None else draw_section(section, fill)
        self._ring.content = (
            ""
            if section is None
            else here_rule(section, section.coordinates(self._context.arm.tip))
        )
        self._point.visible = section is not None
        self._text.content = ""
        if on["boundary"]:
            self._text.content = section_text(section, self._refused)
        for handle in (*self._choices, self._compute):
            handle.visible = on["reach_map"]
        self._see.visible = bool(len(self._nodes.extent))
        self._cancel.visible = self._running
        self._legend.content = self._map_text() if on["reach_map"] else ""

    def _map_text(self) -> str:
        parts = [small_text([self._said])] if self._said else []
        if self._shown is not None and self._map is not None:
            parts.append(map_legend(self._map, self._shown, self._chosen.measure))
        return "".join(parts)


def _pair(text: Any) -> Array:
    expected = "two numbers in m, as 0.5, 0.2"
    pair = np.array(pair_of_numbers(POINT, text, expected))
    if not (np.abs(pair) <= 1e6).all():
        raise BadValueError(POINT, text, expected)
    return pair


def section_text(view: SectionView | None, refused: str) -> str:
    """Write what the section shows, or why there is none, as HTML."""
    if refused:
        return small_text([refused, "The reach map shows what this arm reaches."])
    if view is None:
        return small_text(["Looking for the boundary ..."])
    space, wrist = view.space, bool((abs(view.in_tip) > 1e-9).any())
    what = "the centre of the wrist" if wrist else "the tip"
    joints = "the first three joints, joint 1 being free"
    if space.section.flat:
        joints = "the arm"
    if space.tip is not None:
        joints += "; each stands for a continuum"
    lines = [
        f"Postures of {joints}, at each place of {what} "
        f"{'in its plane' if space.section.flat else 'in the half-plane that it is in'}.",
        f"Reach of it: {space.least_reach:.3f} to {space.greatest_reach:.3f} m from joint 1.",
        "A click brings it there, with the present orientation. The postures listed are those of "
        "the whole arm, inside all its limits.",
    ]
    return small_text(lines, escaped=True).replace("<div ", "<div data-workspace ", 1)


def map_legend(found: ReachMap, shown: ReachPoints, measure: str) -> str:
    """Write what the colours of a map are, as HTML."""
    parts = [k / (STEPS - 1) for k in range(STEPS)]
    colours = ", ".join(f"rgb({r},{g},{b})" for r, g, b in scale_colours(parts).tolist())
    unit = f" {shown.unit}" if shown.unit == "%" else ""
    tried = len(found.request.orientations)
    of = f"{tried} orientations" if tried > 1 else "one orientation"
    title = measure if unit else f"{measure}, of {of} together"
    reached = int((found.reached > 0).sum())
    return (
        f'<div style="{SMALL}" data-reach-map><div>{html.escape(title)}</div>'
        f'<div style="height:0.8em;border-radius:2px;background:linear-gradient(90deg, {colours})">'
        '</div><div style="display:flex;justify-content:space-between">'
        f"<span>{shown.low:g}{unit}</span><span>{shown.high:g}{unit}</span></div>"
        f"<div>{reached} of {found.grid.cells} points reached by the tip, with {of} tried at each. "
        "A click on a point brings the tip there, with the present orientation.</div></div>"
    )
