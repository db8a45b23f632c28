"""Parallel robots in files, and what is refused of them and of arguments."""

import numpy as np
import pytest

from robomech_ros.errors import (
    BadValueError,
    NonFiniteError,
    RobomechError,
    RobotDescriptionError,
    UnknownRobotError,
    WrongSizeError,
)
from robomech_ros.parallel import (
    Delta,
    Planar3RPR,
    Spherical3RRR,
    StewartGough,
    list_parallel,
    load_parallel,
)
from robomech_ros.robots import list_robots

DELTA = """
kind: parallel
name: small
source: a test
type: delta
base_radius: 0.2
platform_radius: 0.05
arm: 0.3
forearm: 0.8
"""
POINTS = np.random.default_rng(1).normal(size=(2, 6, 3))


@pytest.mark.parametrize("name", list_parallel())
def test_every_robot_of_the_library_is_loaded(name):
    robot = load_parallel(name)
    assert robot.name == name and robot.family


def test_arms_and_parallel_robots_are_listed_apart():
    assert {"hexapod", "delta", "dietmaier", "agile_eye"} <= set(list_parallel())
    assert not set(list_parallel()) & set(list_robots())


def test_documents_from_paths_and_texts(tmp_path):
    path = tmp_path / "small.yaml"
    path.write_text(DELTA, encoding="utf-8")
    for given in (path, str(path), DELTA):
        robot = load_parallel(given)
        assert isinstance(robot, Delta) and robot.arm == 0.3 and robot.name == "small"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("kind: parallel", "kind: serial", "kind: 'serial', expected parallel"),
        ("type: delta", "type: gamma", "expected stewart_gough or delta or"),
        ("arm: 0.3\n", "", "missing key 'arm'"),
        ("arm: 0.3", "arm: -0.3", "arm is -0.3, expected a length above 0 m"),
        ("arm: 0.3", "arm: 0.3\nstrokes: [0, 1]", "unknown key 'strokes'"),
        ("arm: 0.3", "arm: long", "arm is 'long'"),
        ("source: a test", "source: ''", "expected a text"),
    ],
)
def test_documents_that_are_refused(old, new, said):
    with pytest.raises(RobotDescriptionError, match=said):
        load_parallel(DELTA.replace(old, new))


def test_a_name_that_is_not_known_lists_those_that_are():
    with pytest.raises(UnknownRobotError, match=r"did you mean 'hexapod'.*agile_eye"):
        load_parallel("hexapot")


@pytest.mark.parametrize("value", [None, 3.0, "", "  ", ["delta"]])
def test_what_is_no_name(value):
    with pytest.raises(BadValueError, match="robot"):
        load_parallel(value)


@pytest.mark.parametrize(
    ("base", "error", "said"),
    [
        (POINTS[0][:5], WrongSizeError, r"base_points has shape \(5, 3\), expected \(6, 3\)"),
        (np.zeros((6, 3)), BadValueError, "three different points or more, not 1"),
        (np.where(np.eye(6, 3) > 0, np.nan, 1.0), NonFiniteError, r"base_points\[0, 0\] is nan"),
        (1e9 * POINTS[0], BadValueError, "coordinates"),
        ("six", BadValueError, "base_points"),
    ],
)
def test_anchors_that_are_refused(base, error, said):
    with pytest.raises(error, match=said):
        StewartGough(base, POINTS[1])


@pytest.mark.parametrize(
    ("lengths", "said"),
    [
        ([1.0] * 5, "lengths has shape"),
        ([1.0, 1.0, np.nan, 1.0, 1.0, 1.0], r"lengths\[2\] is nan"),
        ([1.0, 1.0, 0.0, 1.0, 1.0, 1.0], "length of leg 3 is 0.0, expected more than 0 m"),
        ([1.0, 1.0, 1.0, 1.0, 1.0, 2.5], "length of leg 6 is 2.5, expected 0.5 to 2 m, the stroke"),
        (["a"] * 6, "lengths is"),
    ],
)
def test_lengths_that_are_refused(lengths, said):
    robot = StewartGough(*POINTS, strokes=[0.5, 2.0])
    for call in (robot.direct, lambda given: robot.follow(given, np.eye(4))):
        with pytest.raises(RobomechError, match=said):
            call(lengths)


def test_how_far_lengths_are_outside_their_strokes():
    robot = StewartGough(*POINTS, strokes=[0.5, 2.0])
    assert robot.excess([1.0, 0.3, 2.0, 2.25, 0.5, 1.0]).tolist() == pytest.approx(
        [0.0, -0.2, 0.0, 0.25, 0.0, 0.0]
    )
    assert not StewartGough(*POINTS).excess([0.1] * 6).any()


@pytest.mark.parametrize("strokes", [[2.0, 1.0], [-1.0, 1.0], [1.0], [[0.0, 1.0]] * 5])
def test_strokes_that_are_refused(strokes):
    with pytest.raises(RobomechError, match="strokes"):
        StewartGough(*POINTS, strokes=strokes)


def test_poses_that_a_robot_cannot_have():
    turned = np.eye(4)
    turned[:2, :2] = [[0.0, -1.0], [1.0, 0.0]]
    with pytest.raises(BadValueError, match="the platform only translates"):
        load_parallel("delta").inverse(turned)
    lifted = np.eye(4)
    lifted[2, 3] = 0.1
    with pytest.raises(BadValueError, match=r"from the plane z = 0 is 0\.1"):
        load_parallel("planar_3rpr").inverse(lifted)
    with pytest.raises(BadValueError, match="the platform only turns"):
        load_parallel("agile_eye").inverse(lifted)


def test_other_arguments_that_are_refused():
    corners = [[0, 0], [1, 0], [0, 1]]
    with pytest.raises(BadValueError, match="three different angles"):
        Delta(0.2, 0.05, 0.3, 0.8, azimuths=[0.0, 0.0, 2.0])
    with pytest.raises(BadValueError, match="length of leg 2 is 3.0.*1 m outside"):
        Planar3RPR(corners, corners, strokes=[0.0, 2.0]).direct([1.0, 3.0, 1.0])
    with pytest.raises(BadValueError, match="middle axis 1"):
        Spherical3RRR(np.eye(3), np.eye(3), np.eye(3))
    with pytest.raises(BadValueError, match="distal"):
        Spherical3RRR(np.eye(3), np.roll(np.eye(3), 1, axis=0), np.eye(3), distal=0.0)
    with pytest.raises(BadValueError, match="legs that are longer than 0 m"):
        StewartGough(*[POINTS[0]] * 2).jacobian(np.eye(4))
