"""Ruckig's motions: the same as Ruckig's own samples, within limits, errors that name joints."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import ruckig

from robomech_ros.errors import (
    BadValueError,
    DurationTooShortError,
    LimitExceededError,
    MissingLimitsError,
)
from robomech_ros.trajectory import Limits, point_to_point, through_points, verify
from robomech_ros.trajectory.curves.bounds import extremes

JOINTS = ("base", "shoulder", "elbow")


def random_limits(generator, n=6):
    return Limits(
        [f"joint_{k}" for k in range(n)],
        velocity=generator.uniform(0.5, 4.0, n),
        acceleration=generator.uniform(1.0, 20.0, n),
        jerk=10.0 ** generator.uniform(1.0, 3.5, n),
    )


def ruckig_itself(start, goal, limits, velocity=None, duration=None):
    n = len(start)
    request, motion = ruckig.InputParameter(n), ruckig.Trajectory(n)
    request.current_position, request.target_position = start.tolist(), goal.tolist()
    request.max_velocity = limits.velocity.tolist()
    request.max_acceleration = limits.acceleration.tolist()
    request.max_jerk = limits.jerk.tolist()
    if velocity is not None:
        request.current_velocity = velocity.tolist()
    request.minimum_duration = duration
    request.synchronization = ruckig.Synchronization.Phase
    assert ruckig.Ruckig(n).calculate(request, motion) == ruckig.Result.Working
    return motion


def samples_of(motion, oracle):
    """Sample a motion and Ruckig's own: positions, velocities and accelerations (3, m, n)."""
    instants = np.linspace(0.0, motion.duration * (1.0 - 1e-9), 200)
    sample = motion.sample(instants)
    own = np.array([oracle.at_time(instant) for instant in instants])
    return np.stack([sample.position, sample.velocity, sample.acceleration]), own.swapaxes(0, 1)


@pytest.mark.parametrize("seed", range(40))
def test_from_a_moving_start_it_is_ruckigs_own_motion(seed):
    generator = np.random.default_rng(seed)
    limits = random_limits(generator)
    start, goal = generator.uniform(-3.0, 3.0, (2, 6))
    velocity = generator.uniform(-0.5, 0.5, 6)
    motion = point_to_point(start, goal, limits=limits, profile="ruckig", start_velocity=velocity)
    oracle = ruckig_itself(start, goal, limits, velocity)
    assert motion.duration == pytest.approx(oracle.duration, abs=1e-9)
    samples, own = samples_of(motion, oracle)
    np.testing.assert_allclose(samples, own, atol=1e-7)  # Ruckig's own tolerance


@pytest.mark.parametrize("seed", range(40))
def test_from_rest_every_joint_follows_ruckigs_motion_or_the_course_of_the_slowest(seed):
    generator = np.random.default_rng(seed)
    limits = random_limits(generator)
    start, goal = generator.uniform(-3.0, 3.0, (2, 6))
    motion = point_to_point(start, goal, limits=limits, profile="ruckig")
    oracle = ruckig_itself(start, goal, limits)
    assert motion.duration == pytest.approx(oracle.duration, abs=1e-9)
    samples, own = samples_of(motion, oracle)
    slowest = int(np.argmax(oracle.independent_min_durations))
    np.testing.assert_allclose(samples[..., slowest], own[..., slowest], atol=1e-7)
    course = own[..., slowest].copy()
    course[0] -= start[slowest]
    course /= goal[slowest] - start[slowest]
    sharing = 0
    for joint in range(6):
        shared = course * (goal[joint] - start[joint])
        shared[0] += start[joint]
        follows = np.allclose(samples[..., joint], shared, atol=1e-7)
        assert follows or np.allclose(samples[..., joint], own[..., joint], atol=1e-7)
        sharing += follows
    assert sharing >= 1


@pytest.mark.parametrize("seed", range(40))
def test_limits_hold_everywhere_and_one_of_them_binds(seed):
    generator = np.random.default_rng(1000 + seed)
    limits = random_limits(generator)
    start, goal = generator.uniform(-3.0, 3.0, (2, 6))
    motion = point_to_point(start, goal, limits=limits, profile="ruckig")
    report = verify(motion, limits, start=start)
    assert report.ok, report.violation
    assert report.peak_jerk_ratio.max() == pytest.approx(1.0, rel=1e-9)
    np.testing.assert_array_equal(motion.sample(motion.duration).position, goal)
    dense = motion.sample(np.linspace(0.0, motion.duration, 2000))
    for rate in ("velocity", "acceleration", "jerk"):
        assert (np.abs(getattr(dense, rate)) <= getattr(limits, rate) * (1.0 + 1e-9)).all()


COINCIDENCES = [  # velocity, acceleration and jerk limit, start and goal, shortest time
    (0.1, 2.5, 2000.0, 0.0049921875, 0.005, 0.005),
    (10.0, 20.0, 1000.0, 1.694, 1.71, 0.08),
]


@pytest.mark.parametrize(
    ("velocity", "acceleration", "jerk", "start", "goal", "time"), COINCIDENCES
)
def test_a_displacement_that_just_reaches_the_acceleration_limit_takes_the_shortest_time(
    velocity, acceleration, jerk, start, goal, time
):
    limits = Limits(["slide"], velocity=velocity, acceleration=acceleration, jerk=jerk)
    motion = point_to_point([start], [goal], limits=limits, profile="ruckig")
    assert motion.duration == pytest.approx(time, rel=1e-9)
    assert verify(motion, limits, start=[start]).ok


def test_several_joints_and_via_points_with_such_displacements():
    limits = Limits(JOINTS, velocity=3.0, acceleration=np.pi, jerk=10.0 * np.pi)
    start, goal = np.array([0.46, 0.39, 0.88]), np.array([0.5228318530717959, 0.39, 0.88])
    motion = point_to_point(start, goal, limits=limits, profile="ruckig")
    assert motion.duration == pytest.approx(0.4, rel=1e-9)
    there_and_back = through_points([start, goal, start], limits=limits, profile="ruckig")
    assert there_and_back.duration == pytest.approx(0.8, rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_one_joint_is_as_fast_as_the_closed_form_whatever_the_numbers(seed):
    generator = np.random.default_rng(seed)
    digits = [1.0, 1.5, 2.0, 2.5, 4.0, 5.0, 8.0]
    for _ in range(50):
        velocity, acceleration, jerk = generator.choice(digits, 3) * [1.0, 1.0, 10.0]
        limits = Limits(["turn"], velocity=velocity, acceleration=acceleration, jerk=jerk)
        start = round(generator.uniform(-3.0, 3.0), 2)
        for way in (
            2.0 * acceleration**3 / jerk**2,
            velocity * (velocity / acceleration + acceleration / jerk),
            2.0 * velocity * np.sqrt(velocity / jerk),
            round(generator.uniform(0.01, 2.0), 2),
        ):
            closed, motion = (
                point_to_point([start], [start + way], limits=limits, profile=profile)
                for profile in ("double_s", "ruckig")
            )
            assert motion.duration == pytest.approx(closed.duration, rel=1e-9)


def test_the_time_optimum_of_a_single_joint():
    # Bang-bang jerk without plateaus: four phases of equal length with T = (32 d / j)^(1/3).
    limits = Limits(["slide"], velocity=100.0, acceleration=100.0, jerk=4.0)
    motion = point_to_point([0.0], [1.0], limits=limits, profile="ruckig")
    assert motion.duration == pytest.approx((32.0 / 4.0) ** (1.0 / 3.0), rel=1e-12)
    jerks = motion.sample([0.01, 0.49, 0.51, 1.49, 1.51, 1.99]).jerk[:, 0]
    np.testing.assert_allclose(jerks, [4.0, 4.0, -4.0, -4.0, 4.0, 4.0])


def test_from_rest_the_joints_share_one_course_where_limits_permit():
    limits = Limits(JOINTS, velocity=1.0, acceleration=3.0, jerk=20.0)
    goal = np.array([1.0, -2.0, 0.5])
    motion = point_to_point(np.zeros(3), goal, limits=limits, profile="ruckig")
    positions = motion.sample(np.linspace(0.0, motion.duration, 50)).position
    np.testing.assert_allclose(positions, np.outer(positions[:, 1] / goal[1], goal), atol=1e-12)


def test_a_wanted_duration_is_kept():
    limits = Limits(JOINTS, velocity=1.0, acceleration=3.0, jerk=20.0)
    start, goal = np.zeros(3), np.array([1.0, -2.0, 0.5])
    shortest = point_to_point(start, goal, limits=limits, profile="ruckig").duration
    for factor in (1.0, 1.0001, 2.0, 50.0):
        wanted = shortest * factor
        motion = point_to_point(start, goal, limits=limits, profile="ruckig", duration=wanted)
        assert motion.duration == pytest.approx(wanted, abs=1e-9)
        assert verify(motion, limits, start=start).ok
        moving = [0.1, 0.0, 0.0]
        motion = point_to_point(
            start, goal, limits=limits, profile="ruckig", duration=wanted, start_velocity=moving
        )
        assert motion.duration == pytest.approx(wanted, abs=1e-9)
    with pytest.raises(DurationTooShortError, match="joint 'shoulder'") as caught:
        point_to_point(start, goal, limits=limits, profile="ruckig", duration=0.9 * shortest)
    assert caught.value.shortest == pytest.approx(shortest)
    assert caught.value.limit == "velocity and acceleration and jerk"


@pytest.mark.parametrize("rate", ["velocity", "acceleration", "jerk"])
def test_every_limit_is_needed(rate):
    given = {"velocity": 1.0, "acceleration": 1.0, "jerk": 1.0} | {rate: [1.0, np.nan, 1.0]}
    with pytest.raises(MissingLimitsError, match=f"no {rate} limit for joint shoulder"):
        point_to_point(np.zeros(3), np.ones(3), limits=Limits(JOINTS, **given), profile="ruckig")


def test_a_moving_start_over_its_limit_is_refused():
    limits = Limits(JOINTS, velocity=1.0, acceleration=3.0, jerk=20.0)
    with pytest.raises(LimitExceededError, match=r"start velocity of joint 'elbow' is -1\.5"):
        point_to_point(
            np.zeros(3),
            np.ones(3),
            limits=limits,
            profile="ruckig",
            start_velocity=[0.0, 0.0, -1.5],
        )
    with pytest.raises(LimitExceededError, match="start acceleration of joint 'base' is 4"):
        point_to_point(
            np.zeros(3),
            np.ones(3),
            limits=limits,
            profile="ruckig",
            start_acceleration=[4.0, 0.0, 0.0],
        )


def test_overshoot_over_a_position_limit_is_refused():
    limits = Limits(JOINTS, velocity=2.0, acceleration=3.0, jerk=20.0, lower=-1.0, upper=1.0)
    arguments = {"limits": limits, "profile": "ruckig", "start_velocity": [0.0, 1.5, 0.0]}
    start, goal = np.array([0.0, 0.9, 0.0]), np.zeros(3)
    with pytest.raises(LimitExceededError, match="position on the way of joint 'shoulder'") as over:
        point_to_point(start, goal, **arguments)
    free = Limits(JOINTS, velocity=2.0, acceleration=3.0, jerk=20.0)
    motion = point_to_point(start, goal, **(arguments | {"limits": free}))
    peak = motion.sample(np.linspace(0.0, motion.duration, 20001)).position[:, 1].max()
    assert over.value.value == pytest.approx(peak, abs=1e-6)
    assert over.value.limit == 1.0
    mirrored = arguments | {"start_velocity": [0.0, -1.5, 0.0]}
    with pytest.raises(LimitExceededError) as under:
        point_to_point(-start, goal, **mirrored)
    assert (under.value.value, under.value.limit) == (pytest.approx(-peak, abs=1e-6), -1.0)


def test_motions_that_last_longer_than_ruckig_itself_can_count():
    slow = Limits(JOINTS, velocity=1e-4, acceleration=1.0, jerk=1.0)
    start, goal = np.zeros(3), np.array([1.0, -2.0, 0.5])
    motion = point_to_point(start, goal, limits=slow, profile="ruckig")
    assert motion.duration == pytest.approx(2e4, rel=1e-3)
    assert verify(motion, slow, start=start).ok
    longer = point_to_point(start, goal, limits=slow, profile="ruckig", duration=1e6)
    assert longer.duration == pytest.approx(1e6)
    assert verify(longer, slow, start=start).ok


def test_a_failure_of_ruckig_names_the_joint(monkeypatch):
    def fail(self, request, motion):
        raise ruckig.RuckigError("\n[ruckig] error in step 1, dof: 2 input:\nmore")

    monkeypatch.setattr(ruckig.Ruckig, "calculate", fail)
    limits = Limits(JOINTS, velocity=1.0, acceleration=1.0, jerk=1.0)
    with pytest.raises(BadValueError, match="motion of joint 'elbow' is 'error in step 1, dof: 2"):
        point_to_point(
            np.zeros(3), np.ones(3), limits=limits, profile="ruckig", start_velocity=[0.1, 0.0, 0.0]
        )
    resting = point_to_point(np.zeros(3), np.ones(3), limits=limits, profile="ruckig")
    assert resting.duration == pytest.approx(32.0 ** (1.0 / 3.0), rel=1e-12)


@pytest.mark.parametrize("distance", [0.0, 1e-300, 1e-17, 1e-12, 1e-9, 1e-6])
def test_tiny_motions(distance):
    limits = Limits(JOINTS, velocity=1.0, acceleration=3.0, jerk=20.0)
    start = np.array([0.3, -0.2, 0.1])
    goal = start + np.array([distance, 0.0, -distance])
    motion = point_to_point(start, goal, limits=limits, profile="ruckig")
    assert motion.duration >= 1e-3
    assert verify(motion, limits, start=start).ok
    np.testing.assert_array_equal(motion.sample(motion.duration).position, goal)


def test_a_motion_that_ruckig_cannot_do_in_si_units():
    # Ruckig 0.19 finds no motion of the second joint that lasts as long as that of the first.
    limits = Limits(
        ("slow", "fast"), velocity=[0.1, 0.32], acceleration=[1.0, 0.432], jerk=[10.0, 146908.0]
    )
    start, goal = np.zeros(2), np.array([19.98, 0.0])
    motion = point_to_point(
        start, goal, limits=limits, profile="ruckig", start_velocity=[0.0, 0.0013]
    )
    assert motion.duration == pytest.approx(200.0)
    assert verify(motion, limits, start=start).ok


def test_plans_can_be_copied_and_stored_before_they_are_looked_at():
    limits = Limits(("a", "b"), velocity=1.0, acceleration=2.0, jerk=9.0)
    plans = [
        point_to_point([0.0, 0.1], [1.0, -0.4], limits=limits, profile="ruckig") for _ in range(3)
    ]
    stored = pickle.loads(pickle.dumps(plans[0]))
    copied = copy.deepcopy(plans[1])
    instants = np.linspace(0.0, plans[2].duration, 50)
    wanted = plans[2].sample(instants)
    for plan in (stored, copied):
        assert plan.duration == plans[2].duration
        np.testing.assert_array_equal(plan.sample(instants).position, wanted.position)


def test_from_rest_no_joint_leaves_the_way_from_start_to_goal():
    rng = np.random.default_rng(8)
    for _ in range(60):
        rates = (10.0 ** rng.uniform(low, low + 2.0, 6) for low in (-1.0, -0.5, 0.5))
        limits = Limits(tuple("abcdef"), *rates)
        start = rng.uniform(-3.0, 3.0, 6)
        goal = start + rng.uniform(-1.0, 1.0, 6) * 10.0 ** rng.uniform(-3.0, 0.5, 6)
        motion = point_to_point(start, goal, limits=limits, profile="ruckig")
        low, high = (values[0] for values in extremes(motion.pieces))
        np.testing.assert_array_less(np.minimum(start, goal) - low, 1e-12)
        np.testing.assert_array_less(high - np.maximum(start, goal), 1e-12)
        ends = motion.sample([0.0, motion.duration])
        np.testing.assert_array_equal(ends.position, [start, goal])


def test_threads_may_plan_within_the_same_limits():
    limits = Limits(("a", "b"), velocity=1.0, acceleration=2.0, jerk=9.0)
    goals = np.random.default_rng(1).uniform(-2.0, 2.0, (200, 2))

    def duration(goal):
        return point_to_point([0.0, 0.0], goal, limits=limits, profile="ruckig").duration

    alone = [duration(goal) for goal in goals]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(duration, goals)) == alone


@pytest.mark.parametrize("way", [62.5, 14.22])
def test_what_takes_too_long_for_ruckig_is_still_the_fastest(way):
    """A joint that crawls for hours beside others that start within milliseconds."""
    rates = np.array([[5.0, 8e-5], [8.0, 0.2], [12.8, 500.0]])
    limits = Limits(("far", "slow"), *rates)
    goal = np.array([way, way])
    motion = point_to_point([0.0, 0.0], goal, limits=limits, profile="ruckig")
    alone = [
        point_to_point([0.0], [way], limits=Limits(("one",), *of), profile="double_s").duration
        for of in rates.T[:, :, None]
    ]
    assert motion.duration == pytest.approx(max(alone), rel=1e-9)
    np.testing.assert_array_equal(motion.sample(motion.duration).position, goal)
    # A limit is kept to the rounding of instants, 1e-10 s after nine days, over the ramp's 0.4 ms.
    samples = motion.sample(np.linspace(0.0, motion.duration, 201))
    assert (np.abs(samples.velocity) <= rates[0] * (1.0 + 1e-6)).all()
    assert (np.abs(samples.acceleration) <= rates[1] * (1.0 + 1e-6)).all()
