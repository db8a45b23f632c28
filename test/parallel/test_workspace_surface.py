"""Distances from the boundary of where a platform gets, by its facets."""

import numpy as np
import pytest

from robomech_ros.parallel import load_parallel, platform_position_workspace
from robomech_ros.parallel.kinetostatics.workspace import PlatformWorkspace
from robomech_ros.parallel.kinetostatics.workspace_surface import workspace_surface


def explored(rays, distances, causes):
    """A workspace about a point that ends at distances (k,) along rays (k, 3)."""
    centre = np.eye(4)
    centre[:3, 3] = 1.0, 2.0, 0.5
    return PlatformWorkspace(centre, False, rays, distances, np.array(causes))


def sphere_of_rays(count):
    rays = np.random.default_rng(0).normal(size=(count, 3))
    return rays / np.linalg.norm(rays, axis=1, keepdims=True)


def test_distance_from_a_sphere():
    rays = sphere_of_rays(2000)
    surface = workspace_surface(explored(rays, np.full(2000, 2.0), ["limb"] * 2000))
    points = surface.centre + np.linspace(0.0, 5.0, 26)[:, None] * sphere_of_rays(26)
    away = np.linalg.norm(points - surface.centre, axis=1)
    np.testing.assert_allclose(surface.distance(points), 2.0 - away, atol=0.04)
    assert surface.reach == pytest.approx(2.0)


def test_distance_from_a_square_in_the_plane():
    angles = np.arange(8) * np.pi / 4.0
    rays = np.stack((np.cos(angles), np.sin(angles), 0.0 * angles), axis=1)
    far = np.where(np.arange(8) % 2, np.sqrt(2.0), 1.0)
    surface = workspace_surface(explored(rays, far, ["limb"] * 8))
    points = surface.centre + [[0.0, 0.0, 0.0], [0.9, 0.2, 0.0], [3.0, 0.5, 0.0], [2.0, 2.0, 0.0]]
    expected = [1.0, 0.1, -2.0, -np.sqrt(2.0)]
    np.testing.assert_allclose(surface.distance(points), expected, atol=1e-12)


def test_distance_from_the_ends_of_a_line_and_in_a_tilted_plane():
    up = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    line = workspace_surface(explored(up, np.array([2.0, 1.0]), ["limb"] * 2))
    points = line.centre + np.array([[0.0], [1.5], [3.0], [-0.8], [-2.0]]) * up[0]
    np.testing.assert_allclose(line.distance(points), [1.0, 0.5, -1.0, 0.2, -1.0], atol=1e-12)
    angles = np.arange(64) * np.pi / 32.0
    axes = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]])
    rays = np.stack((np.cos(angles), np.sin(angles)), axis=1) @ axes
    disc = workspace_surface(explored(rays, np.ones(64), ["limb"] * 64))
    found = disc.distance(disc.centre + np.array([[0.0], [0.5], [2.0]]) * axes[0])
    np.testing.assert_allclose(found, [1.0, 0.5, -1.0], atol=0.002)


def test_what_nothing_ends_is_no_boundary():
    rays = sphere_of_rays(200)
    free = workspace_surface(explored(rays, np.ones(200), [""] * 200))
    assert (free.distance(free.centre[None]) == np.inf).all()
    assert not len(free.boundary)
    half = workspace_surface(explored(rays, np.ones(200), np.where(rays[:, 2] > 0.0, "limb", "")))
    assert half.distance(half.centre[None] - [[0.0, 0.0, 0.6]])[0] > 0.8


@pytest.mark.slow
def test_inside_a_hexapod_as_explored_from_each_point():
    robot = load_parallel("hexapod")
    T = robot.mechanism.pose(robot.mechanism.home())
    surface = workspace_surface(platform_position_workspace(robot, T))
    rng = np.random.default_rng(3)
    for step in 0.04 * rng.uniform(-1.0, 1.0, size=(5, 3)):
        pose = T.copy()
        pose[:3, 3] += step
        own = platform_position_workspace(robot, pose, directions=2000)
        found = surface.distance(pose[None, :3, 3])[0]
        assert found == pytest.approx(own.distances.min(), abs=0.005 * surface.reach)
