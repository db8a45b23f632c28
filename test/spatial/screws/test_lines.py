"""Lines by their Pluecker coordinates."""

import numpy as np
import pytest
from scipy.optimize import minimize

from robomech_ros import spatial
from robomech_ros.errors import BadValueError

RNG = np.random.default_rng(1)
POINTS, DIRECTIONS = RNG.normal(size=(2, 2, 40, 3))
FIRST, SECOND = (spatial.line_through(*pair) for pair in zip(POINTS, DIRECTIONS, strict=True))


def test_the_common_normal_is_the_shortest_way():
    found = spatial.common_normal(FIRST, SECOND)
    for k in range(5):
        p, q = POINTS[:, k]
        e, f = FIRST[k, :3], SECOND[k, :3]
        best = minimize(
            lambda x, p=p, q=q, e=e, f=f: np.sum((p + x[0] * e - q - x[1] * f) ** 2), [0, 0]
        )
        assert found.distance[k] == pytest.approx(np.sqrt(best.fun), abs=1e-6)
    np.testing.assert_allclose(
        np.linalg.norm(found.second - found.first, axis=-1), found.distance, atol=1e-12
    )
    for line, foot in ((FIRST, found.first), (SECOND, found.second)):
        np.testing.assert_allclose(np.cross(foot, line[:, :3]), line[:, 3:], atol=1e-12)
    way = found.first + found.distance[:, None] * found.direction
    np.testing.assert_allclose(way, found.second, atol=1e-12)
    mutual = spatial.line_reciprocity(FIRST, SECOND)
    np.testing.assert_allclose(mutual, -found.distance * np.sin(found.angle), atol=1e-13)
    np.testing.assert_array_equal(spatial.line_distance(FIRST, SECOND), found.distance)
    assert not found.parallel.any()


def test_parallel_lines_have_a_distance_and_a_common_normal():
    x = spatial.line_through([0, 0, 0], [1, 0, 0])
    opposite = spatial.line_through([7, 3, 4], [-2, 0, 0])
    found = spatial.common_normal(x, opposite)
    assert found.parallel and float(found.distance) == 5.0
    assert found.first.tolist() == [0, 0, 0] and found.second.tolist() == [0, 3, 4]
    assert abs(float(found.angle)) == np.pi
    assert float(spatial.line_reciprocity(x, opposite)) == 0.0
    same = spatial.common_normal(x, x)
    assert float(same.distance) == 0.0 and same.direction @ x[:3] == 0.0
    assert np.isnan(spatial.line_intersection(x, opposite)).all()


def test_lines_through_one_point_meet_there_and_others_do_not():
    p = RNG.normal(size=(30, 3))
    one, two = (spatial.line_through(p, RNG.normal(size=(30, 3))) for _ in range(2))
    np.testing.assert_allclose(spatial.line_intersection(one, two), p, atol=1e-12)
    np.testing.assert_allclose(spatial.line_reciprocity(one, two), 0.0, atol=1e-14)
    assert np.isnan(spatial.line_intersection(FIRST, SECOND)).all()
    far = np.array([1e8, 2e8, -1e8])
    one, two = (spatial.line_through(far, e) for e in ([0.1, -0.1, 0.6], [0.1, -0.5, 0.4]))
    np.testing.assert_allclose(spatial.line_intersection(one, two), far, rtol=1e-12)


def test_lines_are_the_same_seen_from_every_point():
    points = spatial.line_nearest_point(FIRST)
    np.testing.assert_allclose(np.sum(points * FIRST[:, :3], -1), 0.0, atol=1e-14)
    np.testing.assert_allclose(
        spatial.line_through_points(POINTS[0], POINTS[0] + DIRECTIONS[0]), FIRST, atol=1e-14
    )
    moved = spatial.transfer_line(FIRST, [0, 0, 0], POINTS[0])
    np.testing.assert_allclose(moved[:, 3:], 0.0, atol=1e-14)
    np.testing.assert_allclose(
        spatial.transfer_line(moved, POINTS[0], [0, 0, 0]), FIRST, atol=1e-13
    )
    near = spatial.line_nearest_point(FIRST, POINTS[1])
    np.testing.assert_allclose(np.sum((near - POINTS[1]) * FIRST[:, :3], -1), 0.0, atol=1e-13)


def test_what_is_no_line_is_refused():
    with pytest.raises(BadValueError, match="right angles"):
        spatial.line_nearest_point([1, 0, 0, 1, 0, 0])
    with pytest.raises(BadValueError, match="two different points"):
        spatial.line_through_points([1, 2, 3], [1, 2, 3])
    with pytest.raises(BadValueError, match="direction is .* not zero"):
        spatial.line_through([1, 2, 3], [0, 0, 0])
