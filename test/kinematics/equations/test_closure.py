"""The closure equations of chapter 9 and what elimination leaves of them, on golden postures."""

import numpy as np
import pytest
from golden_arms import NAMES, golden
from numpy.testing import assert_allclose

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.equations import (
    closure_equations,
    half_angle_equations,
    li_woernle_hiller_matrix,
    posture_of,
    raghavan_roth_matrix,
    remaining_angles,
)
from robomech_ros.robots import chain_from_dh, load_robot


def circle(x):
    return np.array([np.cos(x), np.sin(x), 1.0])


def half(x):
    s, c = np.sin(x / 2), np.cos(x / 2)
    return np.array([s * s, s * c, c * c])


@pytest.mark.parametrize("first", range(1, 7))
@pytest.mark.parametrize("name", NAMES)
def test_golden_postures_obey_all_equations(name, first):
    case, chain, T = golden(name)
    equations = closure_equations(chain, T, first=first)
    assert equations.left.shape == (14, 3, 3, 3) and equations.right.shape == (14, 9)
    for q in case["solutions"]:
        assert np.abs(equations.residual(q)).max() < 1e-13
        _, _, q3, q4, q5, _ = np.array(q)[equations.joints]
        monomials = np.outer(circle(q4), circle(q5)).ravel()
        assert np.abs(equations.six_by_nine(q3) @ monomials).max() < 1e-13
        assert np.abs(equations.three_columns(q4, q5) @ circle(q3)).max() < 1e-13
        x3 = np.array([np.sin(q3 / 2), np.cos(q3 / 2)])
        linear = np.einsum(
            "etjk,t,j,k", half_angle_equations(equations), x3, circle(q4), circle(q5)
        )
        assert np.abs(linear).max() < 1e-13
        for matrix, angle in (
            (raghavan_roth_matrix(equations), q3),
            (li_woernle_hiller_matrix(equations), q5),
        ):
            sizes = np.linalg.svd(np.einsum("xij,x", matrix, half(angle)), compute_uv=False)
            assert sizes[-1] < 1e-13 * sizes[0]


@pytest.mark.parametrize("name", NAMES)
def test_the_sides_are_the_products_of_the_loop(name):
    """Coefficients from three angles of each joint are exact at any others."""
    case, chain, T = golden(name)
    equations = closure_equations(chain, T)
    L = equations.links
    q1, q2, q3, q4, q5 = np.random.default_rng(0).uniform(-3, 3, 5)

    def turn(x):
        return forward_kinematics(chain_from_dh([0.0], [0.0], [0.0]), [x])

    left = L[1] @ turn(q3) @ L[2] @ turn(q4) @ L[3] @ turn(q5) @ L[4]
    right = turn(-q2) @ np.linalg.inv(L[0]) @ turn(-q1) @ np.linalg.inv(L[5])
    for pose, values in (
        (left, np.einsum("eijk,i,j,k", equations.left, circle(q3), circle(q4), circle(q5))),
        (right, equations.right @ np.outer(circle(q1), circle(q2)).ravel()),
    ):
        l, p = pose[:3, 2], pose[:3, 3]  # noqa: E741
        expected = [*p, *l, *np.cross(p, l), *((p @ p) * l - 2 * (p @ l) * p), p @ p, p @ l]
        assert_allclose(values, expected, atol=1e-14)
    sizes = np.array([np.linalg.norm(row[:3, 3]) for row in L])
    assert sizes.sum() == pytest.approx(1.0)
    assert len(case["solutions"]) > 1


def test_remaining_angles_close_the_loop():
    case, chain, T = golden("ik6r_tsai_morgan_3")
    for first in range(1, 7):
        equations = closure_equations(chain, T, first=first)
        for q in np.array(case["solutions"]):
            ordered = q[equations.joints]
            found = np.array(remaining_angles(equations, *ordered[2:5]))
            assert np.abs(found.imag).max() < 1e-12
            assert_allclose(np.exp(1j * found), np.exp(1j * ordered[[0, 1, 5]]), atol=1e-12)
            refined = posture_of(equations, *(ordered[2:5] + 1e-3))
            assert_allclose(np.exp(1j * refined), np.exp(1j * q), atol=1e-12)


@pytest.mark.parametrize(
    ("T", "error"),
    [
        (np.eye(3), WrongSizeError),
        (np.full((4, 4), np.nan), NonFiniteError),
        (np.zeros((4, 4)), BadValueError),
        ("pose", BadValueError),
    ],
)
def test_no_pose(T, error):
    with pytest.raises(error):
        closure_equations(load_robot("diestro"), T)


def test_no_such_arm_or_joint():
    with pytest.raises(BadValueError, match="six revolute"):
        closure_equations(load_robot("panda"), np.eye(4))
    with pytest.raises(BadValueError, match="chain"):
        closure_equations("diestro", np.eye(4))
    for first in (0, 7, 1.5, None, "one", np.nan):
        with pytest.raises(BadValueError, match="first"):
            closure_equations(load_robot("diestro"), np.eye(4), first=first)


def test_angles_that_are_none_are_refused():
    arm = load_robot("diestro")
    equations = closure_equations(arm, forward_kinematics(arm, [0.3, 1.2, -1.4, 1.1, -2.0, 0.7]))
    for call, error, words in (
        (lambda: equations.residual([1, 2]), WrongSizeError, r"q has shape .*2.*expected \(6,\)"),
        (lambda: equations.residual(["x"] * 6), BadValueError, "q is"),
        (lambda: equations.residual([[1], [2, 3]]), BadValueError, "q is"),
        (lambda: equations.residual([0, 1, 2, np.inf, 4, 5]), NonFiniteError, r"q\[3\] is inf"),
        (lambda: equations.six_by_nine(np.nan), NonFiniteError, "q3 is nan"),
        (lambda: equations.three_columns(1j, None), BadValueError, "q5 is None"),
        (lambda: equations.three_columns([1, 2], [1, 2, 3]), WrongSizeError, "q4 and q5"),
    ):
        with pytest.raises(error, match=words):
            call()
    assert equations.three_columns([0.1, 1j], 0.2).shape == (2, 6, 3)
