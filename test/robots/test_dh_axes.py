"""Denavit-Hartenberg tables of lines: their chains have the joint axes that were given."""

from dataclasses import replace

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import chain_from_dh, dh_ambiguities, dh_from_axes, load_robot

KINDS = ("skew", "parallel", "opposed", "intersecting", "perpendicular", "coincident")


def chain_of(table):
    return chain_from_dh(
        table.a, table.b, table.alpha, table.theta, base=table.base, tool=table.tool
    )


def random_axes(rng, n):
    points, directions = rng.normal(size=(n, 3)), rng.normal(size=(n, 3))
    for i in range(1, n):
        kind = KINDS[rng.integers(len(KINDS))]
        if kind in ("parallel", "opposed", "coincident"):
            directions[i] = directions[i - 1] * (-2.0 if kind == "opposed" else 3.0)
        if kind in ("intersecting", "coincident"):
            points[i] = points[i - 1] + rng.normal() * directions[i - 1]
        if kind == "perpendicular":
            directions[i] = np.cross(directions[i - 1], rng.normal(size=3))
    return points, directions


def rotation_about(point, direction, angle):
    """Rodrigues' formula about a line that need not pass the origin."""
    e = direction / np.linalg.norm(direction)
    K = np.cross(np.eye(3), e)
    T = np.eye(4)
    T[:3, :3] = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K
    T[:3, 3] = point - T[:3, :3] @ point
    return T


def test_random_arms_move_about_the_lines_given():
    rng = np.random.default_rng(24)
    for _ in range(300):
        n = int(rng.integers(1, 8))
        points, directions = random_axes(rng, n)
        chain = chain_of(dh_from_axes(points, directions))
        q = rng.uniform(-np.pi, np.pi, n)
        expected = forward_kinematics(chain, np.zeros(n))
        for k in reversed(range(n)):
            expected = rotation_about(points[k], directions[k], q[k]) @ expected
        np.testing.assert_allclose(forward_kinematics(chain, q), expected, atol=1e-12)


def test_the_arm_of_the_book_with_parallel_and_crossing_axes():
    # Shoulder, elbow and wrist of an arm that stands upright.
    points = [[0, 0, 0], [0, 0, 0.4], [0, 0, 0.8], [0, 0.1, 1.1]]
    table = dh_from_axes(points, [[0, 0, 1], [0, 1, 0], [0, 1, 0], [0, 0, 2]])
    np.testing.assert_allclose(table.a, [0.0, 0.4, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(np.abs(table.alpha), [np.pi / 2, 0.0, np.pi / 2, 0.0], atol=1e-15)
    np.testing.assert_allclose(table.b[0], 0.4)
    assert np.array_equal(table.tool, np.eye(4))


def test_directions_of_any_length():
    long = dh_from_axes([[0, 0, 0], [1, 0, 0]], [[0, 0, 1e300], [0, 1e-300, 0]])
    short = dh_from_axes([[0, 0, 0], [1, 0, 0]], [[0, 0, 1], [0, 1, 0]])
    for name in ("a", "b", "alpha", "theta", "base"):
        np.testing.assert_array_equal(getattr(long, name), getattr(short, name))


@pytest.mark.parametrize(
    ("points", "directions", "kind", "text"),
    [
        ([[0, 0, 0]], [[0, 0, 0]], BadValueError, r"directions\[0\] is \[0.0, 0.0, 0.0\]"),
        ([[0, 0, 0]], [[0, 0, 1], [0, 0, 1]], WrongSizeError, r"directions has shape \(2, 3\)"),
        ([0, 0, 0], [[0, 0, 1]], WrongSizeError, r"points has shape \(3,\), expected \(n, 3\)"),
        ([], [], WrongSizeError, "points has shape"),
        ([[0, np.nan, 0]], [[0, 0, 1]], NonFiniteError, r"points\[0, 1\] is nan"),
        ([[0, 2e6, 0]], [[0, 0, 1]], BadValueError, "points is 2000000.0, expected at most 1e"),
        ("abc", [[0, 0, 1]], BadValueError, "points"),
    ],
)
def test_what_are_no_lines(points, directions, kind, text):
    with pytest.raises(kind, match=text):
        dh_from_axes(points, directions)


def test_ambiguities_are_free_parameters_and_there_are_no_others():
    """Changed as their reasons say, parameters give the same arm."""
    rng, seen = np.random.default_rng(25), set()
    for _ in range(200):
        n = int(rng.integers(2, 8))
        table = dh_from_axes(*random_axes(rng, n))
        q = rng.uniform(-np.pi, np.pi, n)
        expected = forward_kinematics(chain_of(table), q)
        a, b, alpha, theta = (np.array(x) for x in (table.a, table.b, table.alpha, table.theta))
        found = dh_ambiguities(table)
        assert [one.kind for one in found[:1] + found[-1:]] == ["first frame", "last frame"]
        for one in found[1:-1]:
            seen.add(one.kind)
            i = int(one.parameters[0].split("_")[1]) - 1
            way = np.cos(table.alpha[i])
            if one.kind == "meeting":
                alpha[i], theta[i], theta[i + 1] = -alpha[i], theta[i] + np.pi, theta[i + 1] - np.pi
            else:
                b[[i, i + 1]] += 0.3, -0.3 * way
                assert ("+" if way > 0.0 else "-") in one.reason
            if one.kind == "coincident":
                theta[[i, i + 1]] += 0.4, -0.4 * way
        chain = chain_from_dh(a, b, alpha, theta, base=table.base)
        np.testing.assert_allclose(forward_kinematics(chain, q), expected, atol=1e-12)
        free = {int(one.parameters[0].split("_")[1]) - 1 for one in found[1:-1]}
        skew = set(range(n - 1)) - free
        assert all(table.a[i] > 1e-9 and abs(np.sin(table.alpha[i])) > 1e-8 for i in skew)
    assert seen == {"parallel", "coincident", "meeting"}
    stanford = [one for one in dh_ambiguities(load_robot("stanford").dh) if one.kind == "prismatic"]
    assert stanford[0].parameters == ("a_2", "b_2", "a_3", "b_3")
    with pytest.raises(BadValueError, match="expected a DHTable"):
        dh_ambiguities(None)
    table = load_robot("puma560").dh
    with pytest.raises(NonFiniteError, match=r"alpha\[0\] is nan"):
        dh_ambiguities(replace(table, alpha=np.nan * table.alpha))
    with pytest.raises(WrongSizeError, match="b has shape"):
        dh_ambiguities(replace(table, b=table.b[:5]))
