"""Postures of a hand as ghosts, finger by finger."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from robomech_ros.kinematics import link_poses
from robomech_ros.robots import SerialChain
from robomech_ros.robots.urdf.shapes import Shape
from robomech_ros.rvs.model.ghosts import GhostPieces, Ghosts, Rgb
from robomech_ros.typing import Array

# Largest difference of fingers in one posture (rad or m).
SAME = 1e-6


class HandGhosts:
    """The pieces of a hand, for any number of postures.

    - ``fingers``: fingers in the drawn tree.
    - ``shapes``: bodies of its links.
    - ``present``: returns the posture of the hand (rad or m).
    """

    def __init__(
        self,
        fingers: Sequence[SerialChain],
        shapes: Mapping[str, Sequence[Shape]],
        present: Callable[[], Array],
    ) -> None:
        self._present = present
        self._fingers = [Ghosts(finger, shapes) for finger in fingers]
        self._chains = tuple(fingers)
        self._ends = np.cumsum([finger.n for finger in fingers])
        self.pieces = sum(one.pieces for one in self._fingers)

    def middles(self, postures: Sequence[Array]) -> Array:
        """Return the positions of labels (k, 3) in the palm (m), amid fingers that differ.

        At the last joints of these, where postures are farthest from each other.
        """
        parts, here = self._split(postures), self._split([self._present()])
        at = np.array([_last_joints(one, p) for one, p in zip(self._chains, parts, strict=True)])
        moved = [np.abs(np.array(p) - h[0]).max(axis=1) for p, h in zip(parts, here, strict=True)]
        differs = np.array(moved) > SAME
        weights = np.where(differs.any(axis=0), differs, True).astype(np.float64)
        return (weights[..., None] * at).sum(axis=0) / weights.sum(axis=0)[:, None]

    def placed(self, postures: Sequence[Array], colours: Sequence[Rgb]) -> GhostPieces:
        """Place the pieces of ghosts; postures have all joints, then those of the object."""
        count, parts = len(postures), self._split(postures)
        placed = [one.placed(part, colours) for one, part in zip(self._fingers, parts, strict=True)]
        columns = []
        for rows in zip(*placed, strict=True):
            width = rows[0].shape[1]
            together = np.concatenate([row.reshape(count, -1, width) for row in rows], axis=1)
            columns.append(together.reshape(-1, width))
        return GhostPieces(*columns)

    def _split(self, postures: Sequence[Array]) -> list[list[Array]]:
        parts = np.split(np.array(postures), self._ends, axis=1)
        return [list(part) for part in parts[: len(self._fingers)]]


def _last_joints(finger: SerialChain, postures: Sequence[Array]) -> Array:
    """Return the positions (k, 3) (m) of a finger's last joint in postures."""
    link = f"{finger.joint_names[-1]}_link"
    return np.asarray(link_poses(finger, np.array(postures), [link])[:, 0, :3, 3])
