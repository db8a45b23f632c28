"""No state leaves the controller that the robot cannot be in, whatever went wrong before."""

import threading
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from gripper_cases import panda_with_hand

from robomech_ros.execution.controller.simulated_joints import Faults
from robomech_ros.execution.controller.trajectory_goal import End
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.nodes.common.robot.robot_description import RobotModel, RobotSettings
from robomech_ros.nodes.joint_trajectory_controller.gripper.gripper import gripper_of
from robomech_ros.nodes.joint_trajectory_controller.parallel_robot import ParallelRobot
from robomech_ros.nodes.joint_trajectory_controller.robot import legged_robot, serial_robot
from robomech_ros.nodes.joint_trajectory_controller.settings import ControllerSettings
from robomech_ros.outcomes import Code
from robomech_ros.parallel import load_parallel
from robomech_ros.robots import load_description, load_robot
from robomech_ros.trajectory import Waypoints
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.walking import load_legged

PERIOD = 0.01
KINDS = ["puma560", "phantomx", "hexapod", "delta", "panda's hand"]


class HandClock(SimpleNamespace):
    """Time that goes on when it is told to."""

    def __init__(self):
        super().__init__(seconds=0.0, on_jump=lambda listener: None)

    def now(self):
        return self.seconds


def make(name, **options):
    settings = ControllerSettings(max_acceleration_ratio=0.0, **options)
    clock = HandClock()
    if name == "puma560":
        return serial_robot(load_robot(name), settings, clock)
    if name == "phantomx":
        return legged_robot(load_legged(name), settings, clock)
    if name == "panda's hand":
        model = RobotModel(
            load_description(panda_with_hand()), RobotSettings(tip_link="panda_link8")
        )
        return gripper_of(model, settings, clock, threading.RLock())
    return ParallelRobot(load_parallel(name).mechanism, settings, clock)


def run(robot, cycles):
    """Let the robot run; returns all positions that it would publish, shape (cycles + 1, n)."""
    rows = [robot.shown().position]
    for _ in range(cycles):
        robot._clock.seconds += PERIOD
        robot.advance()
        rows.append(robot.shown().position)
    return np.array(rows)


def assert_possible(robot, rows):
    """All states are inside the limits, no joint is too fast, and loops are closed."""
    limits = robot._check.limits
    assert ((rows >= limits.lower - 1e-6) & (rows <= limits.upper + 1e-6)).all()
    speeds = np.abs(np.diff(rows, axis=0)) / PERIOD
    assert (speeds <= limits.velocity * (1.0 + 1e-6)).all()
    if isinstance(robot, ParallelRobot):
        assert robot.mechanism.loop_errors(rows).max() < 1e-9


def start(robot, change, duration=1.0):
    """Move by a change of the commanded joints, from rest to rest; returns the goal."""
    here = robot.follower.desired.position
    still, anything = np.zeros((2, len(here))), np.full(len(here), np.inf)
    way = Waypoints(np.array([0.0, duration]), np.array([here, here + change]), still, still)
    return robot.follower.start(way, Tolerances(anything, anything, anything, np.inf), robot.time)


def inward(robot, size):
    """Return changes of the commanded joints towards the middles of their ranges."""
    limits, here = robot.follower.joints.limits, robot.follower.desired.position
    middle = np.where(np.isfinite(limits.lower + limits.upper), limits.lower + limits.upper, 1.0)
    return np.where(middle / 2.0 >= here, size, -size)


def faults(robot, **wrong):
    n = len(robot.joint_names)
    none = Faults(stuck=np.zeros(n, dtype=bool), offset=np.zeros(n), seed=1)
    robot.simulated_joints.inject(replace(none, **wrong))


@pytest.mark.parametrize("far", [3.0, 1000.0, np.nan])
@pytest.mark.parametrize("name", KINDS)
def test_a_robot_holds_before_a_jump_of_its_curve(name, far):
    robot = make(name)
    goal = start(robot, inward(robot, 0.002))
    rows = run(robot, 50)
    # A defect such as no curve should have: all joints are elsewhere from one cycle to the next.
    coefficients = goal.curve.coefficients.copy()
    coefficients[0] += far * PERIOD * robot.follower.joints.limits.velocity
    goal.curve = PiecewisePolynomial(goal.curve.breaks, coefficients)
    after = run(robot, 20)
    assert_possible(robot, np.vstack((rows, after)))
    np.testing.assert_array_equal(after, np.repeat(rows[-1:], 21, axis=0))
    assert not robot.shown().velocity.any()
    assert goal.result.end is End.ABORTED
    if np.isfinite(far):
        assert goal.result.code in (Code.LIMIT, Code.SINGULAR)
        assert "the robot holds" in goal.result.text or "singular" in goal.result.text
    # It is as ready as before.
    again = start(robot, inward(robot, 0.002))
    assert_possible(robot, run(robot, 120))
    assert again.result.end is End.REACHED and not robot.fault


@pytest.mark.parametrize("noise", [1e-4, 0.5])
@pytest.mark.parametrize("name", ["puma560", "phantomx", "hexapod", "delta"])
def test_noise_of_sensors_moves_no_robot(name, noise):
    robot = make(name)
    home = robot._real.copy()
    faults(robot, noise=noise)
    rows = run(robot, 200)
    assert_possible(robot, rows)
    np.testing.assert_array_equal(robot._real, home)
    assert np.abs(rows - home).max() > 0.5 * noise if noise < 0.1 else True
    # What the sensors show is a jump of its own after a reset, and goes back when they are mended.
    robot.reset("reset")
    np.testing.assert_array_equal(robot._real, home)
    faults(robot)
    rows = run(robot, 500)
    assert_possible(robot, rows)
    np.testing.assert_allclose(rows[-1], home, atol=1e-9)
    assert not robot.fault
    goal = start(robot, inward(robot, 0.002))
    run(robot, 120)
    assert goal.result.end is End.REACHED


@pytest.mark.parametrize("wrong", [{"dropped": 0.7}, {"delay": 0.3}, {"stuck": True}])
@pytest.mark.parametrize("name", ["puma560", "delta", "hexapod"])
def test_joints_that_are_late_catch_up_no_faster_than_they_can(name, wrong):
    robot = make(name)
    limits = robot.follower.joints.limits
    # Nearly as fast as the drives can be.
    duration = 0.5
    change = inward(robot, np.min(limits.velocity) * duration / 2.0)
    change = np.clip(change, -0.05, 0.05)
    duration = 1.9 * float(np.max(np.abs(change) / limits.velocity))
    if "stuck" in wrong:
        wrong = {"stuck": np.arange(robot.follower.motion.desired.position.size) == 0}
    faults(robot, **wrong)
    start(robot, change, duration)
    rows = run(robot, round(0.7 * duration / PERIOD))
    faults(robot)
    rows = np.vstack((rows, run(robot, 200)))
    assert_possible(robot, rows)
    assert not robot.fault
    np.testing.assert_allclose(robot.follower.actual.position, robot.follower.desired.position)


@pytest.mark.parametrize("name", ["puma560", "hexapod"])
def test_a_robot_that_was_put_beyond_a_limit_holds_and_moves_inside(name):
    robot = make(name)
    beyond = robot._real.copy()
    joint = robot.shown_names.index(robot.joint_names[0])
    beyond[joint] = robot._check.limits.upper[joint] + 0.05
    if name == "hexapod":
        beyond = robot.mechanism.close(beyond[robot.mechanism.drive_index], robot._real).q
    robot._put(beyond, "")
    np.testing.assert_allclose(robot.shown().position, beyond, atol=1e-9)
    rows = run(robot, 20)
    np.testing.assert_allclose(rows[-1], beyond, atol=1e-9)
    assert not robot.fault


@pytest.mark.parametrize("wrong", ["open", "elsewhere", "none"])
def test_loops_that_are_not_closed_where_the_drives_are_are_not_published(monkeypatch, wrong):
    robot = make("hexapod")
    mechanism, close = robot.mechanism, robot.mechanism.close
    rows = run(robot, 5)
    goal = start(robot, inward(robot, 0.01))

    def broken(drives, near):
        closed = close(drives, near)
        if wrong == "open":
            return replace(closed, error=1e-3)
        return replace(closed, q=closed.q + (0.3 if wrong == "elsewhere" else np.nan))

    monkeypatch.setattr(mechanism, "close", broken, raising=False)
    rows = np.vstack((rows, run(robot, 20)))
    assert_possible(robot, rows)
    assert np.ptp(rows, axis=0).max() == 0.0
    assert goal.result.code == Code.NOT_CONVERGED
    assert "drives off by" in goal.result.text
    monkeypatch.undo()
    goal = start(robot, inward(robot, 0.01))
    run(robot, 120)
    assert goal.result.end is End.REACHED
