"""Joints compared with what they were told."""

import numpy as np
import pytest

from robomech_ros.robots import load_robot
from robomech_ros.servo.tracking import Tracking

PERIOD, SPEED, DELAY, TOLERANCE = 0.01, 0.5, 0.1, 0.05


@pytest.fixture
def told():
    """Tracking of a PUMA whose waist was told to turn for a second, and where it is told to be."""
    chain = load_robot("puma560")
    tracking = Tracking(chain, TOLERANCE, DELAY)
    position = np.zeros(chain.n)
    for k in range(101):
        position = np.zeros(chain.n)
        position[0] = SPEED * PERIOD * k
        tracking.tell(PERIOD * k, position)
    return tracking, position


@pytest.mark.parametrize("late", [0.0, 0.5 * DELAY, DELAY, DELAY + 0.9 * TOLERANCE / SPEED])
def test_joints_may_be_late_and_a_little_off(told, late):
    tracking, position = told
    position[0] -= SPEED * late
    assert tracking.deviation(1.0, position) is None


@pytest.mark.parametrize(
    ("joint", "off", "amount"),
    [
        (0, 0.06, 0.06),
        # From where it was told to be the delay, and a period, ago.
        (0, -0.06 - SPEED * (DELAY + PERIOD), 0.06),
        (4, -0.2, 0.2),
        (1, 6.3, 6.3),
    ],
)
def test_the_joint_that_is_off_most_is_named_with_the_amount(told, joint, off, amount):
    tracking, position = told
    position = position + 0.01
    position[joint] += off - 0.01
    found = tracking.deviation(1.0, position)
    name = load_robot("puma560").joint_names[joint]
    assert found is not None and found.joint == name
    assert found.amount == pytest.approx(amount, abs=0.6 * SPEED * PERIOD * 2)
    assert found.text.startswith(f"joint '{name}' is ")
    assert found.text.endswith("rad off its command, the tolerance is 0.05 rad")


def test_places_between_the_last_two_before_the_delay_are_kept():
    tracking = Tracking(load_robot("puma560"), 1e-9, DELAY)
    for k in range(101):
        tracking.tell(PERIOD * k, np.full(6, SPEED * PERIOD * k))
    late = DELAY + 0.5 * PERIOD
    assert tracking.deviation(1.0, np.full(6, SPEED * (1.0 - late))) is None
    late = DELAY + 2.5 * PERIOD
    assert tracking.deviation(1.0, np.full(6, SPEED * (1.0 - late))) is not None


def test_joints_without_limits_may_be_off_by_turns():
    chain = load_robot("scara")
    continuous = np.flatnonzero(chain.continuous)
    tracking = Tracking(chain, TOLERANCE, DELAY)
    tracking.tell(0.0, np.zeros(chain.n))
    for joint in range(chain.n):
        position = np.zeros(chain.n)
        position[joint] = 4.0 * np.pi + 0.01
        found = tracking.deviation(0.0, position)
        assert (found is None) == (joint in continuous)


def test_a_linear_joint_is_off_in_metres():
    chain = load_robot("scara")
    tracking = Tracking(chain, TOLERANCE, DELAY)
    assert tracking.deviation(0.0, np.ones(chain.n)) is None
    tracking.tell(0.0, np.zeros(chain.n))
    linear = int(np.flatnonzero(chain.types)[0])
    position = np.zeros(chain.n)
    position[linear] = -0.2
    found = tracking.deviation(0.0, position)
    assert found is not None
    assert (found.amount, found.unit) == (pytest.approx(0.2), "m")
    tracking.begin()
    assert tracking.deviation(0.0, position) is None
