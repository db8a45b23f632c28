"""A parallel robot: its assembly modes or branches, and how far it is from singular."""

from functools import partial
from typing import Any

from robomech_ros.errors import RobomechError
from robomech_ros.rvs.model.arms.analysis import twist_arrows
from robomech_ros.rvs.model.platforms.lists import (
    LISTS,
    PlatformFacts,
    PlatformList,
    platform_facts,
    platform_list,
)
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.page.twist_nodes import TwistNodes

# Switches, and their labels.
LABELS = {"numbers": "numbers", "arrows": "singular directions"}
LOST, FREE = ((225, 40, 45), (190, 50, 190)), ((20, 130, 60), (20, 150, 170))
WEAKEST = ((235, 165, 60), (190, 140, 220))


class PlatformLayer(Layer):
    """The layer; what takes long is found on a thread of its own, and of each kind the latest."""

    label, order, expanded = "Platform", 10, True

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        self._kind = LISTS[0]
        self._on = {"numbers": True, "arrows": False}
        self._switches = Switches(context, LABELS, self._on)
        self._list: PlatformList | None = None
        self._facts: PlatformFacts | None = None
        self._facts_at: Any = None
        self._lost, self._free = (TwistNodes(context.space, name) for name in ("lost", "free"))
        # At once, so that the eye holds all ghosts from the beginning.
        self._asked = (context.platform.q, self._kind, True)
        self._know(self._asked, self._found(*self._asked))

    def show(self) -> None:
        """Follow the robot."""
        q = self._context.platform.q
        asked = (q, self._kind, any(self._on.values()))
        if asked[1:] != self._asked[1:] or (q != self._asked[0]).any():
            self._asked = asked
            self.find("found", partial(self._found, *asked), partial(self._know, asked))
        self._show_arrows()
        self.write("platform", self._lines())

    def _fill(self, folder: Folder, gui: Any) -> None:
        folder.dropdown("ghosts", LISTS, self._kind, self._list_other)
        for name in LABELS:
            self._switches.add_to(folder, name)
        self._table = folder.text()

    def _list_other(self, value: Any) -> None:
        self._kind, self._list = value, None

    def _found(self, q: Any, kind: str, judged: bool) -> tuple[PlatformList, PlatformFacts | None]:
        robot = self._context.platform.robot
        before = () if self._list is None else self._list.postures
        try:
            found = platform_list(robot, q, kind, before)
            return found, platform_facts(robot, q) if judged else None
        except RobomechError as error:
            return PlatformList((), False, f"Nothing is known here: {error}."), None

    def _know(self, asked: Any, found: tuple[PlatformList, PlatformFacts | None]) -> None:
        q, kind, _ = asked
        if kind == self._kind:
            (self._list, self._facts), self._facts_at = found, q
            self._context.platform.know(self._list)

    def _show_arrows(self) -> None:
        facts = self._facts if self._on["arrows"] else None
        if facts is None:
            self._lost.show(None, LOST)
            self._free.show(None, FREE)
            return
        platform, report = self._context.platform, facts.report
        at = platform.mechanism.pose(self._facts_at)[:3, 3]
        arrows = partial(twist_arrows, at, reach=self._context.seen.reach)
        self._lost.show(arrows(report.lost_directions), LOST)
        free = len(report.free_directions) > 0
        self._free.show(
            arrows(report.free_directions if free else facts.weakest[None]),
            FREE if free else WEAKEST,
        )

    def _lines(self) -> list[tuple[str, str]]:
        if not any(self._on.values()):
            return [("", "Singularities of this robot, live.")]
        if self._facts is None:
            return [("", "Looking for the characteristic length ...")]
        lines = self._facts.lines if self._on["numbers"] else []
        if self._on["arrows"]:
            what = "amber along, lilac about: what the drives hold least"
            if self._facts.report.singular:
                what = (
                    "red along, purple about: lost, no drive moves the platform so; green along, "
                    "turquoise about: free, no drive holds it"
                )
            lines = [*lines, ("arrows", what)]
        return lines
