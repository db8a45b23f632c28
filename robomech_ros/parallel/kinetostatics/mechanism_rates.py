"""Time derivatives of the matrices of K t = J qd with limbs of any kind.

The drives go on at their rates, and all joints with them: central differences of fourth order, to
1e-9 or so of the largest entry.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import BadValueError
from robomech_ros.outcomes import Code
from robomech_ros.parallel.kinetostatics.limb_wrenches import limb_wrenches
from robomech_ros.parallel.mechanism.model import Mechanism

__all__ = ["mechanism_matrix_rates"]

Array = NDArray[np.float64]

# The longest move of a joint from one place to the next (rad; of the size).
_STEP = 1e-3
# Places, in steps, and their weights.
_PLACES = (-2, -1, 1, 2)
_WEIGHTS = np.array([1.0, -8.0, 8.0, -1.0]) / 12.0


def mechanism_matrix_rates(mechanism: Mechanism, q: Array, rates: Array) -> tuple[Array, Array]:
    """Give the rates of K (..., m, 6) and of the diagonal of J (..., m).

    Parameters
    ----------
    mechanism : Mechanism
    q : ndarray, shape (..., n)
        All joints (rad or m), loops closed.
    rates : ndarray, shape (..., m)
        Of the drives, NaN where one has none; NaN then, and in singular postures.
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
        speed = np.abs(mechanism.rates(q, rates)[0] * mechanism.loops.weights).max()
    except BadValueError:
        return None
    if not speed > 0.0:
        return np.zeros((mechanism.dof, 6)), np.zeros(mechanism.dof)
    time, drives = _STEP / speed, q[mechanism.drive_index]
    places = [mechanism.close(drives + k * time * rates, q) for k in _PLACES]
    if any(one.status != Code.NONE for one in places):
        return None
    postures = np.array([one.q for one in places])
    K, J = limb_wrenches(mechanism, mechanism.pose(postures), postures).rows()
    weights = _WEIGHTS / time
    return np.tensordot(weights, K, 1), np.tensordot(weights, J, 1)
