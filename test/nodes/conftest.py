"""Real nodes in this process, over real DDS, alone in a domain of their own."""

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions

from robomech_ros.nodes.process.free_domain import free_domain
from robomech_ros.nodes.process.run import Spinner

sys.path.insert(0, str(Path(__file__).parent))

# Long, since a machine may be busy; nothing waits longer than it has to.
TIMEOUT = 30.0


@pytest.fixture
def domain_id(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain that no other test, of this run or of another, uses at the same time."""
    with free_domain() as number:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
        yield number


class Graph:
    """Nodes of one test in a context of their own, each spinning in a thread of its own."""

    def __init__(self, domain_id: int) -> None:
        self.context = rclpy.Context()
        rclpy.init(
            args=[],
            context=self.context,
            domain_id=domain_id,
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self._spinners: list[Spinner] = []
        self._nodes: list[Node] = []
        self._client: Node | None = None

    def start(self, factory: Callable[..., Node], *, namespace: str = "", **parameters: Any) -> Any:
        """Make a node with these parameters and let it spin."""
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        node = factory(context=self.context, namespace=namespace, parameter_overrides=overrides)
        self._spin(node)
        return node

    @property
    def client(self) -> Node:
        """A node for the test's own clients, publishers and subscriptions; it spins, too."""
        if self._client is None:
            self._client = Node("test_client", context=self.context)
            self._spin(self._client)
        return self._client

    def _spin(self, node: Node) -> None:
        self._nodes.append(node)
        self._spinners.append(Spinner([node], self.context))
        self._spinners[-1].start()

    def call(self, kind: Any, service: str, request: Any) -> Any:
        """Call a service once and return its answer."""
        client = self.client.create_client(kind, service)
        try:
            assert client.wait_for_service(TIMEOUT), f"no service {service}"
            return wait_for(client.call_async(request))
        finally:
            self.client.destroy_client(client)

    def ask(self, kind: Any, service: str, **fields: Any) -> Any:
        """Call a service with the fields of a request and return its answer."""
        return self.call(kind, service, kind.Request(**fields))

    def call_until(
        self, kind: Any, service: str, request: Any, accept: Callable[[Any], bool]
    ) -> Any:
        """Call a service again and again until an answer is accepted; gives that."""
        deadline = time.monotonic() + TIMEOUT
        while not accept(answer := self.call(kind, service, request)):
            assert time.monotonic() < deadline, answer
        return answer

    def start_call(self, kind: Any, service: str, request: Any) -> Any:
        """Call a service without waiting; returns the future of its answer."""
        client = self.client.create_client(kind, service)
        assert client.wait_for_service(TIMEOUT), f"no service {service}"
        return client.call_async(request)

    @staticmethod
    def wait_for(future: Any) -> Any:
        """Wait for the result of a future that another thread completes."""
        return wait_for(future)

    def receive(self, kind: Any, topic: str, qos: Any, accept: Callable[[Any], bool]) -> Any:
        """Wait for a message on a topic that is accepted."""
        received: list[Any] = []
        there = threading.Event()

        def take(message: Any) -> None:
            if not there.is_set() and accept(message):
                received.append(message)
                there.set()

        subscription = self.client.create_subscription(kind, topic, take, qos)
        try:
            assert there.wait(TIMEOUT), f"no message on {topic}"
        finally:
            self.client.destroy_subscription(subscription)
        return received[0]

    def close(self) -> None:
        for spinner in self._spinners:
            spinner.stop()
        if self._client is not None:
            destroy_actions(self._client)
        for node in self._nodes:
            node.destroy_node()
        self.context.try_shutdown()


def destroy_actions(node: Node) -> None:
    """Destroy the actions of a node, which destroy_node() leaves alive.

    With them the context keeps its place in the domain, and DDS looks at 32 places on a machine.
    """
    for waitable in tuple(node.waitables):
        if isinstance(waitable, ActionClient | ActionServer):
            waitable.destroy()


def wait_for(future: Any) -> Any:
    """Wait for a future that another thread completes."""
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    assert done.wait(TIMEOUT), "no answer"
    return future.result()


@pytest.fixture
def graph(domain_id: int) -> Iterator[Graph]:
    """The nodes of one test; all are stopped and destroyed at its end."""
    result = Graph(domain_id)
    yield result
    result.close()


@pytest.fixture(scope="module")
def shared() -> Iterator[Callable[..., Graph]]:
    """Start a node, or take the one with the same parameters, for tests that leave no trace in it.

    Each has a context of its own.
    """
    started: dict[Any, Graph] = {}
    with ExitStack() as stack:

        def start(factory: Callable[..., Node], **parameters: Any) -> Graph:
            key = factory, tuple(sorted(parameters.items()))
            if key not in started:
                started[key] = Graph(stack.enter_context(free_domain()))
                stack.callback(started[key].close)
                started[key].start(factory, **parameters)
            return started[key]

        yield start
