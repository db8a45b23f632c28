"""The positioning and orientation problems of chapter 4, on golden data and random arms."""

import json

import numpy as np
import pytest
from golden_arms import GOLDEN, golden
from numpy.testing import assert_allclose

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinematics.equations import (
    arm_angles,
    decoupled_postures,
    orientation_equation,
    positioning_equations,
    wrist_angles,
    wrist_centre,
)
from robomech_ros.robots import chain_from_dh, load_robot

ARMS = ("decoupled_puma560", "decoupled_irb2000", "decoupled_general_8", "ik6r_tsai_morgan_1")
HALF = np.pi / 2


def orthogonal(b4=1.0):
    """The arm with unit links and perpendicular axes."""
    twists = [HALF, -HALF, HALF, HALF, HALF, 0.0]
    return chain_from_dh([1, 1, 1, 0, 0, 0], [0, 1, 1, b4, 0, 0], twists)


def random_arm(seed, **changes):
    """An arm with a spherical wrist, with angles and transforms at both ends of its table."""
    rng = np.random.default_rng(seed)
    a, b = rng.uniform(-0.5, 0.5, (2, 6))
    a[3] = a[4] = b[4] = 0.0
    alpha = rng.uniform(0.4, 2.7, 6) * rng.choice([-1, 1], 6)
    for name, value in changes.items():
        {"a": a, "alpha": alpha}[name][0] = value
    ends = forward_kinematics(load_robot("ur5e"), rng.uniform(-3, 3, (2, 6)))
    theta = rng.uniform(-3, 3, 6)
    return chain_from_dh(a, b, alpha, theta, base=ends[0], tool=ends[1])


def unmatched(found, expected):
    difference = np.exp(1j * np.asarray(found))[:, None] - np.exp(1j * np.asarray(expected))[None]
    return np.abs(difference).max(axis=2).min(axis=1).max(initial=0.0)


def real(q, bound=1e-7):
    return q.real[np.abs(q.imag).max(axis=1) < bound]


@pytest.mark.parametrize("name", ARMS)
def test_golden_postures(name):
    case, chain, T = golden(name)
    q = decoupled_postures(chain, T)
    assert q.shape == (8, 6)
    assert len(real(q)) == len(case["solutions"])
    assert unmatched(case["solutions"], real(q)) < 1e-9
    assert unmatched(real(q), case["solutions"]) < 1e-9
    if "wrist_center" in case:
        assert_allclose(wrist_centre(chain, T), case["wrist_center"], atol=1e-14)
    if "quartic_theta3" in case:
        ours = positioning_equations(chain, case["wrist_center"]).quartic
        theirs = np.array(case["quartic_theta3"])
        assert_allclose(ours / np.linalg.norm(ours), theirs / np.linalg.norm(theirs), atol=1e-12)


@pytest.mark.parametrize(
    ("centre", "quartic"),
    [
        ((0, 2, -1), (9, 0, -46, -32, 9)),
        ((1, 2, 0), (5, 0, -54, -32, 5)),
        ((1, 1, 1), (1, 0, -30, -32, 33)),
        ((0, 1, 1), (0, 0, -16, -32, 48)),
    ],
)
def test_the_quartics_of_an_orthogonal_arm(centre, quartic):
    if centre == (0, 2, -1):
        case = json.loads((GOLDEN / "decoupled_orthogonal_arm.json").read_text())
        assert case["quartic"] == list(quartic) and case["C"] == list(centre)
    equations = positioning_equations(orthogonal(), centre)
    largest = np.argmax(np.abs(quartic))
    scale = quartic[largest] / equations.quartic[largest]
    assert_allclose(equations.quartic * scale, quartic, atol=1e-12)
    roots = np.roots(quartic)
    assert len(equations.theta3) == 4
    for root in roots:
        assert np.abs(np.tan(equations.theta3 / 2) - root).min() < 1e-6
    # What the quartic has lost in degree are half turns, here a singular posture.
    half_turns = np.abs(np.exp(1j * equations.theta3) + 1.0) < 1e-6
    assert half_turns.sum() == 4 - len(roots)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("special", [{}, {"a": 0.0}, {"alpha": 0.0}, {"alpha": np.pi}])
def test_random_arms_have_eight_postures(seed, special):
    """All eight, real and complex, put the tip at the pose; the real ones are the kernels'."""
    chain = random_arm(seed, **special)
    T = forward_kinematics(chain, np.random.default_rng(seed + 50).uniform(-3, 3, 6))
    q = decoupled_postures(chain, T)
    assert q.shape == (8, 6)
    ours = inverse_kinematics(chain, T, respect_limits=False)
    assert ours.complete and len(real(q)) == len(ours.q)
    assert unmatched(real(q), ours.q) < 1e-8 and unmatched(ours.q, real(q)) < 1e-8
    table = chain.dh
    for row in q:
        pose = table.base.astype(complex)
        for a, b, alpha, theta in zip(
            table.a, table.b, table.alpha, row + table.theta, strict=True
        ):
            c, s, lam, mu = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
            step = [[c, -lam * s, mu * s, a * c], [s, lam * c, -mu * c, a * s], [0, mu, lam, b]]
            pose = pose @ np.array([*step, [0, 0, 0, 1]])
        bound = 1e-10 * np.cosh(np.abs(row.imag).sum())
        assert np.abs(pose @ table.tool - T).max() < bound


@pytest.mark.parametrize("seed", range(4))
def test_both_equations_hold_at_every_root(seed):
    chain = random_arm(seed)
    centre = np.random.default_rng(seed).uniform(-0.6, 0.6, 3)
    equations = positioning_equations(chain, centre)
    assert equations.determinant == pytest.approx(
        equations.first[0] * equations.second[1] - equations.second[0] * equations.first[1]
    )
    K, L, M, N, P, Q = equations.conic
    for theta3 in equations.theta3:
        c3, s3 = np.cos(theta3), np.sin(theta3)
        left = K * c3**2 + L * s3**2 + M * c3 * s3 + N * c3 + P * s3 + Q
        assert abs(left) < 1e-13 * abs(c3) ** 2 + 1e-14
        ((theta1, _, _),) = arm_angles(chain, centre, theta3)
        row = np.array([np.cos(theta1), np.sin(theta1), c3, s3, 1.0])
        for coefficients in (equations.first, equations.second):
            assert abs(coefficients @ row) < 1e-10 * np.abs(row).max()


def test_double_roots_are_singular_postures():
    """A posture whose first three axes meet one line through the centre: two roots merge."""
    chain = chain_from_dh(
        [0.3, 0.5, 0.25, 0, 0, 0],
        [0.2, 0.1, 0.15, 0.6, 0, 0.1],
        np.radians([70, -30, 80, 75, -85, 20]),
    )
    table = chain.dh

    def determinant(theta3):
        q = np.array([0.3, -0.4, theta3, 0.0, 0.0, 0.0])
        step = 1e-6 * np.eye(6)[:3]
        columns = [
            wrist_centre(chain, forward_kinematics(chain, q + h))
            - wrist_centre(chain, forward_kinematics(chain, q - h))
            for h in step
        ]
        return np.linalg.det(np.array(columns) / 2e-6)

    angles = np.linspace(-np.pi, np.pi, 200)
    values = [determinant(x) for x in angles]
    k = next(i for i in range(199) if values[i] * values[i + 1] < 0)
    low, high = angles[k], angles[k + 1]
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if determinant(middle) * values[k] > 0 else (low, middle)
    centre = wrist_centre(chain, forward_kinematics(chain, [0.3, -0.4, low, 0, 0, 0]))
    roots = positioning_equations(chain, centre).theta3
    assert np.sort(np.abs(np.exp(1j * roots) - np.exp(1j * low)))[1] < 1e-3
    assert table.a[0] == 0.3


def test_a_centre_on_the_first_axis_leaves_joint_1_free():
    chain = orthogonal()
    equations = positioning_equations(chain, [0.0, 0.0, 0.7])
    assert equations.determinant == 0.0 and len(equations.theta3) == 4
    assert arm_angles(chain, [0.0, 0.0, 0.7], 0.4)[0, 0] == 0.0


def wrist_of(alpha):
    return chain_from_dh([0.3, 0.4, 0.1, 0, 0, 0], [0, 0, 0, 0.4, 0, 0.1], [1.0, 0.2, 1.1, *alpha])


def test_the_golden_wrist():
    case = json.loads((GOLDEN / "spherical_wrist.json").read_text())
    chain = wrist_of(case["alpha456"])
    equation = orientation_equation(chain, case["R"])
    assert equation.discriminant == pytest.approx(case["discriminant"], abs=1e-12)
    found = wrist_angles(chain, case["R"])
    assert_allclose(
        np.exp(1j * found[np.argsort(found[:, 0].real)]),
        np.exp(1j * np.array(case["solutions"])),
        atol=1e-10,
    )
    for theta4 in equation.theta4:
        assert abs(np.polyval(equation.quadratic, np.tan(theta4 / 2))) < 1e-12


def rotation_of(alpha, theta):
    matrices = [
        forward_kinematics(chain_from_dh([0.0], [0.0], [x]), [y])[:3, :3]
        for x, y in zip(alpha, theta, strict=True)
    ]
    return np.linalg.multi_dot(matrices)


@pytest.mark.parametrize("alpha", [(1.1, -0.8, 0.3), (-HALF, HALF, 0.0), (-1.0, -2.0, 0.5)])
def test_a_half_turn_of_joint_4_is_a_root(alpha):
    R = rotation_of(alpha, (np.pi, 0.7, -0.4))
    equation = orientation_equation(wrist_of(alpha), R)
    assert abs(equation.quadratic[0]) < 1e-15
    assert np.abs(np.exp(1j * equation.theta4) + 1.0).min() < 1e-12
    assert unmatched([[np.pi, 0.7, -0.4]], wrist_angles(wrist_of(alpha), R)) < 1e-12


def test_an_orientation_beyond_the_wrist_has_complex_angles():
    """Axes 4 and 6 can be no more than alpha_4 + alpha_5 apart."""
    alpha = (0.4, 0.5, 0.0)
    chain = wrist_of(alpha)
    R = rotation_of((1.5, 0.0, 0.0), (0.3, 0.0, 0.0))
    equation = orientation_equation(chain, R)
    assert equation.discriminant < 0.0
    assert np.abs(equation.theta4.imag).min() > 0.1
    assert equation.theta4[0] == pytest.approx(equation.theta4[1].conjugate())


def test_a_stretched_wrist_leaves_the_sum_of_two_angles():
    alpha = (-HALF, HALF, 0.0)
    R = rotation_of(alpha, (0.4, 0.0, 0.5))
    ((theta4, theta5, theta6),) = wrist_angles(wrist_of(alpha), R)
    assert theta4 == 0.0 and abs(theta5) < 1e-12 and abs(theta6 - 0.9) < 1e-12


def test_wrong_arguments():
    puma = load_robot("puma560")
    for call in (wrist_centre, decoupled_postures):
        with pytest.raises(BadValueError, match="axes through one point"):
            call(load_robot("diestro"), np.eye(4))
        with pytest.raises(BadValueError, match="a_4, a_5, b_5 = "):
            call(load_robot("diestro"), np.eye(4))
        with pytest.raises(BadValueError, match="six revolute"):
            call(load_robot("panda"), np.eye(4))
        with pytest.raises(WrongSizeError):
            call(puma, np.eye(3))
        with pytest.raises(NonFiniteError):
            call(puma, np.full((4, 4), np.nan))
        with pytest.raises(BadValueError, match="chain"):
            call(None, np.eye(4))
    for call in (positioning_equations, lambda *given: arm_angles(*given, 0.1)):
        with pytest.raises(WrongSizeError):
            call(puma, [1.0, 2.0])
        with pytest.raises(WrongSizeError):
            call(puma, np.zeros((2, 3)))
        with pytest.raises(NonFiniteError):
            call(puma, [1.0, 2.0, np.inf])
        with pytest.raises(BadValueError):
            call(puma, ["x", "y", "z"])
    for theta3, error in ((np.nan, NonFiniteError), (None, BadValueError), ([0.1], WrongSizeError)):
        with pytest.raises(error, match="theta3"):
            arm_angles(puma, [0.3, 0.3, 0.3], theta3)
    same = chain_from_dh(
        [0, 0.4, 0.1, 0, 0, 0], [0.1, 0.2, 0, 0.4, 0, 0.1], [0, 0.2, 1.1, 1, -1, 0]
    )
    with pytest.raises(BadValueError, match="not one line"):
        positioning_equations(same, [0.1, 0.2, 0.3])
    for call in (orientation_equation, wrist_angles):
        with pytest.raises(WrongSizeError):
            call(puma, np.eye(4))
        with pytest.raises(NonFiniteError):
            call(puma, np.full((3, 3), np.nan))
        for wrong in (np.diag([1.0, 1.0, -1.0]), 2.0 * np.eye(3), None, "R", [[1], [2, 3]]):
            with pytest.raises((BadValueError, WrongSizeError)):
                call(puma, wrong)
