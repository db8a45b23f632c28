"""Every refusal has its code and text, and the robot is as ready as before."""

import math
from time import monotonic

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from drivers import ended
from std_srvs.srv import Trigger

from robomech_interfaces.msg import ErrorCode
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.joint_trajectory_controller import commanded_joints
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.middleware.throttled_log import PERIOD

MOVE = np.full(6, 0.05)


def names(*changed):
    def change(trajectory):
        trajectory.joint_names = list(changed)

    return change


def point(index, **fields):
    def change(trajectory):
        for name, value in fields.items():
            setattr(trajectory.points[index], name, value)

    return change


def time(index, value):
    def change(trajectory):
        stamp = trajectory.points[index].time_from_start
        stamp.sec = math.floor(value)
        stamp.nanosec = round((value - math.floor(value)) * 1e9)

    return change


def first_joint(index, field, value):
    def change(trajectory):
        getattr(trajectory.points[index], field)[0] = value

    return change


def all_points(field, joint, value):
    def change(trajectory):
        for entry in trajectory.points:
            getattr(entry, field)[joint] = value

    return change


def stamp(seconds):
    def change(trajectory):
        trajectory.header.stamp.sec = seconds

    return change


def nanoseconds(value):
    def change(trajectory):
        trajectory.header.stamp.nanosec = value

    return change


def no_points(trajectory):
    trajectory.points = []


def many_points(trajectory):
    trajectory.points = [trajectory.points[0]] * 21


JOINTS = ("waist", "shoulder", "elbow", "wrist_roll", "wrist_bend", "wrist_swivel")

CASES = {
    "unknown joint": (names(*JOINTS[:5], "wrist_swivvel"), 102, "mean 'wrist_swivel'"),
    "missing joint": (names(*JOINTS[:5]), 108, "missing: wrist_swivel"),
    "duplicate": (names(*JOINTS[:5], "waist"), 108, "'waist' is repeated"),
    "no names": (names(), 108, "missing: waist"),
    "no points": (no_points, 221, "no points"),
    "too many points": (many_points, 108, "points has size 21, expected at most 20"),
    "positions": (point(1, positions=[0.0] * 5), 108, "points[1].positions has size 5"),
    "velocities": (point(1, velocities=[0.0] * 7), 108, "points[1].velocities has size 7"),
    "accelerations": (point(0, accelerations=[0.0]), 108, "points[0].accelerations has size 1"),
    "effort": (point(0, effort=[0.0] * 6), 108, "are read, no effort"),
    "nan": (first_joint(1, "positions", math.nan), 104, "points[1].positions of joint 'waist'"),
    "infinite": (first_joint(0, "velocities", math.inf), 104, "'waist' is inf"),
    "equal times": (time(1, 0.0), 109, "points[1].time_from_start is 0.0"),
    "negative time": (time(0, -1.0), 109, "points[0].time_from_start is -1.0"),
    "too long": (time(1, 11.0), 109, "at most 10 s"),
    "last velocity": (first_joint(1, "velocities", 0.2), 109, "'waist' in the last point is 0.2"),
    "first velocity": (first_joint(0, "velocities", 1e5), 213, "velocity of joint 'waist' is 1000"),
    "negative seconds": (stamp(-1), 221, "the trajectory ended"),
    "nanoseconds only": (nanoseconds(1), 221, "the trajectory ended"),
    "empty name": (names("", *JOINTS[1:]), 102, "unknown joint ''; available: waist"),
    "endless name": (names("w" * 100_000, *JOINTS[1:]), 102, "(100002 characters); available"),
    "acceleration limit": (time(1, 0.05), 213, "times its limit 8 rad/s^2; at most 5"),
    "velocity limit": (time(1, 0.03), 213, "velocity of joint 'waist' is 3.125"),
    "position limit": (all_points("positions", 4, 1.75), 221, "'wrist_bend'"),
    "position limit on the way": (first_joint(1, "positions", 3.0), 213, "joint 'waist' is 3"),
    "far start": (
        first_joint(0, "positions", 0.5),
        221,
        "'waist' at 0.5 rad, but the joint is at 0 rad",
    ),
    "whole turn": (first_joint(0, "positions", math.tau), 221, "1 whole turn"),
    "ended long ago": (stamp(1), 221, "the trajectory ended"),
    "far future": (stamp(2**31 - 1), 109, "header.stamp"),
}


@pytest.fixture
def limited(drive):
    return drive(max_points=20, max_duration=10.0)


def test_the_action_says_why(limited):
    arm = limited
    for case, (change, code, text) in CASES.items():
        trajectory = arm.trajectory((3.0, MOVE))
        if case == "position limit on the way":
            time(1, 9.0)(trajectory)
        change(trajectory)
        status, result = arm.execute(trajectory)
        got = (status, result.error_code)
        assert got == (GoalStatus.STATUS_ABORTED, code), (case, result.error_msg)
        assert text in result.error_msg, case
        assert len(result.final_position_error) == 0
        assert not arm.velocity.any()
    assert arm.execute(arm.trajectory((0.3, MOVE)))[0] == GoalStatus.STATUS_SUCCEEDED


@pytest.mark.parametrize(
    ("field", "value", "code", "text"),
    [
        ("path_position_tolerance", [0.1], 108, "path_position_tolerance has size 1"),
        ("goal_position_tolerance", [-2.0] + [0.0] * 5, 109, "of joint 'waist' is -2.0"),
        ("goal_velocity_tolerance", [math.nan] * 6, 104, "of joint 'waist' is nan"),
    ],
)
def test_bad_tolerances(arm, field, value, code, text):
    status, result = arm.execute(arm.trajectory((0.3, MOVE)), **{field: value})
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, code)
    assert text in result.error_msg


def test_an_error_within_is_told_with_its_code(drive, monkeypatch, capfd):
    arm = drive()
    monkeypatch.setattr(commanded_joints, "read_waypoints", lambda *args, **options: 1 / 0)
    status, result = arm.execute(arm.trajectory((0.3, MOVE)))
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.INTERNAL)
    assert result.error_msg == "division by zero"
    assert "goal failed, please report" in capfd.readouterr().err
    monkeypatch.undo()
    assert arm.execute(arm.trajectory((0.3, MOVE)))[0] == GoalStatus.STATUS_SUCCEEDED


def test_the_topic_says_why_in_diagnostics_and_goes_on(limited):
    arm = limited
    trajectory = arm.trajectory((0.3, MOVE))
    trajectory.joint_names[0] = "waste"
    arm.publish(trajectory)
    status = arm.diagnosis(lambda status: "refused" in status.message)
    assert status.level == status.WARN
    assert "unknown joint 'waste' (did you mean 'waist'?)" in status.message
    goal = arm.position + MOVE
    arm.publish(arm.trajectory((0.3, MOVE)))
    arm.until_at(goal)
    arm.diagnosis(lambda status: status.level == status.OK and status.message == "holding")


def test_every_reason_why_a_stream_ends_early_is_logged(drive, capfd):
    arm, said = drive(), []

    def logged(text):
        said.append(capfd.readouterr().err)
        return text in "".join(said)

    arm.publish(arm.trajectory((9.0, MOVE)))
    arm.until_moving()
    arm.graph.call(Trigger, "joint_trajectory_controller/hold", Trigger.Request())
    arm.until(lambda: logged("ended early: stopped by the service hold"))
    arm.until(lambda: not arm.velocity.any())
    arm.publish(arm.trajectory((9.0, MOVE)))
    arm.until_moving()
    assert arm.graph.call(Trigger, "joint_trajectory_controller/reset", Trigger.Request()).success
    arm.until(lambda: logged("ended early: ended by the service reset"))


def test_what_is_asked_for_is_no_warning(drive, capfd):
    """Streams that replace one another, a goal that replaces them, a goal that is cancelled."""
    arm = drive()
    goal = arm.position + MOVE
    for _ in range(50):
        arm.publish(arm.trajectory((3.0, MOVE)))
    arm.until_moving()
    first = arm.send(arm.trajectory((3.0, goal - arm.position)))
    second = arm.send(arm.trajectory((3.0, goal - arm.position)))
    assert arm.result(first)[1].error_code == ErrorCode.PREEMPTED
    arm.until_moving()
    ended(arm.ask(second.cancel_goal_async))
    assert arm.result(second)[0] == GoalStatus.STATUS_CANCELED
    said = capfd.readouterr().err
    assert "cancelled by the client" in said
    assert not [line for line in said.splitlines() if line.startswith(("[WARN]", "[ERROR]"))]


def test_a_flood_of_refusals_is_one_line_a_second(drive, capfd):
    arm = drive()
    trajectory, began = arm.trajectory((0.3, MOVE)), monotonic()

    def refused(status):
        for _ in range(10):
            # Each is late by another time.
            trajectory.header.stamp.sec += 1
            arm.publish(trajectory)
        values = {entry.key: entry.value for entry in status.values}
        return int(values["refused"]) > 100

    arm.diagnosis(refused)
    lines = [line for line in capfd.readouterr().err.splitlines() if "trajectory refused" in line]
    assert 1 <= len(lines) <= 2 + (monotonic() - began) / PERIOD


@pytest.mark.slow
def test_a_refused_goal_does_not_disturb_the_one_that_runs(arm):
    goal = arm.position + MOVE
    running = arm.send(arm.trajectory((3.0, MOVE)))
    arm.until_moving()
    status, result = arm.execute(arm.trajectory((0.5, MOVE), start=arm.position + 1.0))
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.REJECTED)
    assert arm.result(running)[0] == GoalStatus.STATUS_SUCCEEDED
    arm.until_at(goal)


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        ({"publish_rate": 0.0}, "'publish_rate' is 0.0; allowed is a number from 1 to 1000 Hz"),
        ({"initial_positions": [0.0, 0.1]}, "'initial_positions' .* a list of 6 numbers"),
        ({"initial_positions": [9.0] + [0.0] * 5}, "'initial_positions' is 9.0.* joint 'waist'"),
        ({"max_points": 0}, "'max_points' is 0"),
        ({"robot_description": "puma650"}, "did you mean 'puma560'"),
    ],
)
def test_bad_parameters(graph, parameters, text):
    with pytest.raises(RobomechError, match=text):
        graph.start(JointTrajectoryControllerNode, **{"robot_description": "puma560", **parameters})
