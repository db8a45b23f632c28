"""Pause, resume, cancel and speed: the robot keeps to its path, and whoever waits is told."""

import math

import numpy as np
import pytest
from drivers import ROBOT, ended
from std_srvs.srv import Trigger

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import SetSpeed

MOVE = np.array([0.6, -0.3, 0.48, 0.2, 0.3, -0.4])
TRANSPORTS = ("topic", "action", "follow_joint_trajectory")


def trigger(arm, service):
    answer = arm.graph.call(Trigger, f"trajectory_publisher/{service}", Trigger.Request())
    return answer.success, answer.message


def set_speed(arm, speed):
    request = SetSpeed.Request(speed=speed)
    return arm.graph.call(SetSpeed, "trajectory_publisher/set_speed", request)


def assert_on_the_path(arm, path=MOVE):
    """All states are on the straight line of joint positions, and no speed steps."""
    times, positions, velocities = arm.path()
    positions -= arm.home
    along = positions @ path / (path @ path)
    np.testing.assert_allclose(positions, np.outer(along, path), atol=1e-6)
    assert np.diff(along).min() > -1e-6
    allowed = 2.0 * arm.chain.acceleration * (np.diff(times) + 0.03)[:, None]
    assert (np.abs(np.diff(velocities, axis=0)) <= allowed).all()


def part_done(arm):
    if not arm.states:
        return 0.0
    return float((arm.position - arm.home) @ MOVE / (MOVE @ MOVE))


def pace(arm, duration):
    """How fast the robot moves, as a part of the speed that was planned for the place."""
    time = np.linspace(0.0, 1.0, 1001)
    planned = np.interp(part_done(arm), 10 * time**3 - 15 * time**4 + 6 * time**5, time)
    speed = 30.0 * planned**2 * (1.0 - planned) ** 2 / duration
    return float(arm.velocity @ MOVE / (MOVE @ MOVE)) / speed


def until_still(arm):
    arm.until(lambda: not arm.velocity.any())


def stays(arm, cycles=40):
    """Whether the robot does not move for that many states."""
    arm.until(lambda: arm.states)
    place, since = arm.position, len(arm.states) + cycles
    arm.until(lambda: len(arm.states) > since)
    return bool((np.abs(arm.position - place) < 1e-12).all())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("transport", "robot"), [*((way, ROBOT) for way in TRANSPORTS), ("topic", "")]
)
def test_pause_and_resume(suite, transport, robot):
    arm = suite(transport=transport, robot_description=robot)
    arm.plan(0.0, MOVE, duration=2.5)
    arm.until(lambda: part_done(arm) > 0.05)
    assert trigger(arm, "pause") == (
        True,
        "the robot stops on its path; what comes waits for resume",
    )
    assert trigger(arm, "pause") == (True, "paused already")
    until_still(arm)
    assert 0.05 < part_done(arm) < 0.95
    assert stays(arm)
    assert "paused" in arm.condition(lambda status: "paused" in status.message).message
    assert trigger(arm, "resume") == (True, "the robot moves on")
    arm.until_at(arm.home + MOVE)
    assert_on_the_path(arm)
    assert arm.value("arrived", lambda status: status.message == "idle") == "1"
    assert trigger(arm, "resume") == (False, "nothing to resume: not paused")


def waiting(status):
    return next(entry.value for entry in status.values if entry.key == "waiting")


def test_pause_makes_the_queue_wait(suite):
    arm = suite()
    assert trigger(arm, "pause") == (True, "nothing is under way; what comes waits for resume")
    arm.plan(0.0, 0.5 * MOVE, duration=0.5)
    arm.plan(0.5 * MOVE, MOVE, duration=0.5)
    arm.condition(lambda status: "paused" in status.message and waiting(status) == "2")
    assert stays(arm)
    assert trigger(arm, "resume") == (True, "the robot moves on")
    arm.until_at(arm.home + MOVE)
    assert_on_the_path(arm)


@pytest.mark.slow
@pytest.mark.parametrize("transport", TRANSPORTS)
def test_speed_changes_on_the_way(suite, transport):
    arm = suite(transport=transport)
    arm.plan(0.0, MOVE, duration=3.0)
    arm.until(lambda: part_done(arm) > 0.05)
    answer = set_speed(arm, 0.25)
    assert (answer.error_code, answer.error_msg) == (ErrorCode.NONE, "")
    left = answer.remaining.sec + 1e-9 * answer.remaining.nanosec
    assert left > 3.0
    arm.until(lambda: pace(arm, 3.0) == pytest.approx(0.25, abs=0.01))
    assert set_speed(arm, 1.0).error_code == ErrorCode.NONE
    arm.until_at(arm.home + MOVE)
    assert_on_the_path(arm)
    assert arm.value("arrived", lambda status: status.message == "idle") == "1"


@pytest.mark.slow
def test_speed_of_what_comes(suite):
    arm = suite()
    answer = set_speed(arm, 0.5)
    assert (answer.remaining.sec, answer.remaining.nanosec) == (0, 0)
    answer = arm.execute(arm.trajectory(0.0, MOVE, duration=1.0))
    assert (answer.error_code, answer.error_msg) == (ErrorCode.NONE, "")
    assert answer.duration.sec >= 2
    assert_on_the_path(arm)
    assert arm.value("speed") == "0.5"


@pytest.mark.parametrize(
    ("speed", "code", "text"),
    [
        (0.0, ErrorCode.BAD_VALUE, "speed is 0.0, expected from 1e-06 up to 1"),
        (1e-300, ErrorCode.BAD_VALUE, "speed is 1e-300"),
        (1.5, ErrorCode.BAD_VALUE, "speed is 1.5"),
        (-1.0, ErrorCode.BAD_VALUE, "speed is -1.0"),
        (math.nan, ErrorCode.NON_FINITE, "speed is nan"),
    ],
)
def test_speeds_that_cannot_be(suite, speed, code, text):
    arm = suite(with_controller=False)
    answer = set_speed(arm, speed)
    assert answer.error_code == code
    assert text in answer.error_msg


def test_cancel_of_an_execution(suite):
    arm = suite()
    waiting = [
        arm.start_execute(arm.trajectory(0.0, MOVE, duration=20.0)),
        arm.start_execute(arm.trajectory(MOVE, 0.0, duration=1.0)),
    ]
    arm.until_moving()
    arm.condition(lambda status: any(v.key == "waiting" and v.value == "1" for v in status.values))
    assert trigger(arm, "cancel") == (True, "trajectories dropped: 2; the robot stops on its path")
    first, second = (ended(answer) for answer in waiting)
    assert first.error_code == second.error_code == ErrorCode.PREEMPTED
    assert "cancelled" in first.error_msg
    assert second.error_msg == "not sent: cancelled by the service cancel"
    until_still(arm)
    assert stays(arm)
    assert_on_the_path(arm)
    assert trigger(arm, "cancel") == (True, "nothing was under way or waiting")


@pytest.mark.slow
def test_cancel_of_a_request_that_waits_for_its_plan(suite):
    arm = suite(auto_execute=False)
    arm.plan(0.0, MOVE, duration=1.0)
    for _ in range(20):
        waiting = arm.start_execute()
        # The two go different ways: the cancel may be there first.
        while "dropped" not in trigger(arm, "cancel")[1]:
            pass
        answer = ended(waiting)
        assert answer.error_code == ErrorCode.PREEMPTED
        if answer.error_msg == "not sent: cancelled by the service cancel":
            break
        # On a busy machine the motion may have begun.
        back = arm.execute(arm.trajectory(arm.position - arm.home, 0.0, duration=1.0))
        assert back.error_code == ErrorCode.NONE
    else:
        pytest.fail("the request is never cancelled while it waits")
    assert abs(part_done(arm)) < 1e-6
    assert arm.execute().error_code == ErrorCode.NONE


@pytest.mark.parametrize(
    ("transport", "paused"),
    [("topic", False), ("action", True), ("follow_joint_trajectory", False), ("topic", True)],
)
def test_cancel_of_a_plan(suite, transport, paused):
    arm = suite(transport=transport)
    arm.plan(0.0, MOVE, duration=10.0)
    arm.until(lambda: part_done(arm) > 0.02)
    if paused:
        assert trigger(arm, "pause")[0]
        until_still(arm)
    assert trigger(arm, "cancel")[0]
    until_still(arm)
    status = arm.condition(lambda status: "cancelled" in status.message)
    assert status.message.startswith("idle")
    assert stays(arm)
    assert_on_the_path(arm)
    # It takes the next one from where it is.
    place = arm.position - arm.home
    arm.plan(place, 0.0, duration=1.0)
    arm.until_at(arm.home)


def test_no_pause_of_what_waits_for_its_stamp(suite):
    arm = suite()
    plan = arm.trajectory(0.0, MOVE, duration=1.0)
    plan.header.stamp = arm.graph.client.get_clock().now().to_msg()
    plan.header.stamp.sec += 60
    arm._planned.publish(plan)
    arm.condition(lambda status: status.message == "executing")
    success, text = trigger(arm, "pause")
    assert not success
    assert "the trajectory under way only begins in" in text
    assert trigger(arm, "cancel")[0]
    assert "may still execute it" in arm.condition(lambda s: "cancelled" in s.message).message
