"""Controls of the commanding browser for a running robot: plan, execute, jog."""

from __future__ import annotations

from typing import Any

from robomech_ros.robots import SerialChain
from robomech_ros.rvs.model.jog import HoldHeartbeat
from robomech_ros.rvs.model.live_robot import LiveRobot
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.live.hold_field import HoldField
from robomech_ros.rvs.page.live.jog_pad import jog_pad
from robomech_ros.rvs.page.tables import short_name
from robomech_ros.rvs.page.units import Units
from robomech_ros.spatial.arrays import as_choice

# Label of the buttons about the goal, and what they do.
GOAL = "Goal"
PLAN, EXECUTE, TO_ROBOT = "Plan", "Execute", "To robot"
# Whose axes the tip is jogged along and about.
FRAMES = ("base", "tip")


class LiveControls:
    """The controls of one browser.

    Parameters
    ----------
    client : viser.ClientHandle
        The browser.
    units : Units
    chain : SerialChain or None
        The arm that is jogged, if there is one.
    robot : LiveRobot
    layer : LiveLayer
    waiting : bool
        Whether plans wait to be executed on request.
    markers : bool
        Whether markers are shown.
    """

    def __init__(
        self,
        client: Any,
        units: Units,
        chain: SerialChain | None,
        robot: LiveRobot,
        layer: Any,
        *,
        waiting: bool,
        markers: bool,
    ) -> None:
        self._robot, self._layer = robot, layer
        self._handles: list[Any] = []
        # Whether the browser commands no more.
        self.gone = False
        self._pad: HoldField | None = None
        gui = client.gui
        self._add_goal(gui)
        if chain is not None:
            self._add_jog(gui, chain)
        folder = Folder(gui, units, "ROS", 50)
        self._handles.append(folder)
        with folder:
            hint = "Off: the trajectory publisher executes every plan as soon as it is made"
            wait = robot.let_plans_wait
            self._waiting = folder.checkbox("plans wait", waiting, wait, hint)
            hint = "What the nodes publish as markers"
            folder.checkbox("markers", markers, layer.want_markers, hint)

    def _add_goal(self, gui: Any) -> None:
        hint = (
            "Plan a motion from the robot to the goal, the orange robot; plan and execute it; put "
            "the goal where the robot is"
        )
        group = gui.add_button_group(GOAL, (PLAN, EXECUTE, TO_ROBOT), hint=hint, order=-0.1)
        self._handles.append(group)
        ways = {
            PLAN: self._layer.plan,
            EXECUTE: self._layer.execute,
            TO_ROBOT: self._layer.bring_goal,
        }

        @group.on_click
        async def _(event: Any) -> None:
            way = ways.get(event.target.value)
            if way is not None:
                way()

    def _add_jog(self, gui: Any, chain: SerialChain) -> None:
        folder = gui.add_folder("Jog", order=3.5, expand_by_default=False)
        self._handles.append(folder)
        with folder:
            hint = "Axes along and about which the tip is jogged"
            let_go, refuse = self._robot.let_go, self._layer.refuse
            self._pad = HoldField(gui, chain.n, self._hold, let_go, refuse)
            self._frame = gui.add_dropdown("axes of", FRAMES, hint=hint)
            names = [short_name(name) for name in chain.joint_names]
            gui.add_html(jog_pad(self._pad.identifier, names))

    def _hold(self, beat: HoldHeartbeat, speed: float) -> None:
        self._robot.hold(beat, as_choice("axes", self._frame.value, FRAMES), speed)

    def show_waiting(self, waiting: bool) -> None:
        """Show whether plans wait to be executed on request."""
        if not self.gone and self._waiting.value != waiting:
            self._waiting.value = waiting

    def remove(self) -> None:
        """Take the controls from the browser, and end its jog."""
        self.gone = True
        if self._pad is not None:
            self._pad.remove()
        else:
            self._robot.let_go()
        for handle in reversed(self._handles):
            handle.remove()
