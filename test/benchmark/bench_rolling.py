"""Rolling robots: single calls, streams of commands, and how well limits and curvature are kept.

There is no peer in Python; limits are compared with those of ros2_control, whose rule is here.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from table import Row
from timing import Work, interleave

from robomech_ros.rolling import (
    CommandLimiter,
    MotionLimits,
    Odometry,
    advance_odometry,
    differential_drive,
    mecanum,
    rolling_robot,
)
from robomech_ros.rolling.arcs import moved
from robomech_ros.typing import Array

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "rolling"))
from limiter_oracle import limited

PERIOD, STREAM = 0.01, 2000
RATE_LIMITER = "control_toolbox"
# A base that is told to go round a circle of one metre, and from rest to 1 m/s.
CIRCLE, STEP = np.array([0.5, 0.5, 0.0]), np.array([0.0, 1.0, 0.0])
LIMITS = MotionLimits(acceleration=[3.0, 0.5, 1.0], jerk=[30.0, 5.0, 5.0])
RAMP = MotionLimits(acceleration=[3.0, 2.0, 1.0], jerk=[30.0, 5.0, 5.0])


def rows() -> list[Row]:
    """Measure and return the rows of the table."""
    return [*_calls(), *_streams(), *_quality()]


def _row(what: str, call: Callable[[], object], units: int, limit: float | None = None) -> Row:
    time = interleave({"ours": Work(call, units)}, rounds=101)["ours"]
    return Row(what, time.median, spread=time.spread, limit=limit)


def _calls() -> list[Row]:
    found = []
    for name in ("differential", "mecanum", "swerve"):
        base = rolling_robot(name).base
        twist = base.feasible([0.2, 0.5, 0.1])
        angles = base.steering_angles(twist) if base.steered else None
        rates = base.wheel_rates(twist)
        calls: dict[str, Callable[[], object]] = {
            "wheel rates": lambda b=base, t=twist: b.wheel_rates(t),  # type: ignore[misc]
            "twist and slip": lambda b=base, r=rates, a=angles: b.body_twist(r, a),  # type: ignore[misc]
        }
        found += [_row(f"{name}: {what}, one checked call", one, 1) for what, one in calls.items()]
    base, start = rolling_robot("mecanum").base, Odometry.at()
    rates = base.wheel_rates([0.2, 0.5, 0.1])
    found.append(_row("mecanum: odometry with covariance, one checked call",
                      lambda: advance_odometry(base, start, rates, PERIOD), 1))  # fmt: skip
    dynamics = rolling_robot("mecanum").dynamics
    assert dynamics is not None
    found.append(_row("mecanum: forward dynamics, one checked call",
                      lambda: dynamics.forward([0.2, 0.5, 0.1], np.ones(4)), 1))  # fmt: skip
    return found


def _streams() -> list[Row]:
    found, rng = [], np.random.default_rng(1)
    commands = np.repeat(rng.normal(size=(STREAM // 20, 3)), 20, axis=0)
    for name in ("differential", "mecanum", "swerve"):
        robot = rolling_robot(name)
        limiter = CommandLimiter(robot.base, robot.limits, PERIOD)
        rest = limiter.at_rest()
        found.append(_row(f"{name}: limited stream, per period",
                          lambda x=limiter, m=rest: x.run(m, commands), STREAM))  # type: ignore[misc] # fmt: skip
    robot = rolling_robot("mecanum")
    limiter = CommandLimiter(robot.base, robot.limits, PERIOD)
    allowed = limiter.allowed(commands)[0][:200]
    time = interleave(
        {
            "ours": Work(lambda: limiter.run(limiter.at_rest(), allowed), len(allowed)),
            "NumPy": Work(lambda: limited(allowed, robot.limits, PERIOD), len(allowed)),
        },
        rounds=11,
    )
    ours, peer = time["ours"], time["NumPy"]
    found.append(Row("mecanum: the same, 200 periods", ours.median, peer=peer.median,
                     peer_name="our rule in NumPy", spread=ours.spread))  # fmt: skip
    limiter = CommandLimiter(differential_drive(0.1, 0.4), LIMITS, PERIOD)
    motion = limiter.step(limiter.at_rest(), CIRCLE)
    found.append(_row("differential: one limited step, one checked call",
                      lambda: limiter.step(motion, CIRCLE), 1))  # fmt: skip
    return found


def _rate_limited(command: Array, limits: MotionLimits, periods: int) -> Array:
    """Limit axis by axis as control_toolbox's RateLimiter does: jerk, then acceleration."""
    twists = np.zeros((periods + 2, 3))
    jerk, acceleration = limits.jerk * PERIOD**2, limits.acceleration * PERIOD  # type: ignore[operator]
    for i in range(2, periods + 2):
        before, gain = twists[i - 1], twists[i - 1] - twists[i - 2]
        wanted = command.copy()
        grows = (wanted - before - gain) * (wanted - before) > 0.0
        held = before + gain + np.clip(wanted - before - gain, -jerk, jerk)
        wanted = np.where(grows, held, wanted)
        twists[i] = before + np.clip(wanted - before, -acceleration, acceleration)
    return twists[2:]


def _jerk(twists: Array, limits: MotionLimits) -> float:
    padded = np.concatenate([np.zeros((2, 3)), twists])
    return float(np.abs(np.diff(padded, n=2, axis=0) / PERIOD**2 / limits.jerk).max())


def _left(twists: Array) -> float:
    """How far a circle of 1 m about (0, 1) is left (mm)."""
    pose, farthest = np.zeros(3), 0.0
    for twist in twists:
        pose = moved(pose, twist * PERIOD)
        farthest = max(farthest, abs(math.hypot(pose[0], pose[1] - 1.0) - 1.0))
    return 1e3 * farthest


def _quarter() -> float:
    """How far odometry of a mecanum base is off after a quarter turn of 1 m (mm)."""
    base, pose, count = mecanum(0.1, 0.6, 0.4), np.zeros(3), 157
    rates = base.wheel_rates(CIRCLE)
    for _ in range(count):
        pose = base.integrate(pose, rates, math.pi / count)
    return 1e3 * float(np.hypot(pose[0] - 1.0, pose[1] - 1.0))


def _quality() -> list[Row]:
    base, periods = differential_drive(0.1, 0.4), 500
    step, circle = (CommandLimiter(base, limits, PERIOD) for limits in (RAMP, LIMITS))
    ramp = step.run(step.at_rest(), np.tile(STEP, (periods, 1)))[0]
    ring = circle.run(circle.at_rest(), np.tile(CIRCLE, (periods, 1)))[0]
    peer = _rate_limited(STEP, RAMP, periods), _rate_limited(CIRCLE, LIMITS, periods)
    return [
        Row("jerk of a step to 1 m/s, in its limit", _jerk(ramp, RAMP), "x",
            _jerk(peer[0], RAMP), RATE_LIMITER, limit=1.0 + 1e-9),
        Row("a circle of 1 m left by, limits 0.5 m/s^2 and 3 rad/s^2", _left(ring), "mm",
            _left(peer[1]), RATE_LIMITER, limit=1e-6),
        Row("mecanum odometry off after a quarter turn of 1 m", _quarter(), "mm",
            7.1, "mecanum_drive (stated)", limit=1e-6),
    ]  # fmt: skip
