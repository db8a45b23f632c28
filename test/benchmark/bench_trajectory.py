"""Trajectories: plans from point to point against Ruckig, splines against scipy, time-optimal
parameterisation of splines through waypoints against toppra."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np
from peers import Array
from scipy.interpolate import CubicSpline
from table import Row
from timing import Work, interleave

from robomech_ros.robots import load_robot
from robomech_ros.trajectory import (
    Limits,
    PiecewisePolynomial,
    TimeOptimal,
    point_to_point,
    spline_through,
    time_optimal,
)

JOINTS, WAYPOINTS, PATHS = 7, 20, 5
FINE_GRID = 1000
SAMPLES = 20_000
ROUNDS = 21
TIME_RATIO = 0.1
EXCESS = 1.0 + 1e-6
LONGER = 1.001
ROBOT, PLANS, SAMPLED = "puma560", 20, 1000
PLAN_TIME, PLAN_RATIO, SPLINE_RATIO = 5.0, 1.3, 0.5
SHORT_ROUNDS = 301


def rows() -> tuple[list[Row], list[str]]:
    """Measure all; return the rows of the table and remarks on accuracy."""
    timed, remarks = _time_optimal_rows()
    return [*_plan_rows(), _spline_row(), *timed], remarks


def _plan_rows() -> list[Row]:
    """Plans between random positions of a robot; Ruckig's own with all that it takes to ask it."""
    import ruckig

    limits = Limits.of(load_robot(ROBOT))
    rng = np.random.default_rng(0)
    ends = [[rng.uniform(limits.lower, limits.upper) for _ in range(2)] for _ in range(PLANS)]

    def bare(start: Array, goal: Array) -> Any:
        request = ruckig.InputParameter(len(start))
        request.synchronization = ruckig.Synchronization.Phase
        request.current_position, request.target_position = start.tolist(), goal.tolist()
        request.max_velocity = limits.velocity.tolist()
        request.max_acceleration = limits.acceleration.tolist()
        request.max_jerk = limits.jerk.tolist()
        motion = ruckig.Trajectory(len(start))
        ruckig.Ruckig(len(start)).calculate(request, motion)
        return motion

    def ours(profile: str) -> Work:
        return Work(
            lambda: [point_to_point(*pair, limits=limits, profile=profile) for pair in ends], PLANS
        )

    def sampled() -> Any:
        motion = point_to_point(*ends[0], limits=limits, profile="ruckig")
        return motion.sample(np.linspace(0.0, motion.duration, SAMPLED))

    def sampled_bare() -> Any:
        motion = bare(*ends[0])
        instants = np.linspace(0.0, motion.duration, SAMPLED).tolist()
        return np.array([motion.at_time(instant) for instant in instants])

    plans = interleave(
        {
            "poly345": ours("poly345"),
            "ruckig": ours("ruckig"),
            "bare": Work(lambda: [bare(*pair) for pair in ends], PLANS),
        },
        rounds=SHORT_ROUNDS,
    )
    both = interleave({"ours": Work(sampled, 1), "bare": Work(sampled_bare, 1)}, rounds=ROUNDS)
    first, second = plans["poly345"], plans["ruckig"]
    return [
        Row("shortest 3-4-5 plan, 6 joints", first.median, spread=first.spread, limit=PLAN_TIME),
        Row(
            "Ruckig plan, 6 joints",
            second.median,
            peer=plans["bare"].median,
            peer_name="ruckig",
            spread=second.spread,
            ratio_limit=PLAN_RATIO,
        ),
        Row(
            f"Ruckig plan and {SAMPLED} samples",
            both["ours"].median,
            peer=both["bare"].median,
            peer_name="ruckig",
            spread=both["ours"].spread,
            ratio_limit=PLAN_RATIO,
        ),
    ]


def _spline_row() -> Row:
    """Make a natural spline through waypoints and sample it with three derivatives."""
    _, waypoints, _ = problem(0)
    knots = 0.5 * np.arange(WAYPOINTS)
    instants = np.linspace(0.0, knots[-1], SAMPLED)

    def peer() -> Any:
        spline = CubicSpline(knots, waypoints, bc_type="natural")
        return [spline(instants, order) for order in range(4)]

    timing = interleave(
        {
            "ours": Work(
                lambda: spline_through(waypoints, times=knots, ends="natural").sample(instants), 1
            ),
            "scipy": Work(peer, 1),
        },
        rounds=SHORT_ROUNDS,
    )
    return Row(
        f"spline, {JOINTS} joints, {WAYPOINTS} waypoints, {SAMPLED} samples",
        timing["ours"].median,
        peer=timing["scipy"].median,
        peer_name="scipy",
        spread=timing["ours"].spread,
        ratio_limit=SPLINE_RATIO,
    )


def _time_optimal_rows() -> tuple[list[Row], list[str]]:
    """Measure on some random paths; return the rows of the table and remarks on accuracy."""
    if find_spec("toppra") is None:
        return [_alone()], [
            "time-optimal: toppra is not installed, no comparison (pip install toppra)"
        ]
    table, remarks = [], []
    for index in range(PATHS):
        row, remark = _against_toppra(index)
        table.append(row)
        remarks.append(remark)
    return table, remarks


def problem(index: int) -> tuple[Array, Array, Limits]:
    """Make path coordinates, waypoints, and limits."""
    rng = np.random.default_rng(index)
    waypoints = rng.uniform(-2.0, 2.0, (WAYPOINTS, JOINTS))
    names = [f"joint{k}" for k in range(JOINTS)]
    velocity, acceleration = rng.uniform(1.0, 3.0, JOINTS), rng.uniform(2.0, 12.0, JOINTS)
    limits = Limits(tuple(names), velocity=velocity, acceleration=acceleration)
    return np.linspace(0.0, 1.0, WAYPOINTS), waypoints, limits


def _path(knots: Array, waypoints: Array) -> PiecewisePolynomial:
    spline = CubicSpline(knots, waypoints)
    return PiecewisePolynomial(spline.x, np.ascontiguousarray(spline.c[::-1]))


def _alone() -> Row:
    knots, waypoints, limits = problem(0)
    path = _path(knots, waypoints)
    timing = interleave({"ours": Work(lambda: time_optimal(path, limits), 1)}, rounds=ROUNDS)
    return Row(_name(0), timing["ours"].median, spread=timing["ours"].spread)


def _name(index: int) -> str:
    return f"time-optimal, {JOINTS} joints, {WAYPOINTS} waypoints, path {index}"


def _against_toppra(index: int) -> tuple[Row, str]:
    knots, waypoints, limits = problem(index)
    path = _path(knots, waypoints)
    constraints, toppra_path = _toppra_problem(knots, waypoints, limits)
    timing = interleave(
        {
            "ours": Work(lambda: time_optimal(path, limits), 1),
            "toppra": Work(lambda: _toppra(constraints, toppra_path, None), 1),
        },
        rounds=ROUNDS,
        warmups=2,
    )
    ours = time_optimal(path, limits)
    automatic = _toppra(constraints, toppra_path, None)
    fine = _toppra(constraints, toppra_path, np.linspace(0.0, 1.0, FINE_GRID))
    excess, duration = _excess(ours, limits), ours.duration / fine.duration
    if excess > EXCESS or duration > LONGER:
        raise AssertionError(
            f"path {index}: {excess:.9f} of the limits, {duration:.6f} of toppra's duration"
        )
    remark = (
        f"time-optimal, path {index}: {ours.duration:.4f} s, {duration - 1.0:+.4%} of toppra on "
        f"{FINE_GRID} points; largest part of a limit {excess:.7f}, toppra's automatic grid "
        f"{_excess(automatic, limits):.4f}"
    )
    row = Row(
        _name(index),
        timing["ours"].median,
        peer=timing["toppra"].median,
        peer_name="toppra",
        spread=timing["ours"].spread,
        ratio_limit=TIME_RATIO,
    )
    return row, remark


def _toppra_problem(knots: Array, waypoints: Array, limits: Limits) -> tuple[list[Any], Any]:
    import toppra

    toppra.setup_logging("ERROR")
    both = np.array([[-1.0], [1.0]])
    constraints = [
        toppra.constraint.JointVelocityConstraint((both * limits.velocity).T),
        toppra.constraint.JointAccelerationConstraint((both * limits.acceleration).T),
    ]
    return constraints, toppra.SplineInterpolator(knots, waypoints)


def _toppra(constraints: list[Any], path: Any, grid: Array | None) -> Any:
    from toppra.algorithm import TOPPRA

    instance = TOPPRA(constraints, path, gridpoints=grid, parametrizer="ParametrizeConstAccel")
    return instance.compute_trajectory(0.0, 0.0)


def _excess(motion: TimeOptimal | Any, limits: Limits) -> float:
    """Find the largest part of a limit that dense samples reach."""
    times = np.linspace(0.0, motion.duration, SAMPLES)
    if isinstance(motion, TimeOptimal):
        sample = motion.sample(times)
        velocity, acceleration = sample.velocity, sample.acceleration
    else:
        velocity, acceleration = motion(times, 1), motion(times, 2)
    ratios = np.abs(velocity) / limits.velocity, np.abs(acceleration) / limits.acceleration
    return float(np.max(ratios))
