"""Start posture of an arm whose description specifies none."""

from dataclasses import replace

import numpy as np
import pytest

from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import chain_from_dh, list_robots, load_robot
from robomech_ros.robots.regular_posture import regular_posture


def least_ratio(chain, q):
    """Least singular value over the largest, lengths over the mean distance of the axes."""
    J = jacobian(chain, q)
    turns = chain.types == 0
    arms = np.linalg.norm(J[3:, turns], axis=0)
    J[3:] /= arms.mean() if arms.any() else 1.0
    values = np.linalg.svd(J, compute_uv=False)
    kept = values[values > 1e-9 * values[0]]
    return kept[-1] / kept[0]


@pytest.mark.parametrize("name", list_robots())
def test_a_home_that_is_not_given_is_regular_and_inside_the_limits(name):
    chain = replace(load_robot(name), home_given=None)
    home = chain.home()
    # The robots of the library have homes chosen by hand, and these are hardly better.
    assert least_ratio(chain, home) > max(0.1, 0.8 * least_ratio(chain, load_robot(name).home()))
    ranges = np.minimum(chain.upper - chain.lower, 2.0 * np.pi)
    margin = np.minimum(home - chain.lower, chain.upper - home)
    assert (margin > 0.09 * ranges - 0.005).all()
    assert home.tolist() == replace(chain).home().tolist()


def test_the_posture_of_a_part_of_an_arm_is_that_of_the_arm():
    chain = replace(load_robot("ur5e"), home_given=None)
    assert chain.with_tip("forearm_link").home().tolist() == chain.home()[:3].tolist()


@pytest.mark.parametrize(
    ("types", "limits"),
    [
        ("R", None),
        ("P", None),
        ("PRP", {"lower": [-np.inf, 0.1, -2.0], "upper": [np.inf, 0.1, 3.0]}),
        ("RRRRRRRRR", [(-0.5, 4.0)] * 9),
        ("RR", {"lower": [2.0, -np.inf], "upper": [np.inf, -3.0]}),
    ],
)
def test_limits_of_every_kind(types, limits):
    n = len(types)
    chain = chain_from_dh([0.3] * n, [0.1] * n, [1.0] * n, types=types, limits=limits)
    home = chain.home()
    assert np.isfinite(home).all()
    assert ((home >= chain.lower) & (home <= chain.upper)).all()


def test_no_joints():
    assert regular_posture(np.zeros((1, 13)), np.zeros(0, dtype=int), *np.zeros((2, 0))).shape == (
        0,
    )
