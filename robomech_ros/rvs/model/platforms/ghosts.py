"""Postures of a parallel robot as ghosts: rods from joint to joint, and around the platform."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from robomech_ros.kinematics import link_poses
from robomech_ros.rvs.model.ghosts import NOTHING, GhostPieces, Rgb, placed_pieces
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.parallel import Mechanism

# Radius of rods, part of the size of the robot.
RADIUS = 0.012
# Joints of a limb nearer to each other than this fraction of the size share a point.
SAME = 1e-6


def limb_points(mechanism: Mechanism, q: Array, reach: float) -> Array:
    """Return the positions of the joints of all limbs.

    - ``q``: postures (rad or m), shape (k, n).
    - ``reach``: distance of joints from the common point of their axes, if there is one (m).

    Returns an array (k, limbs, joints, 3) in the base (m).
    """
    rows, start = [], 0
    for limb in mechanism.limbs:
        chain = limb.chain
        links = [frame.name for frame in chain.frames if frame.joints > 0][: chain.n]
        T = link_poses(chain, q[:, start : start + chain.n], links)
        rows.append(T)
        start += chain.n
    T = np.stack(rows, axis=1)
    points: Array = T[..., :3, 3]
    if np.ptp(points.reshape(-1, 3), axis=0).max() < SAME * mechanism.size:
        points = points + reach * T[..., :3, 2]
    return points


def rod_poses(starts: Array, ends: Array) -> tuple[Array, Array]:
    """Return poses (..., 4, 4) of rods along z between points (..., 3), and lengths (...) (m)."""
    along = ends - starts
    length = np.linalg.norm(along, axis=-1)
    z = along / np.where(length > 0.0, length, 1.0)[..., None]
    z = np.where((length > 0.0)[..., None], z, [0.0, 0.0, 1.0])
    other = np.where(np.abs(z[..., :1]) < 0.9, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    x = np.cross(other, z)
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    T = np.zeros((*length.shape, 4, 4))
    T[..., :3, 0], T[..., :3, 1], T[..., :3, 2] = x, np.cross(z, x), z
    T[..., :3, 3], T[..., 3, 3] = 0.5 * (starts + ends), 1.0
    return T, length


class PlatformGhosts:
    """The pieces of a parallel robot, for any number of postures.

    - ``reach``: size of the drawn robot (m).
    - ``radius_scale``: factor of all radii; one of two ghosts in the same posture is thinner.
    """

    def __init__(self, mechanism: Mechanism, reach: float, radius_scale: float = 1.0) -> None:
        self._mechanism, self._reach, self._slimness = mechanism, reach, radius_scale
        limbs, joints = limb_points(mechanism, mechanism.home()[None], reach).shape[1:3]
        # Rods along the limbs, and from limb to limb around the platform.
        self.pieces = limbs * (joints - 1) + limbs

    def middles(self, postures: Sequence[Array]) -> Array:
        """Return the positions of labels (k, 3) in the base (m), at the platform."""
        points = limb_points(self._mechanism, np.array(postures), self._reach)
        return np.asarray(points[:, :, -1].mean(axis=1))

    def placed(self, postures: Sequence[Array], colours: Sequence[Rgb]) -> GhostPieces:
        """Place the pieces of ghosts; those of the first posture come first."""
        count, size = len(postures), min(self._mechanism.size, self._reach)
        points = limb_points(self._mechanism, np.array(postures), self._reach)
        last = points[:, :, -1]
        starts = np.concatenate((points[:, :, :-1].reshape(count, -1, 3), last), axis=1)
        ends = np.concatenate(
            (points[:, :, 1:].reshape(count, -1, 3), np.roll(last, -1, axis=1)), axis=1
        )
        T, length = rod_poses(starts, ends)
        radius = np.where(length > SAME * size, self._slimness * RADIUS * size, NOTHING)
        scales = np.stack((radius, radius, np.maximum(length, NOTHING)), axis=-1)
        return placed_pieces(T, scales, colours, self.pieces)
