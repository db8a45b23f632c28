"""Samples of a hand-eye calibration: pairs of poses, each pair once."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.poses import as_pose
from robomech_ros.typing import Array

_LEAST_SAMPLES = 3
# Positions farther away (m) are a mistake.
LARGEST_COORDINATE = 1e6


def checked_samples(robot_poses: ArrayLike, sensor_poses: ArrayLike) -> tuple[Array, Array]:
    """Check both lists of poses; gives them as arrays, shape (n, 4, 4)."""
    robot = as_pose(robot_poses, what="robot_poses")
    sensor = as_pose(sensor_poses, what="sensor_poses")
    if robot.ndim != 3 or robot.shape != sensor.shape:
        raise WrongSizeError(
            "robot_poses and sensor_poses",
            (robot.shape, sensor.shape),
            "(n, 4, 4) both, one of each for each sample",
        )
    for what, poses in (("robot_poses", robot), ("sensor_poses", sensor)):
        most = float(np.abs(poses[:, :3, 3]).max(initial=0.0))
        if most > LARGEST_COORDINATE:
            raise BadValueError(
                f"largest coordinate of {what}", most, f"at most {LARGEST_COORDINATE:g} m"
            )
    return robot, sensor


def distinct_samples(robot: Array, sensor: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Numbers of samples (n, 12) that differ, in an order of their own, and of each among them."""
    rows = np.concatenate((robot, sensor), axis=1) + 0.0
    keys = [row.tobytes() for row in rows]
    places = {key: k for k, key in enumerate(sorted(set(keys)))}
    first = np.zeros(len(places), np.intp)
    back = np.array([places[key] for key in keys], np.intp)
    first[back] = np.arange(len(keys))
    if len(first) < _LEAST_SAMPLES:
        raise WrongSizeError(
            "samples that differ from each other", len(first), "3 or more; five or more are better"
        )
    return first, back
