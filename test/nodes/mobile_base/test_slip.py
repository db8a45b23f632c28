"""Wheels that slip: what /diagnostics says of them, and how well the pose of a base is known."""

import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from nav_msgs.msg import Odometry

from robomech_ros.nodes.common.robot.odometry_frame import LEAST, UNMEASURED
from robomech_ros.nodes.mobile_base.node import MobileBaseNode
from robomech_ros.rolling import OdometryNoise, load_rolling
from robomech_ros.rolling.simulated import SimulatedBase

RATE = 50.0


class SlippingBase(SimulatedBase):
    """A base whose first wheel also turns on the spot, as a wheel without load does."""

    spin = 0.0

    def advance(self, motion, period):
        super().advance(motion, period)
        self.rates[0] += self.spin
        self.positions[0] += self.spin * period


@pytest.fixture
def slipping(graph):
    node = graph.start(
        MobileBaseNode, robot_description="mecanum", update_rate=RATE, reference_timeout=0.5
    )
    base = node._base
    base.simulated = SlippingBase(base.robot, dynamic=False, wheel_position=0.0)
    return base.simulated


def told(graph, accept):
    """Return the next status of the motion that is accepted: itself and its slip (m/s)."""

    def slip_of(message):
        (value,) = (one.value for one in message.status[0].values if one.key == "slip (m/s)")
        return float(value)

    message = graph.receive(DiagnosticArray, "/diagnostics", 10, lambda m: accept(slip_of(m)))
    return message.status[0], slip_of(message)


def test_a_wheel_that_slips_is_told_with_how_much(graph, slipping):
    status, _ = told(graph, lambda slip: slip == 0.0)
    assert (status.level, status.message) == (DiagnosticStatus.OK, "stands, without commands")
    slipping.spin = 0.4
    # Four wheels, three freedoms: half of a turn of one wheel contradicts the others.
    expected = 0.5 * 0.4 * load_rolling("mecanum").driven_radii[0]
    status, slip = told(graph, lambda slip: slip > 0.0)
    assert slip == pytest.approx(expected, rel=1e-5)
    assert status.level == DiagnosticStatus.WARN
    assert status.message == f"stands, without commands; wheels slip by {expected:.3g} m/s"
    slipping.spin = 0.0
    status, _ = told(graph, lambda slip: slip == 0.0)
    assert status.level == DiagnosticStatus.OK


def test_covariance_grows_with_slip(graph, slipping):
    base, noise = load_rolling("mecanum"), OdometryNoise()
    # What a velocity (m/s) that one wheel says adds to v_x, squared.
    share = np.linalg.pinv(base.measured_rows())[1] ** 2
    still = graph.receive(Odometry, "mobile_base/odometry", 10, lambda m: True)
    for covariance in (still.pose.covariance, still.twist.covariance):
        expected = [LEAST, LEAST, *[UNMEASURED] * 3, LEAST]
        np.testing.assert_array_equal(np.reshape(covariance, (6, 6)), np.diag(expected))
    before = LEAST
    for spin in (0.4, 0.8):
        slipping.spin = spin
        speed = spin * base.driven_radii[0]
        rolled, slipped = noise.travel * speed * share[0], noise.slip * 0.5 * speed * share.sum()
        assert slipped > 1000.0 * rolled
        # Variances grow with the way: that of the mean velocity over a period T goes with 1/T.
        known = RATE * (rolled + slipped) + LEAST
        now = graph.receive(
            Odometry,
            "mobile_base/odometry",
            10,
            lambda m, known=known: math.isclose(m.twist.covariance[0], known, rel_tol=1e-6),
        )
        # The pose becomes less known all the time.
        assert now.pose.covariance[0] > before
        before = now.pose.covariance[0]
        later = graph.receive(
            Odometry,
            "mobile_base/odometry",
            10,
            lambda m, now=now: m.header.stamp != now.header.stamp,
        )
        assert later.pose.covariance[0] > before
