"""Orientations along a path: geodesics, Frenet frames, splines, and their rates."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.spatial.transform import Rotation, RotationSpline

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.spatial import (
    axial_vector,
    axis_angle_from_matrix,
    matrix_from_axis_angle,
    matrix_from_rotation_vector,
)
from robomech_ros.trajectory import (
    blended_polyline,
    constant_orientation,
    frenet_orientation,
    geodesic_orientation,
    helix,
    orientation_spline,
    spline_curve,
    viviani,
)


def random_rotations(seed, count, largest):
    rng = np.random.default_rng(seed)
    rotations = [matrix_from_rotation_vector(rng.normal(size=3))]
    for _ in range(count - 1):
        turn = rng.normal(size=3)
        turn *= largest * rng.uniform(0.1, 1.0) / np.linalg.norm(turn)
        rotations.append(rotations[-1] @ matrix_from_rotation_vector(turn))
    return np.array(rotations), np.cumsum(rng.uniform(0.5, 2.0, count))


def assert_rates(orientation, ends=None, tolerance=1e-6):
    """Compare angular velocity and acceleration with differences, between the breaks."""
    breaks = orientation.breaks if ends is None else np.asarray(ends)
    h = 1e-5 * (breaks[-1] - breaks[0])
    u = np.linspace(breaks[0], breaks[-1], 90)[1:-1]
    u = u[np.abs(u[:, None] - breaks).min(axis=1) > 2.0 * h]
    here, after, before = (orientation.turning(u + d) for d in (0.0, h, -h))
    rate = (after.rotation - before.rotation) / (2.0 * h)
    omega = axial_vector(rate @ np.swapaxes(here.rotation, -1, -2))
    size = max(1.0, np.abs(here.velocity).max())
    np.testing.assert_allclose(here.velocity, omega, atol=tolerance * size)
    alpha = (after.velocity - before.velocity) / (2.0 * h)
    size = max(1.0, np.abs(here.acceleration).max())
    np.testing.assert_allclose(here.acceleration, alpha, atol=tolerance * size)


def test_a_geodesic_turns_about_a_fixed_axis_in_step_with_the_parameter():
    rotations, knots = random_rotations(1, 4, 3.1)
    orientation = geodesic_orientation(rotations, knots)
    np.testing.assert_allclose(orientation.turning(knots).rotation, rotations, atol=1e-14)
    for k in range(3):
        axis, angle = axis_angle_from_matrix(rotations[k].T @ rotations[k + 1])
        parts = np.array([0.1, 0.5, 0.9])
        found = orientation.turning(knots[k] + parts * (knots[k + 1] - knots[k]))
        wanted = rotations[k] @ matrix_from_axis_angle(np.tile(axis, (3, 1)), parts * angle)
        np.testing.assert_allclose(found.rotation, wanted, atol=1e-14)
        rate = rotations[k] @ axis * angle / (knots[k + 1] - knots[k])
        np.testing.assert_allclose(found.velocity, np.tile(rate, (3, 1)), atol=1e-13)
        np.testing.assert_allclose(found.acceleration, 0.0, atol=1e-13)
    assert_rates(orientation)


@pytest.mark.parametrize("largest", [0.01, 0.5, 1.5, 2.8])
@pytest.mark.parametrize("count", [2, 3, 5, 40])
def test_the_spline_passes_its_knots_and_is_c2(count, largest):
    rotations, knots = random_rotations(count, count, largest)
    spline = orientation_spline(rotations, knots)
    np.testing.assert_allclose(spline.turning(knots).rotation, rotations, atol=1e-13)
    inner = knots[1:-1]
    before, after = spline.turning(np.nextafter(inner, 0.0)), spline.turning(inner)
    for left, right in zip(before, after, strict=True):
        size = max(1.0, np.abs(right).max(initial=0.0))
        np.testing.assert_allclose(left, right, atol=1e-11 * size)
    np.testing.assert_allclose(spline.turning(knots[[0, -1]]).acceleration, 0.0, atol=1e-11)
    assert_rates(spline, tolerance=3e-6)


def test_turns_of_nearly_pi_at_uneven_knots_have_a_spline_as_well():
    rng = np.random.default_rng(0)
    for largest in (2.5, 3.1, 3.14):
        for _ in range(20):
            count = rng.integers(2, 30)
            turns = rng.normal(size=(count, 3))
            turns *= largest / np.linalg.norm(turns, axis=1, keepdims=True)
            rotations = [np.eye(3)]
            for turn in turns:
                rotations.append(rotations[-1] @ matrix_from_rotation_vector(turn))
            knots = np.cumsum(rng.uniform(0.1, 2.0, count + 1))
            spline = orientation_spline(rotations, knots)
            before = spline.turning(np.nextafter(knots[1:-1], 0.0)).acceleration
            after = spline.turning(knots[1:-1]).acceleration
            size = max(1.0, np.abs(after).max(initial=0.0))
            np.testing.assert_allclose(before, after, atol=1e-10 * size)


def test_a_periodic_spline_closes_smoothly():
    rotations, knots = random_rotations(7, 8, 1.2)
    rotations[-1] = rotations[0]
    spline = orientation_spline(rotations, knots, ends="periodic")
    first, last = zip(*spline.turning(knots[[0, -1]]), strict=True)
    for one, other in zip(first, last, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-12)
    inner = knots[1:-1]
    before, after = spline.turning(np.nextafter(inner, 0.0)), spline.turning(inner)
    np.testing.assert_allclose(before.acceleration, after.acceleration, atol=1e-11)


def test_the_clamped_spline_has_the_given_rates_and_equals_scipys_with_its_own():
    rotations, knots = random_rotations(3, 6, 1.5)
    rates = np.array([[0.1, -0.2, 0.3], [0.4, 0.0, -1.0]])
    spline = orientation_spline(rotations, knots, ends="clamped", end_rates=rates)
    np.testing.assert_allclose(spline.turning(knots[[0, -1]]).velocity, rates, atol=1e-13)
    peer = RotationSpline(knots, Rotation.from_matrix(rotations))
    # scipy tells angular velocities in the turned frame.
    own = np.stack([rotations[k] @ peer(knots[k], 1) for k in (0, -1)])
    spline = orientation_spline(rotations, knots, ends="clamped", end_rates=own)
    u = np.linspace(knots[0], knots[-1], 100)
    np.testing.assert_allclose(spline.turning(u).rotation, peer(u).as_matrix(), atol=1e-8)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from(["natural", "clamped", "periodic"]))
def test_the_spline_depends_neither_on_the_base_frame_nor_on_the_tools(seed, ends):
    rotations, knots = random_rotations(seed, 6, 1.6)
    if ends == "periodic":
        rotations[-1] = rotations[0]
        angles = axis_angle_from_matrix(rotations[-2].T @ rotations[-1])[1]
        if angles > 2.5:
            return
    base, tool = random_rotations(seed + 1, 2, 3.0)[0]
    rates = np.random.default_rng(seed).normal(size=(2, 3))
    given = {"end_rates": rates} if ends == "clamped" else {}
    turned = {"end_rates": rates @ base.T} if ends == "clamped" else {}
    one = orientation_spline(rotations, knots, ends=ends, **given)
    other = orientation_spline(base @ rotations @ tool, knots, ends=ends, **turned)
    u = np.linspace(knots[0], knots[-1], 40)
    first, second = one.turning(u), other.turning(u)
    np.testing.assert_allclose(base @ first.rotation @ tool, second.rotation, atol=1e-11)
    np.testing.assert_allclose(first.velocity @ base.T, second.velocity, atol=1e-10)
    np.testing.assert_allclose(first.acceleration @ base.T, second.acceleration, atol=1e-9)


def test_about_a_fixed_axis_it_is_the_cubic_spline_of_the_angle():
    angles = np.array([0.0, 0.7, 0.2, 1.5, 1.6])
    knots = np.array([0.0, 1.0, 1.7, 3.0, 3.5])
    axis = np.array([1.0, -2.0, 0.5]) / np.linalg.norm([1.0, -2.0, 0.5])
    rotations = matrix_from_axis_angle(np.tile(axis, (5, 1)), angles)
    spline = orientation_spline(rotations, knots)
    curve = spline_curve(np.stack([angles, 0 * angles, knots], axis=1), knots=knots)
    u = np.linspace(0.0, 3.5, 60)
    wanted = curve.derivatives(u)[..., 0]
    found = spline.turning(u)
    np.testing.assert_allclose(found.velocity @ axis, wanted[1], atol=1e-12)
    np.testing.assert_allclose(found.acceleration @ axis, wanted[2], atol=1e-11)
    np.testing.assert_allclose(np.cross(found.velocity, axis), 0.0, atol=1e-12)


CURVES = {
    "viviani": viviani(0.4),
    "helix": helix(0.2, 0.1, 8.0),
    "planar, blended": blended_polyline([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], radius=0.3),
}


@pytest.mark.parametrize("name", CURVES)
def test_the_frenet_frame_carries_the_tool(name):
    curve = CURVES[name]
    offset = matrix_from_rotation_vector([0.3, 0.4, -1.0])
    orientation = frenet_orientation(curve, offset)
    assert_rates(orientation, tolerance=1e-5)
    u = np.linspace(*curve.breaks[[0, -1]], 30)
    tangent = curve.derivatives(u)[1]
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    x = orientation.turning(u).rotation @ offset.T[:, 0]
    np.testing.assert_allclose(x, tangent, atol=1e-13)


def test_a_constant_orientation_does_not_turn():
    rotation = matrix_from_rotation_vector([0.1, 0.2, 0.3])
    turning = constant_orientation(rotation).turning(np.array([0.0, 5.0]))
    assert (turning.rotation == rotation).all()
    assert not turning.velocity.any() and not turning.acceleration.any()


def test_a_frame_that_jumps_is_refused_with_place_and_angle():
    wave = spline_curve([[0, 0, 0], [1, 1, 0], [2, 0, 0], [3, 1, 0], [4, 0, 0]])
    with pytest.raises(BadValueError, match=r"parameter \S+ is 3.14159.*the frame jumps") as caught:
        frenet_orientation(wave)
    place = float(caught.value.what.split()[-1])
    assert abs(wave.derivatives(place)[2]).max() < 1e-6
    stairs = blended_polyline([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]], radius=0.2)
    with pytest.raises(BadValueError, match="is 1.57"):
        frenet_orientation(stairs)


HALF = matrix_from_axis_angle([1.0, 2.0, 3.0], math.pi)
STRETCHED = np.diag([1.0, 1.0, 1.1])
ROTATIONS, KNOTS = random_rotations(5, 4, 1.0)
BAD = {
    "opposite": (
        lambda f: f([np.eye(3), HALF], [0, 1]),
        BadValueError,
        r"rotations\[0\] to rotations\[1\] is 3.14159",
    ),
    "no rotation": (
        lambda f: f([np.eye(3), STRETCHED], [0, 1]),
        BadValueError,
        "rotations in row 1 is",
    ),
    "mirror": (
        lambda f: f([np.eye(3), -np.eye(3)], [0, 1]),
        BadValueError,
        "determinant not positive",
    ),
    "NaN": (
        lambda f: f([np.eye(3), np.eye(3) * np.nan], [0, 1]),
        NonFiniteError,
        r"rotations\[1, 0, 0\] is nan",
    ),
    "one": (lambda f: f([np.eye(3)], [0]), WrongSizeError, "n at least 2"),
    "knots": (lambda f: f(ROTATIONS, [0, 1]), WrongSizeError, "knots has size 2, expected 4"),
    "late": (lambda f: f(ROTATIONS, [0, 1, 1, 2]), BadValueError, r"knots\[2\] is 1.0"),
}


@pytest.mark.parametrize("name", BAD)
@pytest.mark.parametrize("function", [geodesic_orientation, orientation_spline])
def test_bad_input_is_named(function, name):
    call, error, text = BAD[name]
    with pytest.raises(error, match=text):
        call(function)


def test_bad_ends_of_a_spline_are_named():
    with pytest.raises(BadValueError, match=r"rotations\[0\] to rotations\[3\]"):
        orientation_spline(ROTATIONS, KNOTS, ends="periodic")
    with pytest.raises(BadValueError, match="end_rates is None"):
        orientation_spline(ROTATIONS, KNOTS, ends="clamped")
    with pytest.raises(BadValueError, match="since the ends are natural"):
        orientation_spline(ROTATIONS, KNOTS, end_rates=np.zeros((2, 3)))
    with pytest.raises(WrongSizeError, match=r"\(3,\), expected \(2, 3\)"):
        orientation_spline(ROTATIONS, KNOTS, ends="clamped", end_rates=np.zeros(3))
    with pytest.raises(WrongSizeError, match="offset has shape"):
        frenet_orientation(viviani(1.0), [np.eye(3)] * 2)
