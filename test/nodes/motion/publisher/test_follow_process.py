"""follow_joint_trajectory of a controller in a process of its own."""

import signal

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from drivers import TIMEOUT
from follow_cases import CODES, START, Follower, three_joints, tolerance

ZERO = np.zeros(3)
FAR = START + np.array([0.4, -0.3, 0.2])


@pytest.fixture
def follow_process(graph, process, tmp_path):
    """Start the controller; returns its driver, and the process."""
    place = tmp_path / "three.urdf"
    place.write_text(three_joints(), encoding="utf-8")

    def start(**parameters):
        started = []
        driver = Follower(
            graph,
            lambda *args, **given: started.append(process(*args, **given)),
            robot_description=str(place),
            **parameters,
        )
        return driver, started[0]

    return start


def test_success_cancel_and_preempt(follow_process):
    arm, _ = follow_process()
    outcome = arm.follow(arm.points((0.3, FAR, ZERO)))
    assert outcome == (GoalStatus.STATUS_SUCCEEDED, CODES.SUCCESSFUL, "")
    arm.until_at(FAR)
    handle = arm.send_goal(arm.points((20.0, START, ZERO)))
    arm.until_moving()
    handle.cancel_goal_async()
    status, code, text = arm.outcome(handle)
    assert (status, code) == (GoalStatus.STATUS_CANCELED, CODES.SUCCESSFUL)
    assert "cancelled by the client" in text
    arm.until_still()
    first = arm.send_goal(arm.points((20.0, START, ZERO)))
    arm.until_moving()
    second = arm.send_goal(arm.points((0.5, START, ZERO)))
    status, code, text = arm.outcome(first)
    assert (status, code) == (GoalStatus.STATUS_ABORTED, CODES.INVALID_GOAL)
    assert text == "preempted by a newer goal of the action"
    assert arm.outcome(second)[0] == GoalStatus.STATUS_SUCCEEDED
    arm.until_at(START)


def test_tolerances(follow_process):
    arm, _ = follow_process(tracking_lag=0.3, goal_time=0.05)
    trajectory = arm.points((0.5, FAR, ZERO))
    status, code, text = arm.follow(trajectory, path_tolerance=[tolerance("joint3", 0.01)])
    assert (status, code) == (GoalStatus.STATUS_ABORTED, CODES.PATH_TOLERANCE_VIOLATED)
    assert "joint 'joint3' is 0.0" in text
    arm.until_still()
    status, code, text = arm.follow(trajectory)
    assert (status, code) == (GoalStatus.STATUS_ABORTED, CODES.GOAL_TOLERANCE_VIOLATED)
    assert "off its goal, the tolerance is 0.01 rad" in text


def test_deactivate_controller_aborts_action(follow_process):
    arm, process = follow_process()
    handle = arm.send_goal(arm.points((20.0, FAR, ZERO)))
    arm.until_moving()
    process.send_signal(signal.SIGINT)
    status, code, text = arm.outcome(handle)
    assert (status, code) == (GoalStatus.STATUS_ABORTED, CODES.INVALID_GOAL)
    assert text == "the controller shuts down; the robot holds"
    assert process.wait(TIMEOUT) == 0
