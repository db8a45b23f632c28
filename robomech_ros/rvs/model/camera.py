"""Camera pose in which a robot and its ghosts fill the picture."""

import itertools
import math
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from robomech_ros.rvs.model.bodies.visual_model import VisualModel
from robomech_ros.rvs.model.running.live_robot import ViewMarker
from robomech_ros.typing import Array

# First direction and field of view: a narrower field than viser's distorts less.
DIRECTION = (0.56, -0.72, 0.4)
FIELD = math.radians(50.0)
# Width of an unknown picture: no wider than it will be.
ASPECT = 1.0
# Filled fraction of the picture, and least size of the subject (m).
FILLED, LEAST = 0.9, 0.02


class Camera(NamedTuple):
    """Position and target of a camera.

    - ``position``: position of the camera in the root (m), shape (3,).
    - ``look_at``: the point that it looks at, in the root (m), shape (3,).
    """

    position: Array
    look_at: Array


def visible_points(seen: VisualModel, postures: Iterable[Mapping[str, float]]) -> Array:
    """Return the corners of boxes around all bodies in several postures.

    - ``postures``: joints by name (rad or m).

    Returns an array (k, 3) in the root (m).
    """
    corners = [(body.link, _corners(body.solid.vertices, body.pose)) for body in seen.bodies]
    points = []
    for positions in postures:
        poses = seen.tree.link_poses(positions)
        points += [at @ poses[link][:3, :3].T + poses[link][:3, 3] for link, at in corners]
    return np.vstack(points) if points else np.zeros((1, 3))


def marker_points(
    seen: VisualModel, markers: Iterable[ViewMarker], positions: Mapping[str, float]
) -> Array:
    """Return the positions of markers, and the ends of their lines.

    - ``positions``: positions of the joints (rad or m).

    Returns an array (k, 3) in the root (m).
    """
    poses = seen.tree.link_poses(positions)
    points = [np.empty((0, 3))]
    for marker in markers:
        T = poses[marker.link] @ marker.pose
        ends = marker.points if len(marker.points) else np.zeros((1, 3))
        points.append(ends @ T[:3, :3].T + T[:3, 3])
    return np.vstack(points)


def fitted_camera(
    points: Array, *, fov: float = FIELD, aspect: float = ASPECT, backwards: Array | None = None
) -> Camera:
    """Place a camera so that points just fit into its picture.

    - ``points``: points in the root (m), shape (k, 3).
    - ``fov``: angle from the lower to the upper edge of the picture (rad).
    - ``aspect``: width of the picture over its height.
    - ``backwards``: direction from the points to the eye, shape (3,); by default the eye is in
      front, above and to the right.

    Notes
    -----
    With x, y across and z into the picture, the point i is left of its right edge where
    ``x_i - e_x <= t (z_i - e_z)``.  The greatest ``x_i - t z_i`` and ``-x_i - t z_i`` give the
    nearest eye and its middle exactly, and so do those of y.
    """
    back = np.array(DIRECTION if backwards is None else backwards, float)
    into = -back / np.linalg.norm(back)
    side = np.cross(into, [0.0, 0.0, 1.0])
    # Seen from straight above, any horizontal direction is across.
    side = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(side) < 1e-6 else side
    side = side / np.linalg.norm(side)
    up = np.cross(side, into)
    x, y, z = points @ side, points @ up, points @ into
    slope = math.tan(0.5 * fov) * FILLED
    middles, depths = [], []
    for across, t in ((x, slope * aspect), (y, slope)):
        most, least = float(np.max(across - t * z)), float(np.max(-across - t * z))
        middles.append(0.5 * (most - least))
        depths.append(-0.5 * (most + least) / t)
    depth = min(*depths, float(np.min(z)) - LEAST)
    position = middles[0] * side + middles[1] * up + depth * into
    ahead = max(0.5 * float(np.max(z) + np.min(z)) - depth, LEAST)
    return Camera(position, position + ahead * into)


def _corners(vertices: Array, pose: Array) -> Array:
    ends = np.stack([vertices.min(axis=0), vertices.max(axis=0)])
    corners = np.array(list(itertools.product(*ends.T)))
    return corners @ pose[:3, :3].T + pose[:3, 3]
