"""The trajectory publisher when processes die."""

import signal

import numpy as np
import pytest

from robomech_interfaces.msg import ErrorCode

MOVE = np.full(6, 0.1)
TIMEOUT = 30.0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_in_mid_motion(suite, process, number):
    arm = suite(start=process)
    waiting = arm.start_execute(arm.trajectory(0.0, MOVE, duration=1.5))
    arm.until_moving()
    arm.node.send_signal(number)
    assert arm.node.wait(TIMEOUT) == 0
    arm.until(waiting.done)
    assert waiting.result().error_code == ErrorCode.REJECTED
    assert "the trajectory publisher shuts down" in waiting.result().error_msg
    # The motion goes on to its end without it.
    arm.until_at(arm.home + MOVE)


def test_a_controller_that_is_killed(suite, drive_process):
    _, controller = drive_process
    arm = suite(controller=False, arrival_timeout=0.3, controller_timeout=0.5)
    waiting = arm.start_execute(arm.trajectory(0.0, MOVE, duration=0.8))
    arm.until_moving()
    controller.kill()
    controller.wait(TIMEOUT)
    arm.condition(lambda status: "idle" in status.message)
    answer = waiting.result()
    assert answer.error_code == ErrorCode.TIMED_OUT
    assert "no result from the controller" in answer.error_msg
