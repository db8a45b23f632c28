"""A gripper: one slider opens and closes it."""

from __future__ import annotations

from functools import partial
from typing import Any

from robomech_ros.numerics.arrays import finite_number
from robomech_ros.robots.gripper import gripper_model
from robomech_ros.rvs.model.live_robot import LiveRobot
from robomech_ros.rvs.page.clients import AllControls, Controls
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import LayerContext
from robomech_ros.rvs.page.tables import short_name

ORDER = 4.5
# Smaller differences are not seen in the field of a slider (m or rad).
SAME = 5e-5


class GripperLayer:
    """The slider, for an arm with a gripper; other robots get none.

    Parameters
    ----------
    place : LayerContext
    robot : LiveRobot, optional
        The robot that runs, which is commanded; by default the gripper of the page moves.
    """

    def __init__(self, place: LayerContext, robot: LiveRobot | None = None) -> None:
        self._place, self._robot = place, robot
        if robot is None:
            self._gripper = gripper_model(place.description, place.chain)
        else:
            self._gripper = robot.gripper
        self._folder: Folder | None = None
        self._slider: Any = None
        # Latest value of the slider that has not been carried out.
        self._asked: float | None = None
        if self._gripper is not None and robot is None:
            home = place.description.joint_positions(place.description.home)
            place.arm.others = {joint.name: home[joint.name] for joint in self._gripper.joints}

    def show(self) -> None:
        """Set the slider to the gripper, unless it is the slider that moves it."""
        busy = self._asked is not None or (self._robot is not None and self._robot.gripper_moves)
        if self._gripper is None or self._folder is None or self._folder.removed or busy:
            return
        value = self._gripper.value(self._place.arm.others)
        if abs(self._slider.value - value) > SAME:
            self._slider.value = value

    def controls(self, client: Any) -> Controls:
        """Give the browser that commands the slider."""
        gripper, gui = self._gripper, client.gui
        if gripper is None:
            return AllControls([])
        (low, high), unit = gripper.ends, gripper.unit
        what, name = f"{low:.4g} to {high:.4g} {unit}", short_name(gripper.joints[0].name)
        label = "width" if gripper.opening is not None else name
        self._folder = folder = Folder(gui, self._place.units, "Gripper", ORDER, expanded=True)
        self._asked = None
        with folder:
            value = gripper.value(self._place.arm.others)
            hint = f"Opens and closes the gripper: {what}"
            self._slider = folder.slider(label, unit, (low, high), value, self._choose, hint)
            if gripper.opening is not None:
                folder.button("Open", partial(self._choose, high))
                folder.button("Close", partial(self._choose, low))
        return folder

    def close(self) -> None:
        """Do nothing: nothing runs."""

    def _choose(self, value: Any) -> None:
        self._asked = value
        self._place.ask((self, "move"), partial(self._move, value))

    def _move(self, value: Any) -> None:
        gripper = self._gripper
        if self._asked == value:
            self._asked = None
        assert gripper is not None
        positions = gripper.positions(finite_number("gripper", value, gripper.unit))
        if self._robot is None:
            self._place.arm.others |= positions
        else:
            self._robot.move_gripper(value)
