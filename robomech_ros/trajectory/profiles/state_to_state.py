"""Jerk-limited motion between two states of any position, velocity and acceleration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from robomech_ros.trajectory.curves.compiled_sampling import PiecewiseMotion, sample_many
from robomech_ros.trajectory.curves.motion_to_rest import check_positions, check_rates, settled
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.curves.time_scaling import checked_duration
from robomech_ros.trajectory.joint_points import check_numbers, joint_values
from robomech_ros.trajectory.limits import RATES, JointLimits, Limits
from robomech_ros.trajectory.profiles.jerk_limited import (
    check_in_time,
    check_state,
    planned_between,
)
from robomech_ros.trajectory.sample import Sample
from robomech_ros.trajectory.tolerances import SHORTEST_TRAJECTORY
from robomech_ros.typing import Array, ArrayLike


@dataclass(frozen=True, eq=False)
class StateToState(PiecewiseMotion):
    """Piecewise constant jerk, all joints arriving together, as fast at the end as was wanted.

    Attributes
    ----------
    final : Sample
        Position, velocity and acceleration at the end, (n,); its jerk is zero.
    pieces : PiecewisePolynomial
        The curve, from t = 0 on.
    """

    final: Sample
    pieces: PiecewisePolynomial

    ACCELERATION_STEPS: ClassVar[bool] = False

    def sample(self, t: ArrayLike) -> Sample:
        """Sample positions and derivatives, (n,) or (m, n), at instants (s), () or (m,).

        Before the start and after the end the joints are at rest there.
        """
        return settled(sample_many(self.pieces, t), t, self.pieces, *self.final[:3])


def state_to_state(
    q0: ArrayLike,
    q1: ArrayLike,
    *,
    limits: JointLimits | Any,
    start_velocity: ArrayLike | None = None,
    start_acceleration: ArrayLike | None = None,
    final_velocity: ArrayLike | None = None,
    final_acceleration: ArrayLike | None = None,
    duration: float | None = None,
) -> StateToState:
    """Plan the fastest jerk-limited motion from one state to another, by Ruckig.

    Parameters
    ----------
    q0, q1 : array_like, shape (n,)
        Start and goal, rad or m.
    limits : JointLimits
        A chain model, `Limits`, or anything with the same attributes; velocity, acceleration and
        jerk limits of every joint.
    start_velocity, start_acceleration : array_like, shape (n,), optional
        Rates at the start, rad or m over s and s^2; zero where not given.
    final_velocity, final_acceleration : array_like, shape (n,), optional
        Rates at the end, likewise.
    duration : float, optional
        Wanted duration in s; None (or 0) for the shortest.

    Returns
    -------
    StateToState
        With ``.duration`` (s), ``.sample(t)`` and ``.pieces``.

    Raises
    ------
    BadValueError
        If positions or rates do not have one finite number for each joint, or Ruckig fails.
    MissingLimitsError
        If a joint lacks a limit.
    SeedOutsideLimitsError, LimitExceededError
        If a state is outside the limits, or the motion between them leaves them: a joint that is as
        fast as it may be and still accelerates must become faster.
    DurationTooShortError
        If the wanted duration is not possible; moving joints may not be able to wait, either.

    References
    ----------
    L. Berscheid, T. Kröger, "Jerk-limited Real-time Trajectory Generation with Arbitrary Target
    States", Robotics: Science and Systems XVII, 2021.

    Examples
    --------
    >>> from robomech_ros.trajectory import Limits, state_to_state
    >>> limits = Limits(["lift"], velocity=1.0, acceleration=4.0, jerk=40.0)
    >>> motion = state_to_state([0.0], [1.0], limits=limits, start_velocity=[0.5])
    >>> motion.sample(0.0).velocity.round(6), motion.sample(motion.duration).position.round(6)
    (array([0.5]), array([1.]))
    """
    allowed = Limits.of(limits)
    allowed.require(*RATES)
    n = len(allowed.joint_names)
    start, goal = _checked("q0", q0, n), _checked("q1", q1, n)
    allowed.check_start(start)
    allowed.check_goal(goal)
    begin = (
        _checked("start_velocity", start_velocity, n),
        _checked("start_acceleration", start_acceleration, n),
    )
    end = (
        _checked("final_velocity", final_velocity, n),
        _checked("final_acceleration", final_acceleration, n),
    )
    check_state("start", allowed, *begin)
    check_state("final", allowed, *end)
    wanted = checked_duration(duration)
    least = max(wanted or 0.0, SHORTEST_TRAJECTORY)
    phases, pieces = planned_between(start, goal, allowed, least, begin, end)
    check_in_time(wanted, pieces, phases.alone, allowed)
    check_rates(pieces, allowed)
    check_positions(pieces, start, allowed)
    return StateToState(Sample(goal, *end, np.zeros(n)), pieces)


def _checked(what: str, values: ArrayLike | None, n: int) -> Array:
    """Copy one finite number for each joint, shape (n,), zeros for None."""
    array = np.zeros(n) if values is None else joint_values(what, values, (n,))
    check_numbers(what, array)
    return array
