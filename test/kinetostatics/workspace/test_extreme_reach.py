"""Least and greatest reach of the tip against closed forms and sampled postures."""

import math

import numpy as np
import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import reach_limits, workspace_boundary
from robomech_ros.robots import chain_from_dh, load_robot


def test_planar_arm_in_closed_form():
    """Links of 1.0, 0.8 and 0.5 m, which can close; a bent elbow keeps them from stretching."""
    free = {"lower": np.full(3, -math.pi), "upper": np.full(3, math.pi)}
    reach = reach_limits(chain_from_dh([1.0, 0.8, 0.5], [0] * 3, [0] * 3, limits=free))
    assert reach == pytest.approx((0.0, 2.3), abs=1e-6)
    bent = {"lower": np.array([-3.0, 1.0]), "upper": np.array([3.0, 2.0])}
    least, greatest = reach_limits(chain_from_dh([1.0, 0.8], [0, 0], [0, 0], limits=bent))
    assert least == pytest.approx(math.sqrt(1.64 + 1.6 * math.cos(2.0)), abs=1e-12)
    assert greatest == pytest.approx(math.sqrt(1.64 + 1.6 * math.cos(1.0)), abs=1e-12)


def test_the_wrist_centre_of_puma_as_its_boundary_tells():
    """The tip of this robot is the centre of its wrist."""
    puma = load_robot("puma560")
    space = workspace_boundary(puma)
    assert reach_limits(puma) == pytest.approx((space.least_reach, space.greatest_reach), abs=1e-6)


@pytest.mark.parametrize("name", ["ur5e", "stanford", "scara", "panda", "vx300"])
def test_no_sampled_posture_is_beyond(name):
    chain = load_robot(name)
    rng = np.random.default_rng(2)
    lower, upper = np.nan_to_num(chain.lower, neginf=-3.2), np.nan_to_num(chain.upper, posinf=3.2)
    T = forward_kinematics(chain, rng.uniform(lower, upper, (20_000, chain.n)))
    distance = np.linalg.norm(T[:, :3, 3] - chain.packed[0, 10:], axis=1)
    least, greatest = reach_limits(chain)
    assert least <= distance.min() + 1e-9
    assert distance.max() <= greatest + 1e-9
    assert greatest < 1.2 * distance.max()


def test_a_slide_without_end_reaches_everywhere():
    endless = chain_from_dh([0, 0, 0], [0, 0.2, 0], [1.5, 1.5, 0], types="RRP")
    assert reach_limits(endless)[1] == math.inf


def test_what_is_no_arm_is_refused():
    with pytest.raises(BadValueError, match="SerialChain"):
        reach_limits(3)
    with pytest.raises(BadValueError, match="number of joints is 0"):
        reach_limits(load_robot("puma560").with_tip(load_robot("puma560").base))
