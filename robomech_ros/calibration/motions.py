"""Whether motions determine a hand-eye calibration, and whether poses are what they should be."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robomech_ros.calibration.start import agreeing, errors_at, packed, starts
from robomech_ros.errors import ContradictionError, UndeterminedError
from robomech_ros.spatial.arrays import readable_axis
from robomech_ros.spatial.matrices import nearest_rotation
from robomech_ros.spatial.poses import inverse_pose
from robomech_ros.spatial.rotations.quaternions import quaternion_from_matrix

__all__ = ["Spread", "check_convention", "check_units"]

Array = NDArray[np.float64]

# Turns smaller than this (rad) are rounding.
_NO_TURN = 1e-6
# Residuals of another convention are so much smaller where that one is meant.
_CLEARLY = 0.2
# Positions in mm among others in m.
_MILLI = 1e-3


def _spread(poses: Array) -> tuple[Array, Array]:
    """Mean squares of turns from their mean (rad^2), ascending, and the axes they are about.

    The axes are in the moving frame, where those of all relative motions are.
    """
    rotations = poses[:, :3, :3]
    mean = nearest_rotation(rotations.sum(axis=0))
    vectors = 2.0 * quaternion_from_matrix(mean.T @ rotations)[:, :3]
    values, axes = np.linalg.eigh(vectors.T @ vectors / len(vectors))
    return np.clip(values, 0.0, None), axes


class Spread:
    """How far the poses of A X S = Z turn, about which axes."""

    def __init__(self, robot: Array, sensor: Array) -> None:
        self._chance = 1.0 + 2.0 / np.sqrt(len(robot))
        self._moved, self._axes = _spread(robot)
        self._seen, _ = _spread(sensor)

    def check(self, parent: str, variances: tuple[float, float] = (0.0, 0.0)) -> None:
        """Refuse motions that leave a direction of the sensor's position free.

        Parameters
        ----------
        parent : str
            Name of the frame that X is expressed in.
        variances : tuple of float
            Of the noise of the robot's and of the sensor's rotations (rad^2): turns that it
            explains in both count for nothing.

        Raises
        ------
        UndeterminedError
            No rotations, or all about parallel axes.
        """
        if self._still(2, variances):
            most = float(np.sqrt(min(self._moved[2], self._seen[2])))
            raise UndeterminedError(
                "rotation of the robot's poses",
                f"{most:.3g} rad: pure translations",
                "turns about two axes that are not parallel; the sensor's position in the "
                f"{parent} frame is free in all directions",
                np.eye(3).tolist(),
            )
        if self._still(1, variances):
            axis = readable_axis(self._axes[:, 2])
            raise UndeterminedError(
                "axes of the robot's rotations",
                f"all parallel to {axis}",
                f"at least two that are not parallel; the sensor's position along {axis} of the "
                f"{parent} frame is free: add poses turned about another axis",
                [axis],
            )

    def _still(self, k: int, variances: tuple[float, float]) -> bool:
        """Whether there are no turns about axis k, or noise explains them on both sides."""
        turned = self._moved[k], self._seen[k]
        if min(turned) <= _NO_TURN**2:
            return True
        return all(
            one <= self._chance * noise for one, noise in zip(turned, variances, strict=True)
        )


def check_units(A: Array, S: Array, shift: float) -> None:
    """Refuse samples whose positions are in m on one side and in mm on the other.

    Parameters
    ----------
    A, S : ndarray, shape (n, 12)
        Poses of A X S = Z, as :func:`packed` gives them.
    shift : float
        Median squared position error (m^2) as they are.

    Raises
    ------
    ContradictionError
    """
    voters = agreeing(A, S)
    moved = float(np.median(((A[:, 9:] - np.median(A[:, 9:], axis=0)) ** 2).sum(axis=1)))
    for factor in (_MILLI, 1.0 / _MILLI):
        scaled = S.copy()
        scaled[:, 9:] *= factor
        _, shifts = errors_at(A, scaled, starts(A, scaled, voters)[0])
        found = float(np.median(shifts))
        # So the sensor must explain how the hand moved, not only see next to nothing.
        if found <= _CLEARLY**2 * min(moved, shift):
            ours, theirs = ("m", "mm") if factor < 1.0 else ("mm", "m")
            # In the larger unit, so that the change of units itself does not count.
            better = min(factor, 1.0) * float(np.sqrt(shift / max(found, 1e-24 * shift)))
            raise ContradictionError(
                "unit of positions",
                f"{ours} in robot_poses and {theirs} in sensor_poses, as it seems",
                f"m in both: with those of the sensor times {factor:g} the samples fit "
                f"{better:.3g} times better",
            )


def check_convention(robot: Array, sensor: Array, mount: str, squares: tuple[float, float]) -> None:
    """Refuse samples that fit far better with the other mount, or with poses inverted.

    Of the four conventions two fit equally well, those with both kinds of poses inverted: sensor
    and target then change places.  So what is wrong is one of three, and not which.

    Parameters
    ----------
    robot, sensor : ndarray, shape (n, 4, 4)
        Poses of A X S = Z.
    mount : str
    squares : tuple of float
        Median squared rotation (rad^2) and position error (m^2) as they are.

    Raises
    ------
    ContradictionError
    """
    A, S = packed(inverse_pose(robot)), packed(sensor)
    found = errors_at(A, S, starts(A, S, agreeing(A, S))[0])
    ratio = max(
        float(np.median(one)) / before if before > 0.0 else np.inf
        for one, before in zip(found, squares, strict=True)
    )
    if ratio <= _CLEARLY**2:
        other = "eye-to-hand" if mount == "eye-in-hand" else "eye-in-hand"
        better = 1.0 / np.sqrt(max(ratio, 1e-24))
        raise ContradictionError(
            "mount",
            mount,
            f"'{other}', or robot_poses T_base_hand and sensor_poses T_sensor_target of which one "
            f"is inverted here: so the samples fit {better:.3g} times better",
        )
