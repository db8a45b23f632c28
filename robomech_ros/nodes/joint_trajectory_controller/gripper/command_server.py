"""Serves an action that commands the gripper."""

from typing import Any

from rclpy.action import GoalResponse
from rclpy.node import Node
from rclpy.task import Future

from robomech_ros.errors import RobomechError
from robomech_ros.execution.gripper.finger_motion import FingerCommand, FingerEnd, FingerMotion
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.nodes.common.cooperative_wait import wake
from robomech_ros.nodes.common.messages.error_codes import code_of
from robomech_ros.nodes.joint_trajectory_controller.action_base import ActionBase
from robomech_ros.nodes.joint_trajectory_controller.gripper.command_messages import GripperMessages
from robomech_ros.nodes.joint_trajectory_controller.gripper.gripper import Gripper
from robomech_ros.outcomes import name_of

# As ros2_control's gripper controllers call it.
_NAME = "gripper_cmd"


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
