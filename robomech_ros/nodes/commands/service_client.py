"""One call of a service whose type may have to be looked up in the graph."""

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import rclpy
from rclpy.node import Node

from robomech_ros.errors import RobomechError
from robomech_ros.errors.names import did_you_mean
from robomech_ros.nodes.commands.message_yaml import fill_message, interface_class, without_types
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.middleware.queue_depth import ask
from robomech_ros.nodes.middleware.retrying_client import RetriedRequest
from robomech_ros.nodes.process.memory import bounded_memory

_POLL, _SPIN = 0.02, 0.1
# How often it is looked whether the service is still there, s.
_LOOK = 0.2
_MOST_LISTED = 12


class NoAnswerError(RobomechError):
    """The service did not appear, or did not answer, in time."""


def call_service(service: str, kind: str, values: Mapping[str, Any], timeout: float) -> Any:
    """Call a service from a node of its own.

    A request that changes nothing is sent again while no answer comes.

    - ``service``: name, with or without the leading slash.
    - ``kind``: interface type, such as ``robomech_interfaces/srv/SolveIK``; empty: ask the graph.
    - ``values``: fields of the request.
    - ``timeout``: how long to wait for service and answer together (s).

    Returns the response.

    Raises NoAnswerError: there is no such service, it went or did not answer in time, or ROS was
    shut down. BadValueError, UnknownFieldError: the type or a field does not exist, or a value does
    not fit.
    """
    with command_node("robomech_call") as node:
        return answer_of(node, service, kind, values, timeout)


@contextmanager
def command_node(name: str, namespace: str = "") -> Iterator[Node]:
    """Make a node for one command in its own context; NoAnswerError after a shutdown of ROS."""
    rclpy.init(args=[])
    try:
        node = Node(name, namespace=namespace, enable_rosout=False, start_parameter_services=False)
        try:
            with bounded_memory():
                yield node
        finally:
            node.destroy_node()
    except Exception:
        # Each of rclpy's functions has an exception of its own for a context that is gone.
        if rclpy.ok():
            raise
        raise NoAnswerError("ROS was shut down before the answer came") from None
    finally:
        rclpy.try_shutdown()


def latched_message(node: Node, kind: Any, topic: str, timeout: float) -> Any:
    """Wait for a message of a latched topic; None where none comes in time (s)."""
    received: list[Any] = []
    subscription = node.create_subscription(kind, topic, received.append, LATCHED)
    deadline = time.monotonic() + timeout
    while not received and time.monotonic() < deadline:
        rclpy.spin_once(node, timeout_sec=_SPIN)
    node.destroy_subscription(subscription)
    return received[0] if received else None


def answer_of(node: Node, name: str, kind: str, values: Mapping[str, Any], timeout: float) -> Any:
    """Call a service from a node; see :func:`call_service`."""
    deadline = time.monotonic() + timeout
    service = f"/{name.removeprefix('/')}"
    interface = interface_class(kind or _type_in_graph(node, service, deadline))
    request = interface.Request()
    fill_message(request, values)
    client = ask(node, interface, service)
    if not client.wait_for_service(timeout_sec=max(0.0, deadline - time.monotonic())):
        raise NoAnswerError(f"service '{service}' is not there after {timeout:g} s")
    question = RetriedRequest(client, interface, request)
    while not question.answered.done():
        left = deadline - time.monotonic()
        if left < 0.0:
            raise NoAnswerError(f"service '{service}' did not answer within {timeout:g} s")
        there = client.service_is_ready()
        rclpy.spin_until_future_complete(node, question.answered, timeout_sec=min(left, _LOOK))
        # An answer may come just before its server goes.
        if not (there or question.answered.done()):
            raise NoAnswerError(f"service '{service}' has gone before it answered")
        question.repeat_if_due()
    return question.answer()


def _type_in_graph(node: Node, service: str, deadline: float) -> str:
    while True:
        services = dict(node.get_service_names_and_types())
        if service in services:
            return str(services[service][0])
        if time.monotonic() > deadline:
            break
        time.sleep(_POLL)
    names = [name for name in sorted(services) if not _is_plumbing(name)]
    there = ", ".join(names[:_MOST_LISTED]) or "none, is anything running?"
    hint = without_types(service) or did_you_mean(service, names)
    raise NoAnswerError(f"service '{service}' did not appear{hint}; there are: {there}")


def _is_plumbing(service: str) -> bool:
    """Return whether a service is one of those that every node has, or belongs to an action."""
    last = service.rsplit("/", 1)[-1]
    return "parameter" in last or "type_description" in last or "/_action/" in service
