"""The simulated robot as a process of its own."""

import re
import signal

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from drivers import NAME, Driver, ended
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters

from robomech_interfaces.msg import ErrorCode
from robomech_ros.dynamics import gravity_torque
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.robots import load_robot

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
    arm.assert_smooth()
    np.testing.assert_allclose(
        arm.position, start + MOVE - np.array(result.final_position_error), atol=1e-9
    )


def test_a_signal_at_rest(drive_process):
    _, process = drive_process
    process.send_signal(signal.SIGINT)
    assert process.wait(TIMEOUT) == 0


def test_a_parameter_out_of_range(process):
    child = process(JointTrajectoryControllerNode, robot_description="puma560", publish_rate=5000.0)
    _, said = child.communicate(timeout=TIMEOUT)
    assert child.returncode == 2
    assert "'publish_rate' is 5000.0; allowed is a number from 1 to 1000 Hz" in said


# Path tolerance of the joints, rad, and what the tip may be off where it stands, m.
TRACKED, PLACED = 5e-3, 4e-3


@pytest.fixture
def dynamic_arm(graph, process):
    """A PUMA 560 with mass, friction and effort limits in a process of its own."""
    above = hand_down(load_robot("puma560"), np.zeros(6), 0.5, 0.2, 0.1)
    return Driver(graph, process, simulation="dynamic", initial_positions=above.tolist())


def carry(arm, mass):
    value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=mass)
    request = SetParameters.Request(parameters=[Parameter(name="payload_mass", value=value)])
    assert arm.graph.call(SetParameters, f"{NAME}/set_parameters", request).results[0].successful


def hand_down(chain, seed, x, y, z):
    """Return the posture nearest to another with the hand at a place (m), pointing down."""
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[:3, 3] = x, y, z
    return inverse_kinematics(chain, pose, seed=seed).q[0]


def go(arm, x, y, z, seconds=0.6):
    """Move the hand to a place, on the path within the tolerance."""
    goal = hand_down(arm.chain, arm.position, x, y, z)
    motion = arm.trajectory((seconds, goal - arm.position))
    status, result = arm.execute(motion, path_position_tolerance=[TRACKED] * 6)
    assert (status, result.error_msg) == (GoalStatus.STATUS_SUCCEEDED, "")
    arm.until(lambda: np.abs(arm.velocity).max() < 1e-4)
    place = forward_kinematics(arm.chain, arm.position)[:3, 3]
    assert np.linalg.norm(place - [x, y, z]) < PLACED


@pytest.mark.slow
def test_payloads_that_the_controller_does_not_know(dynamic_arm):
    """Pick and place of 2 kg is tracked; 40 kg are not, and what gives way is told."""
    arm = dynamic_arm
    go(arm, 0.5, 0.2, 0.0)
    carry(arm, 2.0)
    go(arm, 0.5, 0.2, 0.1)
    go(arm, 0.5, -0.2, 0.1, 1.0)
    go(arm, 0.5, -0.2, 0.0)
    arm.until(lambda: not arm.velocity.any())
    weight = arm.states[-1].effort - gravity_torque(arm.chain, arm.position)
    carry(arm, 0.0)
    go(arm, 0.5, -0.2, 0.1)
    # Friction holds some of the weight of 2 kg at half a metre.
    assert 5.0 < np.abs(weight).max() < 15.0
    carry(arm, 40.0)
    high = hand_down(arm.chain, arm.position, 0.5, -0.2, 0.2)
    lift = arm.trajectory((0.5, high - arm.position))
    status, result = arm.execute(lift, path_position_tolerance=[0.05] * 6)
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.PATH_TOLERANCE)
    told = r"joint '\w+' is 0\.\d+ rad off its path.*; joint '\w+' was at its effort limit for \d"
    assert re.match(told, result.error_msg)
    said = arm.diagnosis(lambda status: "effort limit" in status.message)
    assert said.level == said.WARN
    assert np.all(np.abs([state.effort for state in arm.states]) <= arm.chain.effort)
