"""Crossings that somebody points at."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.numerics import CurvePair, bivariate

BOX = [[-3.0, 3.0], [-3.0, 3.0]]
BIG, SMALL = np.sqrt(2.0 + np.sqrt(3.0)), np.sqrt(2.0 - np.sqrt(3.0))


def circle_and_hyperbola(x, y):
    return [x**2 + y**2 - 4.0, x * y - 1.0]


def line(x, y):
    return [x - y - (BIG - SMALL)]


def test_an_estimate_is_refined_and_judged():
    pair = CurvePair(circle_and_hyperbola, BOX, others=line)
    root = pair.refine([BIG + 0.1, SMALL - 0.1])
    np.testing.assert_allclose(root.point, [BIG, SMALL], atol=1e-14)
    np.testing.assert_allclose(root.path[0], [BIG + 0.1, SMALL - 0.1])
    np.testing.assert_allclose(root.path[-1], root.point, atol=1e-12)
    assert root.left_over < 1e-14
    spurious = pair.refine([SMALL, BIG])
    assert spurious.left_over > 0.1
    # The gradients are (2 x, 2 y) and (y, x).
    assert root.angle == pytest.approx(np.arctan2(BIG**2 - SMALL**2, 2.0 * BIG * SMALL), abs=1e-8)


def test_all_are_those_of_bivariate():
    pair = CurvePair(circle_and_hyperbola, BOX, others=line)
    found = bivariate(lambda x, y: [*circle_and_hyperbola(x, y), *line(x, y)], BOX)
    ours = pair.all()
    np.testing.assert_allclose([one.point for one in ours], found.crossings, atol=1e-12)
    assert [one.left_over < 1e-9 for one in ours] == found.is_root.tolist()
    for ours_curve, theirs in zip(pair.curves(), found.curves, strict=True):
        assert len(ours_curve) == len(theirs)


def test_condition_counts_all_equations_in_parts_of_their_size():
    pair = CurvePair(lambda x, y: [x + 0.0 * y, 1e6 * (y + 0.0 * x)], BOX)
    crossing = pair.refine([0.5, 0.2])
    assert crossing.condition == pytest.approx(1.0, rel=1e-6)
    assert crossing.left_over == 0.0
    flat = CurvePair(lambda x, y: [x + 0.0 * y, x + 1e-3 * y], BOX)
    assert flat.refine([0.5, 0.2]).condition > 1e3


@pytest.mark.parametrize("width", [1e-4, 1.0, 1e6])
def test_the_scale_of_the_plane_means_nothing(width):
    pair = CurvePair(
        lambda x, y: [np.sin(x / width) - 0.3, np.cos(y / width) - 0.2 + x / width],
        [[0, 3 * width]] * 2,
    )
    crossing = pair.refine([0.4 * width, 1.5 * width])
    at = crossing.point / width
    assert np.abs([np.sin(at[0]) - 0.3, np.cos(at[1]) - 0.2 + at[0]]).max() < 1e-9


def test_a_period_brings_crossings_into_the_bounds():
    pair = CurvePair(lambda x, y: [np.sin(x - 3.0), np.cos(y)], period=2.0 * np.pi)
    crossing = pair.refine([-3.1, 1.5])
    np.testing.assert_allclose(crossing.point, [3.0, 0.5 * np.pi], atol=1e-12)
    np.testing.assert_allclose(crossing.path[-1], [3.0 - 2.0 * np.pi, 0.5 * np.pi], atol=1e-9)


def test_what_leads_nowhere_is_refused():
    pair = CurvePair(lambda x, y: [x**2 + y**2 - 1.0, y - 2.0 + 0.0 * x], BOX)
    with pytest.raises(BadValueError, match="near a crossing"):
        pair.refine([0.0, 1.5])
    with pytest.raises(BadValueError, match="x from -3 to 3, y from -3 to 3"):
        pair.refine([0.0, 4.0])
    with pytest.raises(WrongSizeError, match=r"\(2,\)"):
        pair.refine([0.0])
    with pytest.raises(NonFiniteError):
        pair.refine([0.0, np.nan])
    with pytest.raises(BadValueError):
        pair.refine("here")
    with pytest.raises(NonFiniteError, match="others"):
        CurvePair(circle_and_hyperbola, BOX, others=lambda x, y: [np.full_like(x, np.nan)])
    with pytest.raises(WrongSizeError, match="others"):
        CurvePair(circle_and_hyperbola, BOX, others=lambda x, y: x)
