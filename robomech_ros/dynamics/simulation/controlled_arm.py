"""A robot that obeys its dynamics under a torque controller, in fixed steps of time."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros._kernels.dynamics import controlled_chain as kernels
from robomech_ros._kernels.tolerances import LARGEST_SERVO_RATE
from robomech_ros.dynamics.friction import friction_model
from robomech_ros.dynamics.model import GRAVITY, dynamic_model, positive_number, surroundings
from robomech_ros.dynamics.simulation.fixed_gains import felt_inertias
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_choice, as_finite, real_number

__all__ = ["CONTROLS", "ControlledArm", "ControlledMotion"]

Array = NDArray[np.float64]

CONTROLS = ("computed-torque", "pd-gravity")

_MOST_SUBSTEPS = 1000


@dataclass(frozen=True, eq=False)
class ControlledMotion:
    """What became of a chain under a controller, at the end of each period.

    Attributes
    ----------
    q, qd : ndarray, shape (m, n)
        Joint values (rad or m) and rates (rad/s or m/s) at the end of each period that was done.
    effort : ndarray, shape (m, n)
        Torques or forces of the drives in each (N m or N), within their limits.
    saturated : ndarray of bool, shape (m, n)
        Which were at their limits.
    reason : str
        Empty, or why it stopped before the end; the state is then the last one that was finite.
    """

    q: Array
    qd: Array
    effort: Array
    saturated: NDArray[np.bool_]
    reason: str


@dataclass(frozen=True, eq=False)
class ControlledArm:
    """A controller of torques, the chain that it knows, and the one that it drives.

    ``"computed-torque"`` asks the inverse dynamics for the torques of ``qdd + kd (qd - rate) + kp
    (q - value)``, wanted less measured; ``"pd-gravity"`` adds ``kd (..) + kp (..)`` to the torques
    that hold the chain.  Both add the friction of the model at the wanted rate.  Without kp and kd
    errors decay as of an oscillator of the natural frequency ``bandwidth`` and this damping ratio.

    With an observer the controller also learns, at that rate, the torques that its model does not
    explain, such as those of a payload, and adds them.  Joints at a stop and those that friction
    holds teach it nothing, and it learns no more than the drives exert.  What moves must have less
    than ``2 damping / (bandwidth period)`` times the inertia of the model in every direction, 40
    times by default, or the chain swings, within the limits of its drives.

    The chain moves by steps that let dry friction stick and break away, and stops hold it without a
    rebound at the position limits.

    Parameters
    ----------
    model : SerialChain
        Of n joints: what the controller knows.
    plant : SerialChain, optional
        What moves; default the model.  It may carry a payload that the model does not know.
    control : str, optional
        One of CONTROLS.
    bandwidth : float, optional
        In rad/s.
    damping : float, optional
        1 = critical.
    kp, kd : array_like, shape (n,), optional
        Gains of errors and of their rates: for computed torque in 1/s^2 and 1/s, else in N m/rad
        and N m s/rad, or N/m and N s/m.
    observer : float, optional
        Rate at which torques that the model does not explain are learned, in rad/s; 0 = not at all.
    period : float, optional
        Of the controller (s).
    substeps : int, optional
        Steps of the chain in each period.
    gravity : array_like, shape (3,), optional
        In the axes of the base (m/s^2).

    Raises
    ------
    MissingInertiaError, BadValueError, WrongSizeError, NonFiniteError
        A chain has no bodies, or no possible ones; both differ in the number of joints; or a
        number is not what it has to be.
    """

    model: SerialChain
    plant: SerialChain | None = None
    control: str = CONTROLS[0]
    bandwidth: float = 50.0
    damping: float = 1.0
    kp: ArrayLike | None = None
    kd: ArrayLike | None = None
    observer: float = 0.0
    period: float = 1e-3
    substeps: int = 1
    gravity: ArrayLike = GRAVITY
    _arguments: tuple[tuple[Any, ...], float, int, float] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        check_chain(self.model)
        plant = self.model if self.plant is None else self.plant
        check_chain(plant)
        n = self.model.n
        if plant.n != n:
            raise WrongSizeError("joints of the plant", plant.n, f"{n}, as many as of the model")
        if n > kernels.MOST_SERVO_JOINTS:
            raise BadValueError("number of joints", n, f"at most {kernels.MOST_SERVO_JOINTS}")
        mode = CONTROLS.index(as_choice("control", self.control, CONTROLS))
        period = positive_number("period", self.period)
        expected = "a number that is not negative, in rad/s"
        rate = real_number("observer", self.observer, expected)
        if not 0.0 <= rate < np.inf:
            raise BadValueError("observer", self.observer, expected)
        if (
            not isinstance(self.substeps, int | np.integer)
            or isinstance(self.substeps, bool)
            or not 1 <= self.substeps <= _MOST_SUBSTEPS
        ):
            expected = f"a whole number from 1 to {_MOST_SUBSTEPS}"
            raise BadValueError("substeps", self.substeps, expected)
        effort = np.where(np.isfinite(self.model.effort), self.model.effort, np.inf)
        arguments = (
            dynamic_model(plant),
            np.vstack([friction_model(plant), plant.lower, plant.upper]),
            dynamic_model(self.model),
            np.vstack([friction_model(self.model), self._gains(mode), effort]),
            mode,
            surroundings((n,), self.gravity)[0].copy(),
        )
        object.__setattr__(self, "plant", plant)
        object.__setattr__(self, "_arguments", (arguments, period, int(self.substeps), rate))

    def _gains(self, mode: int) -> Array:
        frequency = positive_number("bandwidth", self.bandwidth)
        damping = positive_number("damping", self.damping)
        for name, value, unit in (("bandwidth", frequency, " rad/s"), ("damping", damping, "")):
            if value > LARGEST_SERVO_RATE:
                raise BadValueError(name, value, f"at most {LARGEST_SERVO_RATE:g}{unit}")
        stiffness = viscosity = np.ones(self.model.n)
        if mode == kernels.PD_WITH_GRAVITY and self.model.n > 0:
            turn = frequency * positive_number("period", self.period)
            stiffness, viscosity = felt_inertias(self.model, turn, damping)
        gains = np.array([frequency**2 * stiffness, 2.0 * damping * frequency * viscosity])
        for row, (name, given) in enumerate((("kp", self.kp), ("kd", self.kd))):
            if given is not None:
                array = as_finite(name, given, (self.model.n,))
                if array.ndim != 1:
                    raise WrongSizeError(name, array.shape, f"({self.model.n},)")
                gains[row] = array
                if gains[row].min(initial=0.0) < 0.0:
                    raise BadValueError(name, gains[row].min(), "no negative gain")
        return gains

    def run(
        self,
        q: Array,
        qd: Array,
        wanted: ArrayLike,
        *,
        period: float | None = None,
        held: ArrayLike | None = None,
        observed: Array | None = None,
    ) -> ControlledMotion:
        """Drive the chain along what is wanted, from a state that is brought to the end.

        Parameters
        ----------
        q, qd : ndarray of float64, shape (n,)
            Joint values (rad or m), within the position limits of the plant, and rates; overwritten
            by those at the end.
        wanted : array_like, shape (m, 3, n)
            Joint values, rates and accelerations at the beginning of each period.
        period : float, optional
            Of the controller in this run (s); default its own.
        held : array_like of bool, shape (n,), optional
            Joints that brakes hold where they are.
        observed : ndarray of float64, shape (n,), optional
            Torques (N m or N) that the observer has learned before; overwritten by those at the
            end.  Default none.

        Returns
        -------
        ControlledMotion

        Raises
        ------
        BadValueError, WrongSizeError, NonFiniteError
            The arrays are not what they have to be.
        """
        n = self.model.n
        wanted = np.ascontiguousarray(as_finite("wanted", wanted, (3, n)))
        if wanted.ndim != 3:
            raise WrongSizeError("wanted", wanted.shape, f"(m, 3, {n})")
        learned = np.zeros(n) if observed is None else observed
        state = _state(n, q=q, qd=qd, observed=learned)
        arguments, own_period, substeps, rate = self._arguments
        step = own_period if period is None else positive_number("period", period)
        out = np.empty((len(wanted), 3, n))
        plant, joints, model, controller, mode, around = arguments
        constants = (plant, _with_stops(joints, state[0], held), model, controller, mode)
        share = -math.expm1(-rate * step)
        done = kernels.servo_steps(*constants, share, around, wanted, step, substeps, state, out)
        q[:], qd[:], learned[:] = state
        effort = out[:done, 2]
        reason = "" if done == len(wanted) else _ran_away(done * step, qd)
        saturated = np.abs(effort) >= controller[kernels.EFFORT]
        return ControlledMotion(out[:done, 0], out[:done, 1], effort, saturated, reason)


def _state(n: int, **arrays: Array) -> Array:
    """Check arrays (n,) that the end of a motion overwrites; gives them in rows."""
    for name, array in arrays.items():
        if not isinstance(array, np.ndarray) or array.dtype != np.float64:
            raise BadValueError(name, array, "an array of float64, to be overwritten")
        if array.shape != (n,):
            raise WrongSizeError(name, array.shape, f"({n},)")
        if not np.isfinite(array).all():
            raise NonFiniteError(name, array)
    return np.array([*arrays.values()])


def _ran_away(seconds: float, qd: Array) -> str:
    return (
        f"the motion ran away after {seconds:.6g} s, with rates of up to "
        f"{np.abs(qd).max():.3g} rad/s or m/s; {LARGEST_SERVO_RATE:g} is the most"
    )


def _with_stops(joints: Array, q: Array, held: ArrayLike | None) -> Array:
    """Put the stops where they hold: a joint beyond its limits, to be thrown back, stands at one.

    Brakes are stops on both sides.
    """
    joints = joints.copy()
    stops = joints[kernels.STOPS :]
    np.minimum(stops[0], q, out=stops[0])
    np.maximum(stops[1], q, out=stops[1])
    if held is not None:
        brakes = np.asarray(held)
        if brakes.shape != q.shape or brakes.dtype != np.bool_:
            raise BadValueError("held", held, f"{len(q)} of True and False")
        stops[:, brakes] = q[brakes]
    return joints
