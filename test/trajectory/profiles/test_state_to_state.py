"""From state to state: any rates at both ends, Ruckig as judge, and what cannot be kept."""

import numpy as np
import pytest
import ruckig

from robomech_ros.errors import (
    BadValueError,
    DurationTooShortError,
    LimitExceededError,
    MissingLimitsError,
    NonFiniteError,
    SeedOutsideLimitsError,
    WrongSizeError,
)
from robomech_ros.trajectory import PROFILES, Limits, point_to_point, state_to_state, verify

JOINTS = ("base", "shoulder", "elbow")
LIMITS = Limits(JOINTS, velocity=2.0, acceleration=5.0, jerk=40.0)
ENDS = ("start_velocity", "start_acceleration", "final_velocity", "final_acceleration")


def random_case(generator):
    n = int(generator.integers(1, 8))
    velocity = 10.0 ** generator.uniform(-1.0, 1.0, n)
    acceleration = velocity * 10.0 ** generator.uniform(-0.5, 1.0, n)
    jerk = acceleration * 10.0 ** generator.uniform(0.0, 2.0, n)
    limits = Limits([f"joint_{k}" for k in range(n)], velocity, acceleration, jerk)
    changes = generator.uniform(-1.0, 1.0, (2, n)) * acceleration
    # What the speed gains while the acceleration ends, and has gained since it began.
    gained = np.minimum(changes**2 / (2.0 * jerk), 0.9 * velocity)
    changes = np.sign(changes) * np.sqrt(gained * 2.0 * jerk)
    speeds = generator.uniform(-1.0, 1.0, (2, n)) * (velocity - gained)
    rates = dict(zip(ENDS, (speeds[0], changes[0], speeds[1], changes[1]), strict=True))
    return generator.uniform(-3.0, 3.0, (2, n)), limits, rates


def ruckigs_duration(ends, limits, rates):
    request = ruckig.InputParameter(len(ends[0]))
    request.current_position, request.target_position = ends.tolist()
    request.current_velocity, request.current_acceleration = rates[ENDS[0]], rates[ENDS[1]]
    request.target_velocity, request.target_acceleration = rates[ENDS[2]], rates[ENDS[3]]
    request.max_velocity, request.max_acceleration = limits.velocity, limits.acceleration
    request.max_jerk = limits.jerk
    motion = ruckig.Trajectory(len(ends[0]))
    ruckig.Ruckig(len(ends[0])).calculate(request, motion)
    return motion.duration


def test_any_state_is_reached_from_any_other_as_fast_as_by_ruckig_itself():
    generator = np.random.default_rng(6)
    for _ in range(200):
        ends, limits, rates = random_case(generator)
        motion = state_to_state(*ends, limits=limits, **rates)
        report = verify(motion, limits, start=ends[0], to_rest=False)
        assert report.ok, report.violation
        assert motion.duration == pytest.approx(ruckigs_duration(ends, limits, rates), rel=1e-8)
        first, last = motion.sample(0.0), motion.sample(motion.duration)
        np.testing.assert_allclose(first[:3], [ends[0], rates[ENDS[0]], rates[ENDS[1]]], atol=1e-9)
        np.testing.assert_array_equal(last[:3], [ends[1], rates[ENDS[2]], rates[ENDS[3]]])
        # The curve itself gets there, not only the sample at its end.
        arriving = motion.pieces.sample(motion.duration)
        np.testing.assert_allclose(arriving[:3], last[:3], atol=1e-6)
        dense = motion.sample(np.linspace(0.0, motion.duration, 200))
        for rate in ("velocity", "acceleration", "jerk"):
            assert (np.abs(getattr(dense, rate)) <= getattr(limits, rate) * (1.0 + 1e-9)).all()


def test_motions_follow_each_other_without_a_step():
    via, passing = np.array([0.4, -0.2, 0.3]), np.array([0.8, -0.4, 0.1])
    to = state_to_state(np.zeros(3), via, limits=LIMITS, final_velocity=passing)
    onward = state_to_state(via, np.ones(3), limits=LIMITS, start_velocity=passing)
    np.testing.assert_array_equal(to.sample(to.duration)[:2], onward.sample(0.0)[:2])
    assert verify(onward, LIMITS).ok
    over = to.sample([to.duration, to.duration + 1.0])
    np.testing.assert_array_equal(over.position, [via, via])
    np.testing.assert_array_equal(over.velocity, [passing, np.zeros(3)])


def test_from_rest_to_rest_it_takes_as_long_as_the_profile():
    goal = np.array([1.0, -2.0, 0.5])
    wanted = point_to_point(np.zeros(3), goal, limits=LIMITS, profile="ruckig").duration
    assert state_to_state(np.zeros(3), goal, limits=LIMITS).duration == pytest.approx(wanted)
    longer = state_to_state(np.zeros(3), goal, limits=LIMITS, duration=3.0 * wanted)
    assert longer.duration == pytest.approx(3.0 * wanted)
    with pytest.raises(DurationTooShortError, match="joint 'shoulder'"):
        state_to_state(np.zeros(3), goal, limits=LIMITS, duration=0.5 * wanted)


def test_a_joint_that_must_become_too_fast_is_named():
    rates = {"start_velocity": [0.0, 1.9, 0.0], "start_acceleration": [0.0, 5.0, 0.0]}
    fastest = 1.9 + 5.0**2 / (2.0 * 40.0)
    for plan in (
        lambda: state_to_state(np.zeros(3), np.ones(3), limits=LIMITS, **rates),
        lambda: point_to_point(np.zeros(3), np.ones(3), limits=LIMITS, profile="ruckig", **rates),
    ):
        with pytest.raises(
            LimitExceededError, match="velocity on the way of joint 'shoulder'"
        ) as e:
            plan()
        assert (e.value.value, e.value.limit) == (pytest.approx(fastest), 2.0)
    mirrored = {name: np.negative(values) for name, values in rates.items()}
    with pytest.raises(LimitExceededError) as caught:
        state_to_state(np.zeros(3), np.ones(3), limits=LIMITS, **mirrored)
    assert (caught.value.value, caught.value.limit) == (pytest.approx(-fastest), -2.0)
    before = {"final_velocity": [0.0, 1.9, 0.0], "final_acceleration": [0.0, -5.0, 0.0]}
    with pytest.raises(BadValueError, match="motion of joint 'shoulder'"):
        state_to_state(np.zeros(3), np.ones(3), limits=LIMITS, **before)


@pytest.mark.parametrize(
    ("given", "error", "text"),
    [
        ({"final_velocity": [0.0, 0.0]}, WrongSizeError, r"final_velocity has shape \(2,\)"),
        ({"final_velocity": [0.0, np.nan, 0.0]}, NonFiniteError, r"final_velocity\[1\] is nan"),
        ({"final_acceleration": [0.0, "x", 0.0]}, BadValueError, "final_acceleration"),
        ({"final_velocity": [0.0, 2.5, 0.0]}, LimitExceededError, "final velocity of joint 'shou"),
        ({"final_acceleration": [6, 0, 0]}, LimitExceededError, "final acceleration of joint 'ba"),
        ({"start_acceleration": [0, 0, -6]}, LimitExceededError, "start acceleration of joint 'el"),
        ({"start_velocity": [1e300, 0, 0]}, BadValueError, r"start_velocity\[0\] is 1e\+300"),
        ({"duration": -1.0}, BadValueError, "duration is -1"),
        ({"limits": Limits(JOINTS, 1.0, 1.0)}, MissingLimitsError, "no jerk limit"),
        ({"limits": Limits(JOINTS, 1, 1, 1, lower=0.5)}, SeedOutsideLimitsError, "'base'"),
        ({"limits": Limits(JOINTS, 1, 1, 1, upper=0.5)}, LimitExceededError, "goal position"),
        (
            {"final_velocity": [2.0, 0, 0], "limits": Limits(JOINTS, 2, 5, 9, lower=-0.01)},
            LimitExceededError,
            "position on the way of joint 'base'",
        ),
    ],
)
def test_refusals(given, error, text):
    goal = [0.05, 1.0, 1.0]
    with pytest.raises(error, match=text):
        state_to_state(np.zeros(3), goal, **({"limits": LIMITS} | given))


@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_a_robot_without_joints_stands_still(profile):
    motion = point_to_point([], [], limits=Limits((), [], [], []), profile=profile)
    assert motion.duration == pytest.approx(1e-3)
    assert motion.sample([0.0, motion.duration]).position.shape == (2, 0)
