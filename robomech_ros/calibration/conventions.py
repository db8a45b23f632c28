"""Whether poses are what they should be: mounts, inversions and units compared by residuals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robomech_ros.calibration.freedom import FAR, reach_of
from robomech_ros.calibration.start import Start, started
from robomech_ros.errors import ContradictionError

Array = NDArray[np.float64]

# Residuals this large (rad, and the same part of the distances) are no noise of a sensor.
_SUSPICIOUS = 0.02
# Residuals in the right units are so much smaller.
_CLEARLY = 0.2
# Positions in mm among others in m.
_MILLI = 1e-3
# Errors below (rad, and the same part of the distances) are rounding.
_EXACT = 1e-9


def misfit(errors: Array, reach: float) -> float:
    """Mean logarithm of squared errors (2, n), which a few wrong samples hardly change."""
    least = np.array([[_EXACT**2], [(_EXACT * (1.0 + reach)) ** 2]])
    return float(np.log(np.maximum(errors, least)).sum() / errors.shape[1])


def check_units(S: Array, voters: Array, conventions: Sequence[tuple[Array, Start]]) -> None:
    """Refuse samples whose positions are in m on one side and in mm on the other.

    Parameters
    ----------
    S : ndarray, shape (n, 12)
        Poses of A X S = Z, as :func:`packed` gives them.
    voters : ndarray, shape (n,)
        1 for samples to start from.
    conventions : sequence
        The robot's poses A, shape (n, 12), with the start from them: as they are given, and
        inverted.

    Raises
    ------
    ContradictionError
    """
    A, given = conventions[0]
    turn, shift = (float(one) for one in np.median(given.errors, axis=1))
    off = max(turn, shift / (reach_of(S) ** 2 or 1.0)) > _SUSPICIOUS**2
    if not off and np.abs(given.at[[9, 10, 11, 21, 22, 23]]).max() <= FAR * reach_of(A):
        return
    moved = float(np.median(((A[:, 9:] - np.median(A[:, 9:], axis=0)) ** 2).sum(axis=1)))
    most = min(moved, *(float(np.median(start.errors[1])) for _, start in conventions))
    for robot, _ in conventions:
        for factor in (_MILLI, 1.0 / _MILLI):
            scaled = S.copy()
            scaled[:, 9:] *= factor
            found = float(np.median(started(robot, scaled, voters).errors[1]))
            # So the sensor must explain how the hand moved, not only see next to nothing.
            if found > _CLEARLY**2 * most:
                continue
            ours, theirs = ("m", "mm") if factor < 1.0 else ("mm", "m")
            # In the larger unit, so that the change of units itself does not count.
            better = min(factor, 1.0) * float(np.sqrt(shift / max(found, 1e-24 * shift)))
            also = "" if robot is A else ", and with the other mount or one kind of poses inverted"
            raise ContradictionError(
                "unit of positions",
                f"{ours} in robot_poses and {theirs} in sensor_poses, as it seems",
                f"m in both: with those of the sensor times {factor:g}{also} the samples fit "
                f"{better:.3g} times better",
            )


def refuse_convention(mount: str, gain: float) -> None:
    """Refuse samples that fit better with the other mount, or with poses inverted.

    Of the four conventions two fit equally well, those with both kinds of poses inverted: sensor
    and target then change places.  So what is wrong is one of three, and not which.

    Parameters
    ----------
    mount : str
    gain : float
        How much less the :func:`misfit` is then.

    Raises
    ------
    ContradictionError
    """
    other = "eye-to-hand" if mount == "eye-in-hand" else "eye-in-hand"
    better = float(np.exp(0.25 * min(gain, 100.0)))
    raise ContradictionError(
        "mount",
        mount,
        f"'{other}', or robot_poses T_base_hand and sensor_poses T_sensor_target of which one "
        f"is inverted here: so the samples fit {better:.3g} times better",
    )
