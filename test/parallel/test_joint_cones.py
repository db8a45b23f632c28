"""Cones of the joints of legs: geometry, files, refusals."""

import numpy as np
import pytest

from robomech_ros.errors import RobomechError
from robomech_ros.parallel import StewartGough, load_parallel

HEXAPOD = load_parallel("hexapod")
POINTS = HEXAPOD.base_points, HEXAPOD.platform_points
DOCUMENT = """
kind: parallel
name: coned
source: a test
type: stewart_gough
base_points: {a}
platform_points: {b}
base_cones: {{axes: [0.0, 0.0, 2.0], angles: 0.8}}
platform_cones: {{axes: {axes}, angles: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]}}
"""


def pose():
    T = np.eye(4)
    c, s = np.cos(0.3), np.sin(0.3)
    T[:2, :2], T[:3, 3] = [[c, -s], [s, c]], [0.1, 0.05, 0.6]
    return T


def test_angles_of_legs_leave_their_cones_by_what_is_said():
    axes = np.tile([0.1, 0.0, -1.0], (6, 1))
    text = DOCUMENT.format(a=POINTS[0].tolist(), b=POINTS[1].tolist(), axes=axes.tolist())
    robot, T = load_parallel(text), pose()
    found = robot.cone_excess(np.stack((T, T)))
    assert found.shape == (2, 2, 6) and (found[0] == found[1]).all()
    for k in range(6):
        leg = T[:3, 3] + T[:3, :3] @ POINTS[1][k] - POINTS[0][k]
        leg /= np.linalg.norm(leg)
        base = np.arccos(leg[2]) - 0.8
        top = np.arccos(-leg @ T[:3, :3] @ (axes[k] / np.linalg.norm(axes[k]))) - 0.1 * (k + 1)
        assert found[0, 0, k] == pytest.approx(max(base, 0.0), abs=1e-12)
        assert found[0, 1, k] == pytest.approx(max(top, 0.0), abs=1e-12)
    assert found.any() and not found.all()


def test_without_cones_joints_bend_freely():
    whole = {"axes": [0, 0, 1], "angles": np.pi}
    assert not StewartGough(*POINTS, base_cones=whole).cone_excess(pose()).any()
    assert not StewartGough(*POINTS).cone_excess(pose()).any()


@pytest.mark.parametrize(
    ("cones", "said"),
    [
        (0.5, "a mapping with the keys 'axes' and 'angles'"),
        ({"axes": [0, 0, 1]}, "keys 'axes' and 'angles'"),
        ({"axes": [0, 0, 0], "angles": 0.5}, "directions, none of them zero"),
        ({"axes": [[0, 0, 1]] * 5, "angles": 0.5}, "axes has shape"),
        ({"axes": [0, 0, 1], "angles": 0.0}, "more than 0 rad, up to pi"),
        ({"axes": [0, 0, 1], "angles": 3.2}, "more than 0 rad, up to pi"),
        ({"axes": [0, 0, 1], "angles": [0.5] * 5}, "angles has shape"),
        ({"axes": [0, 0, np.nan], "angles": 0.5}, "nan"),
    ],
)
def test_cones_that_are_refused(cones, said):
    with pytest.raises(RobomechError, match=said):
        StewartGough(*POINTS, base_cones=cones)
