"""Cubics between knots, compared with limits."""

import numpy as np
import pytest

from robomech_ros.servo.cubics import CubicCheck, end_of_cubic
from robomech_ros.servo.limits import ServoLimits

H = 0.1
STILL = np.zeros((2, 2))
LIMITS = {"lower": -1.0, "upper": 1.0, "velocity": 1.0, "acceleration": 2.0, "jerk": 20.0}


def check(**limits):
    given = {name: np.array([x, x]) for name, x in (LIMITS | limits).items()}
    return CubicCheck(ServoLimits(("still", "joint"), **given, units=("rad", "m")))


def knots(start, velocity, acceleration, jerk, count=3):
    """Two joints, one at rest, the other with a constant jerk."""
    t = H * np.arange(count)
    q = start + t * (velocity + t * (acceleration / 2.0 + t * jerk / 6.0))
    v = velocity + t * (acceleration + t * jerk / 2.0)
    return np.full(count - 1, H), np.c_[0.0 * t, q], np.c_[0.0 * t, v]


@pytest.mark.parametrize(
    ("motion", "inside", "bound"),
    [
        ((0.0, 0.5, 0.0, 0.0), True, []),
        ((0.0, 0.99, 0.0, 0.0), True, []),
        ((0.0, 1.01, 0.0, 0.0), False, []),
        ((0.0, 0.0, 1.99, 0.0), True, []),
        ((0.0, 0.0, 2.01, 0.0), False, []),
        ((0.0, 0.0, -2.01, 0.0), False, []),
        ((0.0, 0.1, -1.99, 19.9), True, []),
        ((0.0, 0.1, -1.99, 20.1), False, []),
        ((0.95, 0.5, 0.0, 0.0), False, [1]),
        ((-0.95, -0.5, 0.0, 0.0), False, [1]),
        ((0.85, 0.5, 0.0, 0.0), True, []),
    ],
)
def test_each_limit_is_kept_or_not(motion, inside, bound):
    reached = np.array([[0.0, motion[2]], [0.0, motion[3]]])
    verdict = check().of(*knots(*motion), reached)
    assert (verdict.inside, list(verdict.bound)) == (inside, bound)


def test_a_jump_of_the_acceleration_counts_as_in_a_cycle_of_the_controller():
    """A jump by 1 m/s^2 is a jerk of 500 m/s^3 for 2 ms, beside that before and after it."""
    _, q, v = knots(0.0, 0.0, 0.0, 0.0, 2)
    _, onwards, faster = knots(0.0, 0.0, 1.0, 0.0, 2)
    joined = np.full(2, H), np.vstack((q, onwards[1:])), np.vstack((v, faster[1:]))
    assert check(jerk=501.0).of(*joined, STILL).inside
    assert not check(jerk=499.0).of(*joined, STILL).inside
    assert check(jerk=np.inf).of(*joined, STILL).inside
    _, onwards, faster = knots(0.0, 0.0, 1.0, -5.0, 2)
    joined = np.full(2, H), np.vstack((q, onwards[1:])), np.vstack((v, faster[1:]))
    assert not check(jerk=499.0).of(*joined, STILL).inside
    assert check(jerk=501.0).of(*joined, STILL).inside
    _, onwards, faster = knots(0.0, 0.0, 1.0, 5.0, 2)
    joined = np.full(2, H), np.vstack((q, onwards[1:])), np.vstack((v, faster[1:]))
    assert not check(jerk=504.0).of(*joined, STILL).inside
    assert check(jerk=506.0).of(*joined, STILL).inside


def test_what_the_acceleration_was_before_the_first_knot_counts():
    """The same jump there, from 1 m/s^2 with which the knot was reached."""
    reached = np.array([[0.0, 1.0], [0.0, 0.0]])
    begun = knots(0.0, 0.2, 0.0, 0.0)
    assert check(jerk=501.0).of(*begun, reached).inside
    assert not check(jerk=499.0).of(*begun, reached).inside
    assert not check(jerk=501.0).of(*begun, reached - [[0.0], [5.0]]).inside
    assert check(jerk=501.0).of(*knots(0.0, 0.2, 1.0, 0.0), reached).inside


def test_what_ends_at_rest_loses_its_acceleration_there():
    """Braking from 0.1 m/s at 0.5 m/s^2."""
    braked = knots(0.0, 0.1, -0.5, 0.0)
    braked[2][-1] = 0.0
    reached = np.array([[0.0, -0.5], [0.0, 0.0]])
    assert check(jerk=251.0).of(*braked, reached).inside
    assert not check(jerk=249.0).of(*braked, reached).inside
    # The jerk with which it comes to 0.5 m/s^2 ends at the same time.
    braked = knots(0.0, 0.2, -1.5, 5.0)
    braked[2][-1] = 0.0
    reached = np.array([[0.0, -1.5], [0.0, 5.0]])
    assert check(jerk=256.0).of(*braked, reached).inside
    assert not check(jerk=254.0).of(*braked, reached).inside


def test_the_end_of_a_cubic_has_its_acceleration_and_jerk():
    widths, q, v = knots(0.1, 0.2, 0.3, 0.4, 2)
    np.testing.assert_allclose(
        end_of_cubic(widths[0], q, v), [[0.0, 0.3 + 0.4 * H], [0.0, 0.4]], atol=1e-12
    )
