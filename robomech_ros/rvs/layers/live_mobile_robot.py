"""A running mobile robot: it is drawn at its reported pose, and can be jogged."""

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from robomech_ros.errors import BadValueError
from robomech_ros.numerics.arrays import real_within
from robomech_ros.rvs.model.draggable import ROUNDING
from robomech_ros.rvs.model.running.jog import HoldHeartbeat
from robomech_ros.rvs.model.running.live_robot import LiveMobileRobot, Stance
from robomech_ros.rvs.model.running.observed_robot import ObservedRobot, Shift
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import LayerContext
from robomech_ros.rvs.page.live.hold_field import HoldField
from robomech_ros.rvs.page.live.jog_pad import hold_pad
from robomech_ros.rvs.page.live.live_page import LivePage
from robomech_ros.rvs.page.path_nodes import PathNode
from robomech_ros.rvs.page.switches import Switches
from robomech_ros.rvs.page.tables import fact_table

TRAIL = (31, 119, 180)


class LiveMobileRobotLayer(LivePage):
    """Page of a running mobile robot."""

    order, expanded = 3.5, True

    def __init__(self, context: LayerContext, robot: LiveMobileRobot) -> None:
        super().__init__(context, robot, (), "Commands the robot to stand; every browser may")
        self._robot, self._followed = robot, context.robot_of(ObservedRobot)
        self.label = self._followed.verb.capitalize()
        # It is moved by no gizmo.
        context.switch("gizmo", False)
        self._trail = PathNode(context.space, "trail", TRAIL)
        self._switches = Switches(context, {"trail": "trail"}, {"trail": True})
        self._stance: Stance | None = None
        self._support: Any = None
        self._table = context.units.html(context.server.gui, order=0.5)
        robot.begin(self)

    # Calls of the page, on its thread.

    def show(self) -> None:
        """Show trail and feet."""
        points = self._followed.trail.points
        self._trail.show(points if self._switches["trail"] else points[:0])
        if self._stance is not None:
            self._show_feet(self._stance)

    def _show_feet(self, stance: Stance) -> None:
        from robomech_ros.rvs.layers.walking import SupportNodes

        if self._support is None:
            self._support = SupportNodes(self._context.space)
        self._support.show(stance.support, stance.margin >= stance.bound)
        text = f"{stance.margin:.4f} m, kept above {stance.bound:g} m"
        gait = [("gait", stance.gait)] if stance.gait else []
        self._table.content = fact_table("feet", [*gait, *stance.support.facts(text)])

    def _fill(self, folder: Folder, gui: Any) -> None:
        followed = self._followed
        pad = HoldField(gui, 0, self._hold, self._robot.let_go, self.refuse)
        folder.text().content = hold_pad(pad.identifier, [followed.directions])
        self._pads = [pad]
        if followed.gaits:
            hint = "Choose one, in which it walks on as soon as it stands"
            folder.dropdown("gait", ("", *followed.gaits), "", self._choose_gait, hint)
        if followed.shifts:
            self._add_trunk(folder)
        self._switches.add_to(folder, "trail")
        folder.button("Clear trail", followed.trail.clear)

    def _add_trunk(self, folder: Folder) -> None:
        """Add sliders and buttons for the pose that the trunk is to take."""
        self._sliders = []
        for shift in self._followed.shifts:
            ends, hint = (-shift.most, shift.most), f"Beside the level pose, {shift.unit}"
            slider = folder.slider(shift.name, shift.unit, ends, 0.0, lambda _: None, hint)
            self._sliders.append(slider)
        hint = "Over feet that stay; what would tip the robot or overstretch a leg is refused"
        folder.button("Move trunk", self._move_trunk, hint)
        folder.button("Level trunk", self._level_trunk)

    # Calls of the controls, on threads of the server.

    def _choose_gait(self, value: str) -> None:
        if value:
            self._robot.choose_gait(value)

    def _hold(self, beat: HoldHeartbeat, speed: float) -> None:
        direction, known = beat.direction, self._followed.directions
        if (direction.kind, direction.index) not in [(one.kind, one.axis) for one in known]:
            expected = ", ".join(f"'{one.kind} {one.axis}' ({one.name})" for one in known)
            raise BadValueError("jog", f"{direction.kind} {direction.index}", expected)
        self._robot.hold(beat, speed)

    def _move_trunk(self) -> None:
        pairs = zip(self._followed.shifts, self._sliders, strict=True)
        self._robot.move_trunk([_checked(shift, slider.value) for shift, slider in pairs])

    def _level_trunk(self) -> None:
        for slider in self._sliders:
            slider.value = 0.0
        self._robot.move_trunk([0.0] * len(self._sliders))

    # Calls of the robot, on any thread.

    def show_pose(self, positions: Mapping[str, float], place: NDArray[Any]) -> None:
        """Draw the robot with its joints there (rad or m), at x, y (m) and heading (rad)."""
        self.ask("place", self._followed.update, positions, place)

    def show_stance(self, stance: Stance) -> None:
        """Draw on which feet it stands, and say how safely."""
        self.ask("stance", setattr, self, "_stance", stance)

    def show_condition(self, text: str, links: Sequence[str], *, warns: bool) -> None:
        """Say how it is, or warn of what limits it, and mark links."""
        self.ask("condition", lambda: self._followed.report(text, links, refused=warns))


def _checked(shift: Shift, value: object) -> float:
    expected, most = f"{-shift.most:.6g} to {shift.most:.6g} {shift.unit}", shift.most + ROUNDING
    return real_within(shift.name, value, expected, -most, most)
