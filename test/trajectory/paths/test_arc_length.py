"""Arc length: against closed forms and independent integrals, and as a parameter."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipe

from robomech_ros.errors import BadValueError
from robomech_ros.trajectory import (
    FunctionCurve,
    arc_length,
    arc_through,
    blended_polyline,
    helix,
    line,
    spline_curve,
    viviani,
)


def ellipse(a, b):
    def rows(u):
        c, s, zero = np.cos(u), np.sin(u), np.zeros_like(u)
        waves = [(c, s), (-s, c), (-c, -s), (s, -c), (c, s)]
        return [np.stack([a * x, b * y, zero], axis=1) for x, y in waves]

    return FunctionCurve(rows, [0.0, 2.0 * math.pi])


def test_closed_forms():
    assert arc_length(line([1, 2, 3], [1, 5, 7])).length == pytest.approx(5.0, rel=1e-15)
    assert arc_length(helix(0.3, 0.4, 11.0)).length == pytest.approx(5.5, rel=1e-14)
    for a in (0.1, 3.0):
        # |p'|^2 = a^2 (1 + cos^2(u/2)), u from 0 to 4 pi: a complete elliptic integral.
        exact = 8.0 * a * math.sqrt(2.0) * ellipe(0.5)
        assert arc_length(viviani(a)).length == pytest.approx(exact, rel=1e-13)


@pytest.mark.parametrize("flat", [1.0, 0.3, 1e-2, 1e-4])
def test_ellipses_as_flat_as_may_be(flat):
    exact = 4.0 * ellipe(1.0 - flat**2)
    assert arc_length(ellipse(1.0, flat)).length == pytest.approx(exact, rel=1e-12)


def test_splines_against_adaptive_quadrature():
    rng = np.random.default_rng(3)
    for degree in (3, 5):
        curve = spline_curve(rng.normal(size=(6, 3)), degree=degree)
        pieces = [
            quad(lambda u, c=curve: np.linalg.norm(c.derivatives(u)[1]), a, b, epsabs=1e-13)[0]
            for a, b in zip(curve.breaks[:-1], curve.breaks[1:], strict=True)
        ]
        found = arc_length(curve)
        assert found.length == pytest.approx(sum(pieces), rel=1e-12)
        np.testing.assert_allclose(np.diff(found.breaks), pieces, rtol=1e-11)


CURVES = {
    "viviani": viviani(0.7),
    "spline": spline_curve(np.random.default_rng(8).normal(size=(9, 3))),
    "flat ellipse": ellipse(1.0, 0.2),
    "blended": blended_polyline([[0, 0, 0], [1, 0, 0], [1, 1, 0.3], [0, 2, 0]], radius=0.2),
}


@pytest.mark.parametrize("name", CURVES)
def test_the_derivative_by_arc_length_is_a_unit_vector_and_the_others_follow(name):
    curve = arc_length(CURVES[name])
    h = 1e-5 * curve.length
    s = np.linspace(0.0, curve.length, 101)
    rows = curve.derivatives(s)
    np.testing.assert_allclose(np.linalg.norm(rows[1], axis=1), 1.0, rtol=1e-13)
    # (p'.p')' = 0, and so on.
    size = np.linalg.norm(rows[2], axis=1)
    assert np.abs(np.sum(rows[1] * rows[2], axis=1)).max() <= 1e-12 * max(size.max(), 1.0)
    inner = s[1:-1][np.abs(s[1:-1, None] - curve.breaks).min(axis=1) > 3.0 * h]
    here, after, before = (curve.derivatives(inner + d) for d in (0.0, h, -h))
    for k in range(4):
        found = (after[k] - before[k]) / (2.0 * h)
        size = np.abs(here[k + 1]).max()
        assert np.abs(found - here[k + 1]).max() <= 3e-4 * size + 1e-8


@pytest.mark.parametrize("name", CURVES)
def test_length_and_parameter_invert_each_other(name):
    curve = CURVES[name]
    measure = arc_length(curve).measure
    u = np.linspace(curve.breaks[0], curve.breaks[-1], 1001)
    s = measure.at(u)
    assert 0.0 <= s[0] < 1e-15 and s[-1] == pytest.approx(measure.length, rel=1e-15)
    assert (np.diff(s) > 0.0).all()
    span = curve.breaks[-1] - curve.breaks[0]
    np.testing.assert_allclose(measure.parameter(s), u, atol=1e-12 * span)
    assert measure.at(float(u[7])) == s[7]


def test_a_limit_from_the_left_is_on_the_left():
    curve = blended_polyline([[0, 0, 0], [1, 0, 0], [1, 1, 0]], radius=0.25)
    by_length = arc_length(curve)
    inner = by_length.breaks[1:-1]
    before = np.linalg.norm(by_length.derivatives(np.nextafter(inner, 0.0))[2], axis=1)
    after = np.linalg.norm(by_length.derivatives(inner)[2], axis=1)
    np.testing.assert_allclose(before, [0.0, 4.0], atol=1e-12)
    np.testing.assert_allclose(after, [4.0, 0.0], atol=1e-12)


def cusp(u):
    zero, one = np.zeros_like(u), np.ones_like(u)
    rows = [(u**2, u**3), (2 * u, 3 * u**2), (2 * one, 6 * u), (zero, 6 * one), (zero, zero)]
    return [np.stack([*row, zero], axis=1) for row in rows]


@pytest.mark.parametrize("ends", [(-1.0, 1.0), (0.0, 1.0), (-1.0, 0.3)])
def test_a_cusp_is_refused_with_its_place(ends):
    with pytest.raises(BadValueError, match="speed of the curve at parameter") as caught:
        arc_length(FunctionCurve(cusp, ends))
    assert abs(float(caught.value.what.split()[-1])) < 1e-5


def test_lengths_off_the_curve_are_refused():
    curve = arc_length(arc_through([1, 0, 0], [0, 1, 0], [-1, 0, 0]))
    assert curve.derivatives(curve.length * (1.0 + 1e-12)).shape == (5, 3)
    for bad in (-0.1, 3.2):
        with pytest.raises(BadValueError, match=f"parameter is {bad}, expected from 0 to 3.14159"):
            curve.derivatives(bad)
