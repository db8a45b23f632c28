"""Accelerations of platform and drives with limbs of any kind.

A limb moves the platform with ``J qdd + dJ qd``.  Wrenches that do no work on its passive joints
leave ``w (dt - dJ qd) = w j qdd`` of the drive, and 0 of those that the limb bears by itself.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError
from robomech_ros.kinetostatics import jacobian, jacobian_rate
from robomech_ros.parallel.kinetostatics.limb_wrenches import Wrenches
from robomech_ros.typing import Array

# Part of an acceleration that limbs prevent and that is rounding, of what it is made of.
_PREVENTED = 1e-6


def mechanism_drive_accelerations(
    mechanism: Any, q: ArrayLike | None, limbs: Wrenches, t: Array, dt: Array
) -> Array:
    """Return what the entries of J times the accelerations of the drives are, (..., m).

    Parameters
    ----------
    mechanism : Mechanism
    q : array_like, shape (..., n)
        All joints (rad or m).
    limbs : Wrenches
        There.
    t, dt : ndarray, shape (..., 6)
        Twist of the platform and its rate.

    Raises
    ------
    BadValueError
        A rate that limbs prevent.
    """
    bias, carried = _biases(mechanism, q, limbs, t)
    scaled = dt * np.repeat([1.0, 1.0 / limbs.size], 3)
    off = np.abs((limbs.carried @ scaled[..., None])[..., 0] - carried).max(initial=0.0)
    if off > _PREVENTED * max(np.abs(scaled).max(initial=0.0), np.abs(carried).max(initial=0.0)):
        why = "0: the platform does not have it with this twist"
        raise BadValueError("twist_rate, the part of it that limbs prevent", float(off), why)
    return np.asarray((limbs.borne @ dt[..., None])[..., 0] - bias)


def mechanism_platform_acceleration(
    mechanism: Any, q: ArrayLike | None, limbs: Wrenches, t: Array
) -> tuple[Array, Array]:
    """Return the work (..., m) that K does on the acceleration of the platform without the drives'.

    Besides, its part (..., 6) that limbs prescribe; arguments as above, t NaN where unknown.
    """
    bias, carried = _biases(mechanism, q, limbs, np.nan_to_num(t))
    units = np.repeat([1.0, 1.0 / limbs.size], 3)
    inverse = np.linalg.pinv(limbs.carried, rcond=_PREVENTED)
    rest = (inverse @ carried[..., None])[..., 0] / units
    return bias - (limbs.borne @ rest[..., None])[..., 0], np.where(np.isnan(t), np.nan, rest)


def _biases(mechanism: Any, q: ArrayLike | None, limbs: Wrenches, t: Array) -> tuple[Array, Array]:
    """Return what wrenches do on the accelerations of limbs whose joints keep their rates.

    Of those that drives bear (..., m), and of those that limbs bear by themselves (..., c).
    """
    joints = np.asarray(q, dtype=float)
    drifts = []
    for i, limb in enumerate(mechanism.limbs):
        own = slice(mechanism.loops.starts[i], mechanism.loops.starts[i + 1])
        units = np.repeat([1.0, 1.0 / limbs.size], 3)
        J = jacobian(limb.chain, joints[..., own]) * units[:, None]
        rates = (np.linalg.pinv(J, rcond=_PREVENTED) @ (t * units)[..., None])[..., 0]
        change = jacobian_rate(limb.chain, joints[..., own], rates)
        drifts.append((change @ rates[..., None])[..., 0])
    drift = np.stack(drifts, axis=-2)
    bias = (limbs.borne * drift[..., limbs.limbs, :]).sum(axis=-1)
    drift[..., 3:] /= limbs.size
    carried = (limbs.carried * drift[..., limbs.carriers, :]).sum(axis=-1)
    return bias, carried
