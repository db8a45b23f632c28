"""A gripper: one slider opens and closes it."""

from functools import partial
from typing import Any

from robomech_ros.numerics.arrays import finite_number
from robomech_ros.robots.gripper import gripper_model
from robomech_ros.rvs.model.running.live_robot import LiveRobot
from robomech_ros.rvs.page.clients import AllControls, Controls
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.tables import short_name

# Smaller differences are not seen in the field of a slider (m or rad).
SAME = 5e-5


class GripperLayer(Layer):
    """The slider, for an arm with a gripper; other robots get none.

    - ``robot``: the running robot to command; by default the gripper moves on the page only.
    """

    # A value of the slider is noted at once, so that the slider is not set back meanwhile.
    label, order, expanded, asks = "Gripper", 4.5, True, False

    def __init__(self, context: LayerContext, robot: LiveRobot | None = None) -> None:
        super().__init__(context)
        self._robot = robot
        if robot is None:
            self._gripper = gripper_model(context.description, context.chain)
        else:
            self._gripper = robot.gripper
        self._slider: Any = None
        # Latest value of the slider that has not been carried out.
        self._asked: float | None = None
        if self._gripper is not None and robot is None:
            home = context.description.joint_positions(context.description.home)
            context.arm.others = {joint.name: home[joint.name] for joint in self._gripper.joints}

    def show(self) -> None:
        """Set the slider to the gripper, unless it is the slider that moves it."""
        busy = self._asked is not None or (self._robot is not None and self._robot.gripper_moves)
        if self._gripper is None or not self.is_open or busy:
            return
        value = self._gripper.value(self._context.arm.others)
        if abs(self._slider.value - value) > SAME:
            self._slider.value = value

    def controls(self, client: Any) -> Controls:
        """Add the slider to the commanding browser."""
        return AllControls([]) if self._gripper is None else super().controls(client)

    def _fill(self, folder: Folder, gui: Any) -> None:
        gripper = self._gripper
        assert gripper is not None
        (low, high), unit = gripper.limits, gripper.unit
        what, name = f"{low:.4g} to {high:.4g} {unit}", short_name(gripper.joints[0].name)
        label = "width" if gripper.opening is not None else name
        self._asked = None
        value = gripper.value(self._context.arm.others)
        hint = f"Opens and closes the gripper: {what}"
        self._slider = folder.slider(label, unit, (low, high), value, self._choose, hint)
        if gripper.opening is not None:
            folder.button("Open", partial(self._choose, high))
            folder.button("Close", partial(self._choose, low))

    def _choose(self, value: Any) -> None:
        self._asked = value
        self.ask("move", self._move, value)

    def _move(self, value: Any) -> None:
        gripper = self._gripper
        if self._asked == value:
            self._asked = None
        assert gripper is not None
        positions = gripper.positions(finite_number("gripper", value, gripper.unit))
        if self._robot is None:
            self._context.arm.others |= positions
        else:
            self._robot.move_gripper(value)
