"""Services and actions whose queues hold a burst of calls, and that answer each of them.

The default queue of a ROS service holds ten requests; those that come while it is full vanish,
and their clients wait for ever. The same holds for a client's queue of answers:
https://github.com/ros2/rmw/issues/372, open in November 2026. Look again in May 2027.
"""

import inspect
import traceback
from collections.abc import Awaitable, Callable
from typing import Any

from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import CallbackGroup
from rclpy.client import Client
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.service import Service
from rclpy.task import Future
from std_srvs.srv import Trigger

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.outcomes import Code

# Calls that a queue holds; a thousand at once took 30 MB.
DEPTH = 2000
_DEEP = QoSProfile(depth=DEPTH)
# The three services of an action.
_ACTION = ("goal_service_qos_profile", "result_service_qos_profile", "cancel_service_qos_profile")


def serve(
    node: Node,
    kind: Any,
    name: str,
    callback: Callable[[Any, Any], Any],
    *,
    callback_group: CallbackGroup | None = None,
) -> Service:
    """Create a service that keeps up to `DEPTH` waiting requests.

    Where the callback, plain or async, fails, the traceback is logged, and the answer is an empty
    one: INTERNAL with a text, or the text as its `message`, if it has such fields.
    """
    log = ThrottledLog(node.get_logger())
    waits = inspect.iscoroutinefunction(callback)

    async def answered(request: Any, response: Any) -> Any:
        try:
            answer = callback(request, response)
            return await answer if waits or inspect.isawaitable(answer) else answer
        except Exception as error:
            text = f"{name} failed, please report this:\n{traceback.format_exc()}"
            log.error(text)
            return _internal(type(response)(), error)

    return node.create_service(
        kind, name, answered, qos_profile=_DEEP, callback_group=callback_group
    )


def serve_trigger(
    node: Node, name: str, act: Callable[[], Any], callback_group: CallbackGroup | None = None
) -> None:
    """Serve a Trigger by a function or a coroutine that returns the message of its success.

    A RobomechError of it is the message of its failure.
    """

    async def answered(request: Any, response: Any) -> Any:
        try:
            said = act()
            response.message = await said if inspect.isawaitable(said) else said
            response.success = True
        except RobomechError as error:
            response.message = str(error)
        return response

    serve(node, Trigger, name, answered, callback_group=callback_group)


def _internal(answer: Any, error: Exception) -> Any:
    """Say in an empty answer that the node has a defect."""
    text = f"internal error, please report it: {type(error).__name__}: {error}"
    if hasattr(answer, "error_msg"):
        answer.error_code, answer.error_msg = int(Code.INTERNAL), text
    elif hasattr(answer, "message"):
        answer.message = text
    return answer


def ask(node: Node, kind: Any, name: str) -> Client:
    """Create a client that keeps up to `DEPTH` answers, its own and those of other clients."""
    return node.create_client(kind, name, qos_profile=_DEEP)


def serve_action(
    node: Node, kind: Any, name: str, execute: Callable[[Any], Awaitable[Any]], **options: Any
) -> ActionServer:
    """Create an action server that keeps up to `DEPTH` goals, cancellations and asked results.

    What a goal asked for is kept until it has ended, and no longer.
    """

    async def executed(handle: Any) -> Any:
        try:
            return await execute(handle)
        finally:
            # rclpy keeps it beside the result: 7 MB of each trajectory of 10,000 points.
            handle._goal_request = None

    return ActionServer(node, kind, name, executed, **dict.fromkeys(_ACTION, _DEEP), **options)


def ask_action(node: Node, kind: Any, name: str) -> ActionClient:
    """Create an action client that keeps up to `DEPTH` answers."""
    return _GoalSender(node, kind, name, **dict.fromkeys(_ACTION, _DEEP))


class _GoalSender(ActionClient):
    """Keeps nothing of goals that are over."""

    def send_goal_async(self, *arguments: Any, **options: Any) -> Future:
        """Send a goal; see ActionClient."""
        known = set(self._futures)
        answer = super().send_goal_async(*arguments, **options)
        # rclpy 9.1 makes two futures for each goal, one of which is never done and kept for ever.
        # Mended by https://github.com/ros2/rclpy/pull/1532: remove this with the last rclpy before.
        for future in set(self._futures) - known - {answer}:
            self.remove_future(future)
        return answer
