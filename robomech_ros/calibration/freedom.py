"""Directions in which the motions leave the sensor's position undetermined."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.calibration import starting
from robomech_ros._kernels.compiling.jit import direct

Array = NDArray[np.float64]

_common_turns = direct(starting.common_turns)

# Sensor and target are nearer than so many times the reach of the hand.
FAR = 20.0
# Turns of one side's noise look like turns of both, the more the fewer samples there are: their
# mean square, as part of the noise's, was never larger than this over (n - 2) to this power.
_BY_CHANCE, _POWER = 16.0, 1.1


@dataclass(eq=False)
class Freedom:
    """Directions that are free: none, one, or all three.

    Attributes
    ----------
    directions : ndarray, shape (k, 3)
        Unit vectors in X's parent, k = 0, 1 or 3.
    held : ndarray, shape (7,)
        The one direction in X's parent and in Z's, and the weight of staying along it; or zeros.
    """

    directions: Array
    held: Array

    @property
    def is_axis(self) -> bool:
        """Whether all turns are about parallel axes."""
        return len(self.directions) == 1

    def turn_about_axis(self, A: Array, S: Array, use: Array, at: Array) -> None:
        """Turn X and Z (24) about the axis by the angle that fits the positions best."""
        axis, other = self.held[:3], self.held[3:6]
        columns, right = self._positions_about_axis(A, S, use, at)
        found = np.linalg.lstsq(columns, right, rcond=1e-9)[0]
        angle = np.arctan2(found[1], found[0])
        for first, about in ((0, axis), (12, other)):
            x, y, z = about
            cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            turn = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
            at[first : first + 9] = (turn @ at[first : first + 9].reshape(3, 3)).ravel()

    def motion_off_line(self, A: Array, S: Array, use: Array, at: Array) -> float:
        """Return how far (m) the target moves beyond what turns about one line explain.

        The root of the sum of squares over the samples: the turn of X about the axis is known to
        the noise of positions over this.
        """
        columns, _ = self._positions_about_axis(A, S, use, at)
        about, others = columns[:, :2], columns[:, 2:]
        rest = about - others @ np.linalg.lstsq(others, about, rcond=1e-9)[0]
        return float(np.sqrt(0.5 * np.vdot(rest, rest)))

    def _positions_about_axis(
        self, A: Array, S: Array, use: Array, at: Array
    ) -> tuple[Array, Array]:
        """Return the equations of positions: columns (3 k, 8) and right-hand side (3 k,).

        Unknown are cosine and sine of a turn about the axis, and the positions of X and Z.
        """
        kept, axis = use > 0.0, self.held[:3]
        R = A[kept, :9].reshape(-1, 3, 3)
        seen = S[kept, 9:] @ at[:9].reshape(3, 3).T
        along = np.outer(seen @ axis, axis)
        columns = np.zeros((len(R), 3, 8))
        columns[:, :, 0] = (R @ (seen - along)[:, :, None])[:, :, 0]
        columns[:, :, 1] = (R @ np.cross(axis, seen)[:, :, None])[:, :, 0]
        columns[:, :, 2:5], columns[:, :, 5:] = R, -np.eye(3)
        right = -A[kept, 9:] - (R @ along[:, :, None])[:, :, 0]
        return columns.reshape(-1, 8), right.ravel()

    def settle(self, at: Array) -> None:
        """Move X and Z (24) along the free axis until X's position along it is zero."""
        along = float(self.held[:3] @ at[9:12])
        at[9:12] -= along * self.held[:3]
        at[21:24] -= along * self.held[3:6]


def reach_of(A: Array) -> float:
    """Root mean square distance (m) of origins, rows (n, 12)."""
    return float(np.sqrt(np.vdot(A[:, 9:], A[:, 9:]) / len(A)))


def freedom_of(A: Array, S: Array, use: Array, at: Array, variance: float) -> Freedom:
    """Find what is free, by the turns that robot and sensor have in common.

    Parameters
    ----------
    A, S : ndarray, shape (n, 12)
        Poses of A X S = Z.
    use : ndarray, shape (n,)
        1 for samples that count, 0 for others.
    at : ndarray, shape (24,)
        X and Z.
    variance : float
        Of each coordinate of the rotations, robot and sensor together (rad^2).
    """
    common = np.empty((3, 3))
    _common_turns(A, S, use, at, common)
    values, axes = np.linalg.eigh(common)
    chance = _BY_CHANCE / (float(use.sum()) - 2.0) ** _POWER
    count = int((values <= 2.0 * chance * variance).sum())
    held = np.zeros(7)
    if count == 0:
        return Freedom(np.zeros((0, 3)), held)
    if count > 1:
        return Freedom(np.eye(3), held)
    axis = axes[:, 0]
    axis = axis * np.sign(axis[int(np.argmax(np.abs(axis)))])
    other = (use @ (A[:, :9].reshape(-1, 3, 3) @ axis)) / use.sum()
    held[:3], held[3:6] = axis, other / np.linalg.norm(other)
    # Each of the two positions moves by the root of a half of a step along both.
    held[6] = 0.5 / (FAR * (reach_of(A) or 1.0)) ** 2
    return Freedom(axis[None], held)
