"""Messages of the actions gripper_cmd of control_msgs, as ros2_control's gripper controllers."""

from typing import Any, Protocol

from control_msgs import action
from sensor_msgs.msg import JointState

from robomech_ros.execution.gripper.finger_motion import FingerCommand, FingerEnd
from robomech_ros.execution.gripper.received_command import CommandReader


class CommandMessages(Protocol):
    """Messages of an action that commands a gripper.

    Attributes
    ----------
    type_name : str
        Name of the action in control_msgs.
    kind : type
        The action.
    """

    type_name: str
    kind: Any

    def read(self, goal: Any, reader: CommandReader) -> FingerCommand:
        """Read where a goal wants the fingers; raises RobomechError for what cannot be."""

    def feedback(self, state: JointState) -> Any:
        """Tell the state of the joints that are commanded."""

    def result(self, end: FingerEnd, state: JointState) -> Any:
        """Tell what has become of a command, and the state of its joints."""


class GripperMessages:
    """Those of GripperCommand; see `CommandMessages`.

    Position and effort are those of the first joint that is commanded; the effort is positive,
    whatever way it presses.
    """

    type_name = "GripperCommand"

    def __init__(self) -> None:
        self.kind = getattr(action, self.type_name)

    def read(self, goal: Any, reader: CommandReader) -> FingerCommand:
        """Read where a goal wants the fingers."""
        return reader.read([], [goal.command.position], [], [goal.command.max_effort])

    def feedback(self, state: JointState) -> Any:
        """Tell the state of the joints that are commanded."""
        return self.kind.Feedback(position=state.position[0], effort=abs(state.effort[0]))

    def result(self, end: FingerEnd, state: JointState) -> Any:
        """Tell what has become of a command, and the state of its joints."""
        return self.kind.Result(
            position=state.position[0],
            effort=abs(state.effort[0]),
            stalled=end is FingerEnd.STALLED,
            reached_goal=end is FingerEnd.REACHED,
        )


class ParallelGripperMessages:
    """Those of ParallelGripperCommand; see `CommandMessages`.

    Efforts have the sign of the direction in which they press.
    """

    type_name = "ParallelGripperCommand"

    def __init__(self) -> None:
        self.kind = getattr(action, self.type_name)

    def read(self, goal: Any, reader: CommandReader) -> FingerCommand:
        """Read where a goal wants the fingers."""
        command = goal.command
        return reader.read(command.name, command.position, command.velocity, command.effort)

    def feedback(self, state: JointState) -> Any:
        """Tell the state of the joints that are commanded."""
        return self.kind.Feedback(state=state)

    def result(self, end: FingerEnd, state: JointState) -> Any:
        """Tell what has become of a command, and the state of its joints."""
        return self.kind.Result(
            state=state, stalled=end is FingerEnd.STALLED, reached_goal=end is FingerEnd.REACHED
        )
