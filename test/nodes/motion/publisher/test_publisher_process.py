"""The trajectory publisher when processes die."""

import signal
import time

import numpy as np
import pytest
from drivers import ended

from robomech_interfaces.msg import ErrorCode

MOVE = np.full(6, 0.1)
TIMEOUT = 30.0


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_in_mid_motion(suite, process, number):
    arm = suite(start=process)
    waiting = arm.start_execute(arm.trajectory(0.0, MOVE, duration=3.0))
    arm.until_moving()
    arm.node.send_signal(number)
    assert arm.node.wait(TIMEOUT) == 0
    arm.until(waiting.done)
    assert waiting.result().error_code == ErrorCode.REJECTED
    assert "the trajectory publisher shuts down" in waiting.result().error_msg
    # The motion goes on to its end without it.
    arm.until_at(arm.home + MOVE)


@pytest.mark.slow
@pytest.mark.parametrize("transport", ["topic", "action"])
def test_a_controller_that_is_killed(suite, drive_process, transport):
    _, controller = drive_process
    arm = suite(with_controller=False, controller_timeout=3000.0, transport=transport)
    # One that is killed may block the shared memory of the middleware until its lease of 20 s ends.
    arm.plan(0.0, MOVE, duration=60.0)
    waiting = arm.start_execute()
    arm.until_moving()
    # Its first sign of life is to have come.
    seen = len(arm.states)
    arm.until(lambda: len(arm.states) > seen + 100)
    controller.kill()
    controller.wait(TIMEOUT)
    killed = time.monotonic()
    answer = ended(waiting)
    # Its lease is 1 s, and that of the middleware 20 s.
    assert time.monotonic() - killed < 10.0
    assert answer.error_code == ErrorCode.REJECTED
    assert answer.error_msg.startswith("the controller has died: its process is gone, or stands")
    assert "how the motion ended is not known; at last joint '" in answer.error_msg
    assert answer.duration.sec < 60


@pytest.mark.slow
def test_a_controller_that_is_stopped_for_a_while_is_served_again(suite, drive_process):
    _, controller = drive_process
    arm = suite(with_controller=False)
    waiting = arm.start_execute(arm.trajectory(0.0, MOVE, duration=60.0))
    arm.until_moving()
    controller.send_signal(signal.SIGSTOP)
    assert "the controller has died" in ended(waiting).error_msg
    controller.send_signal(signal.SIGCONT)
    arm.until(lambda: not arm.velocity.any())
    here = arm.position - arm.home
    answer = arm.execute(arm.trajectory(here, here + MOVE, duration=1.0))
    assert (answer.error_code, answer.error_msg) == (ErrorCode.NONE, "")
