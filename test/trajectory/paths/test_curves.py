"""Curves: lines, arcs, splines and blends against closed forms and scipy, and bad input."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.interpolate import CubicSpline, make_interp_spline

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.trajectory import (
    FunctionCurve,
    arc_about,
    arc_length,
    arc_through,
    blended_polyline,
    cylinder_intersection,
    helix,
    join_curves,
    line,
    spline_curve,
    viviani,
)

COORDINATE = st.floats(-2.0, 2.0, width=32)
POINT = st.tuples(COORDINATE, COORDINATE, COORDINATE)


@settings(max_examples=60, deadline=None)
@given(POINT, POINT, POINT)
def test_an_arc_passes_its_three_points_in_order_at_one_distance_from_its_center(a, b, c):
    a, b, c = map(np.array, (a, b, c))
    normal = np.linalg.norm(np.cross(b - a, c - a))
    if normal < 1e-3:
        return
    arc = arc_through(a, b, c)
    ends = arc.derivatives(arc.breaks)[0]
    size = np.linalg.norm(arc.pose[:3, 3] - a)
    np.testing.assert_allclose(ends, [a, c], atol=1e-11 * max(1.0, size))
    u = np.linspace(*arc.breaks, 2001)
    points = arc.derivatives(u)[0]
    np.testing.assert_allclose(np.linalg.norm(points - arc.pose[:3, 3], axis=1), size, rtol=1e-12)
    nearest = np.linalg.norm(points - b, axis=1).min()
    assert nearest <= size * (u[1] - u[0])


def test_arcs_about_an_axis_go_either_way_and_more_than_once_round():
    for angle in (0.5, -0.5, 7.0):
        arc = arc_about([1, 1, 5], [0, 0, 2], [2, 1, 0], angle)
        points = arc.derivatives([0.0, abs(angle)])[0]
        np.testing.assert_allclose(points[0], [2, 1, 0], atol=1e-15)
        end = [1 + math.cos(angle), 1 + math.sin(angle), 0]
        np.testing.assert_allclose(points[1], end, atol=1e-14)
        assert arc_length(arc).length == pytest.approx(abs(angle))


def test_the_seam_of_two_pipes_lies_on_both():
    curve = cylinder_intersection(0.5, 0.2, offset=0.1)
    x, y, z = curve.derivatives(np.linspace(0.0, 2.0 * math.pi, 50))[0].T
    np.testing.assert_allclose(x**2 + y**2, 0.04, rtol=1e-13)
    np.testing.assert_allclose((y - 0.1) ** 2 + z**2, 0.25, rtol=1e-13)


def test_vivianis_curve_lies_on_its_cylinder_and_sphere():
    a = 0.3
    x, y, z = viviani(a).derivatives(np.linspace(0.0, 4.0 * math.pi, 50))[0].T
    np.testing.assert_allclose((x - a) ** 2 + y**2, a**2, rtol=1e-12)
    np.testing.assert_allclose(x**2 + y**2 + z**2, 4.0 * a**2, rtol=1e-12)


RNG = np.random.default_rng(2)
OPEN = RNG.normal(size=(8, 3))
CLOSED = np.concatenate([OPEN, OPEN[:1]])
RATES = RNG.normal(size=(2, 2, 3))
NONE = np.zeros(3)


@pytest.mark.parametrize("knots", ["chord", "centripetal", "given"])
@pytest.mark.parametrize("ends", ["natural", "clamped", "periodic"])
@pytest.mark.parametrize("degree", [3, 5])
def test_splines_equal_scipys(degree, ends, knots):
    points = CLOSED if ends == "periodic" else OPEN
    given = np.cumsum(RNG.uniform(0.5, 2.0, len(points))) if knots == "given" else knots
    rates = {"end_rates": RATES[0] if degree == 3 else RATES} if ends == "clamped" else {}
    curve = spline_curve(points, degree=degree, ends=ends, knots=given, **rates)
    u = np.linspace(curve.breaks[0], curve.breaks[-1], 301)
    if degree == 3:
        kinds = {"clamped": ((1, RATES[0, 0]), (1, RATES[0, 1]))}
        peer = CubicSpline(curve.breaks, points, bc_type=kinds.get(ends, ends))
        derivatives = [peer(u, k) for k in range(4)]
    else:
        kinds = {
            "natural": ([(3, NONE), (4, NONE)], [(3, NONE), (4, NONE)]),
            "clamped": tuple([(1, one[0]), (2, one[1])] for one in RATES),
            "periodic": "periodic",
        }
        peer = make_interp_spline(curve.breaks, points, 5, bc_type=kinds[ends])
        derivatives = [peer.derivative(k)(u) if k else peer(u) for k in range(5)]
    for k, wanted in enumerate(derivatives):
        found = curve.derivatives(u)[k]
        size = max(np.abs(wanted).max(), 1.0)
        away = np.abs(u[:, None] - curve.breaks).min(axis=1) > 1e-9 if k >= degree else slice(None)
        np.testing.assert_allclose(found[away], wanted[away], atol=1e-12 * size)


def test_a_periodic_spline_closes_smoothly_and_two_points_give_a_line():
    for degree, order in ((3, 2), (5, 4)):
        curve = spline_curve(CLOSED, degree=degree, ends="periodic")
        first, last = np.moveaxis(curve.derivatives(curve.breaks[[0, -1]]), 1, 0)
        for k in range(order + 1):
            np.testing.assert_allclose(last[k], first[k], rtol=1e-9, atol=1e-10)
    straight = spline_curve([[0, 0, 0], [3, 4, 0]])
    np.testing.assert_allclose(straight.derivatives(2.5)[:2], [[1.5, 2, 0], [0.6, 0.8, 0]])


CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1.2, 1, 0.3], [0, 2, 0], [0, 2.5, 1]], float)


@pytest.mark.parametrize("blend", ["circular", "parabolic", "quintic"])
def test_blends_have_the_radius_or_the_deviation_asked_for(blend):
    for size in (0.01, 0.05):
        curve = arc_length(blended_polyline(CORNERS, radius=size, blend=blend))
        s = np.linspace(0.0, curve.length, 40001)
        rows = curve.derivatives(s)
        curvature = np.linalg.norm(rows[2], axis=1)
        assert curvature.max() == pytest.approx(1.0 / size, rel=1e-3)
        # Each corner reaches it.
        for corner in CORNERS[1:-1]:
            near = np.linalg.norm(rows[0] - corner, axis=1) < 6.0 * size
            assert curvature[near].max() == pytest.approx(1.0 / size, rel=1e-2)
        curve = arc_length(blended_polyline(CORNERS, deviation=size, blend=blend))
        places = curve.derivatives(np.linspace(0.0, curve.length, 40001))[0]
        for corner in CORNERS[1:-1]:
            apart = np.linalg.norm(places - corner, axis=1).min()
            assert apart == pytest.approx(size, rel=1e-3)


@pytest.mark.parametrize(("blend", "order"), [("circular", 1), ("parabolic", 1), ("quintic", 2)])
def test_blends_are_as_smooth_as_said(blend, order):
    curve = arc_length(blended_polyline(CORNERS, radius=0.1, blend=blend))
    inner = curve.breaks[1:-1]
    before, after = curve.derivatives(np.nextafter(inner, 0.0)), curve.derivatives(inner)
    for k in range(order + 1):
        np.testing.assert_allclose(before[k], after[k], atol=1e-11)
    if order == 1:
        assert np.linalg.norm(before[2] - after[2], axis=1).min() > 1.0


def test_a_blend_takes_half_of_a_leg_at_most_and_straight_corners_need_none():
    curve = blended_polyline([[0, 0, 0], [1, 0, 0], [1, 1, 0], [3, 1, 0]], radius=50.0)
    points = curve.derivatives(curve.breaks)[0]
    np.testing.assert_allclose(
        points, [[0, 0, 0], [0.5, 0, 0], [1, 0.5, 0], [1.5, 1, 0], [3, 1, 0]]
    )
    straight = blended_polyline([[0, 0, 0], [1, 0, 0], [2, 0, 0]], deviation=0.1)
    assert len(straight.breaks) == 2
    assert arc_length(straight).length == 2.0


@pytest.mark.parametrize("blend", ["circular", "parabolic", "quintic"])
def test_every_angle_of_a_corner_keeps_the_least_radius(blend):
    for turn in np.linspace(0.05, 3.0, 12):
        corner = [[-100, 0, 0], [0, 0, 0], [100 * math.cos(turn), 100 * math.sin(turn), 0]]
        curve = arc_length(blended_polyline(corner, radius=0.1, blend=blend))
        low, high = curve.breaks[1:3]
        curvature = np.linalg.norm(curve.derivatives(np.linspace(low, high, 2001)[:-1])[2], axis=1)
        assert curvature.max() == pytest.approx(10.0, rel=1e-9)


def test_joined_curves_run_on():
    curve = join_curves([line([0, 0, 0], [1, 0, 0]), arc_through([1, 0, 0], [2, 1, 0], [1, 2, 0])])
    np.testing.assert_allclose(curve.breaks, [0.0, 1.0, 1.0 + math.pi])
    np.testing.assert_allclose(
        curve.derivatives([0.5, 1.0 + math.pi / 2])[0], [[0.5, 0, 0], [2, 1, 0]], atol=1e-15
    )
    nested = join_curves([curve, line([1, 2, 0], [0, 2, 0])])
    np.testing.assert_allclose(nested.breaks, [0.0, 1.0, 1.0 + math.pi, 2.0 + math.pi])


def three(u):
    return [np.zeros((len(u), 3))] * 3


def nan(u):
    return [np.full((len(u), 3), np.nan)] * 5


def flat(u):
    return [np.zeros(len(u))] * 5


LINE = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]
SAME = [[0, 0, 0], [1, 2, 3], [1, 2, 3]]
BAD = {
    "NaN in a line": (
        lambda: line([0, np.nan, 0], [1, 0, 0]),
        NonFiniteError,
        r"start\[1\] is nan",
    ),
    "no length": (
        lambda: line([1, 2, 3], [1, 2, 3]),
        BadValueError,
        r"\[1.0, 2.0, 3.0\], expected apart",
    ),
    "two coordinates": (lambda: line([1, 2], [1, 2, 3]), WrongSizeError, r"start has shape \(2,\)"),
    "collinear": (lambda: arc_through(*LINE), BadValueError, "expected three points not on a line"),
    "coincident": (
        lambda: arc_through(*SAME),
        BadValueError,
        r"points of the arc\[2\].*apart from",
    ),
    "closed arc": (
        lambda: arc_through([0, 0, 0], [1, 0, 0], [0, 0, 0]),
        BadValueError,
        "apart from",
    ),
    "no axis": (
        lambda: arc_about([0] * 3, [0] * 3, [1, 0, 0], 1.0),
        BadValueError,
        "axis is .*not zero",
    ),
    "on the axis": (
        lambda: arc_about([0] * 3, [0, 0, 1], [0, 0, 4], 1.0),
        BadValueError,
        "away from the axis",
    ),
    "no angle": (
        lambda: arc_about([0] * 3, [0, 0, 1], [1, 0, 4], 0.0),
        BadValueError,
        "angle is 0.0",
    ),
    "no radius": (
        lambda: helix(0.0, 1.0, 1.0),
        BadValueError,
        "radius is 0.0, expected a number above 0",
    ),
    "infinite": (lambda: helix(1.0, np.inf, 1.0), NonFiniteError, "rise is inf"),
    "no pose": (
        lambda: helix(1.0, 1.0, 1.0, pose=np.zeros((4, 4))),
        BadValueError,
        "last row of pose",
    ),
    "large pipe": (
        lambda: cylinder_intersection(1.0, 1.0),
        BadValueError,
        r"small \+ \|offset\| is 1.0",
    ),
    "far pipe": (lambda: cylinder_intersection(1.0, 0.5, offset=-0.6), BadValueError, "is 1.1"),
    "backwards": (lambda: viviani(1.0, start=2.0, end=1.0), BadValueError, "breaks.1. is 1.0"),
    "one point": (lambda: spline_curve([[0, 0, 0]]), WrongSizeError, r"points has shape \(1, 3\)"),
    "neighbours": (lambda: spline_curve(SAME), BadValueError, r"points\[2\] is \[1.0, 2.0, 3.0\]"),
    "not closed": (lambda: spline_curve(OPEN, ends="periodic"), BadValueError, r"points\[7\]"),
    "degree": (lambda: spline_curve(OPEN, degree=4), BadValueError, "degree is 4, expected 3 or 5"),
    "ends": (lambda: spline_curve(OPEN, ends="free"), BadValueError, "natural, clamped, periodic"),
    "no rates": (lambda: spline_curve(OPEN, ends="clamped"), BadValueError, "end_rates is None"),
    "rates": (
        lambda: spline_curve(OPEN, end_rates=RATES[0]),
        BadValueError,
        "since the ends are natural",
    ),
    "knots": (
        lambda: spline_curve(OPEN, knots=[0.0, 1.0]),
        WrongSizeError,
        "knots has size 2, expected 8",
    ),
    "late knot": (lambda: spline_curve(LINE, knots=[0, 2, 1]), BadValueError, r"knots\[2\] is 1.0"),
    "few": (lambda: spline_curve(OPEN[:2], degree=5), WrongSizeError, "k at least 3"),
    "knot rule": (lambda: spline_curve(OPEN, knots="even"), BadValueError, "chord, centripetal"),
    "both": (lambda: blended_polyline(OPEN, radius=1, deviation=1), BadValueError, "exactly one"),
    "neither": (lambda: blended_polyline(OPEN), BadValueError, "exactly one of the two"),
    "blend": (lambda: blended_polyline(OPEN, radius=1, blend="x"), BadValueError, "blend is 'x'"),
    "back": (
        lambda: blended_polyline([[0, 0, 0], [1, 0, 0], [0.5, 0, 0]], radius=0.1),
        BadValueError,
        r"points\[1\] is 3.14",
    ),
    "too far": (
        lambda: spline_curve([[0, 0, 0], [1e9, 0, 0]]),
        BadValueError,
        r"points\[1, 0\] is 1000000000.0, expected at most 1e\+06 m",
    ),
    "gap": (
        lambda: join_curves([line([0] * 3, [1, 0, 0]), line([2, 0, 0], [3, 0, 0])]),
        BadValueError,
        "gap between the curves 0 and 1 is 1.0",
    ),
    "no curves": (lambda: join_curves([]), BadValueError, "at least one curve"),
    "no curve": (lambda: join_curves([1]), BadValueError, r"curves\[0\] is 1"),
    "no function": (lambda: FunctionCurve(1, [0, 1]), BadValueError, "function is 1"),
    "three derivatives": (
        lambda: FunctionCurve(three, [0, 1]).derivatives(0.5),
        WrongSizeError,
        "size 3, expected 5",
    ),
    "NaN": (
        lambda: FunctionCurve(nan, [0, 1]).derivatives(0.5),
        NonFiniteError,
        "derivatives of the curve.0, 0, 0. is nan",
    ),
    "flat": (
        lambda: FunctionCurve(flat, [0, 1]).derivatives(0.5),
        WrongSizeError,
        "order 0 has shape",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_named(name):
    call, error, text = BAD[name]
    with pytest.raises(error, match=text):
        call()
