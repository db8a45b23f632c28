"""Services that hold a burst of requests, and that answer each of them, errors too."""

import inspect
import traceback
from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.service import Service
from std_srvs.srv import Trigger

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.messages.error_codes import answer, code_of
from robomech_ros.nodes.middleware.queue_depth import DEEP
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog


def serve(
    node: Node,
    kind: Any,
    name: str,
    callback: Callable[[Any, Any], Any],
    *,
    callback_group: CallbackGroup | None = None,
) -> Service:
    """Create a service that keeps up to `queue_depth.DEPTH` waiting requests.

    Where the callback, plain or async, fails, the answer is an empty one with the code and the
    text of the error, or the text as its `message`, if it has such fields. Errors other than
    RobomechError are defects: the code is INTERNAL, and the traceback is logged.
    """
    log = ThrottledLog(node.get_logger())

    async def answered(request: Any, response: Any) -> Any:
        try:
            found = callback(request, response)
            return await found if inspect.isawaitable(found) else found
        except Exception as error:
            refusal, text = type(response)(), str(error)
            has_code, has_text = hasattr(refusal, "error_msg"), hasattr(refusal, "message")
            if not (isinstance(error, RobomechError) and (has_code or has_text)):
                log.error(f"{name} failed, please report this:\n{traceback.format_exc()}")
                text = f"internal error, please report it: {type(error).__name__}: {error}"
            if has_code:
                return answer(refusal, code_of(error), text)
            if has_text:
                refusal.message = text
            return refusal

    return node.create_service(
        kind, name, answered, qos_profile=DEEP, callback_group=callback_group
    )


def serve_trigger(
    node: Node, name: str, act: Callable[[], Any], callback_group: CallbackGroup | None = None
) -> None:
    """Serve a Trigger by a function or a coroutine that returns the message of its success."""

    async def answered(request: Any, response: Any) -> Any:
        said = act()
        response.message = await said if inspect.isawaitable(said) else said
        response.success = True
        return response

    serve(node, Trigger, name, answered, callback_group=callback_group)
