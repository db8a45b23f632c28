"""Random plans within the limits of every robot: sampled rates fill the limits and keep to them."""

import numpy as np
import pytest

from robomech_ros.robots import list_robots, load_robot
from robomech_ros.trajectory import PROFILES, Limits, point_to_point

# The extremes of all laws lie at these parts of the duration, at breaks, or halfway between them.
PARTS = np.concatenate(
    [
        np.linspace(0.0, 1.0, 41),
        0.5 + np.array([-1.0, 1.0]) * np.sqrt(3.0) / 6.0,  # accelerations of 3-4-5
        0.5 + np.array([-1.0, 1.0]) * np.sqrt(5.0) / 10.0,  # of 4-5-6-7
    ]
)
# What Ruckig and the other rest-to-rest motions take at least; nothing binds then.
SHORTEST = 1e-3


@pytest.fixture(scope="module")
def limits_of_robots():
    return [(name, Limits.of(load_robot(name))) for name in list_robots()]


def random_plan(rng, limits, profile):
    """Plan between random positions; some of the moves are short, some joints may stand still."""
    low, high = (np.clip(bound, -np.pi, np.pi) for bound in (limits.lower, limits.upper))
    start, goal = rng.uniform(low, high), rng.uniform(low, high)
    goal = start + (goal - start) * rng.choice([1.0, 1.0, 0.1, 0.001])
    still = rng.random(len(low)) < 0.1
    goal[still] = start[still]
    return start, goal, point_to_point(start, goal, limits=limits, profile=profile)


def largest_ratios(motion, limits):
    """Largest sampled part of each kind of limit: velocity, acceleration, jerk."""
    breaks = motion.pieces.breaks
    instants = np.concatenate(
        [PARTS * motion.duration, breaks, 0.5 * (breaks[1:] + breaks[:-1])]
    ).clip(0.0, motion.duration)
    sample = motion.sample(instants)
    rates = (
        (sample.velocity, limits.velocity),
        (sample.acceleration, limits.acceleration),
        (sample.jerk, limits.jerk),
    )
    return [float(np.abs(rate / limit).max()) for rate, limit in rates]


@pytest.mark.parametrize(
    "count", [pytest.param(300, id="300"), pytest.param(3000, marks=pytest.mark.long, id="3000")]
)
@pytest.mark.parametrize("profile", sorted(PROFILES))
def test_random_plans_fill_the_limits_and_keep_to_them(profile, count, limits_of_robots):
    rng = np.random.default_rng(count)
    for k in range(count):
        name, limits = limits_of_robots[k % len(limits_of_robots)]
        start, goal, motion = random_plan(rng, limits, profile)
        ratios = largest_ratios(motion, limits)
        if PROFILES[profile].ACCELERATION_STEPS:
            ratios = ratios[:2]
        what = (name, start.tolist(), goal.tolist(), ratios)
        assert max(ratios) <= 1.0 + 1e-9, what
        assert max(ratios) >= 0.999 or motion.duration == SHORTEST, what
        ends = motion.sample([0.0, motion.duration]).position
        np.testing.assert_array_equal(ends[1], goal)
        np.testing.assert_allclose(ends[0], start, rtol=0.0, atol=1e-15)
