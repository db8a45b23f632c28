"""The page of one robot: requests of the browser that commands, done one after the other."""

from collections.abc import Callable, Hashable, Sequence
from typing import Any

from numpy.typing import NDArray

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.robots import RobotDescription, SerialChain
from robomech_ros.rvs.model.arms.arm import ArmView
from robomech_ros.rvs.model.bodies.visual_model import VisualModel, load_visual_model
from robomech_ros.rvs.model.draggable import DraggableRobot
from robomech_ros.rvs.model.platforms.platform_view import PlatformView
from robomech_ros.rvs.motion import Motion
from robomech_ros.rvs.page.clients import AllControls, Controls, PageClients
from robomech_ros.rvs.page.layer import Layer, LayerContext, LayerMaker, PlanView, Switch
from robomech_ros.rvs.page.panel import AT_FIRST, Panel
from robomech_ros.rvs.page.scene import BASE, PageScene
from robomech_ros.rvs.page.surroundings import set_theme
from robomech_ros.rvs.page.units import Units
from robomech_ros.rvs.serving.server import ServedPage, guarded_server
from robomech_ros.rvs.serving.worker import Worker

# Switches of items at the last set pose of the arm.
WITH_THE_ARM = ("ghosts", "gizmo")


class RobotPage(ServedPage):
    """A page of one robot, served until it is closed.

    - ``moved``: the arm of the robot that is moved; other robots are moved as a whole.
    - ``port``, ``host``: as for :func:`robomech_ros.rvs.view`.
    - ``layers``: each makes a layer of the page.
    - ``fixed``: whether the page refuses another robot, as that of a running robot does.
    """

    def __init__(
        self,
        description: RobotDescription,
        moved: SerialChain | DraggableRobot,
        *,
        port: int,
        host: str,
        layers: Sequence[LayerMaker] = (),
        fixed: bool = False,
    ) -> None:
        self._makers, self._fixed = tuple(layers), fixed
        self._switches = dict(AT_FIRST)
        self._dark: set[int] = set()
        self._revealed = True
        self._saved: dict[str, Any] = {}
        self._units = Units()
        arm: DraggableRobot = ArmView(moved) if isinstance(moved, SerialChain) else moved
        seen = load_visual_model(description)
        self._layers: list[Layer] = []
        self._server = guarded_server(host, port, arm.name)
        set_theme(self._server.viser.gui, False)
        self._worker = Worker()
        self._set_up(description, seen, arm)
        self._audience = PageClients(self._make_controls, self._take_over)
        self._server.viser.on_client_connect(self._connected)
        self._server.viser.on_client_disconnect(self._disconnected)

    @property
    def name(self) -> str:
        """Name of the robot."""
        return self._arm.name

    @property
    def browsers(self) -> int:
        """Number of browsers that show the page."""
        return len(self._server.viser.get_clients())

    def close(self) -> None:
        """Stop serving, and what the layers do."""
        self._worker.close()
        for layer in self._layers:
            layer.close()
        super().close()

    def _set_up(
        self, description: RobotDescription, seen: VisualModel, arm: DraggableRobot
    ) -> None:
        self._arm, self._reach = arm, seen.reach
        self._panel: Panel | None = None
        viser = self._server.viser
        self._stage = PageScene(viser, seen, arm, self._units)
        self._stage.ghosts.on_click(self._clicked)
        for what, shown in self._switches.items():
            self._stage.switch(what, shown)
        self._stage.show(arm, ())
        self._plan = PlanView()
        self._offered: dict[str, Switch] = {}
        context = LayerContext(
            server=viser,
            seen=seen,
            moved=arm,
            base=BASE,
            ask=self._ask,
            plan=self._plan,
            description=description,
            replace=self._replace,
            run=self._worker.submit,
            switched=self._switched,
            switch=self._switch,
            offered=self._offered,
            saved_values=self._saved,
            reveal=self._reveal,
            separate=self._stage.separate,
            fade=self._stage.fade,
            path=self._stage.path,
            move_base=self._stage.move_base,
            root_pose=lambda: self._stage.root_pose,
            units=self._units,
        )
        self._layers = [make(context) for make in self._makers]
        self._stage.show(arm, ())

    # Requests of browsers, on threads of the server.

    async def _connected(self, client: Any) -> None:
        self._worker.submit(("came", client.client_id), lambda: self._audience.came(client))

    async def _disconnected(self, client: Any) -> None:
        def forget() -> None:
            self._dark.discard(client.client_id)
            if self._audience.left(client.client_id):
                self._panel = None
                self._arm.release()
                self._show(None)

        self._worker.submit(("left", client.client_id), forget)

    def _take_over(self, number: int) -> None:
        self._worker.submit("take over", lambda: self._audience.give_command(number))

    def _clicked(self, client: Any, number: int) -> None:
        def take() -> None:
            if client.client_id == self._audience.commander:
                self._do(lambda: self._arm.take(number), None)

        self._worker.submit("take", take)

    def set_joint(self, joint: int, value: float) -> None:
        """Move a joint (rad or m)."""
        self._ask(("joint", joint), lambda: self._arm.set_joint(joint, value), joint)

    def drag(self, T: Callable[[], NDArray]) -> None:
        """Bring the tip to a pose, which is made when its turn comes."""
        self._ask("drag", lambda: self._arm.drag(T()))

    def release(self) -> None:
        """Release the gizmo."""
        self._ask("release", self._arm.release)

    def take(self, text: str) -> None:
        """Take the posture of this number, from 1; nothing is written between two numbers."""
        if text.strip():
            self._ask("take", lambda: self._arm.take(_numbered(text) - 1))

    def slide(self, length: float) -> None:
        """Move along the self-motion (rad or m)."""
        self._ask("self-motion", lambda: self._arm.slide(length), "self-motion")

    def home(self) -> None:
        """Go to where the robot began."""
        self._ask("home", self._arm.go_home)

    def show(self, what: str, shown: bool) -> None:
        """Show or hide a part of the scene; set the commanding browser dark or light."""
        self._worker.submit(("show", what), lambda: self._switch(what, shown))

    def replace(self, description: RobotDescription, chain: SerialChain) -> None:
        """Show another robot and its arm on the same page, or say why not."""
        self._ask("replace", lambda: self._replace(description, chain))

    def show_plan(self, motion: Motion, name: str = "plan") -> None:
        """Show a motion of the robot: a sweep of ghosts, and its curves; returns at once.

        - ``motion``: motion of all joints of the page's arm or parallel robot.
        - ``name``: name of the motion on the page.
        """
        self._check_joints(motion)
        self._ask("plan", lambda: self._show_plan(motion, name))

    def forget_plan(self) -> None:
        """Show no plan any more."""
        self._ask("plan", self._plan.forget)

    # Work, on the thread of the worker.

    def _show_plan(self, motion: Motion, name: str) -> None:
        # Another robot may have come meanwhile.
        self._check_joints(motion)
        self._plan.show(motion, name)

    def _check_joints(self, motion: Motion) -> None:
        """Refuse a motion that is not one of the joints of this robot."""
        if not isinstance(self._arm, ArmView | PlatformView):
            raise BadValueError("plan", self._arm.name, "one of an arm or a parallel robot")
        if not isinstance(motion, Motion):
            raise BadValueError("motion", motion, "a Motion")
        names, joints = tuple(motion.chain.joint_names), self._arm.state_joints
        if names != joints:
            raise BadValueError("joints of the motion", names, ", ".join(joints))

    def _make_controls(self, client: Any) -> Controls:
        self._panel = None
        shown = self._shown_to(client.client_id)
        panel = Panel(client, self._arm, self, BASE, self._reach, shown, self._units)
        controls = AllControls([panel, *(layer.controls(client) for layer in self._layers)])
        self._panel = panel
        self._show_or_hide("gizmo")
        return controls

    def _shown_to(self, browser: int | None) -> dict[str, bool]:
        """Return what of the stage a browser is shown, and whether its page is dark."""
        return {**self._switches, "dark": browser in self._dark}

    def _switched(self) -> dict[str, bool]:
        """Return all switches, those of layers too, and their states in the commanding browser."""
        offered = {what: switch.is_on() for what, switch in self._offered.items()}
        return {**self._shown_to(self._audience.commander), **offered}

    def _switch(self, what: str, shown: bool) -> None:
        if what in self._offered:
            self._offered[what].turn(shown)
            return
        if what == "dark":
            if self._audience.commander is not None:
                change = self._dark.add if shown else self._dark.discard
                change(self._audience.commander)
        else:
            self._switches[what] = shown
            self._show_or_hide(what)
        if self._panel is not None:
            self._panel.switch(what, shown)
        if what == "degrees":
            self._units.turn(shown)
            self._show(None)

    def _reveal(self, shown: bool) -> None:
        self._revealed = shown
        for what in WITH_THE_ARM:
            self._show_or_hide(what)

    def _show_or_hide(self, what: str) -> None:
        seen = self._switches[what] and (self._revealed or what not in WITH_THE_ARM)
        self._stage.switch(what, seen)
        if what == "gizmo" and self._panel is not None:
            self._panel.show_gizmo(seen)

    def _replace(self, description: RobotDescription, chain: SerialChain) -> None:
        """Take the stage down and set it up; what can be refused is made before."""
        if self._fixed or not isinstance(self._arm, ArmView):
            raise BadValueError("robot", description.name, "the one that runs; no other is shown")
        seen, arm = load_visual_model(description), self._arm.like(chain)
        with self._server.viser.atomic():
            self._audience.withdraw()
            for layer in self._layers:
                layer.close()
            self._server.viser.scene.reset()
            self._server.viser.gui.reset()
            self._set_up(description, seen, arm)
            self._audience.renew()

    def _ask(self, kind: Hashable, request: Callable[[], None], source: object = None) -> None:
        self._worker.submit(kind, lambda: self._do(request, source))

    def _do(self, request: Callable[[], None], source: object) -> None:
        notices = []
        try:
            request()
        except RobomechError as error:
            notices, source = [f"Refused: {error}"], None
        self._show(source, *notices)

    def _show(self, source: object, *notices: str) -> None:
        with self._server.viser.atomic():
            self._stage.show(self._arm, notices)
            if self._panel is not None:
                self._panel.update(self._arm, source)
            for layer in self._layers:
                layer.show()


def _numbered(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise BadValueError("posture", text, "its number") from None
