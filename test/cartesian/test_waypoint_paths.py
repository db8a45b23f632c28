"""Paths through waypoints: where they go, and errors in the words of the caller."""

import numpy as np
import pytest

from robomech_ros.cartesian import waypoint_path
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError

HERE = np.eye(4)


def at(*places):
    poses = np.tile(np.eye(4), (len(places), 1, 1))
    poses[:, :3, 3] = places
    return poses


def test_straight_paths_go_from_the_start_through_all():
    path = waypoint_path(HERE, at([0.3, 0, 0], [0.3, 0.4, 0]))
    assert path.length == pytest.approx(0.7, rel=1e-12)
    np.testing.assert_allclose(path.breaks, [0.0, 0.3, 0.7], atol=1e-12)
    np.testing.assert_allclose(path.sample(0.5).pose[:3, 3], [0.3, 0.2, 0.0], atol=1e-12)


def test_waypoints_that_come_twice_count_once():
    path = waypoint_path(HERE, at([0, 0, 0], [0.3, 0, 0], [0.3, 0, 0], [0.3, 0.4, 0]))
    assert len(path.breaks) == 3
    assert waypoint_path(HERE, at([0, 0, 0], [0, 0, 0])) is None


def test_arcs_and_splines():
    arc = waypoint_path(HERE, at([0.1, 0.1, 0], [0.2, 0, 0]), "arc")
    assert arc.length == pytest.approx(0.1 * np.pi, rel=1e-6)
    spline = waypoint_path(HERE, at([0.1, 0.1, 0], [0.2, 0, 0]), "spline")
    assert not len(spline.stops) and 0.28 < spline.length < 0.4


@pytest.mark.parametrize(
    ("start", "waypoints", "kind", "error", "text"),
    [
        (HERE, [], "straight", WrongSizeError, "waypoints has size 0, expected at least one pose"),
        (HERE, HERE, "straight", WrongSizeError, r"waypoints .*\(m, 4, 4\)"),
        ([HERE], [HERE], "straight", WrongSizeError, r"start .*\(4, 4\)"),
        (HERE, at([np.nan, 0, 0]), "straight", NonFiniteError, "waypoints"),
        (HERE, np.zeros((1, 4, 4)), "straight", BadValueError, "waypoints"),
        (HERE, at([1, 0, 0]), "zigzag", BadValueError, "kind is 'zigzag', .*straight, spline, arc"),
        (HERE, at([1, 0, 0]), "arc", WrongSizeError, "pairs of poses"),
        (HERE, at([1, 0, 0], [2, 0, 0]), "arc", BadValueError, r"the start, waypoints\[0\]"),
        (HERE, at([0, 0, 0], [1, 1, 0]), "arc", BadValueError, r"waypoints\[0\] .*the start"),
        (
            HERE,
            at([0, 0, 0], [0.1, 0, 0], [0.05, 0, 0]),
            "spline",
            BadValueError,
            r"waypoints\[1\].*a straight path rests there",
        ),
    ],
)
def test_errors_name_the_waypoints(start, waypoints, kind, error, text):
    with pytest.raises(error, match=text):
        waypoint_path(start, waypoints, kind)


def test_opposite_orientations_are_named():
    turned = at([0.1, 0, 0]) @ np.diag([-1.0, -1.0, 1.0, 1.0])
    with pytest.raises(BadValueError, match=r"from the start to waypoints\[0\] is 3\.14159"):
        waypoint_path(HERE, turned)
