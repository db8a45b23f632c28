"""Rates of the matrices of K t = J qd, and accelerations, with limbs of any kind.

Both matrices are functions of the joints, which are smooth in singular postures, too: all joints go
on straight at their rates, and central differences of fourth order are taken, to 1e-9 or so of the
largest entry.  Loops stay closed to first order, which is all that a derivative asks for, while the
joints of loops that are closed move like a root in front of a singular posture.

A limb moves the platform with ``J qdd + dJ qd``.  Wrenches that do no work on its passive joints
leave ``w (dt - dJ qd) = w j qdd`` of the drive, and 0 of those that the limb bears by itself.
"""

from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinetostatics import jacobian, jacobian_rate
from robomech_ros.parallel.kinetostatics.limb_wrenches import Wrenches, wrenches_of_limbs
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.typing import Array, ArrayLike

# The longest move of a joint from one place to the next (rad; of the size).
_STEP = 1e-3
# Places, in steps, and their weights.
_PLACES = (-2, -1, 1, 2)
_WEIGHTS = np.array([1.0, -8.0, 8.0, -1.0]) / 12.0
# Part of an acceleration that limbs prevent and that is rounding, of what it is made of.
_PREVENTED = 1e-6


def mechanism_matrix_rates(mechanism: Mechanism, q: Array, rates: Array) -> tuple[Array, Array]:
    """Return the rates of K (..., m, 6) and of the diagonal of J (..., m).

    All joints (..., n) close the loops.  Both are NaN where one of the rates (..., m) of the drives
    is, and in singular postures.
    """
    m = mechanism.dof
    lead, flat = q.shape[:-1], q.reshape(-1, mechanism.n)
    dK, dJ = np.full((len(flat), m, 6), np.nan), np.full((len(flat), m), np.nan)
    for k, (posture, own) in enumerate(zip(flat, rates.reshape(-1, m), strict=True)):
        if not np.isfinite(own).all():
            continue
        found = _differences(mechanism, posture, own)
        if found is not None:
            dK[k], dJ[k] = found
    return dK.reshape(*lead, m, 6), dJ.reshape(*lead, m)


def _differences(mechanism: Mechanism, q: Array, rates: Array) -> tuple[Array, Array] | None:
    try:
        speeds = mechanism.rates(q, rates)[0]
    except BadValueError:
        return None
    speed = np.abs(speeds * mechanism.loops.weights).max()
    if not speed > 0.0:
        return np.zeros((mechanism.dof, 6)), np.zeros(mechanism.dof)
    time = _STEP / speed
    K, J = wrenches_of_limbs(mechanism, q + np.outer(_PLACES, time * speeds)).rows()
    # A row changes its sign where J goes through zero: all count as in the posture itself.
    here = wrenches_of_limbs(mechanism, q).rows()[0]
    signs = np.where((K * here).sum(axis=-1) < 0.0, -1.0, 1.0)
    weights = _WEIGHTS / time
    return np.tensordot(weights, K * signs[..., None], 1), np.tensordot(weights, J * signs, 1)


def mechanism_drive_accelerations(
    mechanism: Any, q: ArrayLike | None, limbs: Wrenches, t: Array, dt: Array
) -> Array:
    """Return what the entries of J times the accelerations of the drives are, (..., m).

    The limbs are those for all joints q (..., n), and t and dt (..., 6) the twist of the platform
    and its rate; a rate that limbs prevent is refused.
    """
    bias, carried = _biases(mechanism, q, limbs, t)
    scaled = dt * np.repeat([1.0, 1.0 / limbs.size], 3)
    off = np.abs((limbs.carried @ scaled[..., None])[..., 0] - carried).max(initial=0.0)
    if off > _PREVENTED * max(np.abs(scaled).max(initial=0.0), np.abs(carried).max(initial=0.0)):
        what = "twist_rate, the part of it that limbs prevent"
        raise BadValueError(what, float(off), "0: the platform does not have it with this twist")
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
        own = mechanism.loops.joints_of(i)
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
