"""Checked kernel arguments of a mechanism in some states."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros._kernels.loops import dynamics as kernels
from robomech_ros.errors import NonFiniteError, WrongSizeError
from robomech_ros.parallel.dynamics.model import mechanism_model, refuse
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.typing import Array, IntArray


def as_rows(array: Array) -> Array:
    """Flatten the batch axes to one."""
    return array.reshape(-1, array.shape[-1])


def finite(result: Array) -> Array:
    """Return a result, or raise NonFiniteError where the arguments are too large for one."""
    if not np.isfinite(result).all():
        raise NonFiniteError("result", result)
    return result


def loop_arguments(mechanism: Mechanism) -> tuple[Array, IntArray, IntArray, float]:
    """Return model, starts, drives and scale, as the kernels name them."""
    return mechanism_model(mechanism), *mechanism.loops.chains[1:]


def states(mechanism: Mechanism, q: ArrayLike, **of_drives: ArrayLike) -> list[Array]:
    """Return joints (..., n), and what belongs to the drives (..., m), with the same batch."""
    joints = np.ascontiguousarray(as_finite("q", q, (mechanism.n,)))
    found, shape = [joints], (*joints.shape[:-1], mechanism.dof)
    for what, value in of_drives.items():
        array = np.ascontiguousarray(as_finite(what, value, (mechanism.dof,)))
        if array.shape != shape:
            raise WrongSizeError(what, array.shape, shape)
        found.append(array)
    return found


def complements(mechanism: Mechanism, q: Array, rates: Array) -> tuple[Array, Array, Array, Array]:
    """Return q, the rates of all joints (..., n), N (..., n, m) and its rate."""
    n, m = mechanism.n, mechanism.dof
    N, N_dot = np.empty((2, *q.shape[:-1], n, m))
    qd = np.empty(q.shape)
    out = N.reshape(-1, n, m), N_dot.reshape(-1, n, m), as_rows(qd)
    given = as_rows(q), as_rows(rates)
    status = kernels.complements(*loop_arguments(mechanism), *given, *out)
    if status:
        refuse(mechanism, status, q)
    return q, finite(qd), N, finite(N_dot)
