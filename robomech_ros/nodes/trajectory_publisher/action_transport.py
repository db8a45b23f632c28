"""Goals of an action on their way to a controller, and their results."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalStatus
from rclpy.node import Node
from rclpy.task import Future
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.execution.motion_result import MotionResult
from robomech_ros.nodes.middleware.queue_depth import ask_action
from robomech_ros.nodes.trajectory_publisher.goals import AskedTolerances, ExecuteGoals
from robomech_ros.outcomes import Code

if TYPE_CHECKING:
    from robomech_ros.nodes.trajectory_publisher.follow_goals import FollowGoals

OnResult = Callable[[ExecutionRequest, int, str], None]
Moved = Callable[[], bool]

_ENDED = (GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_ABORTED, GoalStatus.STATUS_CANCELED)


def request_topic(action: str) -> str:
    """Name the middleware's topic on which a server of an action takes goals."""
    return f"rq{action}/_action/send_goalRequest"


class ActionTransport:
    """Sends deliveries as goals; of all goals the result of the last one counts.

    Parameters
    ----------
    node : Node
    controller : str
        Name of the controller.
    goals : ExecuteGoals or FollowGoals
        Those of the action.
    tolerances : AskedTolerances
        What every goal asks of the controller.
    on_result : callable
        Called with every delivery whose result has come, its code and its text.
    """

    def __init__(
        self,
        node: Node,
        controller: str,
        goals: "ExecuteGoals | FollowGoals",
        tolerances: AskedTolerances,
        on_result: OnResult,
    ) -> None:
        name = f"{controller}/{goals.name}"
        self.name = node.resolve_service_name(name)
        self._client = ask_action(node, goals.kind, name)
        self._goals, self._tolerances, self._on_result = goals, tolerances, on_result
        self._destroyed = False
        # Goals are numbered; the result of the last one counts.
        self._last = self._cancelled = 0
        self._handles: dict[int, Any] = {}

    @property
    def ready(self) -> bool:
        """Whether the controller serves the action."""
        return bool(self._client.server_is_ready())

    @property
    def runs(self) -> bool:
        """Whether the controller executes a goal."""
        return bool(self._handles)

    def send(self, execution: ExecutionRequest, message: JointTrajectory, moved: Moved) -> None:
        """Send the message of a delivery; `moved` says whether the robot has moved since."""
        self._last += 1
        number = self._last
        sent = self._client.send_goal_async(self._goals.goal(message, self._tolerances))
        sent.add_done_callback(lambda future: self._take_handle(number, execution, moved, future))

    def cancel(self) -> None:
        """Ask the controller to give up all that was sent, also what it has not accepted yet."""
        self._cancelled = self._last
        for handle in self._handles.values():
            handle.cancel_goal_async()

    def destroy(self) -> None:
        """Give up the action client; once is enough."""
        if not self._destroyed:
            self._destroyed = True
            self._client.destroy()

    def _take_handle(
        self, number: int, execution: ExecutionRequest, moved: Moved, future: Future
    ) -> None:
        if future.exception() is not None:
            text = f"sending the goal failed: {future.exception()}"
        elif not (handle := future.result()).accepted:
            text = f"action '{self.name}' rejected the goal without a reason"
        else:
            text = ""
        if text:
            self._conclude(number, execution, Code.REJECTED, text)
            return
        self._handles[number] = handle
        if number <= self._cancelled:
            handle.cancel_goal_async()
        result = handle.get_result_async()
        result.add_done_callback(lambda done: self._take_result(number, execution, moved, done))

    def _take_result(
        self, number: int, execution: ExecutionRequest, moved: Moved, future: Future
    ) -> None:
        self._handles.pop(number, None)
        if future.exception() is not None:
            text = f"asking for the result failed: {future.exception()}"
            verdict = MotionResult(Code.REJECTED, text)
        elif (answer := future.result()).status not in _ENDED:
            text = f"action '{self.name}' does not know the goal; how the motion ended is not known"
            verdict = MotionResult(Code.REJECTED, text)
        else:
            verdict = self._goals.verdict(answer.status, answer.result, moved())
        self._conclude(number, execution, *verdict)

    def _conclude(self, number: int, execution: ExecutionRequest, code: int, text: str) -> None:
        """Hand over the result of what was sent last."""
        if number == self._last:
            self._on_result(execution, code, text)
