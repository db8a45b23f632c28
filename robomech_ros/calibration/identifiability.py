"""Refuse motions that do not determine the sensor's pose."""

import numpy as np

from robomech_ros.calibration.free_directions import rms_distance
from robomech_ros.calibration.maximum_likelihood import EXACT, Fit
from robomech_ros.errors import UnderdeterminedError

# Rotation residuals (rad) of poses that are not related to each other.
UNRELATED = 0.3
# Poses farther apart than this (rad) are different ones, and so much (twice the logarithm of the
# likelihood) the best must be more likely.
_APART, _LIKELIHOOD_GAIN = 0.5, 20.0
# Required deviation of the sensor's rotation about parallel axes (rad), and the squared motion per
# sample that noise makes, in variances.
_AXIS_DEVIATION, _MOTION_BY_NOISE = 0.1, 12.0


def check_rotations(fit: Fit, other: Fit | None, mount: str) -> None:
    """Refuse motions without rotations that robot and sensor have in common, up to noise."""
    if any(len(one.free.directions) < 3 for one in (fit, other) if one is not None):
        return
    A = fit.A[fit.use > 0.0, :9]
    most = float(np.sqrt(((A - A.mean(axis=0)) ** 2).sum(axis=1).mean() / 2.0))
    parent = "base" if mount == "eye-to-hand" else "hand"
    raise UnderdeterminedError(
        "rotation of robot_poses (rad, root mean square)",
        float(f"{most:.3g}"),
        "rotations about two axes that are not parallel, the same in sensor_poses: pure "
        f"translations leave the sensor's position in the {parent} frame free in all directions",
        np.eye(3).tolist(),
    )


def check_common_line(fit: Fit) -> None:
    """Refuse rotations about one line: they leave the sensor's rotation about it free, too."""
    if not fit.free.is_axis:
        return
    off = fit.free.motion_off_line(fit.A, fit.S, fit.use, fit.at)
    by_noise = _AXIS_DEVIATION**-2 + _MOTION_BY_NOISE * float(fit.use.sum())
    if off**2 > float(fit.noise[1]) * by_noise and off > EXACT * rms_distance(fit.S):
        return
    raise UnderdeterminedError(
        "layout of the robot's rotation axes",
        "one common line",
        "axes that are not parallel, or motions across that line: the sensor's rotation about the "
        "line and its position along it are free",
        fit.free.directions.tolist(),
    )


def check_half_turns(fit: Fit) -> None:
    """Refuse half turns that other poses of the sensor fit as well."""
    if not fit.guess.others or fit.free.is_axis:
        return
    best = float(fit.use @ fit.distances(fit.at))
    information = fit.information.copy()
    for at in fit.guess.others:
        fit.step(at, fit.noise.copy(), known=True)
        apart = float(at[:9] @ fit.at[:9])
        likely = float(fit.use @ fit.distances(at)) - best < _LIKELIHOOD_GAIN
        if apart < 1.0 + 2.0 * np.cos(_APART) and likely:
            raise UnderdeterminedError(
                "layout of the robot's rotation axes",
                "that of half turns at right angles to each other",
                "one more rotation, by another angle or about another axis: several poses of the "
                "sensor fit equally well",
            )
    fit.information = information
