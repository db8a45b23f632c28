"""A walking machine: on which feet it stands, how safely, and in which gait it walks."""

from __future__ import annotations

from typing import Any

from robomech_ros.rvs.model.walking.walker_view import WalkerView
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.support_nodes import SupportNodes
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.page.tables import fact_table
from robomech_ros.spatial.arrays import as_choice

SHOWN = "support polygon"


class WalkingLayer(Layer):
    """The layer."""

    label, order, expanded = "Feet", 3.6, True

    def __init__(self, place: LayerContext) -> None:
        if not isinstance(place.moved, WalkerView):
            raise TypeError("the page shows no walking machine")
        super().__init__(place)
        self._robot = place.moved
        self._nodes = SupportNodes(place.server.scene, place.base, place.seen.reach)
        self._switches = Switches(place, {SHOWN: SHOWN}, {SHOWN: True})
        self._gait: Any = None

    def show(self) -> None:
        """Follow the machine."""
        robot = self._robot
        if self._switches[SHOWN]:
            support = robot.support
            self._nodes.show(support, support.margin >= robot.bound)
        else:
            self._nodes.hide()
        if self.is_open:
            if self._gait.value != robot.chosen_gait:
                self._gait.value = robot.chosen_gait
            self._table.content = fact_table("feet", robot.support_facts())

    def _fill(self, folder: Folder, gui: Any) -> None:
        hint = "In which it walks on as soon as it stands"
        gaits, chosen = self._robot.gaits, self._robot.chosen_gait
        self._gait = folder.dropdown("gait", gaits, chosen, self._choose, hint)
        hint = "Of the feet that stand, and the way from the mass centre to its nearest edge"
        self._switches.add_to(folder, SHOWN, hint)
        self._table = folder.text()

    def _choose(self, value: Any) -> None:
        self._robot.choose_gait(as_choice("gait", value, self._robot.gaits))
