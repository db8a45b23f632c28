"""A walking machine: on which feet it stands, how safely, and in which gait it walks."""

from __future__ import annotations

from typing import Any

from robomech_ros.rvs.model.walking.walker_view import WalkerView
from robomech_ros.rvs.page.clients import Controls
from robomech_ros.rvs.page.fact_table import fact_table
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import LayerContext
from robomech_ros.rvs.page.mobile.support_nodes import SupportNodes
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.spatial.arrays import as_choice

ORDER = 3.6
SHOWN = "support polygon"


class WalkingLayer:
    """The layer.

    Parameters
    ----------
    place : LayerContext
    """

    def __init__(self, place: LayerContext) -> None:
        if not isinstance(place.moved, WalkerView):
            raise TypeError("the page shows no walking machine")
        self._place, self._robot = place, place.moved
        self._nodes = SupportNodes(place.server.scene, place.base, place.seen.reach)
        self._switches = Switches(place, {SHOWN: SHOWN}, {SHOWN: True})
        self._folder: Folder | None = None
        self._gait: Any = None
        self._table: Any = None

    def show(self) -> None:
        """Follow the machine."""
        robot = self._robot
        if self._switches[SHOWN]:
            support = robot.support
            self._nodes.show(support, support.margin >= robot.bound)
        else:
            self._nodes.hide()
        if self._folder is not None and not self._folder.removed:
            if self._gait.value != robot.chosen_gait:
                self._gait.value = robot.chosen_gait
            self._table.content = fact_table("feet", robot.support_facts())

    def controls(self, client: Any) -> Controls:
        """Give a browser the folder "Feet"."""
        folder = self._folder = Folder(client.gui, self._place.units, "Feet", ORDER, expanded=True)
        with folder:
            hint = "In which it walks on as soon as it stands"
            gaits = self._robot.gaits
            self._gait = client.gui.add_dropdown(
                "gait", gaits, initial_value=self._robot.chosen_gait, hint=hint
            )
            folder.listen(self._gait, self._choose)
            hint = "Of the feet that stand, and the way from the mass centre to its nearest edge"
            self._switches.add_to(folder, SHOWN, hint)
            self._table = folder.text()
        self.show()
        return folder

    def close(self) -> None:
        """Do nothing: nothing runs."""

    def _choose(self, value: Any) -> None:
        def chosen() -> None:
            self._robot.choose_gait(as_choice("gait", value, self._robot.gaits))

        self._place.ask((self, "gait"), chosen)
