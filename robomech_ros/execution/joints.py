"""Joint data of the execution: limits and positions."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros.trajectory.curves.interpolation import interpolant
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.trajectory.sample import Sample
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array, BoolArray

# Assumed for joints without limits: seconds to full speed and to full acceleration, and the speed
# (rad/s, m/s).
TIME_TO_SPEED, TIME_TO_ACCELERATION = 0.25, 0.1
USUAL_SPEED = 1.0


@dataclass(frozen=True, eq=False)
class State:
    """Positions (n,), rad or m, of n joints, and their rates (n,) per s and s^2."""

    position: Array
    velocity: Array
    acceleration: Array

    def __sub__(self, other: "State") -> "State":
        return State(
            self.position - other.position,
            self.velocity - other.velocity,
            self.acceleration - other.acceleration,
        )


def paced_state(sample: Sample, pace: float | Array, rate: float | Array) -> State:
    """Return the state on a curve that is followed at a pace, which changes at a rate (1/s)."""
    acceleration = sample.acceleration * pace * pace + sample.velocity * rate
    return State(sample.position, sample.velocity * pace, acceleration)


def approached(waypoints: Waypoints, positions: Array, present: State) -> PiecewisePolynomial:
    """Make the curve through waypoints, at these positions, from the present state on."""
    velocities, accelerations = waypoints.velocities, waypoints.accelerations
    return interpolant(
        np.concatenate([[0.0], waypoints.times]),
        np.vstack([present.position, positions]),
        None if velocities is None else np.vstack([present.velocity, velocities]),
        None if accelerations is None else np.vstack([present.acceleration, accelerations]),
    )


def at_rest(position: Array) -> State:
    """Return the state of joints that stand somewhere (rad or m)."""
    still = np.zeros(len(position))
    return State(np.array(position, dtype=np.float64), still, still)


@dataclass(frozen=True, eq=False)
class JointKinds:
    """Kinds of n joints, as far as a client knows them.

    Continuous ones (n,) turn without limits, so that a whole turn makes no difference. The units
    are ``"rad"`` or ``"m"``, for messages; empty where that is not known.
    """

    continuous: BoolArray
    units: Sequence[str]


@dataclass(frozen=True, eq=False)
class Joints:
    """Limits that the execution needs, infinite where there is none, and continuous joints (n,).

    Those turn without limits, so that a whole turn makes no difference.
    """

    limits: Limits
    continuous: BoolArray

    @classmethod
    def of(cls, chain: JointLimits) -> "Joints":
        """Read them of a chain model; for bare `Limits` no joint counts as continuous."""
        limits = Limits.of(chain)
        none = np.zeros(len(limits.joint_names), dtype=bool)
        return cls(limits, np.asarray(getattr(chain, "continuous", none)))

    @property
    def names(self) -> Sequence[str]:
        """Names of the joints."""
        return self.limits.joint_names

    @cached_property
    def acceleration(self) -> Array:
        """Acceleration limits; estimated from the velocity limit where there is none."""
        speed = np.where(np.isfinite(self.limits.velocity), self.limits.velocity, USUAL_SPEED)
        given = self.limits.acceleration
        return np.where(np.isfinite(given), given, speed / TIME_TO_SPEED)
