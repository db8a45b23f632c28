"""The simulated robot as a process of its own."""

import signal

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from drivers import ended

from robomech_interfaces.msg import ErrorCode
from robomech_ros.nodes.joint_state_simulator_node import JointStateSimulatorNode

MOVE = np.full(6, 0.4)
TIMEOUT = 30.0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_in_mid_motion(drive_process, number):
    arm, process = drive_process
    start = arm.position
    handle = arm.send(arm.trajectory((2.0, MOVE)))
    arm.until(lambda: arm.position[0] - start[0] > 0.05)
    waiting = arm.ask(handle.get_result_async)
    process.send_signal(number)
    answer = ended(waiting)
    status, result = answer.status, answer.result
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.PREEMPTED)
    assert result.error_msg == "the controller shuts down; the robot holds"
    assert result.final_position_error[0] > 0.1
    assert process.wait(TIMEOUT) == 0
    arm.until(lambda: not arm.velocity.any())
    velocities = np.array([state.velocity for state in arm.states])
    # A cycle may be missed on a busy machine, but there is no step from motion to rest.
    assert np.abs(velocities[-1] - velocities[-2]).max() < 0.5 * np.abs(velocities).max()
    np.testing.assert_allclose(
        arm.position, start + MOVE - np.array(result.final_position_error), atol=1e-9
    )


def test_a_signal_at_rest(drive_process):
    _, process = drive_process
    process.send_signal(signal.SIGINT)
    assert process.wait(TIMEOUT) == 0


def test_a_parameter_out_of_range(process):
    child = process(JointStateSimulatorNode, robot_description="puma560", publish_rate=5000.0)
    _, said = child.communicate(timeout=TIMEOUT)
    assert child.returncode == 2
    assert "'publish_rate' is 5000.0; allowed is a number from 1 to 1000 Hz" in said
