"""A controller whose answers, feedback or status are bytes that are no message."""

import re
import struct
from pathlib import Path

import pytest
from drivers import Driver
from raw_answers import raw_answers

from robomech_interfaces.action import ExecuteTrajectory
from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import Execute
from robomech_ros.nodes.process.memory import LARGEST_DATA
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode

SENT = ExecuteTrajectory.Impl
# The end of a goal that succeeded, and five million names of joints that do not come.
ANNOUNCING = b"\4\0\0\0" + struct.pack("<I", 5_000_000) + bytes(49)
STEP = 0.05
# What a node may hold, MB: its data are bounded, libraries come to that.
MOST = 1e-6 * LARGEST_DATA + 500.0


def largest_ever(process):
    """Return the most that a process ever held, MB."""
    text = Path(f"/proc/{process.pid}/status").read_text()
    return int(re.search(r"VmHWM:\s+(\d+)", text)[1]) / 1e3


@pytest.mark.slow
def test_the_publisher_says_what_it_does_not_know_and_goes_on(graph, process):
    patience = {"controller_timeout": 5.0, "controller_lease": 10.0}
    publisher = process(TrajectoryPublisherNode, **patience)
    arm = Driver(graph, graph.start)
    home = arm.position

    def execute(step):
        request = Execute.Request(trajectory=arm.trajectory((0.3, home + step - arm.position)))
        return graph.call(Execute, "trajectory_publisher/execute", request).error_code

    assert execute(STEP) == ErrorCode.NONE
    for number, (kind, data, code) in enumerate(
        (
            (SENT.SendGoalService.Response, b"", ErrorCode.TIMED_OUT),
            (SENT.GetResultService.Response, b"\xff" * 300, ErrorCode.REJECTED),
            (SENT.GetResultService.Response, ANNOUNCING, ErrorCode.TIMED_OUT),
            (SENT.FeedbackMessage, b"\xff" * 300, ErrorCode.NONE),
            (SENT.GoalStatusMessage, b"\xff" * 300, ErrorCode.NONE),
        )
    ):
        with raw_answers(kind, data):
            assert execute(-STEP if number % 2 else 0.0) == code, (kind, data)
    assert execute(STEP) == ErrorCode.NONE
    assert publisher.poll() is None
    assert largest_ever(publisher) < MOST
