"""Equations of motion of chains on one floating base, solved by kernels and checked."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robomech_ros._kernels.chain.serial import NOT_FINITE
from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.dynamics import floating
from robomech_ros._kernels.dynamics.layout import MASS, MODEL_WIDTH, ROTOR
from robomech_ros.dynamics.model import body_rows, dynamic_model, surroundings
from robomech_ros.errors import BadValueError, NonFiniteError
from robomech_ros.robots.bodies import Body, possible_body
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC, REVOLUTE
from robomech_ros.typing import Array, ArrayLike

WEIGHTLESS = (0.0, 0.0, 0.0)
_NOTHING = surroundings((6,), WEIGHTLESS)
_NOTHING.setflags(write=False)
_inverse, _forward = direct(floating.floating_inverse), direct(floating.floating_forward)
_mass = direct(floating.floating_mass)
# Rotation that maps x to y, y to z and z to x: the base has three prismatic joints, then three
# revolute joints, along x, y and z.
_NEXT_AXIS = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def floating_models(chains: Sequence[SerialChain], base: Body | None) -> Array:
    """Lay out chains of n joints on one base for the kernels, shape (k, 7 + n, 24)."""
    models = np.zeros((len(chains), 7 + chains[0].n, MODEL_WIDTH))
    models[:, :6, 0] = [PRISMATIC] * 3 + [REVOLUTE] * 3
    models[:, :6, 1:10] = _NEXT_AXIS.ravel()
    for model, chain in zip(models, chains, strict=True):
        model[6:] = dynamic_model(chain)
    if base is not None:
        body = possible_body("base", base)
        packed = [body.mass, *body.com, *body.inertia[np.triu_indices(3)]]
        models[0, 5, MASS:ROTOR] = body_rows(np.array([packed]))[0]
    models.setflags(write=False)
    return models


def floating_inertia(models: Array, q: Array) -> Array:
    """Compute the inertia (6 + k n, 6 + k n) of chains on one base at q (k, n)."""
    M = np.empty((6 + q.size, 6 + q.size))
    check_status(_mass(models, q, M), q=q.ravel())
    return M


def floating_efforts(
    models: Array,
    q: Array,
    u: Array,
    du: Array,
    gravity: ArrayLike,
    tip_wrench: ArrayLike | None = None,
) -> Array:
    """Compute the efforts (6 + k n,) of a motion of chains on one base."""
    out = np.empty(u.shape)
    status = _inverse(models, q, u, du, _surroundings(gravity, tip_wrench), out)
    # A sum takes a third of the time of np.isfinite.
    if not status and math.isfinite(sum(out.ravel().tolist())):
        return out
    if not np.isfinite(out).all():
        status |= NOT_FINITE
    check_status(
        status, q=q.ravel(), rates=u, accelerations=du, gravity=gravity, tip_wrench=tip_wrench
    )
    return out


def floating_accelerations(
    models: Array,
    q: Array,
    u: Array,
    efforts: Array,
    gravity: ArrayLike,
    tip_wrench: ArrayLike | None,
) -> Array:
    """Compute the accelerations (6 + n,) of one chain from its efforts."""
    around, out = _surroundings(gravity, tip_wrench), np.empty(u.shape)
    status = _forward(models[0], q, u, efforts, around, out)
    check_status(status, q=q, rates=u, efforts=efforts, gravity=gravity, tip_wrench=tip_wrench)
    return out


def check_status(status: int, **values: ArrayLike | None) -> None:
    """Raise the error for the status of a kernel that was given these values."""
    if not status:
        return
    given = {what: np.asarray(value) for what, value in values.items() if value is not None}
    for what, array in given.items():
        if not np.isfinite(array).all():
            raise NonFiniteError(what, array)
    if status & ~NOT_FINITE:
        expected = "bodies that resist every motion"
        raise BadValueError("least inertia of the floating chain", 0.0, expected)
    what, array = max(given.items(), key=lambda one: np.abs(one[1]).max())
    largest = float(np.abs(array).max())
    raise BadValueError(f"largest of {what}", largest, "values with a finite result")


def _surroundings(gravity: ArrayLike, tip_wrench: ArrayLike | None) -> Array:
    if gravity is WEIGHTLESS and tip_wrench is None:
        return _NOTHING
    return surroundings((6,), gravity, tip_wrench)
