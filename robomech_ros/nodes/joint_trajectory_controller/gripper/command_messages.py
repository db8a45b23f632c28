"""Messages of the actions gripper_cmd of control_msgs, as ros2_control's gripper controllers."""

from typing import Any

from control_msgs import action
from sensor_msgs.msg import JointState

from robomech_ros.execution.gripper.finger_motion import FingerCommand, FingerEnd
from robomech_ros.execution.gripper.received_command import CommandReader


class GripperMessages:
    """Messages of the action GripperCommand.

    Position and effort are those of the first joint that is commanded; the effort is positive,
    whatever way it presses.

    - ``type_name``: name of the action in control_msgs.
    """

    type_name = "GripperCommand"

    def __init__(self) -> None:
        self.kind = getattr(action, self.type_name)

    def read(self, goal: Any, reader: CommandReader) -> FingerCommand:
        """Read where a goal wants the fingers; raises RobomechError for what cannot be."""
        return reader.read([], [goal.command.position], [], [goal.command.max_effort])

    def _fields(self, state: JointState) -> dict[str, Any]:
        return {"position": state.position[0], "effort": abs(state.effort[0])}

    def feedback(self, state: JointState) -> Any:
        """Tell the state of the joints that are commanded."""
        return self.kind.Feedback(**self._fields(state))

    def result(self, end: FingerEnd, state: JointState) -> Any:
        """Tell what has become of a command, and the state of its joints."""
        stalled, reached = end is FingerEnd.STALLED, end is FingerEnd.REACHED
        return self.kind.Result(**self._fields(state), stalled=stalled, reached_goal=reached)


class ParallelGripperMessages(GripperMessages):
    """Messages of ParallelGripperCommand; efforts have the sign of their direction."""

    type_name = "ParallelGripperCommand"

    def read(self, goal: Any, reader: CommandReader) -> FingerCommand:
        """Read where a goal wants the fingers; raises RobomechError for what cannot be."""
        command = goal.command
        return reader.read(command.name, command.position, command.velocity, command.effort)

    def _fields(self, state: JointState) -> dict[str, Any]:
        return {"state": state}
