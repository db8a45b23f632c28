"""Pauses leave nothing behind in their node."""

import gc

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger

from robomech_ros.nodes.common.cooperative_wait import ended_within, passing_timer, pause
from robomech_ros.nodes.common.services import serve

PAUSES = 10


class Pausing(Node):
    def __init__(self, **options):
        super().__init__("pausing", **options)
        serve(self, Trigger, "~/pause", self._pause)
        serve(self, Trigger, "~/end", self._end)

    async def _pause(self, request, response):
        for _ in range(PAUSES):
            await pause(self)
        response.success = True
        return response

    async def _end(self, request, response):
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        for _ in range(PAUSES):
            done = Future()
            timer = passing_timer(self, 1e-4, lambda done=done: done.set_result(None), clock)
            await ended_within(self, done, 1e3)
            self.destroy_timer(timer)
        response.success = True
        return response


def traces(node):
    """Count what the node and its callback group know of timers and other entities."""
    return len(node.default_callback_group.entities), len(list(node.timers))


def test_neither_pauses_nor_timers_that_are_destroyed_leave_anything_behind(graph):
    node = graph.start(Pausing)
    services = ("pausing/pause", "pausing/end")
    for service in services:
        assert graph.ask(Trigger, service).success
    gc.collect()
    before = traces(node)
    for service in services:
        assert graph.ask(Trigger, service).success
    gc.collect()
    assert traces(node) == before
