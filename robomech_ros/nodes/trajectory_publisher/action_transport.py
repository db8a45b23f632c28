"""Goals of an action on their way to a controller, and their results."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalStatus
from rclpy.node import Node
from rclpy.task import Future
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.nodes.common.messages.execute_goals import AskedTolerances, ExecuteGoals
from robomech_ros.nodes.middleware.queue_depth import ask_action
from robomech_ros.outcomes import Code

if TYPE_CHECKING:
    from robomech_ros.nodes.common.messages.follow_goals import FollowGoals

OnResult = Callable[[ExecutionRequest, int, str], None]
Moved = Callable[[], bool]

_ENDED = (GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_ABORTED, GoalStatus.STATUS_CANCELED)


def request_topic(action: str) -> str:
    """Name the middleware's topic on which a server of an action takes goals."""
    return f"rq{action}/_action/send_goalRequest"


class ActionTransport:
    """Sends execution requests as goals; only the result of the latest goal counts.

    - ``goals``: writes the goals of the action, and reads its results.
    - ``tolerances``: tolerances of every goal.
    - ``on_result``: called with an execution request, and with the code and text of its result.
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
        """True if the controller serves the action."""
        return bool(self._client.server_is_ready())

    @property
    def runs(self) -> bool:
        """True if the controller executes a goal."""
        return bool(self._handles)

    def send(self, execution: ExecutionRequest, message: JointTrajectory, moved: Moved) -> None:
        """Send the message of a request; `moved` says whether the robot has moved since."""
        self._last += 1
        number = self._last

        def conclude(code: int, text: str) -> None:
            if number == self._last:
                self._on_result(execution, code, text)

        def take_handle(future: Future) -> None:
            if future.exception() is not None:
                conclude(Code.REJECTED, f"sending the goal failed: {future.exception()}")
                return
            handle = future.result()
            if not handle.accepted:
                text = f"action '{self.name}' rejected the goal without a reason"
                conclude(Code.REJECTED, text)
                return
            self._handles[number] = handle
            if number <= self._cancelled:
                handle.cancel_goal_async()
            handle.get_result_async().add_done_callback(take_result)

        def take_result(future: Future) -> None:
            self._handles.pop(number, None)
            if future.exception() is not None:
                conclude(Code.REJECTED, f"asking for the result failed: {future.exception()}")
                return
            answer = future.result()
            if answer.status in _ENDED:
                conclude(*self._goals.verdict(answer.status, answer.result, moved()))
            else:
                text = f"action '{self.name}' does not know the goal; how the motion ended is not "
                conclude(Code.REJECTED, f"{text}known")

        sent = self._client.send_goal_async(self._goals.goal(message, self._tolerances))
        sent.add_done_callback(take_handle)

    def cancel(self) -> None:
        """Ask the controller to give up all that was sent, also what it has not accepted yet."""
        self._cancelled = self._last
        for handle in self._handles.values():
            handle.cancel_goal_async()

    def destroy(self) -> None:
        """Destroy the action client, once."""
        if not self._destroyed:
            self._destroyed = True
            self._client.destroy()
