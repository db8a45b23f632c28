"""Random requests for plans: limits, points and rates over many magnitudes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from robomech_ros.trajectory import (
    PROFILES,
    VIA_PROFILES,
    Limits,
    PiecewisePolynomial,
    point_to_point,
    spline_through,
    state_to_state,
    through_points,
    time_optimal,
    torque_limited,
)
from robomech_ros.trajectory.limits import RATES

__all__ = ["CASES", "Case", "Planned"]

MOST_JOINTS = 7


@dataclass
class Planned:
    """A plan, and what it must be.

    Attributes
    ----------
    motion : PiecewiseTrajectory
    limits : Limits
    rates : tuple of str
        Which limits it keeps.
    points : ndarray, shape (m, n)
        Start, via points and goal.
    ends : tuple of ndarray, shape (2, n)
        Velocity and acceleration at start and end that were asked for; None for any.
    smooth : int
        Up to which derivative it is continuous.
    """

    motion: Any
    limits: Limits
    rates: tuple[str, ...]
    points: np.ndarray
    ends: tuple[np.ndarray | None, np.ndarray | None]
    smooth: int


Case = Callable[[np.random.Generator], Planned]


def random_limits(rng: np.random.Generator, n: int, jerk: bool) -> Limits:
    """Return limits around those of arms, or each over six magnitudes."""
    wide = rng.choice([0.5, 3.0])
    velocity = 10.0 ** rng.uniform(-wide, wide, n)
    acceleration = velocity * 10.0 ** (0.5 + rng.uniform(-wide, wide, n))
    jerks = acceleration * 10.0 ** (1.0 + rng.uniform(-wide, wide, n))
    names = [f"joint {k}" for k in range(n)]
    return Limits(names, velocity, acceleration, jerks if jerk else None)


def random_points(rng: np.random.Generator, n: int, count: int) -> np.ndarray:
    """Return points far from each other or micrometres apart; some joints stand still."""
    start = rng.uniform(-np.pi, np.pi, n)
    steps = rng.normal(size=(count - 1, n)) * 10.0 ** rng.uniform(-7.0, 0.5)
    if rng.random() < 0.3:
        steps *= 10.0 ** rng.uniform(-7.0, 0.0, (count - 1, 1))
    steps[:, rng.random(n) < 0.15] = 0.0
    return np.concatenate([start[None], start + np.cumsum(steps, axis=0)])


def _sizes(rng: np.random.Generator) -> int:
    return int(rng.integers(1, MOST_JOINTS + 1))


def _duration(rng: np.random.Generator, plan: Callable[[float | None], Any]) -> Any:
    """Plan the fastest motion, or one that is slowed down or lasts exactly as long."""
    motion = plan(None)
    if rng.random() < 0.7:
        return motion
    return plan(motion.duration * rng.choice([1.0, 1.0 + 1e-9, rng.uniform(1.0, 5.0)]))


def _resting(n: int) -> tuple[np.ndarray, np.ndarray]:
    return np.zeros((2, n)), np.zeros((2, n))


def _kept(profile: str, limits: Limits) -> tuple[str, ...]:
    if PROFILES[profile].ACCELERATION_STEPS:
        return RATES[:2]
    return RATES if np.isfinite(limits.jerk).all() else RATES[:2]


def _straight(profile: str) -> Case:
    def case(rng: np.random.Generator) -> Planned:
        n = _sizes(rng)
        limits = random_limits(rng, n, rng.random() < 0.5 or "jerk" in PROFILES[profile].REQUIRED)
        points = random_points(rng, n, 2)
        motion = _duration(
            rng,
            lambda seconds: point_to_point(
                *points, limits=limits, profile=profile, duration=seconds
            ),
        )
        steps = PROFILES[profile].ACCELERATION_STEPS
        velocity, acceleration = _resting(n)
        ends = velocity, None if steps else acceleration
        return Planned(motion, limits, _kept(profile, limits), points, ends, 1 if steps else 2)

    return case


def _through(profile: str) -> Case:
    def case(rng: np.random.Generator) -> Planned:
        n = _sizes(rng)
        limits = random_limits(rng, n, rng.random() < 0.5 or "jerk" in PROFILES[profile].REQUIRED)
        most = 4 if profile.startswith("poly") else 6
        points = random_points(rng, n, int(rng.integers(3, most + 1)))
        motion = _duration(
            rng,
            lambda seconds: through_points(
                points, limits=limits, profile=profile, duration=seconds
            ),
        )
        return Planned(motion, limits, _kept(profile, limits), points, _resting(n), 2)

    return case


def _state(rng: np.random.Generator, limits: Limits) -> tuple[np.ndarray, np.ndarray]:
    """Return a velocity and an acceleration from which a joint need not become too fast."""
    n = len(limits.joint_names)
    velocity = rng.uniform(-0.9, 0.9, n) * limits.velocity * (rng.random(n) < 0.8)
    room = np.sqrt(2.0 * limits.jerk * (limits.velocity - np.abs(velocity)))
    most = 0.9 * np.minimum(limits.acceleration, room)
    return velocity, rng.uniform(-1.0, 1.0, n) * most * (rng.random(n) < 0.6)


def _from_moving(rng: np.random.Generator) -> Planned:
    n = _sizes(rng)
    limits, points = random_limits(rng, n, True), random_points(rng, n, 2)
    velocity, acceleration = _state(rng, limits)
    given = {"start_velocity": velocity, "start_acceleration": acceleration}
    motion = point_to_point(*points, limits=limits, profile="ruckig", **given)
    rest = np.zeros(n)
    ends = np.stack([velocity, rest]), np.stack([acceleration, rest])
    return Planned(motion, limits, RATES, points, ends, 2)


def _between_states(rng: np.random.Generator) -> Planned:
    n = _sizes(rng)
    limits, points = random_limits(rng, n, True), random_points(rng, n, 2)
    begin, end = _state(rng, limits), _state(rng, limits)
    motion = state_to_state(
        *points,
        limits=limits,
        start_velocity=begin[0],
        start_acceleration=begin[1],
        final_velocity=end[0],
        final_acceleration=end[1],
    )
    ends = np.stack([begin[0], end[0]]), np.stack([begin[1], end[1]])
    return Planned(motion, limits, RATES, points, ends, 2)


def _path(rng: np.random.Generator, n: int) -> tuple[PiecewisePolynomial, np.ndarray]:
    """Return a spline, or lines with corners, over a path coordinate of any size."""
    points = random_points(rng, n, int(rng.integers(2, 7)))
    where = np.cumsum(rng.uniform(0.1, 1.0, len(points))) * 10.0 ** rng.uniform(-3.0, 3.0)
    if rng.random() < 0.3:
        rises = np.diff(points, axis=0) / np.diff(where)[:, None]
        return PiecewisePolynomial(where, np.stack([points[:-1], rises])), points
    spline = spline_through(points, times=where - where[0], ends="natural")
    return spline.pieces, points


def _along_path(jerk: bool) -> Case:
    def case(rng: np.random.Generator) -> Planned:
        n = _sizes(rng)
        limits = random_limits(rng, n, jerk)
        path, points = _path(rng, n)
        motion = time_optimal(path, limits, jerk_smoothing=jerk)
        velocity, acceleration = _resting(n)
        ends = velocity, acceleration if jerk else None
        rates = RATES if jerk else RATES[:2]
        return Planned(motion, limits, rates, points[[0, -1]], ends, 2 if jerk else 1)

    return case


def _along_path_within_torques(rng: np.random.Generator) -> Planned:
    """Take the pendulums of a point mass each, coupled by their bases."""
    n = int(rng.integers(1, 4))
    limits = random_limits(rng, n, False)
    path, points = _path(rng, n)
    mass = np.eye(n) + 0.2

    def dynamics(q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
        return qdd @ mass + 0.1 * np.sin(q) * qd**2 + np.cos(q)

    effort = 1.5 + 10.0 ** rng.uniform(-1.0, 2.0, n)
    motion = torque_limited(path, limits, dynamics, effort=effort)
    ends = _resting(n)[0], None
    return Planned(motion, limits, RATES[:2], points[[0, -1]], ends, 1)


CASES: dict[str, Case] = {
    **{profile: _straight(profile) for profile in PROFILES},
    "ruckig_from_moving": _from_moving,
    "state_to_state": _between_states,
    **{f"{profile}_through": _through(profile) for profile in VIA_PROFILES},
    "path": _along_path(False),
    "path_smoothed": _along_path(True),
    "path_torques": _along_path_within_torques,
}
