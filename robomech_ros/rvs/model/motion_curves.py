"""The curves of a motion: positions, rates and torques over time, and their limits."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robomech_ros.dynamics import inverse_dynamics
from robomech_ros.errors import MissingInertiaError
from robomech_ros.robots import SerialChain
from robomech_ros.rvs.motion import Motion

__all__ = ["QUANTITIES", "MotionCurves", "Quantity", "motion_curves"]

Array = NDArray[np.float64]

QUANTITIES = ("position", "velocity", "acceleration", "jerk", "torque")
# What follows the unit of a position in those of its derivatives.
_PER = ("", "/s", "/s²", "/s³")


class Quantity(NamedTuple):
    """One quantity of the joints that have it in the same unit.

    Parameters
    ----------
    name, unit : str
    joints : tuple of int
        Of the k joints.
    values : ndarray, shape (m, k)
        In this unit.
    lower, upper : ndarray, shape (k,)
        Its limits; infinite where there is none.
    """

    name: str
    unit: str
    joints: tuple[int, ...]
    values: Array
    lower: Array
    upper: Array


class MotionCurves(NamedTuple):
    """The curves of a motion.

    Parameters
    ----------
    times : ndarray, shape (m,)
        From 0 on (s).
    quantities : tuple of Quantity
    missing : tuple of str
        A sentence for each quantity that is not known.
    """

    times: Array
    quantities: tuple[Quantity, ...]
    missing: tuple[str, ...]


def motion_curves(motion: Motion) -> MotionCurves:
    """Give the curves of a motion.

    Rates that the motion does not bring are differences of what it brings; torques are those of
    the rigid bodies, without friction.

    Parameters
    ----------
    motion : Motion
    """
    chain, times = motion.arm, motion.times - motion.times[0]
    qd = _rate(motion.q, times) if motion.qd is None else motion.qd
    qdd = _rate(qd, times) if motion.qdd is None else motion.qdd
    qddd = _rate(qdd, times) if motion.qddd is None else motion.qddd
    quantities = _of_unit(chain, "position", motion.q, (chain.lower, chain.upper))
    for name, values in (("velocity", qd), ("acceleration", qdd), ("jerk", qddd)):
        most = np.asarray(getattr(chain, name), dtype=np.float64)
        most = np.where(np.isnan(most), np.inf, most)
        quantities += _of_unit(chain, name, values, (-most, most))
    missing: tuple[str, ...] = ()
    try:
        tau = inverse_dynamics(chain, motion.q, qd, qdd) if motion.tau is None else motion.tau
        most = np.where(np.isnan(chain.effort), np.inf, chain.effort)
        quantities += _of_unit(chain, "torque", tau, (-most, most))
    except MissingInertiaError:
        missing = ("No torques: the robot's description has no masses.",)
    return MotionCurves(times, tuple(quantities), missing)


def _rate(values: Array, times: Array) -> Array:
    if len(times) < 2:
        return np.zeros_like(values)
    rate: Array = np.gradient(values, times, axis=0)
    return rate


def _of_unit(
    chain: SerialChain, name: str, values: Array, limits: tuple[Array, Array]
) -> list[Quantity]:
    """Tell joints that turn from those that slide."""
    quantities = []
    for unit in dict.fromkeys(chain.units):
        joints = tuple(k for k, other in enumerate(chain.units) if other == unit)
        shown = ("N m" if unit == "rad" else "N") if name == "torque" else unit
        if name != "torque":
            shown += _PER[QUANTITIES.index(name)]
        low, high = (limit[list(joints)] for limit in limits)
        quantities.append(Quantity(name, shown, joints, values[:, list(joints)], low, high))
    return quantities
