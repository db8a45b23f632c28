"""A mechanism with its bodies, laid out for the kernels."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import numpy as np

from robomech_ros._kernels.dynamics.layout import MASS, MODEL_WIDTH, ROTOR
from robomech_ros._kernels.dynamics.mass import totals
from robomech_ros._kernels.loops.dynamics import NO_MASS, OPEN
from robomech_ros.dynamics.model import body_rows
from robomech_ros.errors import BadValueError, MissingInertiaError, SingularPostureError
from robomech_ros.parallel.mechanism.loops import refuse_status
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.robots import Body, combine_bodies
from robomech_ros.typing import Array


def platform_body(mechanism: Mechanism) -> Body:
    """Return the body of the platform."""
    if mechanism.platform_body is None:
        last = mechanism.limbs[0].chain.joint_names[-1]
        raise MissingInertiaError([mechanism.platform_link], [last])
    return mechanism.platform_body


def limb_bodies(mechanism: Mechanism) -> list[list[Body | None]]:
    """Return what moves with each joint of each limb, in its frame; the platform with the first."""
    body = platform_body(mechanism)
    rows: list[list[Body | None]] = [list(limb.chain.bodies) for limb in mechanism.limbs]
    first = mechanism.limbs[0].chain
    platform = body.expressed_in(first.transforms[-1])
    own = rows[0][-1]
    rows[0][-1] = platform if own is None else combine_bodies((own, platform))
    return rows


@lru_cache(maxsize=64)
def mechanism_model(mechanism: Mechanism) -> Array:
    """Lay out all limbs, (n + limbs, 24), as ``_kernels.dynamics.layout`` says.

    Links of which nothing is known have no mass.
    """
    parts = []
    for limb, bodies in zip(mechanism.limbs, limb_bodies(mechanism), strict=True):
        chain = limb.chain
        rows = np.zeros((chain.n + 1, MODEL_WIDTH))
        rows[:, :MASS] = chain.packed
        packed = np.zeros((chain.n, 10))
        for j, body in enumerate(bodies):
            if body is not None:
                packed[j, 0], packed[j, 1:4] = body.mass, body.com
                packed[j, 4:] = body.inertia[np.triu_indices(3)]
        rows[:-1, MASS:ROTOR] = body_rows(packed)
        rows[:-1, ROTOR] = [drive.reflected_inertia for drive in chain.drives]
        parts.append(rows)
    model = np.concatenate(parts)
    model.setflags(write=False)
    return model


def limb_totals(mechanism: Mechanism, q: Array, qd: Array) -> Array:
    """Add up mass, first moment (3), momentum (6) and kinetic energy of all limbs, (..., 11)."""
    model, n = mechanism_model(mechanism), mechanism.n
    joints, rates = q.reshape(-1, n), qd.reshape(-1, n)
    out, part = np.zeros((len(joints), 11)), np.empty((len(joints), 11))
    for i, (s, e) in enumerate(pairwise(mechanism.loops.starts)):
        own = (np.ascontiguousarray(one[:, s:e]) for one in (joints, rates))
        totals(model[s + i : e + i + 1], *own, part)
        out += part
    return out.reshape(*q.shape[:-1], 11)


def refuse(mechanism: Mechanism, status: int, q: Array) -> None:
    """Raise the error for a status of the kernels that is not 0, for joints q (..., n)."""
    if status == NO_MASS:
        expected = "bodies or rotors that resist every motion, far from singular postures"
        raise BadValueError("least inertia of the robot", 0.0, expected)
    if status == OPEN:
        raise mechanism.open_loops(q, "q")
    for k, posture in enumerate(q.reshape(-1, mechanism.n) if q.ndim > 1 else ()):
        try:
            mechanism.complement(posture)
        except SingularPostureError as error:
            raise SingularPostureError(f"posture[{k}]", posture, error.expected) from None
    refuse_status(status, q)
