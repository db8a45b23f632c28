"""Pose paths: twists against differences, path coordinate, stops, lists of poses, bad input."""

import math

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.spatial import (
    axial_vector,
    matrix_from_axis_angle,
    matrix_from_rotation_vector,
    pose_from_matrix,
)
from robomech_ros.trajectory import (
    arc_length,
    arc_path,
    blended_polyline,
    constant_orientation,
    frenet_orientation,
    frenet_serret,
    geodesic_orientation,
    helix,
    line,
    orientation_spline,
    pose_path,
    spline_curve,
    spline_path,
    straight_path,
    viviani,
)


def random_poses(seed, count, turn=1.0, move=0.3):
    rng = np.random.default_rng(seed)
    poses = [pose_from_matrix(matrix_from_rotation_vector(rng.normal(size=3)), rng.normal(size=3))]
    for _ in range(count - 1):
        axis = rng.normal(size=3)
        step = matrix_from_rotation_vector(turn * axis / np.linalg.norm(axis))
        place = poses[-1][:3, 3] + move * rng.normal(size=3)
        poses.append(pose_from_matrix(poses[-1][:3, :3] @ step, place))
    return np.array(poses)


POSES = random_poses(4, 7)
ON_THE_SPOT = POSES.copy()
ON_THE_SPOT[:, :3, 3] = [1.0, 2.0, 3.0]
PAUSING = POSES.copy()
PAUSING[3, :3, 3] = PAUSING[2, :3, 3]
SLIDING = POSES.copy()
SLIDING[:, :3, :3] = POSES[0, :3, :3]
PAIRS = [(POSES[1], POSES[2]), (POSES[3], POSES[4])]
SEAM = viviani(0.3)
SPLINE = spline_curve(POSES[:, :3, 3])
PATHS = {
    "straight": straight_path(POSES),
    "straight, on the spot": straight_path(ON_THE_SPOT),
    "straight, without turn": straight_path(SLIDING),
    "spline": spline_path(POSES),
    "spline, on the spot": spline_path(ON_THE_SPOT),
    "spline, pausing": spline_path(PAUSING, radius=0.3),
    "spline, without turn": spline_path(SLIDING),
    "arcs": arc_path(POSES[0], PAIRS),
    "frenet": pose_path(SEAM, frenet_orientation(SEAM, POSES[1, :3, :3])),
    "curve and orientation spline": pose_path(
        SPLINE, orientation_spline(POSES[:, :3, :3], SPLINE.breaks)
    ),
    "curve and geodesic": pose_path(
        helix(0.2, 0.1, 4.0), geodesic_orientation(POSES[:3, :3, :3], [-1.0, 1.5, 4.0])
    ),
}


@pytest.mark.parametrize("name", PATHS)
def test_twist_and_rate_are_the_derivatives_of_the_pose(name):
    path = PATHS[name]
    h = 1e-6 * path.length
    s = np.linspace(0.0, path.length, 120)[1:-1]
    s = s[np.abs(s[:, None] - path.breaks).min(axis=1) > 2.0 * h]
    here, after, before = (path.sample(s + d) for d in (0.0, h, -h))
    change = (after.pose - before.pose) / (2.0 * h)
    omega = axial_vector(change[:, :3, :3] @ np.swapaxes(here.pose[:, :3, :3], -1, -2))
    found = np.concatenate([omega, change[:, :3, 3]], axis=1)
    size = np.abs(here.twist).max()
    np.testing.assert_allclose(here.twist, found, atol=1e-6 * size)
    rate = (after.twist - before.twist) / (2.0 * h)
    size = np.abs(here.twist_rate).max() + np.abs(here.twist).max()
    np.testing.assert_allclose(here.twist_rate, rate, atol=1e-5 * size)


@pytest.mark.parametrize("name", PATHS)
def test_the_coordinate_counts_lengths_and_turns(name):
    path = PATHS[name]
    twist = path.sample(np.linspace(0.0, path.length, 101)).twist
    unit = np.sum(twist[:, 3:] ** 2, axis=1) + path.radius**2 * np.sum(twist[:, :3] ** 2, axis=1)
    np.testing.assert_allclose(unit, 1.0, rtol=1e-12)


def test_the_twist_of_a_frenet_path_is_the_darboux_vector_and_the_tangent():
    path = PATHS["frenet"]
    curve = arc_length(SEAM)
    assert path.length == curve.length
    s = np.linspace(0.0, path.length, 50)
    frenet, found = frenet_serret(curve, s), path.sample(s)
    np.testing.assert_allclose(found.twist[:, :3], frenet.darboux, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(found.twist[:, 3:], frenet.frame[:, :, 0], atol=1e-13)
    size = np.abs(frenet.darboux_rate).max()
    np.testing.assert_allclose(found.twist_rate[:, :3], frenet.darboux_rate, atol=1e-11 * size)
    normal = frenet.curvature[:, None] * frenet.frame[:, :, 1]
    np.testing.assert_allclose(found.twist_rate[:, 3:], normal, atol=1e-11)
    offset = POSES[1, :3, :3]
    np.testing.assert_allclose(found.pose[:, :3, :3], frenet.frame @ offset, atol=1e-13)


@pytest.mark.parametrize("poses", [POSES, ON_THE_SPOT, PAUSING, SLIDING])
def test_paths_pass_their_poses(poses):
    for path in (straight_path(poses), spline_path(poses)):
        np.testing.assert_allclose(path.sample(path.breaks).pose, poses, atol=1e-12)
        inner = path.breaks[1:-1]
        before = path.sample(np.nextafter(inner, 0.0)).pose
        np.testing.assert_allclose(before, poses[1:-1], atol=1e-12)


def test_a_straight_path_moves_on_lines_about_fixed_axes_and_stops_at_the_corners():
    path = PATHS["straight"]
    np.testing.assert_array_equal(path.stops, path.breaks[1:-1])
    for k in range(len(POSES) - 1):
        s = np.linspace(path.breaks[k], path.breaks[k + 1], 9)[:-1]
        found = path.sample(s)
        np.testing.assert_allclose(found.twist, np.tile(found.twist[:1], (8, 1)), atol=1e-11)
        np.testing.assert_allclose(found.twist_rate, 0.0, atol=1e-10)
        way = POSES[k + 1, :3, 3] - POSES[k, :3, 3]
        assert np.linalg.norm(np.cross(found.pose[:, :3, 3] - POSES[k, :3, 3], way)) < 1e-14
        length = math.hypot(np.linalg.norm(way), 0.1 * 1.0)
        assert path.breaks[k + 1] - path.breaks[k] == pytest.approx(length, rel=1e-12)


def test_a_pose_on_the_way_is_no_stop():
    turn = matrix_from_rotation_vector([0.0, 0.0, 0.4])
    first = pose_from_matrix(np.eye(3), [0.0, 0.0, 0.0])
    middle = pose_from_matrix(turn, [0.3, 0.0, 0.0])
    last = pose_from_matrix(turn @ turn, [0.6, 0.0, 0.0])
    assert not len(straight_path([first, middle, last]).stops)
    last[0, 3] = 0.7
    assert len(straight_path([first, middle, last]).stops) == 1


def test_a_turn_on_the_spot_is_as_long_as_its_angle_at_the_radius():
    start = np.eye(4)
    end = pose_from_matrix(matrix_from_axis_angle([1, 1, 0], 1.2), [0, 0, 0])
    for radius in (0.1, 2.0):
        path = straight_path([start, end], radius=radius)
        assert path.length == pytest.approx(1.2 * radius, rel=1e-14)
        twist = path.sample(0.3 * path.length).twist
        np.testing.assert_allclose(twist, np.array([1, 1, 0, 0, 0, 0]) / math.sqrt(2) / radius)


@pytest.mark.parametrize("name", ["spline", "spline, on the spot", "spline, pausing"])
def test_a_spline_path_is_c2(name):
    path = PATHS[name]
    assert not len(path.stops)
    inner = path.breaks[1:-1]
    before, after = path.sample(np.nextafter(inner, 0.0)), path.sample(inner)
    np.testing.assert_allclose(before.twist, after.twist, rtol=1e-9, atol=1e-10)
    size = np.abs(after.twist_rate).max()
    np.testing.assert_allclose(before.twist_rate, after.twist_rate, atol=1e-9 * size)


def test_arcs_pass_all_poses_and_stop_where_they_bend():
    path = PATHS["arcs"]
    np.testing.assert_allclose(path.sample(path.breaks).pose, POSES[:5], atol=1e-12)
    np.testing.assert_array_equal(path.stops, path.breaks[2:3])
    for first in (0, 2):
        s = np.linspace(path.breaks[first], path.breaks[first + 2], 30)
        points = path.sample(s).pose[:, :3, 3]
        spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
        assert spread[2] < 1e-12 * spread[0]
    circle = [
        pose_from_matrix(matrix_from_axis_angle([0, 0, 1], a), [math.cos(a), math.sin(a), 0])
        for a in (0.0, 0.8, 1.6, 2.4, 3.2)
    ]
    smooth = arc_path(circle[0], [(circle[1], circle[2]), (circle[3], circle[4])])
    assert not len(smooth.stops)
    assert smooth.length == pytest.approx(3.2 * math.hypot(1.0, 0.1), rel=1e-12)


def test_paths_do_not_depend_on_the_base_frame():
    base = random_poses(9, 1)[0]
    for make in (straight_path, spline_path, lambda p: arc_path(p[0], [(p[1], p[2])])):
        one, other = make(POSES), make(base @ POSES)
        assert one.length == pytest.approx(other.length, rel=1e-12)
        s = np.linspace(0.0, 0.999 * one.length, 30)
        first, second = one.sample(s), other.sample(s)
        np.testing.assert_allclose(base @ first.pose, second.pose, atol=1e-10)
        for half in (slice(0, 3), slice(3, 6)):
            turned = first.twist[:, half] @ base[:3, :3].T
            np.testing.assert_allclose(turned, second.twist[:, half], atol=1e-7)


def test_a_blend_with_arcs_of_a_constant_orientation_does_not_stop_but_one_by_its_frame_does():
    curve = blended_polyline([[0, 0, 0], [1, 0, 0], [1, 1, 0]], radius=0.2)
    assert not len(pose_path(curve, constant_orientation(np.eye(3))).stops)
    np.testing.assert_allclose(
        pose_path(curve, frenet_orientation(curve)).stops, arc_length(curve).breaks[1:3]
    )
    smooth = blended_polyline([[0, 0, 0], [1, 0, 0], [1, 1, 0]], radius=0.2, blend="quintic")
    assert not len(pose_path(smooth, frenet_orientation(smooth)).stops)


def test_one_coordinate_gives_one_pose():
    pose, twist, rate = PATHS["spline"].sample(0.2)
    assert pose.shape == (4, 4) and twist.shape == (6,) and rate.shape == (6,)


TURN = geodesic_orientation([np.eye(3), POSES[0, :3, :3]], [0.0, 0.5])
BAD_POSE = np.diag([1.0, 1.0, 2.0, 1.0])
OPPOSITE = pose_from_matrix(matrix_from_axis_angle([1, 0, 0], math.pi), [1, 0, 0])
NAN = POSES.copy()
NAN[2, 0, 3] = np.nan
FAR = POSES.copy()
FAR[2, 0, 3] = 1e7
IN_LINE = [pose_from_matrix(np.eye(3), [x, 0, 0]) for x in (0, 1, 2)]
LISTS = {
    "one": (POSES[:1], WrongSizeError, r"poses has shape \(1, 4, 4\), expected .*at least 2"),
    "none": (np.empty((0, 4, 4)), WrongSizeError, "at least 2"),
    "NaN": (NAN, NonFiniteError, r"poses\[2, 0, 3\] is nan"),
    "no rotation": ([np.eye(4), BAD_POSE], BadValueError, "rotation of poses in row 1"),
    "equal": (POSES[[0, 1, 1]], BadValueError, r"poses\[2\] is .* other than poses\[1\]"),
    "opposite": ([np.eye(4), OPPOSITE], BadValueError, r"from poses\[0\] to poses\[1\] is 3.14159"),
    "far": (FAR, BadValueError, "position of poses is 10000000.0, expected coordinates of at most"),
    "text": ("x", BadValueError, "poses is 'x'"),
}


@pytest.mark.parametrize("name", LISTS)
@pytest.mark.parametrize("function", [straight_path, spline_path])
def test_bad_lists_of_poses_are_named(function, name):
    poses, error, text = LISTS[name]
    with pytest.raises(error, match=text):
        function(poses)


BAD = {
    "radius": (lambda: straight_path(POSES, radius=0.0), BadValueError, "radius is 0.0"),
    "pair": (lambda: arc_path(POSES[0], [POSES[1:2]]), WrongSizeError, r"pairs\[0\] has size 1"),
    "no pairs": (lambda: arc_path(POSES[0], []), BadValueError, "at least one pair"),
    "in line": (
        lambda: arc_path(IN_LINE[0], [IN_LINE[1:]]),
        BadValueError,
        "arc 0: points of the arc .*not on a line",
    ),
    "arc pose": (
        lambda: arc_path(POSES[0], [(POSES[1], BAD_POSE)]),
        BadValueError,
        r"rotation of pairs\[0\]\[1\]",
    ),
    "uncovered": (
        lambda: pose_path(line([0, 0, 0], [1, 0, 0]), TURN),
        BadValueError,
        r"range of the orientation is \(0.0, 0.5\), expected from 0 to 1",
    ),
    "no orientation": (
        lambda: pose_path(SEAM, np.eye(3)),
        BadValueError,
        "expected one with breaks and turning",
    ),
    "no curve": (lambda: pose_path(1, TURN), BadValueError, "curve is 1"),
    "negative": (
        lambda: pose_path(SEAM, constant_orientation(np.eye(3)), radius=-1.0),
        BadValueError,
        "radius is -1.0, expected at least 0",
    ),
    "off": (lambda: PATHS["spline"].sample(99.0), BadValueError, "s is 99.0, expected from 0 to"),
    "NaN": (lambda: PATHS["spline"].sample([0, np.nan]), NonFiniteError, r"s\[1\] is nan"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_named(name):
    call, error, text = BAD[name]
    with pytest.raises(error, match=text):
        call()


def test_a_path_that_stands_needs_a_radius():
    spot = PATHS["straight, on the spot"]
    with pytest.raises(BadValueError, match="radius above 0 for a path that turns on the spot"):
        pose_path(spot.curve, spot.orientation)
