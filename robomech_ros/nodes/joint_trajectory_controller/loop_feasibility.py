"""Trajectories of a parallel robot, checked along the whole way before anything moves."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from robomech_ros.errors import LimitExceededError
from robomech_ros.execution.controller.joining import completed
from robomech_ros.execution.joints import at_rest
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.nodes.common.error_codes import OutcomeError
from robomech_ros.parallel import Mechanism, follow_drives
from robomech_ros.robots import PRISMATIC
from robomech_ros.trajectory.tolerances import POSITION_SLACK
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array

# Passive joints that a trajectory names may be off by this (rad, m).
_AGREES = 1e-3
# A trajectory of few points is looked at in so many places at least, along its curve.
_PLACES = 200
_TURN = 2.0 * math.pi


def checked_drives(
    mechanism: Mechanism, received: Waypoints, passive: Sequence[str], posture: Array
) -> Waypoints:
    """Check a trajectory from a posture on, and give the part of the drives.

    Parameters
    ----------
    mechanism : Mechanism
        Of n joints and m drives.
    received : Waypoints
        Of the drives and, behind them, of passive joints; NaN for drives that are not named.
    passive : sequence of str
        These passive joints.
    posture : ndarray, shape (n,)
        All joints now (rad or m), loops closed.

    Returns
    -------
    Waypoints
        Of the drives.

    Raises
    ------
    LimitExceededError
        A drive is to be outside its limits.
    OutcomeError
        It crosses a singularity, or a passive joint leaves its limits: after which point.
    TrajectoryRefusedError
        A passive joint is to be where the drives do not move it, as in another assembly mode.
    """
    m = mechanism.dof
    _require_limits(mechanism, received.positions[:, :m])
    drives = replace(
        received,
        positions=received.positions[:, :m],
        velocities=None if received.velocities is None else received.velocities[:, :m],
        accelerations=None if received.accelerations is None else received.accelerations[:, :m],
    )
    whole = completed(drives, at_rest(posture[mechanism.drive_index]))
    times = _places(whole.times)
    followed = follow_drives(mechanism, whole.curve.sample(times).position, posture)
    last = len(whole.times) - 1
    if followed.stop is not None:
        reached = int(np.searchsorted(whole.times, times[followed.stop])) - 1
        where = f"after points[{reached}] of {last}" if reached >= 0 else "to points[0]"
        text = f"the trajectory cannot be followed {where}: {followed.reason}"
        raise OutcomeError(followed.status, text)
    rows = followed.q[np.searchsorted(times, whole.times)]
    _require_agreement(mechanism, rows, received.positions[:, m:], passive)
    return drives


def _require_limits(mechanism: Mechanism, positions: Array) -> None:
    """Refuse positions (k, m) of drives outside their limits; NaN is where one is not named."""
    lower, upper = (row[mechanism.drive_index] for row in (mechanism.lower, mechanism.upper))
    excess = np.maximum(lower - positions, positions - upper)
    bad = np.argwhere(excess > POSITION_SLACK)
    if not len(bad):
        return
    k = int(bad[0, 0])
    j = int(np.nanargmax(excess[k]))
    value, low, high = float(positions[k, j]), float(lower[j]), float(upper[j])
    unit = mechanism.units[int(mechanism.drive_index[j])]
    limit = low if value < low else high
    raise LimitExceededError(f"points[{k}]: position", mechanism.actuated[j], value, limit, unit)


def _places(times: Array) -> Array:
    """Return all times of points (s), and some between them where they are few."""
    between = math.ceil(_PLACES / len(times))
    parts = [np.linspace(a, b, between, endpoint=False) for a, b in pairwise(times)]
    return np.concatenate([*parts, times[-1:]])


def _require_agreement(
    mechanism: Mechanism, rows: Array, given: Array, passive: Sequence[str]
) -> None:
    """Refuse passive joints (k, p) that are not where the drives move them, rows (k, n)."""
    if not passive:
        return
    index = [mechanism.joint_names.index(name) for name in passive]
    apart = given - rows[:, index]
    turns = mechanism.types[index] != PRISMATIC
    apart = np.abs(np.where(turns, apart - _TURN * np.round(apart / _TURN), apart))
    bad = np.argwhere(apart > _AGREES)
    if not len(bad):
        return
    k = int(bad[0, 0])
    column = int(np.argmax(apart[k]))
    unit = mechanism.units[index[column]]
    other = ": the trajectory starts in another assembly mode than the robot is in" if not k else ""
    raise TrajectoryRefusedError(
        f"points[{k}]: joint '{passive[column]}' is passive and at {given[k, column]:.6g} {unit}, "
        f"but the drives move it to {rows[k, index[column]]:.6g} {unit}{other}"
    )
