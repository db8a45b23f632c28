"""The self-motion from a posture: the tip stays, until a limit."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics, self_motion
from robomech_ros.kinetostatics import self_motion_curve
from robomech_ros.robots import load_robot


@pytest.mark.parametrize("robot", ["iiwa14", "panda", "gen3", "general7r"])
def test_the_tip_stays_all_along_inside_the_limits(robot):
    chain = load_robot(robot)
    curve = self_motion_curve(chain, chain.home())
    T = forward_kinematics(chain, curve.q)
    np.testing.assert_allclose(T, np.broadcast_to(curve.target, T.shape), atol=1e-8)
    assert (curve.q >= chain.lower).all() and (curve.q <= chain.upper).all()
    steps = np.linalg.norm(np.diff(curve.q, axis=0), axis=1)
    np.testing.assert_allclose(np.diff(curve.length), steps)
    for end, why in zip(curve.q[[0, -1]], curve.ends, strict=True):
        if "limit" in why:
            joint = chain.joint_names.index(why.split("'")[1])
            assert min(end[joint] - chain.lower[joint], chain.upper[joint] - end[joint]) < 1e-6


def test_it_is_the_one_that_the_arm_angle_traces():
    chain = load_robot("iiwa14")
    curve = self_motion_curve(chain, chain.home())
    traced = np.concatenate([branch.q for branch in self_motion(chain, curve.target).branches])
    for length in np.linspace(curve.low, curve.high, 7):
        gap = traced - curve.at(length)
        gap -= 2.0 * np.pi * np.round(gap / (2.0 * np.pi))
        assert np.abs(gap).max(axis=1).min() < 0.06


def test_what_has_none_and_what_is_refused():
    six = load_robot("ur5e")
    assert self_motion_curve(six, six.home()) is None
    chain = load_robot("iiwa14")
    with pytest.raises(WrongSizeError):
        self_motion_curve(chain, [0.0] * 6)
    with pytest.raises(BadValueError, match=r"expected -2.09\d+ to 2.09\d+ rad"):
        self_motion_curve(chain, [0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    curve = self_motion_curve(chain, chain.home())
    for wrong in (float("nan"), "far"):
        with pytest.raises(BadValueError, match="length"):
            curve.at(wrong)
