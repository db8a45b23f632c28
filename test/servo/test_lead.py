import numpy as np
import pytest
from servo_drives import robot_of

from robomech_ros.servo.lead import AdaptiveLead
from robomech_ros.servo.tracking import Tracking

PERIOD = 0.01


def test_one_late_point_is_an_accident_and_two_raise_the_lead():
    lead = AdaptiveLead(PERIOD, 2, 10)
    lead.sent(0.0, 0.009)
    assert (lead.periods, lead.latest) == (2, 0.0)
    lead.sent(1.0, 0.045)
    assert (lead.periods, lead.needed) == (2, 6)
    lead.sent(2.0, 0.032)
    assert lead.periods == 5
    # That would be in time now.
    lead.sent(3.0, 0.035)
    assert lead.periods == 5


def test_it_falls_slowly_and_keeps_its_bounds():
    lead = AdaptiveLead(PERIOD, 2, 8)
    for now in (0.0, 0.1):
        lead.sent(now, 0.5)
    assert lead.periods == 8
    told = []
    for now in np.arange(0.2, 20.0, PERIOD):
        lead.sent(now, 0.0)
        told.append((now, lead.periods))
    assert next(now for now, periods in told if periods < 8) == pytest.approx(11.0, abs=0.05)
    assert next(now for now, periods in told if periods == 2) == pytest.approx(16.0, abs=0.3)
    assert AdaptiveLead(PERIOD, 5, 1).periods == 5


def test_a_lag_that_grows_tells_of_late_points_and_a_constant_one_does_not():
    lead = AdaptiveLead(PERIOD, 2, 10)
    for now in np.arange(0.0, 1.0, PERIOD):
        lead.followed(now, 0.08)
        lead.sent(now, 0.0)
    assert (lead.periods, lead.latest) == (2, 0.0)
    for now, lag in ((1.0, 0.12), (1.1, 0.12), (1.2, 0.14)):
        lead.followed(now, lag)
        lead.sent(now, 0.0)
    assert lead.latest == pytest.approx(0.05)
    assert lead.periods == 4


def test_the_lag_is_that_of_the_joint_that_moves_most():
    chain = robot_of("puma560")
    tracking = Tracking(chain, 0.1, 0.2)

    def told(now):
        return np.array([0.1 * now, -0.8 * now, 0.3, 0.0, 0.0, 0.0])

    assert tracking.lag(0.0, told(0.0)) is None
    for now in np.arange(0.0, 0.3, PERIOD):
        tracking.tell(now, told(now))
    assert tracking.lag(0.29, told(0.29 - 0.074)) == pytest.approx(0.074)
    # Nobody can say where it has not been told to be.
    assert tracking.lag(0.29, told(0.5)) is None
    tracking.begin()
    for now in np.arange(0.0, 0.3, PERIOD):
        tracking.tell(now, np.zeros(6))
    assert tracking.lag(0.29, np.zeros(6)) is None
