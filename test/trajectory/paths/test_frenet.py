"""Frenet-Serret frames: golden values, closed forms, the equations themselves, straight places."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.spatial import as_pose, matrix_from_rotation_vector, pose_from_matrix
from robomech_ros.trajectory import (
    FunctionCurve,
    arc_length,
    blended_polyline,
    cylinder_intersection,
    frenet_serret,
    helix,
    line,
    spline_curve,
    viviani,
)

GOLDEN = json.loads((Path(__file__).parents[2] / "data" / "golden" / "curves.json").read_text())
POINTS = np.random.default_rng(5).normal(size=(7, 3))
PLACED = pose_from_matrix(matrix_from_rotation_vector([0.3, -1.2, 0.7]), [0.4, -0.1, 2.0])
CURVES = {
    "helix": helix(0.3, -0.2, 9.0, pose=PLACED),
    "viviani": viviani(0.5, pose=PLACED),
    "cylinders": cylinder_intersection(0.7, 0.3, offset=0.2, pose=PLACED),
    "quintic spline": spline_curve(POINTS, degree=5),
}


def test_golden_cylinders():
    golden = GOLDEN["cylinders"]
    curve = cylinder_intersection(golden["R"], golden["r"])
    theta, kappa, tau, speed = np.array(golden["rows_theta_kappa_tau_speed"]).T
    frenet = frenet_serret(curve, theta)
    np.testing.assert_allclose(frenet.curvature, kappa, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(frenet.torsion, tau, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(frenet.speed, speed, rtol=1e-12, atol=1e-12)
    assert arc_length(curve).length == pytest.approx(golden["arc_length"], rel=1e-12)


def test_golden_viviani():
    golden = GOLDEN["viviani"]
    theta = np.linspace(0.0, 4.0 * math.pi, 401)
    for a in (0.2, 1.0, 30.0):
        names = {"theta": theta, "a": a, "cos": np.cos, "sqrt": np.sqrt}
        frenet = frenet_serret(viviani(a), theta)
        kappa, tau = (eval(golden[key], {}, names) for key in ("kappa", "tau"))
        np.testing.assert_allclose(frenet.curvature, kappa, rtol=1e-12)
        np.testing.assert_allclose(frenet.torsion, tau, rtol=1e-12, atol=1e-12 / a)


@pytest.mark.parametrize(("a", "b"), [(1.0, 0.0), (0.3, 0.2), (2.0, -5.0)])
def test_golden_helix(a, b):
    names = {"a": a, "b": b}
    kappa, tau = (eval(text, {}, names) for text in halves())
    frenet = frenet_serret(helix(a, b, 7.0, pose=PLACED), np.linspace(0.0, 7.0, 30))
    np.testing.assert_allclose(frenet.curvature, kappa, rtol=1e-12)
    np.testing.assert_allclose(frenet.torsion, tau, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(frenet.curvature_rate, 0.0, atol=1e-12)
    np.testing.assert_allclose(frenet.torsion_rate, 0.0, atol=1e-12)
    np.testing.assert_allclose(frenet.darboux[0], frenet.darboux[-1], atol=1e-12)


def halves():
    """Return the formulae of curvature and torsion from the golden text, as Python has them."""
    formulae = GOLDEN["helix"].split(" for ")[0].replace("^", "**").split(", ")
    return [formula.split("=")[1] for formula in formulae]


@pytest.mark.parametrize("name", CURVES)
def test_frenet_serret_equations_and_darboux_rate_by_differences(name):
    curve = arc_length(CURVES[name])
    h = 1e-5 * curve.length
    breaks = curve.breaks
    s = np.linspace(0.01, 0.99, 60) * curve.length
    s = s[np.abs(s[:, None] - breaks).min(axis=1) > 3.0 * h]
    here, after, before = (frenet_serret(curve, s + d) for d in (0.0, h, -h))

    def rate(what):
        return (getattr(after, what) - getattr(before, what)) / (2.0 * h)

    t, n, b = np.moveaxis(here.frame, -1, 0)
    kappa, tau = here.curvature[:, None], here.torsion[:, None]
    scale = kappa + np.abs(tau)
    change = np.moveaxis(rate("frame"), -1, 0)
    for found, wanted in zip(change, (kappa * n, tau * b - kappa * t, -tau * n), strict=True):
        assert (np.abs(found - wanted) / scale).max() < 1e-4
    for what in ("curvature", "torsion"):
        found, wanted = rate(what), getattr(here, f"{what}_rate")
        assert np.abs(found - wanted).max() < 1e-4 * np.abs(wanted).max() + 1e-7
    wanted = here.darboux_rate
    assert np.abs(rate("darboux") - wanted).max() < 1e-4 * np.abs(wanted).max() + 1e-7
    np.testing.assert_allclose(here.speed, 1.0, atol=1e-13)


@pytest.mark.parametrize("name", CURVES)
def test_curvature_and_torsion_do_not_depend_on_the_parameter_and_turn_with_the_frame(name):
    own = CURVES[name]
    by_length = arc_length(own)
    s = np.linspace(0.03, 0.97, 20) * by_length.length
    u = by_length.measure.parameter(s)
    one, other = frenet_serret(own, u), frenet_serret(by_length, s)
    np.testing.assert_allclose(one.frame, other.frame, atol=1e-11)
    for what in ("curvature", "torsion", "curvature_rate", "torsion_rate"):
        values = getattr(one, what)
        size = np.abs(values).max()
        np.testing.assert_allclose(getattr(other, what), values, atol=1e-9 * size + 1e-9)


def test_a_straight_curve_has_a_frame_without_turn():
    for end in ([1.0, 0.0, 0.0], [1.0, 2.0, 3.0], [0.0, 0.0, -1.0]):
        frenet = frenet_serret(line([0.0, 0.0, 0.0], end), [0.0, 0.5, 1.0])
        as_pose(pose_from_matrix(frenet.frame, [0.0, 0.0, 0.0]))
        assert (frenet.frame == frenet.frame[0]).all()
        np.testing.assert_allclose(frenet.frame[0, :, 0], end / np.linalg.norm(end), atol=1e-15)
        for what in ("curvature", "torsion", "curvature_rate", "torsion_rate", "darboux"):
            assert not getattr(frenet, what).any()


def test_straight_pieces_keep_the_normal_from_before_and_take_the_first_one_from_after():
    curve = blended_polyline([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]], radius=0.1)
    first, second = curve.breaks[1:3]
    frenet = frenet_serret(curve, [0.0, 0.5 * first, second + 0.1, curve.breaks[-1]])
    np.testing.assert_allclose(frenet.frame[0, :, 1], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(frenet.frame[1, :, 1], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(frenet.frame[2, :, 1], [-1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(frenet.frame[3, :, 1], [0, -1, 0], atol=1e-12)


def cubic(u):
    zero, one = np.zeros_like(u), np.ones_like(u)
    rows = [(u, u**3, zero), (one, 3 * u**2, zero), (zero, 6 * u, zero), (zero, 6 * one, zero)]
    return [np.stack(row, axis=1) for row in (*rows, (zero, zero, zero))]


def test_at_an_inflection_the_frame_is_the_one_from_before():
    curve = FunctionCurve(cubic, [-1.0, 1.0])
    frenet = frenet_serret(curve, [-1e-3, 0.0, 1e-3])
    np.testing.assert_allclose(frenet.frame[0, :, 1], [0, -1, 0], atol=1e-5)
    np.testing.assert_allclose(frenet.frame[1, :, 1], [0, -1, 0], atol=1e-8)
    np.testing.assert_allclose(frenet.frame[2, :, 1], [0, 1, 0], atol=1e-5)
    assert frenet.curvature[1] == 0.0
    starts_straight = frenet_serret(FunctionCurve(cubic, [0.0, 1.0]), 0.0)
    np.testing.assert_allclose(starts_straight.frame, np.eye(3), atol=1e-8)


def twisted(u):
    zero, one = np.zeros_like(u), np.ones_like(u)
    rows = [(u, u**3, u**4), (one, 3 * u**2, 4 * u**3), (zero, 6 * u, 12 * u**2)]
    rows += [(zero, 6 * one, 24 * u), (zero, zero, 24 * one)]
    return [np.stack(row, axis=1) for row in rows]


def test_at_an_inflection_of_a_twisted_curve_the_frame_is_the_limit_from_before():
    curve = FunctionCurve(twisted, [-1.0, 1.0])
    frenet = frenet_serret(curve, [-0.01, 0.0])
    # The normal turns by twice the parameter about x: -y at the inflection.
    assert abs(frenet.frame[0, 2, 1]) > 0.01
    np.testing.assert_allclose(frenet.frame[1, :, 1], [0, -1, 0], atol=1e-6)


def test_one_parameter_gives_arrays_without_an_axis_for_many():
    frenet = frenet_serret(viviani(1.0), 0.3)
    assert frenet.frame.shape == (3, 3) and frenet.darboux.shape == (3,)
    assert frenet.curvature.shape == ()


@pytest.mark.parametrize(
    ("u", "error", "text"),
    [
        (np.nan, NonFiniteError, "parameter is nan"),
        ([0.1, 13.0], BadValueError, r"parameter\[1\] is 13.0, expected from 0 to 12.566"),
        (np.zeros((2, 2)), WrongSizeError, r"shape \(2, 2\)"),
        ("x", BadValueError, "real numbers"),
    ],
)
def test_wrong_parameters_are_named(u, error, text):
    with pytest.raises(error, match=text):
        frenet_serret(viviani(1.0), u)


def test_what_is_no_curve_is_refused():
    with pytest.raises(BadValueError, match="curve is 3, expected a curve"):
        frenet_serret(3, 0.0)
