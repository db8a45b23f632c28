"""Systems that a drive controller can command, and a chain that follows commands exactly."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.friction import friction_model
from robomech_ros.dynamics.model import dynamic_model, surroundings
from robomech_ros.errors import BadValueError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class ServoLaw:
    """A controller of m drives: its mode in the kernels, and gains (2, m) of errors and rates.

    Limits of the efforts (m,) are infinite where there is none; gravity (3,) is in the base
    (m/s^2).
    """

    mode: int
    gains: Array
    effort: Array
    gravity: Array


@dataclass(frozen=True, eq=False)
class DrivenState:
    """State of n joints q (n,) and their m drives; a run overwrites the arrays.

    The drives have rates (m,), and efforts (m,) that the observer has learned (N m or N).
    """

    q: Array
    rates: Array
    learned: Array


@dataclass(frozen=True)
class Timing:
    """Period of the controller (s), and the steps of the motion in each period.

    The share is the part of the unexplained efforts that is learned in a period, 0 to 1.
    """

    period: float
    substeps: int
    share: float


@dataclass(frozen=True, eq=False)
class ServoRun:
    """All joints q (k, n) at the ends of k periods, and rates and efforts (k, m) of the drives.

    It is ``lost`` where no posture of the assembly mode follows, and says why.
    """

    q: Array
    rates: Array
    effort: Array
    lost: str = ""


# Drives a state along what is wanted (k, 3, m), between least and largest values (2, m).
CompiledServo = Callable[[DrivenState, Array, Array, Timing], ServoRun]


def chain_servo(model: SerialChain, plant: SerialChain, law: ServoLaw) -> CompiledServo:
    """Simulate a controller with the model of one chain on another chain."""
    # Compiled for those who simulate drives.
    from robomech_ros._kernels.dynamics import controlled_chain as kernels

    if model.n > kernels.MOST_SERVO_JOINTS:
        raise BadValueError("number of joints", model.n, f"at most {kernels.MOST_SERVO_JOINTS}")
    moved, known = dynamic_model(plant), dynamic_model(model)
    friction = friction_model(plant)
    controller = np.vstack([friction_model(model), law.gains, law.effort])
    around = surroundings((model.n,), law.gravity)[0].copy()

    def servo(state: DrivenState, wanted: Array, stops: Array, timing: Timing) -> ServoRun:
        out = np.empty((len(wanted), 3, model.n))
        rows = np.array([state.q, state.rates, state.learned])
        joints = np.vstack([friction, stops])
        constants = (moved, joints, known, controller, law.mode, timing.share, around)
        done = kernels.servo_steps(*constants, wanted, timing.period, timing.substeps, rows, out)
        state.q[:], state.rates[:], state.learned[:] = rows
        return ServoRun(out[:done, 0], out[:done, 1], out[:done, 2])

    return servo
