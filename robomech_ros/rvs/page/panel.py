"""The controls of the browser that commands: sliders, the gizmo at the tip, what is shown."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from robomech_ros.rvs.model.draggable import DraggableRobot
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.node_space import place_node, placed
from robomech_ros.rvs.page.surroundings import set_theme
from robomech_ros.rvs.page.tables import TAKE, short_name
from robomech_ros.rvs.page.units import STEP, Units
from robomech_ros.spatial import pose_from_position_quaternion

# Size of the gizmo in reaches of the robot.
GIZMO = 0.28
HINT = "drag to move"
# Switches, and their first states.
AT_FIRST = {
    "ghosts": True,
    "frames": False,
    "joint axes": False,
    "ground": True,
    "gizmo": True,
    "degrees": False,
}


class Panel:
    """The controls of one browser.

    - ``base``: node at the base of the arm.
    - ``switches``: states of the switches: the parts of :data:`AT_FIRST`, and the dark page.
    """

    def __init__(
        self,
        client: Any,
        arm: DraggableRobot,
        page: Any,
        base: str,
        reach: float,
        switches: Mapping[str, bool],
        units: Units,
    ) -> None:
        self._client, self._page, self._units = client, page, units
        self._handles: list[Any] = []
        self._held = False
        gui = client.gui
        if arm.lists_postures:
            hint = "Number of a posture; a click on its row or its ghost takes it, too"
            take = gui.add_text(TAKE, "", hint=hint, order=3)
            self._handles.append(take)

            @take.on_update
            async def _(event: Any) -> None:
                if event.client is not None:
                    page.take(take.value)

        self._sliders = self._add_joints(arm)
        self._self_motion = self._add_self_motion(arm) if arm.self_motion() is not None else None
        self._add_switches(switches)
        options = arm.gizmo(GIZMO * reach)
        self._gizmo = client.scene.add_transform_controls(
            f"{base}/target",
            depth_test=False,
            visible=switches["gizmo"],
            **options,
            **placed(arm.target),
        )
        self._handles.append(self._gizmo)
        # Beside the gizmo, until it is dragged.
        self._hint = client.scene.add_label(
            f"{base}/target/hint",
            HINT,
            position=(0.0, 0.0, options["scale"]),
            anchor="bottom-center",
            font_screen_scale=0.75,
            depth_test=False,
            visible=self._gizmo.visible,
        )
        self._handles.append(self._hint)
        self._listen_to_gizmo()
        self.update(arm, None)

    def _add_joints(self, arm: DraggableRobot) -> list[Any]:
        sliders: list[Any] = []
        if not arm.joint_names:
            return sliders
        folder = self._folder("Joints", 4, expanded=True)
        with folder:
            for joint, name in enumerate(arm.joint_names):
                low, high = arm.travel(joint)
                unit, value = arm.units[joint], float(arm.values[joint])
                hint = f"{name}: {low:.4g} to {high:.4g} {unit}"
                label, move = short_name(name), partial(self._page.set_joint, joint)
                sliders.append(folder.slider(label, unit, (low, high), value, move, hint))
            folder.button("Home", self._page.home)
        return sliders

    def _add_self_motion(self, arm: DraggableRobot) -> Any:
        folder = self._folder("Self-motion", 5, expanded=True)
        with folder:
            unit = arm.units[0] if len(set(arm.units)) == 1 else ""
            hint = "Moves the arm while its tip stays: length of the path in joint space, rad or m"
            return folder.slider("along it", unit, (-1.0, 1.0), 0.0, self._page.slide, hint)

    def _add_switches(self, switches: Mapping[str, bool]) -> None:
        self._shown = folder = self._folder("Show", 6)
        with folder:
            for what, shown in switches.items():
                folder.checkbox(what, shown, partial(self._page.show, what))

    def _folder(self, label: str, order: float, *, expanded: bool = False) -> Folder:
        folder = Folder(self._client.gui, self._units, label, order, expanded=expanded)
        self._handles.append(folder)
        return folder

    def switch(self, what: str, shown: bool) -> None:
        """Draw the page dark or light, and mark what is shown."""
        self._shown.mark(what, shown)
        if what == "dark":
            set_theme(self._client.gui, shown)

    def show_gizmo(self, shown: bool) -> None:
        """Show the gizmo, or not."""
        self._gizmo.visible = shown

    def _listen_to_gizmo(self) -> None:
        gizmo = self._gizmo

        @gizmo.on_update
        async def _(event: Any) -> None:
            # Messages after the end were on their way before.
            if event.phase == "start":
                self._held, self._hint.visible = True, False
            elif event.phase == "end":
                self._held = False
                self._page.release()
            elif self._held:
                wxyz, position = np.roll(gizmo.wxyz, -1), gizmo.position.copy()
                self._page.drag(lambda: pose_from_position_quaternion(position, wxyz))

    def update(self, arm: DraggableRobot, source: object) -> None:
        """Show where the arm is in all controls but the one that it was moved with.

        - ``source``: the number of the joint, or the name of the control; None for none of them.
        """
        for joint, slider in enumerate(self._sliders):
            # The one that moves may be farther already than what it asked for.
            if source != joint:
                slider.value = float(arm.values[joint])
        if not self._held:
            place_node(self._gizmo, arm.target)
            if self._self_motion is not None and source != "self-motion":
                curve = arm.self_motion()
                if curve is not None:
                    self._self_motion.between(min(curve.low, -STEP), max(curve.high, STEP))
                    self._self_motion.value = 0.0

    def remove(self) -> None:
        """Take the controls from the browser."""
        for handle in reversed(self._handles):
            handle.remove()
