"""Convex parts of closed meshes hold all that a mesh encloses."""

import numpy as np
import pytest
from arms import torus_mesh
from scipy.spatial import ConvexHull

from robomech_ros.collision import Mesh
from robomech_ros.collision.convex_parts import convex_parts, is_closed


def elbow():
    """Return the triangles of a bent bar: two boxes that share an edge of their outline."""
    outline = np.array([[0, 0], [0.4, 0], [0.4, 0.1], [0.1, 0.1], [0.1, 0.3], [0, 0.3]])
    ends = [np.column_stack([outline, np.full(6, height)]) for height in (0.0, 0.1)]
    caps = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    below = [ends[0][list(face[::-1])] for face in caps]
    above = [ends[1][list(face)] for face in caps]
    sides = []
    for k in range(6):
        a, b, c, d = ends[0][k], ends[0][(k + 1) % 6], ends[1][(k + 1) % 6], ends[1][k]
        sides += [np.array([a, b, c]), np.array([a, c, d])]
    return np.array([*below, *above, *sides])


def ring():
    vertices, faces = torus_mesh()
    return np.asarray(vertices)[np.asarray(faces)]


def turned(triangles):
    """Return a mesh that lies across all axes."""
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    return triangles @ (turn * np.sign(np.linalg.det(turn))).T


@pytest.mark.parametrize("make", [elbow, ring])
@pytest.mark.parametrize("most", [2, 5, 8, 16])
def test_every_point_of_the_mesh_is_in_a_part(make, most):
    triangles = turned(make())
    assert is_closed(triangles)
    rng = np.random.default_rng(most)
    faces = rng.integers(len(triangles), size=5000)
    weights = rng.dirichlet((1.0, 1.0, 1.0), size=5000)
    surface = np.einsum("ij,ijk->ik", weights, triangles[faces])
    # Between two points of the surface a point may be inside or outside.
    inner = 0.5 * (surface + rng.permutation(surface))
    body = Mesh(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)).body()
    inner = np.array([point for point in inner[:1000] if body.encloses(point)])
    assert len(inner) > 50
    parts = convex_parts(triangles, most)
    assert len(parts) <= most
    for points in (surface, inner):
        away = np.full(len(points), np.inf)
        for corners in parts:
            planes = ConvexHull(corners).equations
            away = np.minimum(away, (points @ planes[:, :3].T + planes[:, 3]).max(axis=1))
        assert away.max() < 1e-9


def test_more_parts_are_nearer_to_the_mesh():
    volumes = [
        sum(ConvexHull(corners).volume for corners in convex_parts(elbow(), most))
        for most in (1, 2, 8)
    ]
    # The bar itself has 0.006 m^3.
    assert volumes[0] > volumes[1] > 0.00599 and volumes[2] < 1.2 * 0.006
