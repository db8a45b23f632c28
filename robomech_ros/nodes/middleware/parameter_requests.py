"""Answers to malformed parameter requests.

rclpy lets the exception out of its callbacks, as if the node had a defect, and answers nobody.
"""

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.service import Service

from robomech_ros.nodes.middleware.sparing_log import SparingLog


def guard_parameter_services(node: Node) -> None:
    """Reject malformed parameter requests with the reason, logged in one line.

    Parameters
    ----------
    node : Node
        Owner of the services; the existing ones get the guard.
    """
    for service in node.services:
        if service.srv_type.__module__.startswith("rcl_interfaces."):
            service.callback = _guarded(node, service, service.callback)


def _guarded(node: Node, service: Service, callback: Callable[[Any, Any], Any]) -> Any:
    log = SparingLog(node.get_logger())

    def guarded(request: Any, response: Any) -> Any:
        given = getattr(request, "parameters", ())
        reason = next(filter(None, map(_fault, given)), "")
        if not reason:
            return callback(request, response)
        log.warning(f"rejected a malformed request on '{service.srv_name}': {reason}")
        result = SetParametersResult(reason=reason)
        if isinstance(response, SetParametersAtomically.Response):
            response.result = result
        elif isinstance(response, SetParameters.Response):
            response.results = [result for _ in given]
        return response

    return guarded


def _fault(message: Any) -> str:
    """Say what is wrong with a parameter of a message; empty if nothing is."""
    try:
        Parameter.from_parameter_msg(message)
    except (TypeError, ValueError) as error:
        return f"parameter {message.name!r} of the type {message.value.type}: {error}"
    return ""
