"""A mechanism with its bodies and in some states, checked and laid out for the kernels."""

from functools import lru_cache
from itertools import pairwise

import numpy as np

from robomech_ros._kernels.dynamics.layout import MASS, MODEL_WIDTH, ROTOR
from robomech_ros._kernels.dynamics.mass import totals
from robomech_ros._kernels.loops import dynamics as kernels
from robomech_ros._kernels.loops.controlled import servo_steps
from robomech_ros._kernels.loops.dynamics import NO_MASS, OPEN
from robomech_ros._kernels.loops.factors import FREE, SINGULAR
from robomech_ros.dynamics.drive_control import (
    CompiledServo,
    DrivenState,
    ServoLaw,
    ServoRun,
    Timing,
)
from robomech_ros.dynamics.model import body_rows, surroundings
from robomech_ros.errors import (
    BadValueError,
    MissingInertiaError,
    NonFiniteError,
    SingularPostureError,
)
from robomech_ros.parallel.mechanism.loops import refuse_status
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.robots import Body, combine_bodies
from robomech_ros.spatial.arrays import as_finite, of_shape
from robomech_ros.typing import Array, ArrayLike, IntArray


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
    """Raise the error for a status of the kernels, for joints q (..., n); none for 0."""
    if not status:
        return
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
        of_shape(what, array, shape)
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
    refuse(mechanism, status, q)
    return q, finite(qd), N, finite(N_dot)


def loop_servo(
    model: Mechanism, plant: Mechanism, friction: tuple[Array, Array], law: ServoLaw
) -> CompiledServo:
    """Simulate a controller with the model of a mechanism on it, or on a loaded one.

    The friction is that of all joints (4, n) of the one that moves, and of the model.
    """
    if not np.array_equal(plant.loops.packed, model.loops.packed):
        raise BadValueError("plant", plant.name, f"the limbs of the model, '{model.name}'")
    n, m, loops = model.n, model.dof, plant.loops
    models = np.stack([mechanism_model(plant), mechanism_model(model)])
    tables = np.zeros((2, 7, n))
    tables[:, :4] = friction
    drives = model.drive_index
    tables[1, 4:6, drives], tables[1, 6, drives] = law.gains.T, law.effort
    around = surroundings((n,), law.gravity)[0].copy()
    chains = loops.packed, loops.starts, loops.drives, loops.weights

    def servo(state: DrivenState, wanted: Array, stops: Array, timing: Timing) -> ServoRun:
        given = tables.copy()
        given[0, 4:6, drives] = stops.T
        how = np.array(
            [1.0 / loops.size, law.mode, timing.share, timing.period, timing.substeps], np.float64
        )
        row = np.concatenate([state.q, state.rates, state.learned])
        out, report = np.empty((len(wanted), n + 2 * m)), np.zeros(1, np.int64)
        status = servo_steps(*chains, models, given, how, around, wanted, row, out, report)
        state.q[:], state.rates[:], state.learned[:] = np.split(row, [n, n + m])
        ended = "the way comes to a singular posture, in which the assembly mode ends"
        q, rates, effort = np.split(out[: report[0]], [n, n + m], axis=1)
        return ServoRun(q, rates, effort, ended if status in (SINGULAR, FREE) else "")

    return servo
