"""The trajectory publisher when processes die."""

import signal

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
    arm = suite(with_controller=False, controller_timeout=2.0, transport=transport)
    # One that is killed may block the shared memory of the middleware until its lease of 20 s ends.
    arm.plan(0.0, MOVE, duration=60.0)
    waiting = arm.start_execute()
    arm.until_moving()
    controller.kill()
    controller.wait(TIMEOUT)
    answer = ended(waiting)
    assert answer.error_code == ErrorCode.REJECTED
    assert answer.error_msg.startswith("the controller is gone: no joint states of waist, shoulder")
    assert "how the motion ended is not known; at last joint '" in answer.error_msg
    assert answer.duration.sec < 60
