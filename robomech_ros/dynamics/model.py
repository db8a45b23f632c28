"""A chain's bodies and what surrounds it, checked and laid out for the kernels of dynamics."""

from __future__ import annotations

from functools import lru_cache
from typing import NoReturn

import numpy as np

from robomech_ros._kernels.chain.serial import NOT_FINITE
from robomech_ros._kernels.dynamics.layout import (
    LINEAR_ACCELERATION,
    MASS,
    MODEL_WIDTH,
    ROTOR,
    SURROUNDINGS,
    TIP_WRENCH,
)
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import LARGEST, LEAST, real_array, real_within
from robomech_ros.typing import Array, ArrayLike

GRAVITY = (0.0, 0.0, -9.81)


@lru_cache(maxsize=256)
def dynamic_model(chain: SerialChain) -> Array:
    """Lay out a chain with its bodies and rotors as ``_kernels.dynamics.layout`` says.

    The shape is (n + 1, 24), or (m + 1, 28) where n of m joints move by themselves.
    """
    check_chain(chain)
    model = np.zeros((len(chain.packed), MODEL_WIDTH + chain.packed.shape[1] - MASS))
    model[:, :MASS], model[:, MODEL_WIDTH:] = chain.packed[:, :MASS], chain.packed[:, MASS:]
    model[:-1, MASS:ROTOR] = body_parameters(chain)
    for k, drive in enumerate(chain.drives):
        joint, gain = chain.driven_joint(k)
        model[joint, ROTOR] = drive.reflected_inertia / gain**2
    model.setflags(write=False)
    return model


def body_parameters(chain: SerialChain) -> Array:
    """Return the ten numbers of each body in which the torques are linear.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.

    Returns
    -------
    ndarray, shape (n, 10), or (m, 10) with followers
        Mass (kg), first moment (kg m), and the moments xx, xy, xz, yy, yz, zz about the origin
        (kg m^2) of the frame that moves with the joint, z its axis.
    """
    check_chain(chain)
    return body_rows(chain.packed_bodies)


def body_rows(packed: Array) -> Array:
    """Return moments about the origins of bodies packed as in a chain, (n, 10)."""
    rows = packed.copy()
    mass, com = rows[:, 0], rows[:, 1:4].copy()
    rows[:, 1:4] *= mass[:, None]
    square = (com**2).sum(axis=1)
    for column, (i, j) in enumerate(zip(*np.triu_indices(3), strict=True), start=4):
        rows[:, column] += mass * ((square if i == j else 0.0) - com[:, i] * com[:, j])
    return rows


def surroundings(
    shape: tuple[int, ...],
    gravity: ArrayLike,
    tip_wrench: ArrayLike | None = None,
    base_twist: ArrayLike | None = None,
    base_twist_rate: ArrayLike | None = None,
) -> Array:
    """Lay out what surrounds the chain: (1, 15) for all states of a batch, or (m, 15).

    The shape is that of the joint values, (n,) or (*batch, n); gravity (3,) is in the base (m/s^2),
    and the others are of shape (6,) or (*batch, 6).
    """
    if gravity is GRAVITY and tip_wrench is None and base_twist is None and base_twist_rate is None:
        return _ON_EARTH
    batch = shape[:-1]
    g = _part("gravity", gravity, (3,), ())
    wrench, twist, rate = (
        np.zeros((1, 6)) if value is None else _part(name, value, (6,), batch)
        for name, value in (
            ("tip_wrench", tip_wrench),
            ("base_twist", base_twist),
            ("base_twist_rate", base_twist_rate),
        )
    )
    (rows,) = np.broadcast_shapes(*((len(part),) for part in (g, wrench, twist, rate)))
    around = np.zeros((rows, SURROUNDINGS))
    around[:, :3] = twist[:, :3]
    around[:, 3:TIP_WRENCH] = rate
    around[:, LINEAR_ACCELERATION:TIP_WRENCH] -= g
    around[:, TIP_WRENCH:] = wrench
    return around


def _part(name: str, value: ArrayLike, tail: tuple[int, ...], batch: tuple[int, ...]) -> Array:
    """Return rows of a vector that is one for all of a batch, or one for each."""
    array = real_array(name, value)
    if array.shape not in (tail, (*batch, *tail)):
        expected = f"{tail} or {(*batch, *tail)}" if batch else tail
        raise WrongSizeError(name, array.shape, expected)
    if not np.isfinite(array).all():
        raise NonFiniteError(name, array)
    return array.reshape(-1, *tail)


_ON_EARTH = np.zeros((1, SURROUNDINGS))
_ON_EARTH[0, LINEAR_ACCELERATION:TIP_WRENCH] = np.negative(GRAVITY)
_ON_EARTH.setflags(write=False)


def positive_number(what: str, value: object) -> float:
    """Return a finite number above 0."""
    return real_within(what, value, "a positive number", LEAST, LARGEST)


def raise_outcome(chain: SerialChain, status: int, **arrays: Array) -> NoReturn:
    """Raise the error for a status of a kernel, not 0, that was given these arrays (..., n)."""
    for name, array in arrays.items():
        bad = np.argwhere(~np.isfinite(array))
        if len(bad):
            *row, joint = (int(i) for i in bad[0])
            where = f" in row {', '.join(map(str, row))}" if row else ""
            what = f"{name} of joint '{chain.joint_names[joint]}'{where}"
            raise NonFiniteError(what, float(array[(*row, joint)]))
    if status & ~NOT_FINITE:
        raise BadValueError(
            "least inertia of the chain", 0.0, "bodies or rotors that resist every motion"
        )
    name, largest = max(
        ((name, float(np.abs(array).max(initial=0.0))) for name, array in arrays.items()),
        key=lambda pair: pair[1],
    )
    raise BadValueError(f"largest of {name}", largest, "values with a finite result")
