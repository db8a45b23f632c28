"""Isotropic designs, loci of equal condition number, gradient of the characteristic length."""

import json

import numpy as np
import pytest
from scipy.optimize import minimize
from wrong_values import WRONG_VALUES, answered_or_refused, with_options

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import (
    characteristic_length,
    characteristic_length_gradient,
    condition_loci,
    condition_number,
    condition_number_gradient,
    conditioning_index,
    isotropic_planar_2r,
    isotropic_planar_3r,
    isotropic_spatial_3r,
    isotropic_wrist,
    jacobian,
)
from robomech_ros.plotting.condition_loci import plot_condition_loci
from robomech_ros.robots import chain_from_dh, load_robot

MOST = 2.0 * 1.5 / (3.0 + 2.0**0.5)
DESIGNS = {
    "planar 2R": isotropic_planar_2r(0.8),
    "planar 3R": isotropic_planar_3r(2.0),
    **{f"spatial 3R, {a:.2f}": isotropic_spatial_3r(1.5, shoulder=a) for a in (0.0, 0.3, MOST)},
    **{f"wrist {n}R": isotropic_wrist(n) for n in (3, 4, 5, 7)},
}


@pytest.mark.parametrize("name", DESIGNS)
def test_designs_are_isotropic_by_their_jacobian(name):
    design = DESIGNS[name]
    q = design.q + np.eye(len(design.q))[0]
    J = jacobian(design.chain, q)
    blocks = {"orientation": J[:3], "position": J[3:]}
    planar = name.startswith("planar")
    if design.part == "pose":
        rows = np.vstack((J[2], J[3:5] / design.length))
    else:
        rows = blocks[design.part][: 2 if planar else 3]
    square = rows @ rows.T
    assert np.abs(square - square[0, 0] * np.eye(len(square))).max() < 1e-12 * square[0, 0]
    for norm in ("2", "frobenius"):
        given = {"part": design.part, "length": design.length, "norm": norm}
        assert condition_number(design.chain, q, **given) == pytest.approx(1.0, abs=1e-12)


def test_designs_are_those_of_the_golden_data_and_of_the_search(golden):
    data = golden("isotropy_kci")
    planar, three, spatial = (DESIGNS[k] for k in ("planar 2R", "planar 3R", "spatial 3R, 0.00"))
    assert planar.a[0] / planar.a[1] == pytest.approx(data["planar2R"]["l1_over_l2"], abs=1e-9)
    assert three.length / three.a[0] == pytest.approx(data["planar3R"]["L_over_a"], abs=1e-9)
    ratio = data["articulated3R"]["a3_over_a2"]
    assert spatial.a[2] / spatial.a[1] == pytest.approx(ratio, abs=1e-9)
    assert planar.a.sum() == pytest.approx(0.8) and three.a.sum() == pytest.approx(2.0)
    found = characteristic_length(three.chain, norm="frobenius")
    assert float(found) == pytest.approx(three.length, rel=1e-6)
    for name in ("planar 2R", "spatial 3R, 0.30", "wrist 3R"):
        design = DESIGNS[name]
        index = conditioning_index(design.chain, part=design.part, norm="frobenius")
        assert float(index) == pytest.approx(100.0, abs=1e-6)


def test_the_shoulder_of_the_spatial_design_ends_where_no_posture_is_isotropic():
    """Beyond the bound the best posture of the arm with the same links is not isotropic."""
    edge = DESIGNS[f"spatial 3R, {MOST:.2f}"]
    for more, isotropic in ((0.0, True), (0.05, False)):
        arm = chain_from_dh(edge.a + [more, 0.0, 0.0], edge.b, edge.alpha)
        index = conditioning_index(arm, part="position", norm="frobenius")
        assert (float(index) > 100.0 - 1e-6) == isotropic
    with pytest.raises(BadValueError, match="shoulder is 0.7, expected 0 to 0.679623 m"):
        isotropic_spatial_3r(1.5, shoulder=0.7)
    with pytest.raises(BadValueError, match="joints is 2, expected a whole number from 3 to 64"):
        isotropic_wrist(2)
    for reach in (-1.0, np.inf, 1e-300):
        with pytest.raises(BadValueError, match="reach is .* expected 1e-06 to 1e.06 m"):
            isotropic_planar_2r(reach)


def test_loci_have_their_condition_number_and_separate_the_plane(tmp_path):
    arm, levels = load_robot("puma560"), [3.0, 5.0]
    loci = condition_loci(arm, levels, length=0.3, part="pose", q=[0, 0, 0, 0.3, 0.8, 0.2])
    for level, pieces in zip(levels, loci.curves, strict=True):
        assert pieces
        for curve in pieces:
            assert np.array_equal(curve[:, 3:], np.tile([0.3, 0.8, 0.2], (len(curve), 1)))
            J = jacobian(arm, curve)
            J[:, 3:] /= 0.3
            s = np.linalg.svd(J, compute_uv=False)
            found = np.sqrt((s**2).sum(1) * (s**-2.0).sum(1)) / 6.0
            assert np.abs(found - level).max() < 1e-8 * level
            # Neighbours on the curve are no more than a cell apart, or a little more.
            assert np.abs(np.diff(curve[:, 1:3], axis=0)).max() < 3.0 * 2.0 * np.pi / 180.0
    picture = plot_condition_loci(tmp_path / "loci.png", loci)
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_loci_of_the_planar_arm_are_circles_of_its_tip():
    design = isotropic_planar_2r(1.0)
    loci = condition_loci(design.chain, [1.2])
    for curve in loci.curves[0]:
        radius = np.linalg.norm(forward_kinematics(design.chain, curve)[:, :2, 3], axis=1)
        assert np.ptp(radius) < 1e-9


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"levels": [1.0]}, "levels is .1.0., expected condition numbers above 1"),
        ({"levels": [2.0], "joints": (1, 6)}, "expected two different joints from 0 to 5"),
        ({"levels": [2.0], "joints": 1}, "expected two different joints from 0 to 5"),
        ({"levels": [2.0], "steps": 4}, "steps is 4, expected a whole number from 8 to 2048"),
        ({"levels": [2.0], "joints": ("1", 2.5)}, "expected two different joints from 0 to 5"),
        ({"levels": [1e300]}, "condition numbers above 1 and below 4.85e.08"),
        ({"levels": [2.0], "q": np.zeros((2, 6))}, "q has shape .2, 6., expected .6,."),
        ({"levels": [2.0], "q": [np.nan, 0, 0, 0, 0, 0]}, "q of joint .* is nan"),
        ({"levels": [2.0], "part": "poses"}, "part is 'poses'"),
    ],
)
def test_wrong_requests_for_loci(given, text):
    with pytest.raises(RobomechError, match=text):
        condition_loci(load_robot("puma560"), **given)


def best_length(chain, near):
    """The length of least condition near a posture, with the best length of each in closed form."""

    def length(q):
        J = jacobian(chain, q)
        inverse = np.linalg.inv(J)
        linear = (J[3:] ** 2).sum() * (inverse[:, :3] ** 2).sum()
        return (linear / ((J[:3] ** 2).sum() * (inverse[:, 3:] ** 2).sum())) ** 0.25

    def height(q):
        given = {"norm": "frobenius", "length": length(q)}
        value = condition_number(chain, q, **given)
        return np.log(value), condition_number_gradient(chain, q, **given) / value

    q = minimize(height, near, jac=True, method="BFGS").x
    for _ in range(4):
        slopes = [(height(q + h)[1] - height(q - h)[1]) / 2e-5 for h in 1e-5 * np.eye(6)]
        q = q - np.linalg.pinv(slopes, rcond=1e-6) @ height(q)[1]
    return length(q)


@pytest.mark.parametrize(
    "name",
    [
        "puma560",
        "random",
        pytest.param("fanuc_arcmate", marks=pytest.mark.long),
        pytest.param("general6r", marks=pytest.mark.long),
    ],
)
def test_the_gradient_of_the_length_is_that_of_finite_differences(name):
    rng = np.random.default_rng(3)
    if name == "random":
        chain = chain_from_dh(*rng.uniform(0.2, 0.8, (2, 6)), rng.uniform(0.4, 2.6, 6))
    else:
        chain = load_robot(name)
    found, table, h = characteristic_length_gradient(chain), chain.dh, 5e-5
    near = found.length.q
    assert best_length(chain, near) == pytest.approx(float(found.length), rel=1e-7)
    for part in ("a", "b", "alpha"):
        for i in range(6):
            ends = []
            for step in (h, -h):
                rows = {key: getattr(table, key).copy() for key in ("a", "b", "alpha")}
                rows[part][i] += step
                arm = chain_from_dh(**rows, theta=table.theta, base=table.base, tool=table.tool)
                ends.append(best_length(arm, near))
            expected = (ends[0] - ends[1]) / (2.0 * h)
            if part == "a" and i == 5 and table.a[5] == 0.0:
                assert np.isnan(found.a[5])
                continue
            assert getattr(found, part)[i] == pytest.approx(expected, abs=2e-5)
    if not table.tool[:3, 3].any():
        scaled = np.nansum(found.a * table.a) + found.b @ table.b
        assert scaled == pytest.approx(float(found.length), rel=1e-6)


def test_a_tip_off_the_last_axis_makes_its_angle_count():
    """The length has a kink there: it is the same on either side, and changes at once."""
    arm, h = load_robot("fanuc_arcmate"), 1e-3
    lengths = []
    for step in (-h, 0.0, h):
        a = arm.dh.a + step * np.eye(6)[5]
        other = chain_from_dh(a, arm.dh.b, arm.dh.alpha, arm.dh.theta)
        lengths.append(float(characteristic_length(other, norm="frobenius")))
    assert lengths[0] == pytest.approx(lengths[2], rel=1e-6)
    assert abs(lengths[0] - lengths[1]) > 0.02 * h
    assert np.isnan(characteristic_length_gradient(arm).a[5])


def test_a_length_that_is_free_has_no_gradient():
    slides = chain_from_dh([0.0] * 3, [0.0] * 3, [1.0] * 3, types=["prismatic"] * 3)
    with pytest.raises(BadValueError, match="whose condition number depends on the length"):
        characteristic_length_gradient(slides)
    with pytest.raises(BadValueError, match="whose condition number depends on the length"):
        characteristic_length_gradient(isotropic_wrist().chain)


def test_a_planar_design_keeps_its_own_directions(golden):
    """Twists of links would lead out of the plane: only motions in it count."""
    design = isotropic_planar_3r(1.0)
    found = characteristic_length_gradient(design.chain)
    assert found.a @ design.a == pytest.approx(design.length, rel=1e-7)
    assert json.dumps(found.b.round(6).tolist()) == "[0.0, 0.0, 0.0]"


@pytest.mark.parametrize(
    "function",
    [isotropic_planar_2r, isotropic_planar_3r, isotropic_spatial_3r, isotropic_wrist],
    ids=lambda function: function.__name__,
)
def test_wrong_values_are_answered_or_refused(function):
    good = {} if function is isotropic_wrist else {"reach": 1.0}
    for call in with_options(function, **good).values():
        assert len(answered_or_refused(call, WRONG_VALUES)) > 10


def test_wrong_values_of_loci_and_of_the_gradient_are_answered_or_refused():
    loci = with_options(condition_loci, load_robot("puma560"), levels=[2.0], steps=8)
    for call in (*loci.values(), characteristic_length_gradient):
        assert answered_or_refused(call, WRONG_VALUES)
