"""The servo node with robots that do not follow, clocks that jump, and signals on the way."""

import signal
import time

import numpy as np
import pytest
from drivers import NAME
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from servo_operator import START, Operator

from robomech_interfaces.msg import ServoStatus


def stick(hand, joints):
    """Have joints of the simulated robot stuck from now on."""
    value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=joints)
    request = SetParameters.Request(parameters=[Parameter(name="fault_stuck_joints", value=value)])
    assert hand.graph.call(SetParameters, f"{NAME}/set_parameters", request).results[0].successful


def has_lost(hand, joint):
    """Whether the servo has said that a joint does not follow, and how far it is off."""
    return hand.has_code(ServoStatus.NO_STATE, f"joint '{joint}' is ")


@pytest.mark.slow
def test_a_stuck_joint_stops_the_stream_which_begins_again_where_the_robot_is(operator):
    hand = operator(arm={"goal_time": 0.2}, tracking_tolerance=0.05)
    send = hand.speeds(["waist", "elbow"], [0.4, -0.4])
    hand.repeat(send, lambda: hand.arm.position[0] > 0.35)
    stick(hand, "elbow")
    hand.repeat(send, lambda: has_lost(hand, "elbow"))
    said = hand.last_status()
    assert list(said.joint_names) == ["elbow"] and np.isnan(said.condition_number)
    assert "off its command, the tolerance is 0.05 rad; the stream has stopped" in said.message
    off = float(said.message.split(" is ")[1].split()[0])
    assert 0.05 < off < 3.0
    streamed = len(hand.streamed)
    assert not any(hand.streamed[-1][1].points[-1].velocities)
    hand.wait_for(lambda: not hand.arm.velocity.any())
    assert len(hand.streamed) == streamed
    # The controller gives up, too, and stands where the joints are.
    hand.arm.diagnosis(lambda status: "off its goal" in str(status))
    stick(hand, "")
    place = hand.arm.position
    hand.repeat(send, lambda: hand.arm.position[2] < place[2] - 0.1)
    first = hand.streamed[streamed][1].points[0].positions
    np.testing.assert_allclose(first, place, atol=0.05)
    hand.until_still()


def test_joints_that_follow_late_are_no_fault(simulated_time, operator):
    """By simulated time that waits for them: on a busy machine they follow later than that."""
    hand = operator(arm={"fault_delay": 0.1, "use_sim_time": True}, use_sim_time=True)
    simulated_time.wait_for(hand.arm.states)
    start = hand.arm.position[0]
    hand.repeat(hand.speeds(["waist"], [1.5]), lambda: hand.arm.position[0] > start + 0.6)
    hand.until_still()
    assert ServoStatus.NO_STATE not in {m.code for _, m in hand.statuses}


def test_any_deviation_is_taken_where_none_is_looked_for(operator):
    hand = operator(arm={"fault_stuck_joints": "elbow"}, tracking_tolerance=0.0)
    start = hand.arm.position
    send = hand.speeds(["waist", "elbow"], [0.5, -0.5])
    hand.repeat(send, lambda: hand.arm.position[0] > start[0] + 0.3)
    assert ServoStatus.NO_STATE not in {m.code for _, m in hand.statuses}


def test_a_robot_that_falls_silent_is_let_go(drive_process, graph):
    arm, process = drive_process
    hand = Operator(arm, graph)
    send = hand.speeds(["waist"], [0.2])
    hand.repeat(send, lambda: len(hand.streamed) > 10)
    process.kill()
    text = "no state of the joints for 0."
    hand.repeat(send, lambda: hand.has_code(ServoStatus.NO_STATE, text))
    hand.repeat(send, lambda: hand.has_code(ServoStatus.NO_STATE, "waits for a new state"))


@pytest.mark.parametrize("jump", [-100.0, -0.3, 5.0, 3600.0])
def test_a_clock_that_jumps_while_the_robot_moves(simulated_time, operator, jump):
    """It is driven on, without a jump of its own."""
    hand = operator(arm={"use_sim_time": True}, use_sim_time=True)
    start = hand.arm.position[0]
    send = hand.speeds(["waist"], [0.4])
    hand.repeat(send, lambda: hand.arm.position[0] > start + 0.1)
    simulated_time.jump(jump)
    before = hand.arm.position[0]
    hand.repeat(send, lambda: hand.arm.position[0] > before + 0.2)
    hand.until_still()
    positions = np.array([state.position for state in hand.arm.states])
    assert np.abs(np.diff(positions, axis=0)).max() < 0.1
    # Points that were refused, or came too soon, bend the end of the stream a little.
    assert (np.maximum.accumulate(positions[:, 0]) - positions[:, 0]).max() < 0.01
    for _, message in hand.streamed:
        assert not any(message.points[-1].velocities)


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_on_the_way_brakes_the_robot(drive, graph, process, number):
    child = []

    def start(node, **parameters):
        child.append(process(node, **parameters))

    hand = Operator(drive(initial_positions=START), graph, start=start)
    send = hand.twist((0, 0.2, 0))
    hand.repeat(send, lambda: len(hand.streamed) > 20 and hand.arm.velocity.any())
    child[0].send_signal(number)
    assert child[0].wait(30.0) == 0
    hand.wait_for(lambda: not hand.arm.velocity.any())
    last = hand.streamed[-1][1].points[-1]
    assert not any(last.velocities)
    np.testing.assert_allclose(hand.arm.position, last.positions, atol=1e-6)
    hand.arm.assert_smooth()


@pytest.mark.slow
def test_commands_from_a_time_when_the_servo_was_held_up_move_nothing(drive, graph, process):
    """The sender of such commands may have let go since."""
    child = []

    def start(node, **parameters):
        child.append(process(node, **parameters))

    hand = Operator(drive(initial_positions=START), graph, start=start)
    send = hand.speeds(["waist"], [0.8])
    hand.repeat(send, lambda: hand.arm.velocity[0] > 0.7)
    child[0].send_signal(signal.SIGSTOP)
    stopped = time.monotonic()
    hand.repeat(send, lambda: not hand.arm.velocity.any() and time.monotonic() > stopped + 1.0)
    place, told = hand.arm.position, len(hand.statuses)
    child[0].send_signal(signal.SIGCONT)
    hand.wait_for(lambda: len(hand.statuses) > told + 3)
    hand.until_still()
    np.testing.assert_allclose(hand.arm.position, place, atol=1e-6)
    hand.repeat(send, lambda: hand.arm.position[0] > place[0] + 0.1)
    hand.until_still()


def test_a_pause_in_full_motion_brakes_within_limits(operator):
    hand = operator()
    limits = hand.arm.chain
    send = hand.speeds(["waist"], [1.5])
    hand.repeat(send, lambda: hand.arm.velocity[0] > 1.0)
    paused = time.monotonic()
    hand.pause(True)
    hand.until_still()
    braking = [m for at, m in hand.streamed if at > paused]
    for message in braking:
        times = [p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in message.points]
        speeds = np.array([p.velocities for p in message.points])
        rates = np.abs(np.diff(speeds, axis=0)) / np.diff(times)[:, None]
        assert (rates <= limits.acceleration * (1 + 1e-6)).all()
    last = hand.streamed[-1][1].points[-1]
    np.testing.assert_allclose(hand.arm.position, last.positions, atol=1e-6)
