"""Capabilities of an arm: key figures, ellipsoids of velocity and force, and lost motions."""

import math
from functools import partial
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.errors.formatting import counted
from robomech_ros.rvs.model.arms.analysis import (
    ROWS,
    ArmFacts,
    DrawnEllipsoid,
    NextSingularity,
    PostureFacts,
    arm_facts,
    drawn_ellipsoid,
    next_singularity,
    posture_facts,
    twist_arrows,
)
from robomech_ros.rvs.model.bodies.solids import sphere
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.mesh_nodes import add_mesh
from robomech_ros.rvs.page.node_space import place_node
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.page.twist_nodes import TwistNodes

COLOURS = {"velocity": (40, 125, 230), "force": (235, 130, 30)}
OPACITY = 0.4
# Label of the choice between ellipsoids of motions and of rotations.
PART = "ellipsoids of"
# Switches, and their labels.
LABELS = {
    "numbers": "numbers",
    "velocity": "velocity ellipsoid",
    "force": "force ellipsoid",
    "lost": "lost directions",
}
LOST, WEAKEST = ((225, 40, 45), (190, 50, 190)), ((235, 165, 60), (190, 140, 220))


class AnalysisLayer(Layer):
    """The layer."""

    label, order = "Understand", 10

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        # The next robot shows the same.
        first = {"on": dict.fromkeys(LABELS, False), "part": "translation"}
        self._saved: dict[str, Any] = context.saved_values.setdefault("understand", first)
        self._switches = Switches(context, LABELS, self._saved["on"])
        self._facts: ArmFacts | None = None
        self._next: NextSingularity | None = None
        self._asked_for_facts, self._goes = False, False
        self._asked_at: Any = None
        self._nodes: dict[str, Any] = {}
        self._arrows = TwistNodes(context.space, "lost")

    def show(self) -> None:
        """Follow the arm."""
        q = self._context.arm.q
        found = {kind: self._show_ellipsoid(kind) for kind in COLOURS}
        judged = None
        if self._judges:
            self._find_facts()
        if self._judges and self._facts is not None:
            length = self._facts.length
            judged = posture_facts(self._context.chain, q, length)
            if self._switches["numbers"] and not np.array_equal(q, self._asked_at):
                self._asked_at = q
                search = partial(next_singularity, self._context.chain, q, length)
                self.find("next", search, partial(setattr, self, "_next"))
        self._show_arrows(judged if self._switches["lost"] else None)
        self.write("understand", self._lines(judged, found))

    def _fill(self, folder: Folder, gui: Any) -> None:
        self._table = folder.text()
        for name in LABELS:
            self._switches.add_to(folder, name)
            if name == "force":
                choose = partial(self._saved.__setitem__, "part")
                folder.dropdown(PART, tuple(ROWS), self._saved["part"], choose)
        folder.button("Go to the least condition number", self._go)

    @property
    def _judges(self) -> bool:
        """True if the posture is judged, which needs the characteristic length."""
        return self._switches["numbers"] or self._switches["lost"]

    def _find_facts(self) -> None:
        if not self._asked_for_facts:
            self._asked_for_facts = True
            self.find("facts", partial(arm_facts, self._context.chain), self._know_facts)

    def _know_facts(self, facts: ArmFacts) -> None:
        self._facts = facts
        if self._goes:
            self._go()

    def _go(self) -> None:
        facts, self._goes = self._facts, self._facts is None
        if facts is None:
            self._find_facts()
            return
        if facts.best is None:
            expected = "one that is regular in some posture"
            raise BadValueError("arm", self._context.chain.name, expected)
        self._context.arm.move_to(facts.best.q)

    def _show_ellipsoid(self, kind: str) -> DrawnEllipsoid | None:
        wanted, node = self._switches[kind], self._nodes.get(kind)
        if node is not None:
            node.visible = wanted
        if not wanted:
            return None
        arm, reach = self._context.arm, self._context.seen.reach
        drawn = drawn_ellipsoid(arm.chain, arm.q, kind, self._saved["part"], reach)
        if node is None:
            scene, name = self._context.server.scene, f"{self._context.base}/{kind}_ellipsoid"
            node = add_mesh(scene, name, sphere(1.0), COLOURS[kind], OPACITY)
            self._nodes[kind] = node
        place_node(node, drawn.pose)
        node.scale = tuple(drawn.half_axes.tolist())
        return drawn

    def _show_arrows(self, judged: PostureFacts | None) -> None:
        if judged is None:
            self._arrows.show(None, LOST)
            return
        tip, reach = self._context.arm.tip[:3, 3], self._context.seen.reach
        colours = LOST if judged.report.singular else WEAKEST
        self._arrows.show(twist_arrows(tip, judged.twists, reach), colours)

    def _lines(
        self, judged: PostureFacts | None, found: dict[str, DrawnEllipsoid | None]
    ) -> list[tuple[str, str]]:
        lines: list[tuple[str, str]] = []
        facts = self._facts
        if self._judges and facts is None:
            lines.append(("", "Looking for the characteristic length ..."))
        if self._switches["numbers"] and facts is not None and judged is not None:
            lines += _of_arm(facts) + _of_posture(judged, self._next)
        if self._switches["lost"] and judged is not None:
            what, colours = "takes the greatest effort", "amber, rotations about lilac"
            if judged.report.singular:
                what, colours = "the tip cannot do", "red, rotations about purple"
            lines.append(("arrows", f"what {what}: motions along {colours}"))
        for kind, drawn in found.items():
            if drawn is not None:
                values = ", ".join(f"{value:.3g}" for value in drawn.values)
                of = "rates" if kind == "velocity" else "torques"
                lines.append(
                    (f"{kind} ellipsoid", f"{values} {drawn.unit} at joint {of} of norm 1")
                )
        return lines or [("", "Conditioning, ellipsoids and singularities of this arm, live.")]


def _of_arm(facts: ArmFacts) -> list[tuple[str, str]]:
    best = "none, every posture is singular"
    if facts.best is not None:
        best = (
            f"{facts.least_condition:.3f}, conditioning index {100 / facts.least_condition:.1f} %"
        )
        if facts.best.condition_number > facts.least_condition * (1.0 + 1e-6):
            best += f"; inside the limits {facts.best.condition_number:.3f}"
    reach = f"{facts.least_reach:.3f} to {facts.greatest_reach:.3f} m from the first joint"
    return [
        ("characteristic length", f"{facts.length:.4f} m"),
        ("reach", reach),
        ("least condition number", best),
    ]


def _of_posture(judged: PostureFacts, near: NextSingularity | None) -> list[tuple[str, str]]:
    report = judged.report
    condition = report.normalised_condition_number
    here = "infinite, manipulability 0"
    if math.isfinite(condition):
        here = f"{condition:.3f}, manipulability {report.manipulability:.4g}"
    lines = [("condition number here", here)]
    if report.singular:
        count = len(report.lost_directions)
        lines.append(("singular", f"{', '.join(report.kinds)}: {counted(count, 'direction')} lost"))
    elif report.factors:
        parts = ", ".join(f"{name} {value:+.3f}" for name, value in report.factors.items())
        lines.append(("regular", f"{parts}; 0 is singular"))
    if near is not None and not report.singular:
        found = "none found"
        if math.isfinite(near.distance):
            found = f"{', '.join(near.kinds)}, {near.distance:.3f} rad away"
        lines.append(("next singularity", found))
    return lines
