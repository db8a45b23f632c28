"""A parallel robot that a controller of its drives moves."""

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
from robomech_ros.parallel.dynamics.model import mechanism_model
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.typing import Array


def loop_servo(model: Mechanism, plant: Mechanism, law: ServoLaw) -> CompiledServo:
    """Have a controller that knows a mechanism drive it, or the same with a load."""
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
