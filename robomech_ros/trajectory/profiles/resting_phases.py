"""Fastest motion from rest to rest in closed form, for what Ruckig refuses."""

import numpy as np

from robomech_ros.trajectory.limits import Limits
from robomech_ros.trajectory.profiles.ruckig_phases import JointPhases, Phases, common_phases
from robomech_ros.trajectory.profiles.velocity_profiles import DoubleS, along_line
from robomech_ros.typing import Array

# Powers of time times these are derivatives.
_FACTORIALS = np.array([1.0, 1.0, 2.0, 6.0])


def resting_phases(rise: Array, limits: Limits, shortest: float) -> Phases:
    """Compute the fastest motion from rest to rest that takes at least a given time.

    Every joint follows the double-S profile of its own way, slowed down to the duration of all.

    Parameters
    ----------
    rise : ndarray, shape (n,)
        Displacements, rad or m.
    limits : Limits
        Velocity, acceleration and jerk limits, all finite.
    shortest : float
        Least duration in s.

    Returns
    -------
    Phases
        Positions count from the start.
    """
    moving = np.flatnonzero(rise)
    rates = 1.0 / (np.abs(rise[moving]) * limits.inverses[:, moving])
    shapes = [DoubleS.shape(*of)[:2] for of in rates.T.tolist()]
    alone = np.zeros(len(rise))
    alone[moving] = [lasting for _, lasting in shapes]
    total = max(shortest, float(alone.max()))
    joints: list[JointPhases] = [(np.array([0.0, total]), np.zeros((2, 4))) for _ in rise]
    for joint, (ramp, lasting) in zip(moving, shapes, strict=True):
        slow = tuple(part * (total / lasting) for part in ramp)
        line = along_line(np.zeros(1), rise[joint : joint + 1], slow, total)
        states = np.zeros((len(line.breaks), 4))
        states[:-1] = line.coefficients[:, :, 0].T * _FACTORIALS
        states[-1, 0] = rise[joint]
        joints[joint] = line.breaks, states
    return Phases(*common_phases(joints, total), alone)
