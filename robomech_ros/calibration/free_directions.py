"""Directions along which the motions do not determine the sensor's position."""

from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.calibration import starting
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros.spatial.rotations.axis_angle import matrix_from_rotation_vector
from robomech_ros.typing import Array

_common_turns = direct(starting.common_turns)

# Sensor and target are nearer than so many times the reach of the hand.
FAR = 20.0
# Noise of one side looks like rotations of both, more so for few samples: in simulations, its mean
# square over the variance of the noise was never larger than this over (n - 2) to this power.
_BY_CHANCE, _POWER = 16.0, 1.1
# Smaller mean squares (rad^2) are rounding.
_ROUNDING = 1e-14


@dataclass(eq=False)
class FreeDirections:
    """Directions along which positions are not determined: none, one, or all three.

    These are unit vectors (k, 3) in X's parent; the free directions of a servo are names of
    coordinates. The constraint (7,) is the one direction in X's parent and in Z's, and the weight
    that keeps positions along it constant; zeros for k = 0 or 3.
    """

    directions: Array
    constraint: Array

    @property
    def is_axis(self) -> bool:
        """True if all rotations are about parallel axes."""
        return len(self.directions) == 1

    def rotate_about_axis(self, A: Array, S: Array, use: Array, at: Array) -> None:
        """Rotate X and Z (24) about the axis by the angle that fits the positions best."""
        axis, other = self.constraint[:3], self.constraint[3:6]
        columns, right = self._positions_about_axis(A, S, use, at)
        found = np.linalg.lstsq(columns, right, rcond=1e-9)[0]
        angle = np.arctan2(found[1], found[0])
        for first, about in ((0, axis), (12, other)):
            turn = matrix_from_rotation_vector(angle * about)
            at[first : first + 9] = (turn @ at[first : first + 9].reshape(3, 3)).ravel()

    def motion_off_line(self, A: Array, S: Array, use: Array, at: Array) -> float:
        """Return the motion of the target (m) that rotations about one line do not explain.

        This is the root of the sum of squares over the samples.  The deviation of X's rotation
        about the axis is that of the positions over this motion.
        """
        columns, _ = self._positions_about_axis(A, S, use, at)
        about, others = columns[:, :2], columns[:, 2:]
        rest = about - others @ np.linalg.lstsq(others, about, rcond=1e-9)[0]
        return float(np.sqrt(0.5 * np.vdot(rest, rest)))

    def _positions_about_axis(
        self, A: Array, S: Array, use: Array, at: Array
    ) -> tuple[Array, Array]:
        """Return the equations of positions: columns (3 k, 8) and right-hand side (3 k,).

        The unknowns are cosine and sine of a rotation about the axis, and the positions of X and Z.
        """
        kept, axis = use > 0.0, self.constraint[:3]
        R = A[kept, :9].reshape(-1, 3, 3)
        seen = S[kept, 9:] @ at[:9].reshape(3, 3).T
        along = np.outer(seen @ axis, axis)
        columns = np.zeros((len(R), 3, 8))
        columns[:, :, 0] = (R @ (seen - along)[:, :, None])[:, :, 0]
        columns[:, :, 1] = (R @ np.cross(axis, seen)[:, :, None])[:, :, 0]
        columns[:, :, 2:5], columns[:, :, 5:] = R, -np.eye(3)
        right = -A[kept, 9:] - (R @ along[:, :, None])[:, :, 0]
        return columns.reshape(-1, 8), right.ravel()

    def zero_along_axis(self, at: Array) -> None:
        """Move X and Z (24) along the free axis until X's position along it is zero."""
        along = float(self.constraint[:3] @ at[9:12])
        at[9:12] -= along * self.constraint[:3]
        at[21:24] -= along * self.constraint[3:6]


def rms_distance(A: Array) -> float:
    """Return the root mean square distance (m) of origins, rows (n, 12)."""
    return float(np.sqrt(np.vdot(A[:, 9:], A[:, 9:]) / len(A)))


def find_free_directions(
    A: Array, S: Array, use: Array, at: Array, variance: float
) -> FreeDirections:
    """Find the free directions by the rotations that robot and sensor have in common.

    Poses (n, 12) are those of A X S = Z; `variance` is that of each coordinate of the rotations,
    robot and sensor together (rad^2).
    """
    common = np.empty((3, 3))
    _common_turns(A, S, use, at, common)
    values, axes = np.linalg.eigh(common)
    chance = _BY_CHANCE / (float(use.sum()) - 2.0) ** _POWER
    count = int((values <= max(2.0 * chance * variance, _ROUNDING)).sum())
    constraint = np.zeros(7)
    if count == 0:
        return FreeDirections(np.zeros((0, 3)), constraint)
    if count > 1:
        return FreeDirections(np.eye(3), constraint)
    axis = axes[:, 0]
    axis = axis * np.sign(axis[int(np.argmax(np.abs(axis)))])
    other = (use @ (A[:, :9].reshape(-1, 3, 3) @ axis)) / use.sum()
    constraint[:3], constraint[3:6] = axis, other / np.linalg.norm(other)
    # Each of the two positions moves by the root of a half of a step along both.
    constraint[6] = 0.5 / (FAR * (rms_distance(A) or 1.0)) ** 2
    return FreeDirections(axis[None], constraint)
