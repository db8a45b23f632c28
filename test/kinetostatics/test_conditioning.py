"""The characteristic length: golden values, isotropic designs, random postures, refusals."""

from dataclasses import replace

import numpy as np
import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.kinetostatics import (
    characteristic_length,
    condition_number,
    condition_number_gradient,
    conditioning_index,
    planar_jacobian,
)
from robomech_ros.robots import chain_from_dh, load_robot

QUARTER = np.pi / 2


@pytest.fixture(scope="module")
def designs(golden):
    return golden("isotropy_kci")


def test_golden_values_of_the_fanuc_arc_mate(designs):
    chain, case, tolerance = (
        load_robot("fanuc_arcmate"),
        designs["fanuc_arc_mate"],
        designs["tolerance"],
    )
    best = characteristic_length(chain)
    assert float(best) == pytest.approx(case["L2"], rel=tolerance["L_rel_2norm"])
    assert best.condition_number == pytest.approx(case["kappa2_min"], rel=tolerance["kappa2_rel"])
    assert best.conditioning_index == pytest.approx(case["KCI2_percent"], rel=1e-5)
    assert condition_number(chain, best.q, length=best) == pytest.approx(
        best.condition_number, rel=1e-12
    )
    smooth = characteristic_length(chain, norm="frobenius")
    assert float(smooth) == pytest.approx(case["LF"], rel=tolerance["L_rel_F"])
    assert smooth.condition_number == pytest.approx(case["kappaF_min"], rel=tolerance["kappaF_rel"])


@pytest.mark.parametrize(("name", "b6"), [("puma560_b6_0", 0.0), ("puma560_b6_56mm", 0.05625)])
def test_golden_values_of_the_puma(designs, name, b6):
    case, table = designs[name], designs["puma560_b6_0"]
    chain = chain_from_dh(table["a"], [*table["b"][:5], b6], np.deg2rad(table["alpha_deg"]))
    smooth = characteristic_length(chain, norm="frobenius")
    assert smooth.condition_number == pytest.approx(case["kappaF_min"], rel=1e-7)
    assert float(smooth) == pytest.approx(case["LF"], rel=1e-6)
    best = characteristic_length(chain)
    assert best.condition_number == pytest.approx(case["kappa2_min_approx"], rel=2e-5)
    assert float(best) == pytest.approx(case["L2_approx"], rel=1e-4)


def test_isotropic_designs_are_found(designs):
    best = characteristic_length(load_robot("diestro"))
    assert float(best) == pytest.approx(designs["diestro"]["L"], rel=1e-9)
    assert best.condition_number == pytest.approx(1.0, abs=1e-9)
    side = 0.4
    planar = chain_from_dh([side, side, side / 3**0.5], np.zeros(3), np.zeros(3))
    best = characteristic_length(planar)
    assert float(best) == pytest.approx(designs["planar3R"]["L_over_a"] * side, rel=1e-7)
    assert best.condition_number == pytest.approx(1.0, abs=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["ur5e", "panda", "scara", "stanford"])
def test_no_posture_is_better_conditioned(robot):
    chain = load_robot(robot)
    for norm in ("2", "frobenius"):
        best = characteristic_length(chain, norm=norm)
        rng = np.random.default_rng(1)
        q = np.concatenate(
            [rng.uniform(-3.2, 3.2, (5_000, chain.n)), best.q + rng.normal(0, 0.02, (500, chain.n))]
        )
        for length in best * np.array([0.9, 0.999, 1.0, 1.001, 1.1]):
            values = condition_number(chain, q, norm=norm, length=float(length))
            assert values.min() >= best.condition_number * (1 - 1e-6)


@pytest.mark.slow
def test_the_index_of_positioning_of_orientation_and_of_both(designs):
    """100 % for the isotropic designs; for others no posture has a better condition number."""
    two = chain_from_dh([designs["planar2R"]["l1_over_l2"], 1.0], [0.0, 0.0], [0.0, 0.0])
    best = conditioning_index(two, part="position")
    assert float(best) == pytest.approx(100.0, abs=1e-7)
    assert abs(np.rad2deg(best.q[1])) % 360 == pytest.approx(135.0, abs=1e-4)
    wrist = chain_from_dh(np.zeros(3), np.zeros(3), [np.pi / 2, -np.pi / 2, 0.0])
    assert conditioning_index(wrist, part="orientation") == pytest.approx(100.0, abs=1e-7)
    ratio = designs["articulated3R"]["a3_over_a2"]
    arm = chain_from_dh([0.0, 1.0, ratio], np.zeros(3), [np.pi / 2, 0.0, 0.0])
    assert conditioning_index(arm, part="position", norm="frobenius") == pytest.approx(100.0)
    fanuc = load_robot("fanuc_arcmate")
    both = conditioning_index(fanuc)
    expected = designs["fanuc_arc_mate"]["KCI2_percent"]
    assert float(both) == pytest.approx(expected, rel=1e-5)
    for part in ("position", "orientation"):
        best = conditioning_index(fanuc, part=part)
        assert float(best) == pytest.approx(100.0 / best.condition_number)
        assert condition_number(fanuc, best.q, part=part) == pytest.approx(best.condition_number)
        q = np.random.default_rng(3).uniform(-3.2, 3.2, (20_000, 6))
        values = condition_number(fanuc, q, part=part)
        assert values.min() >= best.condition_number * (1 - 1e-6)


def test_what_is_refused():
    with pytest.raises(BadValueError, match="part .*one of pose, orientation, position"):
        conditioning_index(load_robot("puma560"), part="tool")
    with pytest.raises(BadValueError, match="norm .*one of 2, frobenius"):
        characteristic_length(load_robot("puma560"), norm="1")
    with pytest.raises(BadValueError, match="a SerialChain"):
        characteristic_length("puma560")
    wrist = chain_from_dh([0.0] * 3, [0.0] * 3, [QUARTER, -QUARTER, 0.0])
    with pytest.raises(BadValueError, match="regular in some posture"):
        conditioning_index(wrist, part="position")


def turned(chain, rng):
    """The chain on a base that leans."""
    axis, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    packed = chain.packed.copy()
    packed[0, 1:10] = (axis * np.linalg.det(axis)).ravel()
    return replace(chain, packed=packed)


@pytest.mark.parametrize("leans", [False, True])
@pytest.mark.parametrize(
    ("robot", "part", "rows"),
    [
        ("planar3r", "position", slice(1, 3)),
        ("planar3r", "orientation", slice(0, 1)),
        ("planar4r", "pose", slice(0, 3)),
        ("planar4r", "position", slice(1, 3)),
    ],
)
def test_a_planar_arm_is_judged_by_what_it_does_in_its_plane(robot, part, rows, leans):
    """``conditioning_index(planar3r, part="position")`` was refused."""
    rng = np.random.default_rng(5)
    lengths = (1.0, 0.8, 0.5) if robot == "planar3r" else (0.5, 0.4, 0.3, 0.2)
    arm = chain_from_dh(lengths, [0.0] * len(lengths), [0.0] * len(lengths))
    arm = turned(arm, rng) if leans else arm
    q = rng.uniform(-3.0, 3.0, (4000, arm.n))
    J = planar_jacobian(arm, q)
    J[:, 1:] /= 0.4
    expected = np.linalg.cond(J[:, rows])
    given = {"part": part, "length": 0.4}
    np.testing.assert_allclose(condition_number(arm, q, **given), expected, rtol=1e-9)
    step = 1e-6
    ahead, behind = (
        condition_number(arm, q[0] + s * step * np.eye(arm.n), **given) for s in (1, -1)
    )
    gradient = condition_number_gradient(arm, q[0], **given)
    np.testing.assert_allclose(gradient, (ahead - behind) / (2 * step), rtol=1e-5, atol=1e-7)
    best = conditioning_index(arm, part=part)
    assert 1.0 <= best.condition_number <= expected.min() + (1.0 if part == "pose" else 1e-9)
    length = float(characteristic_length(arm)) if part == "pose" else None
    again = condition_number(arm, best.q, part=part, length=length)
    assert again == pytest.approx(best.condition_number, rel=1e-9)
    if part == "position":
        assert best == pytest.approx(100.0, abs=1e-6)  # an isotropic posture


@pytest.mark.parametrize("robot", ["scara", "stanford", "puma560"])
def test_the_angles_of_the_best_posture_are_within_a_turn(robot):
    """The PUMA had an angle of -17.8 rad in ``characteristic_length(puma).q``."""
    chain = load_robot(robot)
    length = characteristic_length(chain)
    assert np.abs(length.q[chain.types == 0]).max() <= np.pi
    again = condition_number(chain, length.q, length=length)
    assert again == pytest.approx(length.condition_number, rel=1e-12)


@pytest.mark.parametrize(
    ("types", "angles"), [("RRR", [QUARTER, -QUARTER, 0.0]), ("R", [0.0]), ("PPP", [QUARTER] * 3)]
)
def test_an_arm_without_lengths_is_conditioned_as_its_axes_are(types, angles):
    n = len(types)
    arm = chain_from_dh([0.0] * n, [0.0] * n, angles, [0.0, QUARTER, 0.0][:n], types=types)
    length = characteristic_length(arm)
    assert 1e-3 <= length <= 1e3
    assert length.condition_number == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("n", [2, 3])
def test_a_length_that_would_vanish_ends_at_a_thousandth_of_the_arm(n):
    # Of few joints positions alone can be conditioned best; here 1.618 in the limit of the 2R arm.
    rng = np.random.default_rng(2)
    a, b = rng.uniform(-0.5, 0.5, (2, n))
    twists, angles = rng.uniform(-3.0, 3.0, (2, n))
    planar = chain_from_dh([1.0, 1.0], [0.0, 0.0], [0.0, 0.0])
    arm = planar if n == 2 else chain_from_dh(a, b, twists, angles)
    length = characteristic_length(arm)
    reach = np.linalg.norm(arm.packed[1:, 10:], axis=1).sum()
    assert 1e-3 * reach * (1 - 1e-12) <= length < 0.1 * reach
    again = condition_number(arm, length.q, length=length)
    assert again == pytest.approx(length.condition_number, rel=1e-12)
    if n == 2:
        assert length.condition_number == pytest.approx((1 + np.sqrt(5)) / 2, abs=1e-4)


def test_where_the_base_stands_does_not_matter():
    far = np.eye(4)
    far[:3, 3] = 1e5
    arms = [
        chain_from_dh([1.0, 1.0, 0.5773502691896258], [0.0] * 3, [0.0] * 3, base=base)
        for base in (None, far)
    ]
    near_length, far_length = (characteristic_length(arm) for arm in arms)
    assert far_length == pytest.approx(near_length, rel=1e-6)
