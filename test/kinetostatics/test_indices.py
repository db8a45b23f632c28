"""Performance indices: numpy's singular values, differences, isotropic designs, refusals."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError
from robomech_ros.kinetostatics import (
    condition_number,
    condition_number_gradient,
    jacobian,
    least_singular_value_gradient,
    manipulability,
    manipulability_gradient,
    min_singular_value,
)
from robomech_ros.robots import chain_from_dh, list_robots, load_robot

ROWS = {"pose": slice(0, 6), "orientation": slice(0, 3), "position": slice(3, 6)}
GRADIENTS = [
    (manipulability, manipulability_gradient, {}),
    (condition_number, condition_number_gradient, {}),
    (condition_number, condition_number_gradient, {"norm": "frobenius"}),
    (min_singular_value, least_singular_value_gradient, {}),
]


@pytest.mark.parametrize("part", ROWS)
@pytest.mark.parametrize("robot", list_robots())
def test_agrees_with_numpy(robot, part):
    chain = load_robot(robot)
    q = np.random.default_rng(2).uniform(-3, 3, (50, chain.n))
    J = jacobian(chain, q)
    J[:, 3:] /= 0.3
    s = np.linalg.svd(J[:, ROWS[part]], compute_uv=False)
    # What the arm does in no posture, as out of the plane of a planar one, does not count.
    s = s[:, (s > 1e-9 * s[:, :1]).any(axis=0)]
    k = s.shape[1]
    regular = s[:, -1] > 1e-9 * s[:, 0]
    given = {"part": part, "length": 0.3}
    products = manipulability(chain, q, **given)
    np.testing.assert_allclose(products, s.prod(axis=1), rtol=1e-11, atol=1e-14)
    least = min_singular_value(chain, q, **given)
    np.testing.assert_allclose(least, s[:, -1], rtol=1e-11, atol=1e-14)
    two, weighted = (condition_number(chain, q, norm=norm, **given) for norm in ("2", "frobenius"))
    np.testing.assert_allclose(two[regular], s[regular, 0] / s[regular, -1], rtol=1e-11)
    expected = np.sqrt((s[regular] ** 2).sum(axis=1) * (s[regular] ** -2).sum(axis=1)) / k
    np.testing.assert_allclose(weighted[regular], expected, rtol=1e-11)
    assert np.isinf(two[~regular]).all() and np.isinf(weighted[~regular]).all()


@pytest.mark.parametrize(("index", "gradient", "given"), GRADIENTS)
@pytest.mark.parametrize("seed", range(12))
def test_gradients_agree_with_differences(random_chain, seed, index, gradient, given):
    n = 2 + seed % 7
    chain = random_chain(seed, types=np.arange(n) % 4 == 3, n=n, kind="general")
    given = {**given, "length": 0.7, "part": list(ROWS)[seed % 3] if n >= 6 else "pose"}
    q, step = np.random.default_rng(seed).uniform(-2, 2, n), 1e-5

    def moved(steps):
        return index(chain, q + steps * step * np.eye(n), **given)

    expected = (8 * (moved(1) - moved(-1)) - moved(2) + moved(-2)) / (12 * step)
    scale = max(1.0, np.abs(expected).max())
    np.testing.assert_allclose(gradient(chain, q, **given) / scale, expected / scale, atol=1e-8)


def test_isotropic_designs(golden):
    designs = golden("isotropy_kci")
    diestro = load_robot("diestro")
    posture = np.zeros(6)
    posture[1:] = designs["diestro"]["theta"][1:]
    for norm in ("2", "frobenius"):
        value = condition_number(diestro, posture, norm=norm, length=designs["diestro"]["L"])
        assert value == pytest.approx(1.0, abs=1e-12)
    side = 0.4
    planar = chain_from_dh([side, side, side / 3**0.5], np.zeros(3), np.zeros(3))
    length = designs["planar3R"]["L_over_a"] * side
    corners = [[0.3, 2 * np.pi / 3, turn * 5 * np.pi / 6] for turn in (1, -1)]
    values = condition_number(planar, corners, length=length)
    assert min(values) == pytest.approx(1.0, abs=1e-12)


def test_isotropic_designs_of_positioning_and_orienting(golden):
    designs = golden("isotropy_kci")
    two, bent = designs["planar2R"], np.deg2rad(designs["planar2R"]["theta2_deg"])
    chain = chain_from_dh([two["l1_over_l2"], 1.0], [0.0, 0.0], [0.0, 0.0])
    three = designs["articulated3R"]
    articulated = chain_from_dh([0.0, 1.0, three["a3_over_a2"]], np.zeros(3), [np.pi / 2, 0, 0])
    angles = np.deg2rad(three["theta2_theta3_deg"][0])
    wrist = chain_from_dh(np.zeros(3), np.zeros(3), [np.pi / 2, -np.pi / 2, 0.0])
    quarter = np.pi / 2
    for norm in ("2", "frobenius"):
        for arm, q, part in (
            (chain, [0.3, bent[0]], "position"),
            (chain, [0.3, bent[1]], "position"),
            (articulated, [0.3, *angles], "position"),
            (wrist, [0.3, quarter, 0.7], "orientation"),
            (wrist, [0.3, -quarter, 0.7], "orientation"),
        ):
            value = condition_number(arm, q, norm=norm, part=part)
            assert value == pytest.approx(1.0, abs=1e-7)
    aside = [[0.3, quarter / 2, 0.7], [0.3, np.deg2rad(10), 0.7]]
    np.testing.assert_allclose(
        condition_number(wrist, aside, part="orientation"), [1 + 2**0.5, 11.43005], rtol=1e-6
    )
    smooth = condition_number(wrist, aside[0], norm="frobenius", part="orientation")
    assert smooth == pytest.approx(1.29099445, rel=1e-8)


def test_singular_postures_and_shapes():
    chain = load_robot("puma560")
    straight = np.zeros(6)
    assert condition_number(chain, straight) == np.inf
    assert manipulability(chain, straight) == pytest.approx(0.0, abs=1e-15)
    q = np.random.default_rng(1).uniform(-2, 2, (2, 3, 6))
    assert manipulability(chain, q).shape == (2, 3)
    assert manipulability_gradient(chain, q).shape == (2, 3, 6)
    assert isinstance(manipulability(chain, q[0, 0]), float)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"part": "tool"}, "part .*one of pose, orientation, position"),
        ({"length": 0.0}, "length .*a length from 1e-9 to 1e9 m"),
        ({"length": np.inf}, "length .*a length from 1e-9 to 1e9 m"),
        ({"length": "long"}, "length .*a length from 1e-9 to 1e9 m"),
        ({"norm": "3"}, "norm .*one of 2, frobenius"),
    ],
)
def test_what_is_refused(given, message):
    chain = load_robot("puma560")
    with pytest.raises(BadValueError, match=message):
        condition_number(chain, np.zeros(6), **given)
    with pytest.raises(NonFiniteError, match="joint 'waist'"):
        condition_number_gradient(chain, [np.nan, 0, 0, 0, 0, 0])
