"""The eye: what it sees just fits."""

import numpy as np
import pytest

from robomech_ros.robots import load_description
from robomech_ros.rvs.model.bodies.visual_model import load_visual_model
from robomech_ros.rvs.model.camera import FIELD, fitted_camera, visible_points


def seen_at(eye, points, fov, aspect):
    """Return image coordinates of points, from -1 to 1 both ways, and their distance (m)."""
    into = eye.look_at - eye.position
    into = into / np.linalg.norm(into)
    side = np.cross(into, [0.0, 0.0, 1.0])
    side = side / np.linalg.norm(side)
    away = (points - eye.position) @ into
    half = np.tan(0.5 * fov)
    up = np.cross(side, into)
    return np.stack(
        [
            (points - eye.position) @ side / away / half / aspect,
            (points - eye.position) @ up / away / half,
        ]
    ), away


@pytest.mark.parametrize("aspect", [0.6, 1.0, 1.8])
def test_points_fill_the_picture_and_stay_in_it(aspect):
    rng = np.random.default_rng(0)
    for _ in range(20):
        points = rng.normal(size=(30, 3)) * rng.uniform(0.05, 5.0, 3) + rng.normal(size=3)
        back = rng.normal(size=3)
        eye = fitted_camera(points, fov=FIELD, aspect=aspect, backwards=back)
        places, away = seen_at(eye, points, FIELD, aspect)
        assert (away > 0.0).all()
        assert np.abs(places).max() < 0.9 + 1e-9
        # One direction is full, and in both the picture is in the middle.
        assert np.abs(places).max(axis=1).max() > 0.9 - 1e-9
        assert places[:, :].max() > 0.0 > places[:, :].min()


@pytest.mark.parametrize("name", ["ur5e", "puma560", "panda", "scara", "stanford"])
def test_robots_fill_a_picture(name):
    description = load_description(name)
    arm, seen = description.chain(), load_visual_model(description)
    at = dict(zip(arm.joint_names, arm.home().tolist(), strict=True))
    points = visible_points(seen, [at])
    eye = fitted_camera(points)
    places, _ = seen_at(eye, points, FIELD, 1.0)
    assert 0.89 < np.abs(places).max() < 0.91
    assert eye.position[2] > eye.look_at[2]


def test_from_above_and_of_a_single_point():
    eye = fitted_camera(np.zeros((1, 3)), backwards=np.array([0.0, 0.0, 1.0]))
    assert eye.position[2] > 0.0
    np.testing.assert_allclose(eye.position[:2], 0.0, atol=1e-12)
