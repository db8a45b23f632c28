"""Appendix B: least squares, minimum norm, Newton-Raphson, Newton-Gauss."""

import json
from pathlib import Path

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.numerics import least_squares, minimum_norm, newton_gauss, newton_raphson

CASES = json.loads(
    (Path(__file__).parents[1] / "data/golden/appendix_b.json").read_text(encoding="utf-8")
)


def test_least_squares_of_the_reference():
    case = CASES["ls"]
    x, error = least_squares(case["A"], case["b"])
    np.testing.assert_allclose(x, case["x"], atol=1e-12)
    assert abs(error - case["residual_norm"]) < 1e-12


def test_minimum_norm_of_the_reference():
    case = CASES["min_norm"]
    np.testing.assert_allclose(minimum_norm(case["A"], case["b"]), case["x"], atol=1e-12)


def test_newton_gauss_of_the_reference():
    case = CASES["newton_gauss"]
    end = newton_gauss(
        lambda x: [x[0] ** 2 + x[1] ** 2 - 4, x[0] * x[1] - 1, x[0] - x[1] - 1.3],
        lambda x: [[2 * x[0], 2 * x[1]], [x[1], x[0]], [1, -1]],
        case["x0"],
    )
    assert end.converged
    np.testing.assert_allclose(end.x, case["x"], atol=1e-9)
    np.testing.assert_allclose(end.residual, case["residual"], atol=1e-9)


@pytest.mark.parametrize("shape", [(3, 3), (7, 3), (20, 6)])
def test_least_squares_against_numpy(shape):
    rng = np.random.default_rng(1)
    for _ in range(50):
        A, b = rng.normal(size=shape), rng.normal(size=shape[0])
        x, error = least_squares(A, b)
        np.testing.assert_allclose(x, np.linalg.lstsq(A, b, rcond=None)[0], atol=1e-10)
        assert abs(error - np.linalg.norm(A @ x - b)) < 1e-12


@pytest.mark.parametrize("shape", [(3, 3), (3, 7), (6, 20)])
def test_minimum_norm_against_numpy(shape):
    rng = np.random.default_rng(2)
    for _ in range(50):
        A, b = rng.normal(size=shape), rng.normal(size=shape[0])
        np.testing.assert_allclose(minimum_norm(A, b), np.linalg.pinv(A) @ b, atol=1e-10)


def test_least_squares_is_as_accurate_as_the_problem():
    """Normal equations would lose all digits here."""
    A = np.vander(np.linspace(1, 1.02, 12), 5)
    x = np.array([1.0, -2.0, 3.0, -4.0, 5.0])
    found, error = least_squares(A, A @ x)
    assert error < 1e-14 and np.abs(A @ (found - x)).max() < 1e-13


def test_newton_raphson_squares_the_error():
    end = newton_raphson(lambda x: [x[0] ** 2 - 2.0], lambda x: [[2.0 * x[0]]], [1.5])
    assert end.converged and end.iterations <= 6 and abs(end.x[0] - np.sqrt(2.0)) < 1e-15


def test_newton_raphson_tells_that_it_did_not_converge():
    end = newton_raphson(lambda x: [x[0] ** 2 + 1.0], lambda x: [[2.0 * x[0]]], [0.7])
    assert not end.converged


def test_refusals():
    with pytest.raises(WrongSizeError, match="at least as many rows"):
        least_squares(np.ones((2, 3)), np.ones(2))
    with pytest.raises(WrongSizeError, match="at most as many rows"):
        minimum_norm(np.ones((3, 2)), np.ones(3))
    with pytest.raises(WrongSizeError, match="b"):
        least_squares(np.eye(3), np.ones(2))
    with pytest.raises(BadValueError, match="full rank"):
        least_squares(np.ones((3, 2)), np.ones(3))
    with pytest.raises(NonFiniteError):
        least_squares([[np.nan], [1.0]], [1.0, 2.0])
    with pytest.raises(WrongSizeError):
        newton_raphson(lambda x: [x[0], x[0]], lambda x: [[1.0], [1.0]], [1.0])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: least_squares([["a", 1.0], [2.0, 3.0]], [1.0, 2.0]), "A is .* real numbers"),
        (lambda: least_squares(np.eye(2), "ab"), "b is 'ab', expected an array of real numbers"),
        (lambda: least_squares(np.eye(2) * 1j, [1.0, 2.0]), "A is"),
        (lambda: minimum_norm([[1.0, 2.0], [3.0]], [1.0, 2.0]), "A is"),
        (lambda: minimum_norm(np.eye(2), [True, False]), "b is"),
        (lambda: newton_raphson(lambda x: x, lambda x: np.eye(1), ["one"]), "x is"),
        (lambda: newton_raphson(lambda x: "y", lambda x: np.eye(1), [1.0]), r"f\(x\) is 'y'"),
        (lambda: newton_gauss(lambda x: x, lambda x: [["one"]], [1.0]), "A is"),
        (lambda: newton_gauss(lambda x: x, lambda x: [[1.0]], [1.0], tolerance="1"), "tolerance"),
        (lambda: newton_gauss(lambda x: x, lambda x: [[1.0]], [1.0], tolerance=0.0), "tolerance"),
        (lambda: newton_gauss(lambda x: x, lambda x: [[1.0]], [1.0], iterations=0), "iterations"),
    ],
)
def test_what_is_no_number_is_said_by_name(call, words):
    with pytest.raises(BadValueError, match=words):
        call()


def test_starts_that_do_not_fit():
    with pytest.raises(WrongSizeError, match=r"x has shape \(\), expected \(n,\)"):
        newton_gauss(lambda x: x, lambda x: [[1.0]], 1.0)
    with pytest.raises(NonFiniteError, match=r"x\[0\] is nan"):
        newton_gauss(lambda x: x, lambda x: [[1.0]], [np.nan])


def test_the_start_is_left_as_it_is():
    start = np.array([1.5])
    newton_raphson(lambda x: [x[0] ** 2 - 2.0], lambda x: [[2.0 * x[0]]], start)
    assert start.tolist() == [1.5]


@pytest.mark.parametrize("constant", [0.0, 1.0, 1e3])
def test_issue_12_a_large_residual_that_stays_does_not_hide_the_minimum(constant):
    """The norm of the residual stops falling at 1e-8 of the root, its normality does not."""
    end = newton_gauss(
        lambda x: [constant, x[0] ** 2 - 2.0], lambda x: [[0.0], [2.0 * x[0]]], [5.0]
    )
    assert end.converged is True
    assert abs(end.x[0] - np.sqrt(2.0)) < 1e-12


def test_a_slope_that_does_not_belong_to_the_equations_does_not_converge():
    end = newton_gauss(lambda x: [x[0] - 1.0, 1e3], lambda x: [[-1.0], [0.0]], [5.0])
    assert end.converged is False
