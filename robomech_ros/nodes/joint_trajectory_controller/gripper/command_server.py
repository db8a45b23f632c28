"""Actions gripper_cmd of control_msgs, as ros2_control's gripper controllers have them."""

from typing import Any

from control_msgs import action
from rclpy.action import GoalResponse
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import JointState

from robomech_ros.errors import RobomechError
from robomech_ros.execution.gripper.finger_motion import FingerCommand, FingerEnd, FingerMotion
from robomech_ros.execution.gripper.received_command import CommandReader
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.nodes.common.cooperative_wait import wake
from robomech_ros.nodes.common.messages.error_codes import code_of
from robomech_ros.nodes.joint_trajectory_controller.action_base import ActionBase
from robomech_ros.nodes.joint_trajectory_controller.gripper.gripper import Gripper
from robomech_ros.outcomes import name_of

# As ros2_control's gripper controllers call it.
_NAME = "gripper_cmd"


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
        """Read the positions of the fingers from a goal; RobomechError if they are impossible."""
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
        """Read the positions of the fingers from a goal; RobomechError if they are impossible."""
        command = goal.command
        return reader.read(command.name, command.position, command.velocity, command.effort)

    def _fields(self, state: JointState) -> dict[str, Any]:
        return {"state": state}


class CommandServer(ActionBase[FingerMotion]):
    """Serves the action.

    Results have no place for a reason: a goal that cannot be executed is rejected, and the log and
    /diagnostics say why.

    - ``place``: namespace of the action.
    - ``messages``: reads the goals of the action, and writes its feedback and results.
    """

    _what = "gripper command"

    def __init__(self, node: Node, gripper: Gripper, place: str, messages: GripperMessages) -> None:
        self._gripper, self._messages = gripper, messages
        name = f"{place}/{_NAME}"
        super().__init__(node, gripper, messages.kind, name, goal_callback=self._accept)

    def _accept(self, goal: Any) -> GoalResponse:
        try:
            self._read(goal)
        except RobomechError as error:
            self._refuse(error)
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def _read(self, goal: Any) -> FingerCommand:
        if self._gripper.refuse_all:
            raise TrajectoryRefusedError(self._gripper.refuse_all)
        return self._messages.read(goal, self._gripper.reader)

    def _refuse(self, error: RobomechError) -> None:
        code = code_of(error)
        with self._lock:
            self._gripper.counts.refuse(code, str(error), "a command to the gripper")
        self._log.error(f"gripper command refused ({code} {name_of(code)}): {error}")

    def _refused(self, error: Exception) -> Any:
        if isinstance(error, RobomechError):
            self._refuse(error)
        return self._messages.kind.Result()

    def _ended(self, outcome: tuple[FingerEnd, Any]) -> tuple[Any, bool, bool]:
        end, result = outcome
        stalled_well = end is FingerEnd.STALLED and self._gripper.allow_stalling
        return result, end is FingerEnd.REACHED or stalled_well, end is FingerEnd.CANCELLED

    def _start(self, request: Any, ended: Future) -> FingerMotion:
        gripper = self._gripper
        command = self._read(request)

        def end(how: FingerEnd, text: str) -> None:
            said = f": {text}" if text else ""
            gripper.counts.end_with(how is FingerEnd.REACHED, f"command {how.value}{said}")
            if text:
                # Fingers that hold an object have stalled; the others were asked to end.
                self._log.info(f"gripper command {how.value}: {text}")
            ended.set_result((how, self._messages.result(how, gripper.state_of(command))))
            wake(self._node)

        with self._lock:
            motion = gripper.fingers.move(command, gripper.time, end)
            gripper.counts.accept()
        return motion

    def _stop(self, motion: FingerMotion) -> bool:
        if motion.end is not None:
            return False
        self._gripper.fingers.cancel(motion, "cancelled by the client; the fingers hold")
        return True

    def publish_feedback(self) -> None:
        """Tell the clients where the fingers are; the gripper's lock is to be held."""
        for handle, motion in self._served.values():
            handle.publish_feedback(self._messages.feedback(self._gripper.state_of(motion.command)))
