"""Time derivatives of the matrices of K t = J qd with limbs of any kind.

Both matrices are functions of the joints, which are smooth in singular postures, too: all joints go
on straight at their rates, and central differences of fourth order are taken, to 1e-9 or so of the
largest entry.  Loops stay closed to first order, which is all that a derivative asks for, while the
joints of loops that are closed move like a root in front of a singular posture.
"""

from __future__ import annotations

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.parallel.kinetostatics.limb_wrenches import wrenches_of_limbs
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.typing import Array

# The longest move of a joint from one place to the next (rad; of the size).
_STEP = 1e-3
# Places, in steps, and their weights.
_PLACES = (-2, -1, 1, 2)
_WEIGHTS = np.array([1.0, -8.0, 8.0, -1.0]) / 12.0


def mechanism_matrix_rates(mechanism: Mechanism, q: Array, rates: Array) -> tuple[Array, Array]:
    """Return the rates of K (..., m, 6) and of the diagonal of J (..., m).

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
