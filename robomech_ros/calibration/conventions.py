"""Compare mounts, inverted poses and units by residuals, and refuse those that fit worse."""

import numpy as np

from robomech_ros.calibration.free_directions import FAR, rms_distance
from robomech_ros.calibration.initial_guess import (
    TRANSPOSED,
    closed_form_guess,
    medians,
    rotation_products,
)
from robomech_ros.calibration.maximum_likelihood import Fit
from robomech_ros.errors import InconsistentDataError
from robomech_ros.typing import Array

# Larger residuals (rad, and the same fraction of the distances) are no noise of a sensor.
_SUSPICIOUS = 0.02
# The right units reduce residuals to this fraction or less.
_UNIT_GAIN = 0.2
_MILLI = 1e-3
# Smaller errors (rad, and the same fraction of the distances) are rounding.
_ROUNDING = 1e-9
# A convention is wrong if another one has a mean logarithm of residuals that is smaller by
# _BETTER / (n - 3), a difference that noise does not make.  A guess that is worse by _WORSE is not
# refined.
_BETTER, _WORSE = 2.0, 6.0
# A convention is excluded if its squared rotation residuals are so many times larger at least.
# Right ones never reached a factor of 3 in 8,000 random calibrations, most with much noise.
_EXCLUDED = 100.0
_MIN_VARIANCE = 1e-12


def mean_log_residual(residuals: Array, distance: float) -> float:
    """Return the mean logarithm of squared residuals (2, n), on which outliers have little effect.

    Rotation and position count alike; the distance (m) scales what is rounding of positions.
    """
    least = np.array([[_ROUNDING**2], [(_ROUNDING * (1.0 + distance)) ** 2]])
    return float(np.log(np.maximum(residuals, least)).sum() / residuals.shape[1])


def rotations_exclude_inverse(fit: Fit, consistent: Array) -> bool:
    """Return whether rotations alone exclude that the robot's poses are inverted.

    For inverted poses, the traces of R_Z^T R_A^T R_X R_S add up to at most three times the largest
    singular value s of the linear map from R_X to R_Z, for all X and Z.  A trace is ``1 + 2
    cos(error)``, so the squared errors of m samples add up to at least ``3 (m - s)``.  This
    compares that bound with the squared errors of the poses as they are.
    """
    count = float(consistent.sum())
    products = rotation_products(fit.A[:, TRANSPOSED], fit.S, consistent)
    bound = 3.0 * (count - float(np.linalg.svd(products, compute_uv=False)[0]))
    reached = float(consistent @ fit.guess.residuals[0])
    return bound > _EXCLUDED * max(reached, _MIN_VARIANCE * count)


def check_convention(fit: Fit, other: Fit, mount: str, robust: bool) -> None:
    """Refuse samples that fit better with the other mount, or with one list of poses inverted.

    Inverting both lists exchanges sensor and target, and fits equally well. The residuals therefore
    show that mount, robot poses or sensor poses are wrong, and not which of them. ``fit`` is
    refined with the poses as they are; ``other``, with the robot's poses inverted, if it may fit
    better.
    """
    distance = rms_distance(fit.S)
    guessed = mean_log_residual(other.guess.residuals, distance)
    least = _least_residual(fit, distance)
    if guessed > least + _WORSE:
        return
    other.refine(robust)
    gain = least - _least_residual(other, distance)
    if gain <= _BETTER / (len(fit.A) - 3):
        return
    right = "eye-to-hand" if mount == "eye-in-hand" else "eye-in-hand"
    raise InconsistentDataError(
        "mount",
        mount,
        f"'{right}', with which the samples fit {float(np.exp(0.25 * min(gain, 100.0))):.3g} times "
        "better; if the mount is right, invert one list: robot_poses are T_base_hand and "
        "sensor_poses T_sensor_target",
    )


def _least_residual(fit: Fit, distance: float) -> float:
    """Return the smaller residual of the refined fit and of the guess, which resists outliers."""
    return min(
        mean_log_residual(fit.residuals(), distance),
        mean_log_residual(fit.guess.residuals, distance),
    )


def check_units(fit: Fit, other: Fit | None, consistent: Array) -> None:
    """Refuse samples whose positions are in m in one list and in mm in the other.

    Fits are the initial guesses with the poses as they are, and with the robot's poses inverted.
    """
    turn, shift = medians(fit.guess.residuals)
    suspicious = max(turn, shift / (rms_distance(fit.S) ** 2 or 1.0)) > _SUSPICIOUS**2
    far = np.abs(fit.at[[9, 10, 11, 21, 22, 23]]).max() > FAR * rms_distance(fit.A)
    if not suspicious and not far:
        return
    fits = (fit,) if other is None else (fit, other)
    moved = ((fit.A[:, 9:] - np.median(fit.A[:, 9:], axis=0)) ** 2).sum(axis=1)
    # The sensor must explain the motion of the hand: tiny positions have tiny residuals, too.
    most = float(min(np.median([moved, *(one.guess.residuals[1] for one in fits)], axis=1)))
    for one in fits:
        for factor in (_MILLI, 1.0 / _MILLI):
            scaled = fit.S.copy()
            scaled[:, 9:] *= factor
            residuals = closed_form_guess(one.A, scaled, consistent).residuals[1]
            scaled_shift = float(np.median(residuals))
            if scaled_shift > _UNIT_GAIN**2 * most:
                continue
            robot_unit, sensor_unit = ("m", "mm") if factor < 1.0 else ("mm", "m")
            # In the larger unit, so that the change of units itself does not count.
            ratio = np.sqrt(shift / max(scaled_shift, 1e-24 * shift))
            better = min(factor, 1.0) * float(ratio)
            also = "" if one is fit else " and with the other mount or one list inverted"
            raise InconsistentDataError(
                "unit of positions",
                f"probably {robot_unit} in robot_poses and {sensor_unit} in sensor_poses",
                f"m in both: with positions of sensor_poses times {factor:g}{also} the samples fit "
                f"{better:.3g} times better",
            )
