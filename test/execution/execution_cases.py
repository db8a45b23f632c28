"""Joints and trajectories for the tests of the execution."""

import numpy as np

from robomech_ros.execution.controller.follower import TrajectoryFollower
from robomech_ros.execution.controller.follower_settings import FollowerSettings
from robomech_ros.execution.controller.simulated_joints import SimulatedJoints
from robomech_ros.execution.joints import Joints, State
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.trajectory import Limits, Waypoints

NAMES = ("shoulder", "elbow", "roll")
VELOCITY, ACCELERATION = 2.0, 10.0
PERIOD = 0.01


def joints():
    limits = Limits(
        NAMES,
        velocity=VELOCITY,
        acceleration=ACCELERATION,
        lower=[-2.0, -2.0, -np.inf],
        upper=[2.0, 2.0, np.inf],
        units=["rad"] * 3,
    )
    return Joints(limits, np.array([False, False, True]))


def follower(position=(0.0, 0.0, 0.0), lag=0.0, **settings):
    standing = SimulatedJoints(np.array(position), lag)
    return TrajectoryFollower(joints(), standing, FollowerSettings(**settings))


def state(position=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0)):
    return State(np.array(position), np.array(velocity), np.zeros(3))


def tolerances(path=np.inf, goal=0.01, velocity=0.01, goal_time=0.5):
    return Tolerances(np.full(3, path), np.full(3, goal), np.full(3, velocity), goal_time)


def to_rest(goal, duration=1.0, start=(0.0, 0.0, 0.0)):
    """From rest at t = 0 to rest, one quintic."""
    still = np.zeros((2, 3))
    positions = np.array([start, goal], dtype=float)
    return Waypoints(np.array([0.0, duration]), positions, still, still)


def single_point(goal, duration, velocities=True):
    """One point, to be reached from wherever the robot is."""
    still = np.zeros((1, 3)) if velocities else None
    return Waypoints(np.array([duration]), np.array([goal], dtype=float), still, still)


def run(arm, begin, end, watch=None):
    """Let time pass in cycles of the controller; returns the states seen."""
    seen = []
    for k in range(round((end - begin) / PERIOD)):
        now = begin + (k + 1) * PERIOD
        arm.advance(now)
        seen.append((now, arm.actual))
        if watch is not None:
            watch(now)
    return seen


def assert_continuous(seen, acceleration=2.0 * ACCELERATION):
    """No joint jumps, nor changes its speed faster than that."""
    positions = np.array([state.position for _, state in seen])
    velocities = np.array([state.velocity for _, state in seen])
    assert np.abs(np.diff(positions, axis=0)).max() <= VELOCITY * PERIOD * 1.01
    assert np.abs(np.diff(velocities, axis=0)).max() <= acceleration * PERIOD


def wave():
    """A wave of two joints, from rest to rest in 2 s."""
    t = np.linspace(0.0, 1.0, 41)
    u = 10 * t**3 - 15 * t**4 + 6 * t**5
    rate = (30 * t**2 - 60 * t**3 + 30 * t**4) / 2.0
    change = (60 * t - 180 * t**2 + 120 * t**3) / 4.0
    wave, slope = 0.4 * np.sin(3 * u), 1.2 * np.cos(3 * u)
    return Waypoints(
        2.0 * t,
        np.column_stack([1.2 * u, wave]),
        np.column_stack([1.2 * rate, slope * rate]),
        np.column_stack([1.2 * change, slope * change - 9.0 * wave * rate**2]),
    )
