"""Angles of directions and angles modulo a turn, against the standard library."""

import math

import numba
import numpy as np
import pytest

from robomech_ros._kernels.algebra.angles import angle_of, wrapped


@numba.njit
def angles_of(sines, cosines, angles):
    for i in range(len(angles)):
        angles[i] = angle_of(sines[i], cosines[i])


@numba.njit
def all_wrapped(angles, out):
    for i in range(len(out)):
        out[i] = wrapped(angles[i])


def of(sines, cosines):
    sines, cosines = np.asarray(sines, float), np.asarray(cosines, float)
    angles = np.empty(len(sines))
    angles_of(sines, cosines, angles)
    return angles


def test_angles_are_those_of_atan2_to_two_units_in_the_last_place():
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(2, 100_000)) * 10.0 ** rng.uniform(-12, 12, (2, 100_000))
    wanted = np.arctan2(*directions)
    assert np.all(np.abs(of(*directions) - wanted) <= 2.0 * np.spacing(np.abs(wanted)))


@pytest.mark.parametrize("turn", np.arange(-8, 9) * math.pi / 8)
def test_angles_near_multiples_of_an_eighth_of_a_turn(turn):
    angles = turn + np.linspace(-1e-7, 1e-7, 101)
    sines, cosines = np.sin(angles), np.cos(angles)
    wanted = np.arctan2(sines, cosines)
    assert np.all(np.abs(of(sines, cosines) - wanted) <= 2.0 * np.spacing(np.abs(wanted)))


@pytest.mark.parametrize(
    ("sine", "cosine"),
    [(0.0, 1.0), (-0.0, 1.0), (0.0, -1.0), (-0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 0.0)]
    + [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0), (5e-324, -1.0), (1e300, 1e-300)],
)
def test_angles_of_special_directions_are_exact(sine, cosine):
    (angle,) = of([sine], [cosine])
    assert angle == math.atan2(sine, cosine)
    assert math.copysign(1.0, angle) == math.copysign(1.0, sine)


def test_wrapped_angles_are_in_the_half_open_turn_and_the_same():
    turns = np.array([0.0, math.pi, np.nextafter(math.pi, 0.0), -3.0, 1e-300])
    angles = np.concatenate([turns + 2.0 * math.pi * k for k in range(-40, 41)])
    angles = np.concatenate((angles, np.random.default_rng(1).uniform(-100.0, 100.0, 10_000)))
    out = np.empty(len(angles))
    all_wrapped(angles, out)
    assert np.all((out > -math.pi) & (out <= math.pi))
    turned = (angles - out) / (2.0 * math.pi)
    assert np.abs(turned - np.round(turned)).max() < 1e-14
    inside = (angles > -math.pi) & (angles <= math.pi)
    assert np.array_equal(out[inside], angles[inside])


def test_half_a_turn_backwards_is_half_a_turn_forwards():
    out = np.empty(3)
    all_wrapped(np.array([-math.pi, math.pi, -3.0 * math.pi]), out)
    assert out.tolist() == [math.pi] * 3
