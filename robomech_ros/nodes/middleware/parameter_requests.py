"""Requests to the services that rclpy makes for parameters, as their senders made them wrong."""

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.service import Service

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.middleware.bounded_requests import bounded_service
from robomech_ros.nodes.middleware.sparing_log import SparingLog

__all__ = ["guard_parameter_services"]


def guard_parameter_services(node: Node) -> None:
    """Have what nobody can read answered with the reason, or empty, and logged in one line.

    rclpy lets the error out of its callbacks, as if the node had a defect, and answers nobody.

    Parameters
    ----------
    node : Node
        Owner of the services; those that are there get the guard.
    """
    for service in node.services:
        ours = not service.srv_type.__module__.startswith("rcl_interfaces.")
        service.srv_type = bounded_service(service.srv_type)
        if not ours:
            service.callback = _guarded(node, service, service.callback)


def _guarded(node: Node, service: Service, callback: Callable[[Any, Any], Any]) -> Any:
    log = SparingLog(node.get_logger())

    def guarded(request: Any, response: Any) -> Any:
        try:
            given = getattr(request, "parameters", ())
            faults = [_fault(parameter) for parameter in given]
            if not any(faults):
                return callback(request, response)
        except RobomechError as error:
            given, faults = (), [str(error)]
        reason = next(fault for fault in faults if fault)
        log.warning(
            f"passed over on '{service.srv_name}': its sender made the request wrong: {reason}"
        )
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
