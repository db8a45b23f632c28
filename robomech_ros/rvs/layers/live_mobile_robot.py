"""A robot that runs over the ground: it is drawn where it is heard to be, and jogged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from robomech_ros.rvs.model.live_robot import LiveMobileRobot, Stance
from robomech_ros.rvs.model.observed_robot import ObservedRobot
from robomech_ros.rvs.page.layer import LayerContext
from robomech_ros.rvs.page.live.live_page import LivePage
from robomech_ros.rvs.page.live.mobile_robot_controls import MobileRobotControls
from robomech_ros.rvs.page.path_nodes import PathNode
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.page.tables import fact_table

TRAIL = (31, 119, 180)


class LiveMobileRobotLayer(LivePage):
    """Page of a running mobile robot."""

    def __init__(self, place: LayerContext, robot: LiveMobileRobot) -> None:
        if not isinstance(place.moved, ObservedRobot):
            raise TypeError("the page shows no robot that runs over the ground")
        hint = "Commands the robot to stand; every browser may"
        super().__init__(place, robot, (), hint)
        self._robot, self._followed = robot, place.moved
        # It is moved by no gizmo.
        place.switch("gizmo", False)
        scene, gui = place.server.scene, place.server.gui
        self._trail = PathNode(scene, f"{place.base}/trail", TRAIL, place.seen.reach)
        self.switches = Switches(place, {"trail": "trail"}, {"trail": True})
        self._stance: Stance | None = None
        self._support: Any = None
        self._table = place.units.html(gui, order=0.5)
        robot.begin(self)

    # Of the page, on its thread.

    def show(self) -> None:
        """Show trail and feet."""
        points = self._followed.trail.points
        self._trail.show(points if self.switches["trail"] else points[:0])
        if self._stance is not None:
            self._show_feet(self._stance)

    def _show_feet(self, stance: Stance) -> None:
        from robomech_ros.rvs.page.support_nodes import SupportNodes

        place = self._place
        if self._support is None:
            self._support = SupportNodes(place.server.scene, place.base, place.seen.reach)
        self._support.show(stance.support, stance.margin >= stance.bound)
        text = f"{stance.margin:.4f} m, kept above {stance.bound:g} m"
        gait = [("gait", stance.gait)] if stance.gait else []
        self._table.content = fact_table("feet", [*gait, *stance.support.facts(text)])

    def controls(self, client: Any) -> MobileRobotControls:
        """Give the browser that commands its controls."""
        controls = MobileRobotControls(client, self._place.units, self._followed, self._robot, self)
        self._controls = controls
        return controls

    # Of the controls.

    def clear_trail(self) -> None:
        """Begin a new trail."""
        self._place.ask((self, "clear"), self._followed.trail.clear)

    def show_pose(self, positions: Mapping[str, float], place: NDArray[Any]) -> None:
        """Draw the robot with its joints there (rad or m), at x, y (m) and heading (rad)."""
        self._place.ask((self, "place"), lambda: self._followed.hear(positions, place))

    def show_stance(self, stance: Stance) -> None:
        """Draw on which feet it stands, and say how safely."""

        def stands() -> None:
            self._stance = stance

        self._place.ask((self, "stance"), stands)

    def show_condition(self, text: str, links: Sequence[str], *, warns: bool) -> None:
        """Say how it is, or warn of what limits it, and mark links."""
        self._place.ask(
            (self, "condition"), lambda: self._followed.tell(text, links, refused=warns)
        )
