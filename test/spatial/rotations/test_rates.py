"""Rates of every representation against differences of conversions, and SymPy for the book's."""

import numpy as np
import pytest
import sympy
from scipy.spatial.transform import Rotation

from robomech_ros import spatial
from robomech_ros.errors import BadValueError, WrongSizeError

STEP = 1e-3


def moving(t, start, w, dw):
    """Rotation at time t of a motion with these at 0: a rotation vector on top."""
    vector = w * t + 0.5 * dw * t * t
    return spatial.matrix_from_rotation_vector(vector) @ start


def differences(name, start, w, dw):
    """Rates by central differences of fourth order, with numbers kept continuous."""
    times = STEP * np.arange(-2, 3)
    rows = [spatial.convert_rotation(moving(t, start, w, dw), "matrix", name) for t in times]
    middle = rows[2]
    for i, row in enumerate(rows):
        if name == "quaternion" and row @ middle < 0.0:
            rows[i] = -row
        elif name in spatial.SEQUENCES:
            rows[i] = middle + (row - middle + np.pi) % (2.0 * np.pi) - np.pi
    first = (rows[0] - 8.0 * rows[1] + 8.0 * rows[3] - rows[4]) / (12.0 * STEP)
    second = (-rows[0] + 16.0 * rows[1] - 30.0 * middle + 16.0 * rows[3] - rows[4]) / (
        12.0 * STEP**2
    )
    return middle, first, second


@pytest.mark.parametrize("name", spatial.REPRESENTATIONS)
def test_rates_are_derivatives_and_lead_back(name):
    rng = np.random.default_rng(1)
    for start in Rotation.random(12, rng=rng).as_matrix():
        w, dw = rng.normal(size=(2, 3))
        value, first, second = differences(name, start, w, dw)
        rates, second_rates = spatial.rotation_rates(value, name, w, dw)
        scale = 1.0 + np.abs(second_rates).max() ** 2
        np.testing.assert_allclose(rates, first, atol=1e-8 * scale)
        np.testing.assert_allclose(second_rates, second, atol=2e-7 * scale)
        velocity, acceleration = spatial.angular_motion(value, name, rates, second_rates)
        np.testing.assert_allclose(velocity, w, atol=1e-12 * scale)
        np.testing.assert_allclose(acceleration, dw, atol=1e-11 * scale)


@pytest.mark.parametrize("name", spatial.REPRESENTATIONS)
def test_a_batch_is_one_after_the_other(name):
    rng = np.random.default_rng(2)
    Q = Rotation.random(6, rng=rng).as_matrix().reshape(2, 3, 3, 3)
    w, dw = rng.normal(size=(2, 2, 3, 3))
    value = spatial.convert_rotation(Q, "matrix", name)
    rates = spatial.rotation_rates(value, name, w, dw)
    back = spatial.angular_motion(value, name, *rates)
    for i in np.ndindex(2, 3):
        alone = spatial.rotation_rates(value[i], name, w[i], dw[i])
        assert all(a.tobytes() == b[i].tobytes() for a, b in zip(alone, rates, strict=True))
    np.testing.assert_allclose(back[0], w, atol=1e-10)
    steady = spatial.rotation_rates(value, name, w[0, 0])[0]
    assert steady.shape == value.shape


@pytest.mark.parametrize("name", ["quaternion", "rotation-vector", "rodrigues-vector", "XYZ",
                                  "linear-invariants", "matrix"])  # fmt: skip
@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-6, 0.3, 0.9999, 1.0001, 1.0])
def test_small_angles_are_as_good_as_any(name, angle):
    e = np.array([2.0, -1.0, 2.0]) / 3.0
    w, dw = np.array([0.3, -1.1, 0.8]), np.array([0.5, 0.2, -0.7])
    value = spatial.convert_rotation(e * angle, "rotation-vector", name)
    rates = spatial.rotation_rates(value, name, w, dw)
    velocity, acceleration = spatial.angular_motion(value, name, *rates)
    np.testing.assert_allclose(velocity, w, atol=2e-15)
    np.testing.assert_allclose(acceleration, dw, atol=5e-15)


def test_the_rates_of_the_rotation_vector_are_smooth_where_series_end():
    e = np.array([2.0, -1.0, 2.0]) / 3.0
    w, dw = np.array([0.3, -1.1, 0.8]), np.array([0.5, 0.2, -0.7])
    sides = [
        spatial.rotation_rates(e * (1.0 + d), "rotation-vector", w, dw) for d in (-1e-12, 1e-12)
    ]
    for low, high in zip(*sides, strict=True):
        np.testing.assert_allclose(low, high, atol=2e-11)


@pytest.mark.slow
def test_the_book_formulae_by_sympy():
    t = sympy.Symbol("t")
    phi = 0.4 + 0.7 * t + 0.2 * t**2
    polar, around = 0.5 + 0.3 * t, 1.1 - 0.6 * t**2
    e = sympy.Matrix([
        sympy.sin(polar) * sympy.cos(around), sympy.sin(polar) * sympy.sin(around), sympy.cos(polar)
    ])  # fmt: skip
    forms = {
        "axis-angle": [*e, phi],
        "quaternion": [*(e * sympy.sin(phi / 2)), sympy.cos(phi / 2)],
        "rotation-vector": list(e * phi),
        "rodrigues-vector": list(e * sympy.tan(phi / 2)),
        "linear-invariants": [*(e * sympy.sin(phi)), sympy.cos(phi)],
    }
    E = sympy.Matrix([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
    Q = e * e.T + sympy.cos(phi) * (sympy.eye(3) - e * e.T) + sympy.sin(phi) * E
    forms["matrix"] = list(Q)
    turn = Q.diff(t) * Q.T
    omega = sympy.Matrix([turn[2, 1], turn[0, 2], turn[1, 0]])
    w, dw = (
        np.array(one.subs(t, 0.3).evalf(), dtype=float)[:, 0] for one in (omega, omega.diff(t))
    )
    for name, form in forms.items():
        value, first, second = (
            np.array([one.diff(t, k).subs(t, 0.3).evalf() for one in form], dtype=float)
            for k in range(3)
        )
        shape = (3, 3) if name == "matrix" else (len(form),)
        value, first, second = (one.reshape(shape) for one in (value, first, second))
        rates, second_rates = spatial.rotation_rates(value, name, w, dw)
        np.testing.assert_allclose(rates, first, atol=1e-13, err_msg=name)
        np.testing.assert_allclose(second_rates, second, atol=1e-12, err_msg=name)
        velocity, acceleration = spatial.angular_motion(value, name, first, second)
        np.testing.assert_allclose(velocity, w, atol=1e-13, err_msg=name)
        np.testing.assert_allclose(acceleration, dw, atol=1e-12, err_msg=name)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("axis-angle", [0.0, 0.0, 1.0, 0.0]),
        ("ZYZ", [0.1, 0.0, 0.2]),
        ("xyz", [0.1, 0.5 * np.pi, 0.2]),
        ("rotation-vector", [0.0, 2.0 * np.pi, 0.0]),
    ],
)
def test_where_numbers_have_no_rates_is_said(name, value):
    with pytest.raises(BadValueError, match="not a singular one"):
        spatial.rotation_rates(value, name, [0.1, 0.2, 0.3])


def test_rates_of_another_shape_are_refused():
    with pytest.raises(WrongSizeError, match="rates has shape"):
        spatial.angular_motion(np.eye(3), "matrix", np.zeros(3))
    with pytest.raises(WrongSizeError, match="as the rotation"):
        spatial.rotation_rates(np.eye(3), "matrix", np.zeros((2, 3)))
