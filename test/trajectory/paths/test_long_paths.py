"""Paths through thousands of points: as exact as short ones, in time that grows as they do."""

from itertools import pairwise

import numpy as np
import pytest

from robomech_ros.spatial import matrix_from_rotation_vector
from robomech_ros.trajectory import (
    arc_length,
    arc_through,
    blended_polyline,
    join_curves,
    line,
    spline_path,
)

RNG = np.random.default_rng(5)


def walk(count):
    """Points some 50 mm from one to the next, never straight back."""
    steps = RNG.normal(size=(count, 3))
    steps /= np.linalg.norm(steps, axis=1)[:, None]
    return np.cumsum(0.03 * (steps + [1.2, 0.0, 0.0]), axis=0)


@pytest.mark.parametrize("blend", ["circular", "parabolic", "quintic"])
def test_ten_thousand_corners(blend):
    points = walk(10_000)
    curve = blended_polyline(points, radius=5e-5, blend=blend)
    assert len(curve.breaks) == 2 * len(points) - 2
    ends = curve.derivatives(curve.breaks[[0, -1]])[0]
    np.testing.assert_allclose(ends, points[[0, -1]], atol=1e-9)
    inner = curve.breaks[1:-1]
    before, after = curve.derivatives(np.nextafter(inner, 0.0)), curve.derivatives(inner)
    np.testing.assert_allclose(before[0], after[0], atol=1e-9)
    directions = [row[1] / np.linalg.norm(row[1], axis=1)[:, None] for row in (before, after)]
    np.testing.assert_allclose(*directions, atol=1e-6)  # some blends are a micrometre long
    enter, leave = curve.breaks[1:-2:2], curve.breaks[2:-1:2]
    cuts = np.linalg.norm(curve.derivatives(enter)[0] - points[1:-1], axis=1)
    apart = np.linalg.norm(curve.derivatives(0.5 * (enter + leave))[0] - points[1:-1], axis=1)
    assert (apart > 0.0).all() and (apart < cuts).all()
    if blend == "circular":
        np.testing.assert_allclose(apart, np.hypot(cuts, 5e-5) - 5e-5, rtol=1e-6, atol=1e-12)


def test_a_long_blended_polyline_is_the_joined_curve_of_its_parts():
    curve = blended_polyline([[0, 0, 0], [1, 0, 0], [1, 1, 0]], radius=0.25)
    half = 0.25 * np.sqrt(0.5)
    middle = [0.75 + half, 0.25 - half, 0.0]
    joined = join_curves(
        [
            line([0, 0, 0], [0.75, 0, 0]),
            arc_through([0.75, 0, 0], middle, [1, 0.25, 0]),
            line([1, 0.25, 0], [1, 1, 0]),
        ]
    )
    np.testing.assert_allclose(curve.breaks, joined.breaks, rtol=1e-15)
    instants = np.linspace(0.0, curve.breaks[-1], 501)[:-1]
    np.testing.assert_allclose(
        curve.derivatives(instants), joined.derivatives(instants), atol=1e-14
    )


def test_joined_curves_of_many_parts_answer_unsorted_parameters():
    points = walk(1_000)
    curve = join_curves([line(*pair) for pair in pairwise(points)])
    knots = RNG.permutation(len(points))
    np.testing.assert_allclose(curve.derivatives(curve.breaks[knots])[0], points[knots], atol=1e-9)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert arc_length(curve).length == pytest.approx(lengths.sum(), rel=1e-12)


def test_thousands_of_poses():
    poses = np.tile(np.eye(4), (4_000, 1, 1))
    poses[:, :3, 3] = walk(len(poses))
    turns = np.cumsum(0.02 * RNG.normal(size=(len(poses), 3)), axis=0)
    poses[:, :3, :3] = matrix_from_rotation_vector(turns)
    path = spline_path(poses)
    assert len(path.breaks) == len(poses) and not len(path.stops)
    np.testing.assert_allclose(path.sample(path.breaks).pose, poses, atol=1e-9)
