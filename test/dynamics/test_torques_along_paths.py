"""Joint torques along a path, and the fastest motion along it that the drives can make."""

import numpy as np
import pytest

from robomech_ros.dynamics import gravity_torque, inverse_dynamics, path_torques
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.robots import load_robot
from robomech_ros.trajectory import Limits, TorqueLimits, spline_through, time_optimal

PUMA = load_robot("puma560")
POINTS = [
    [0.0, 0.5, -0.5, 0.0, 0.3, 0.0],
    [0.7, 0.9, -0.2, 0.4, 0.6, -0.5],
    [1.1, 0.4, -0.8, 0.9, 0.1, 0.4],
    [0.6, 0.7, -1.1, 0.2, -0.4, 0.8],
]
PATH = spline_through(POINTS, times=[0.0, 1.0, 2.0, 3.0], ends="natural").pieces


def test_the_torques_of_a_motion_are_linear_in_what_it_may_choose():
    s, speed, change = np.array([0.3, 1.7, 2.6]), np.array([0.5, 2.0, 1.3]), np.array([-3.0, 0, 4])
    q, rate, bend = PATH.sample(s)[:3]
    qd, qdd = rate * speed[:, None], bend * speed[:, None] ** 2 + rate * change[:, None]
    a, b, c = path_torques(PUMA, PATH)(s)
    found = a * change[:, None] + b * speed[:, None] ** 2 + c
    np.testing.assert_allclose(found, inverse_dynamics(PUMA, q, qd, qdd), atol=1e-9)
    np.testing.assert_allclose(c, gravity_torque(PUMA, q))
    weightless = path_torques(PUMA, PATH, gravity=[0.0, 0.0, 0.0])(s)
    np.testing.assert_array_equal(weightless[2], np.zeros((3, 6)))


def test_the_fastest_motion_within_the_torques_of_a_robot():
    limits = Limits(PUMA.joint_names, velocity=PUMA.velocity)
    drives = TorqueLimits(path_torques(PUMA, PATH), -PUMA.effort, PUMA.effort)
    motion = time_optimal(PATH, limits, torque_limits=drives)
    sample = motion.sample(np.linspace(1e-9, motion.duration - 1e-9, 4001))
    torques = inverse_dynamics(PUMA, sample.position, sample.velocity, sample.acceleration)
    shares = np.abs(torques) / PUMA.effort
    fast = np.abs(sample.velocity) / PUMA.velocity
    assert shares.max() <= 1.0 + 1e-5
    assert fast.max() <= 1.0 + 1e-6
    # At every instant a drive gives all it can, or a joint is as fast as it may be.
    assert (np.maximum(shares.max(axis=1), fast.max(axis=1)) > 0.98).mean() > 0.98


@pytest.mark.parametrize(
    ("given", "error", "text"),
    [
        ({"chain": "puma560"}, BadValueError, "chain is 'puma560'"),
        ({"path": POINTS}, BadValueError, "expected a joint path"),
        ({"chain": load_robot("panda")}, WrongSizeError, "joints of the path"),
        ({"gravity": [0.0, 9.81]}, WrongSizeError, "gravity"),
    ],
)
def test_refusals(given, error, text):
    with pytest.raises(error, match=text):
        path_torques(**({"chain": PUMA, "path": PATH} | given))
