"""A robot that runs over the ground: it is drawn where it is heard to be, and jogged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from robomech_ros.errors import BadValueError
from robomech_ros.rvs.model.running.followed import Followed
from robomech_ros.rvs.model.running.live_mover import LiveMover, Stance
from robomech_ros.rvs.page.fact_table import fact_table
from robomech_ros.rvs.page.layer import Place
from robomech_ros.rvs.page.live.mover_controls import MoverControls
from robomech_ros.rvs.page.live.news import News, Onlookers
from robomech_ros.rvs.page.path_nodes import PathNode
from robomech_ros.rvs.page.switches import Switches

__all__ = ["LiveMoverLayer"]

TRAIL = (31, 119, 180)


class LiveMoverLayer:
    """The robot on its page, as :class:`~robomech_ros.rvs.model.running.live_mover.MoverView`.

    Parameters
    ----------
    place : Place
    robot : LiveMover
    """

    def __init__(self, place: Place, robot: LiveMover) -> None:
        if not isinstance(place.moved, Followed):
            raise TypeError("the page shows no robot that runs over the ground")
        self._place, self._robot, self._followed = place, robot, place.moved
        # It is moved by no gizmo.
        place.switch("gizmo", False)
        scene, gui = place.server.scene, place.server.gui
        self._trail = PathNode(scene, f"{place.base}/trail", TRAIL, place.seen.reach)
        self.switches = Switches(place, {"trail": "trail"}, {"trail": True})
        self._stance: Stance | None = None
        self._support: Any = None
        self._onlookers = Onlookers()
        self._news = News(gui, place.units, ("state", "jog", "result"))
        self._table = place.units.html(gui, order=0.5)
        self._controls: MoverControls | None = None
        hint = "Commands the robot to stand; every browser may"
        stop = gui.add_button("Stop", color="red", hint=hint, order=-0.15)

        @stop.on_click
        async def _(_: Any) -> None:
            robot.stop()

        place.server.on_client_connect(self._came)
        place.server.on_client_disconnect(self._left)
        robot.begin(self)

    # Of the page, on its thread.

    def show(self) -> None:
        """Show trail and feet."""
        points = self._followed.trail.points
        self._trail.show(points if self.switches["trail"] else points[:0])
        if self._stance is not None:
            self._show_feet(self._stance)

    def _show_feet(self, stance: Stance) -> None:
        from robomech_ros.rvs.page.moving.support_nodes import SupportNodes

        place = self._place
        if self._support is None:
            self._support = SupportNodes(place.server.scene, place.base, place.seen.reach)
        self._support.show(stance.support, stance.margin >= stance.bound)
        text = f"{stance.margin:.4f} m, kept above {stance.bound:g} m"
        gait = [("gait", stance.gait)] if stance.gait else []
        self._table.content = fact_table("feet", [*gait, *stance.support.facts(text)])

    def controls(self, client: Any) -> MoverControls:
        """Give the browser that commands its controls."""
        self._controls = MoverControls(client, self._place.units, self._followed, self._robot, self)
        return self._controls

    def close(self) -> None:
        """End what is jogged."""
        self._robot.let_go()

    # Of the controls.

    def clear_trail(self) -> None:
        """Begin a new trail."""
        self._place.ask((self, "clear"), self._followed.trail.clear)

    def refuse(self, error: BadValueError) -> None:
        """Say that something was refused."""
        self.show_result(f"Refused: {error}", failed=True)

    async def _came(self, client: Any) -> None:
        self._onlookers.came(client.client_id)

    async def _left(self, client: Any) -> None:
        self._onlookers.left(client.client_id)
        if self._controls is not None and self._controls.client_id == client.client_id:
            self._robot.let_go()

    # Of the robot, on any thread.

    def wait_until_seen(self, seconds: float) -> bool:
        """Wait until somebody looks, at most so long; says whether somebody does."""
        return self._onlookers.wait(seconds)

    def show_place(self, positions: Mapping[str, float], place: NDArray[Any]) -> None:
        """Draw the robot with its joints there (rad or m), at x, y (m) and heading (rad)."""
        self._place.ask((self, "place"), lambda: self._followed.hear(positions, place))

    def show_stance(self, stance: Stance) -> None:
        """Draw on which feet it stands, and say how safely."""

        def stands() -> None:
            self._stance = stance

        self._place.ask((self, "stance"), stands)

    def show_state(self, text: str) -> None:
        """Say what is wrong with odometry or joint states; empty for nothing."""
        self._news.say("state", text)

    def show_condition(self, text: str, links: Sequence[str], *, warns: bool) -> None:
        """Say how it is, or warn of what limits it, and mark links."""
        self._place.ask(
            (self, "condition"), lambda: self._followed.tell(text, links, refused=warns)
        )

    def show_result(self, text: str, *, failed: bool = False) -> None:
        """Say what came of a request."""
        self._news.say("result", text, failed)

    def show_jog(self, text: str) -> None:
        """Say why a jog has ended, or does not begin; empty for nothing."""
        self._news.say("jog", text)
