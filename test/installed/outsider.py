"""Somebody who knows of the suite only what is on the network."""

from __future__ import annotations

import threading

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import JointState

from robomech_ros.nodes.process.run import Spinner

PATIENCE = 60.0


class Outsider:
    """A process (this one) that knows of the suite only what is on the network."""

    def __init__(self, domain: int) -> None:
        self.context = rclpy.Context()
        rclpy.init(
            args=[],
            context=self.context,
            domain_id=domain,
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self.node = Node("outsider", context=self.context)
        self._spinner = Spinner([self.node], self.context)
        self._spinner.start()
        self._clients = {}

    def close(self):
        self._spinner.stop()
        self.node.destroy_node()
        self.context.try_shutdown()

    def client(self, kind, service):
        """Return the client of a service."""
        if service not in self._clients:
            self._clients[service] = self.node.create_client(kind, service)
        return self._clients[service]

    def call(self, kind, service, request):
        client, done = self.client(kind, service), threading.Event()
        assert client.wait_for_service(PATIENCE), f"no {service}"
        future = client.call_async(request)
        future.add_done_callback(lambda _: done.set())
        assert done.wait(PATIENCE), f"{service} does not answer"
        return future.result()

    def wait_for_joints(self, accept, topic="joint_states"):
        """Wait for a joint state that is accepted."""
        found = []
        there = threading.Event()

        def take(message):
            if not there.is_set() and accept(
                dict(zip(message.name, message.position, strict=True))
            ):
                found.append(message)
                there.set()

        subscription = self.node.create_subscription(JointState, topic, take, 10)
        try:
            assert there.wait(PATIENCE), f"no such state on {topic}"
        finally:
            self.node.destroy_subscription(subscription)
        return found[0]
