"""A parallel robot that a controller of its drives moves, and postures spread over its mode."""

from __future__ import annotations

import numpy as np

from robomech_ros._kernels.loops.controlled import servo_steps
from robomech_ros._kernels.loops.factors import FREE, SINGULAR
from robomech_ros.dynamics.drive_control import (
    CompiledServo,
    DrivenState,
    ServoLaw,
    ServoRun,
    Timing,
)
from robomech_ros.dynamics.friction import friction_model
from robomech_ros.dynamics.model import surroundings
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.posture_samples import spread_values
from robomech_ros.parallel.dynamics.calls import loop_arguments
from robomech_ros.parallel.dynamics.model import mechanism_model
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.typing import Array

# Each costs as much as closing the loops.
_MOST_POSTURES = 256


def mode_postures(mechanism: Mechanism, count: int) -> Array:
    """Spread postures (k, n), at most count, over the assembly mode of home."""
    drives = mechanism.drive_index
    limits = mechanism.lower[drives], mechanism.upper[drives]
    count = min(count, _MOST_POSTURES)
    return mechanism.midway_postures(spread_values(mechanism.types[drives], *limits, count))


def loop_servo(model: Mechanism, plant: Mechanism, law: ServoLaw) -> CompiledServo:
    """Have a controller that knows a mechanism drive it, or the same with a load.

    Raises
    ------
    MissingInertiaError
        Nothing is known of the platform.
    BadValueError
        They are two different mechanisms.
    """
    if not np.array_equal(plant.loops.packed, model.loops.packed):
        raise BadValueError("plant", plant.name, f"the limbs of the model, '{model.name}'")
    n, m, loops = model.n, model.dof, plant.loops
    models = np.stack([mechanism_model(plant), mechanism_model(model)])
    tables = np.zeros((2, 7, n))
    for table, mechanism in zip(tables, (plant, model), strict=True):
        rows = [friction_model(limb.chain) for limb in mechanism.limbs]
        table[:4] = np.concatenate(rows, axis=1)
    drives = model.drive_index
    tables[1, 4:6, drives], tables[1, 6, drives] = law.gains.T, law.effort
    around = surroundings((n,), law.gravity)[0].copy()
    _, starts, driven, scale = loop_arguments(plant)

    def servo(state: DrivenState, wanted: Array, stops: Array, timing: Timing) -> ServoRun:
        given = tables.copy()
        given[0, 4:6, drives] = stops.T
        how = np.array([scale, law.mode, timing.share, timing.period, timing.substeps], np.float64)
        row = np.concatenate([state.q, state.rates, state.learned])
        out, report = np.empty((len(wanted), n + 2 * m)), np.zeros(1, np.int64)
        status = servo_steps(
            loops.packed,
            starts,
            driven,
            loops.weights,
            models,
            given,
            how,
            around,
            wanted,
            row,
            out,
            report,
        )
        state.q[:], state.rates[:], state.learned[:] = np.split(row, [n, n + m])
        done = out[: report[0]]
        lost = ""
        if status in (SINGULAR, FREE):
            lost = "the way comes to a singular posture, in which the assembly mode ends"
        return ServoRun(done[:, :n], done[:, n : n + m], done[:, n + m :], lost)

    return servo
