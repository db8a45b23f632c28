"""A robot that obeys its dynamics under a torque controller, in fixed steps of time."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from robomech_ros._kernels.dynamics import controlled_chain as kernels
from robomech_ros._kernels.tolerances import LARGEST_SERVO_RATE
from robomech_ros.dynamics.drive_control import CompiledServo, DrivenState, ServoLaw, Timing
from robomech_ros.dynamics.model import GRAVITY, positive_number
from robomech_ros.dynamics.simulation.fixed_gains import effective_inertias
from robomech_ros.dynamics.systems import DynamicSystem, dynamic_system
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.entry_checks import whole_number
from robomech_ros.spatial.arrays import LARGEST, as_choice, as_finite, as_single, real_within
from robomech_ros.typing import Array, ArrayLike, BoolArray

CONTROLS = ("computed-torque", "pd-gravity")

_MOST_SUBSTEPS = 1000


@dataclass(frozen=True, eq=False)
class ControlledMotion:
    """Motion of a controlled robot, at the end of each period.

    Attributes
    ----------
    q : ndarray, shape (k, n)
        Values of all joints (rad or m) at the end of each period that was done.
    qd : ndarray, shape (k, m)
        Rates of the drives (rad/s or m/s) then, of a chain those of all joints.
    effort : ndarray, shape (k, m)
        Torques or forces of the drives in each (N m or N), within their limits.
    saturated : ndarray of bool, shape (k, m)
        Which were at their limits.
    reason : str
        Empty, or why it stopped before the end; the state is then the last one that was finite.
    singular : bool
        Whether it stopped before a singular posture, where the assembly mode of a parallel robot
        ends.
    """

    q: Array
    qd: Array
    effort: Array
    saturated: BoolArray
    reason: str
    singular: bool = False


@dataclass(frozen=True, eq=False)
class ControlledArm:
    """A controller of torques, the robot that it knows, and the one that it drives.

    ``"computed-torque"`` asks the inverse dynamics for the torques of ``qdd + kd (qd - rate) + kp
    (q - value)``, wanted less measured; ``"pd-gravity"`` adds ``kd (..) + kp (..)`` to the torques
    that hold the chain.  Both add the friction of the model at the wanted rate.  Without kp and kd
    errors decay as of an oscillator of the natural frequency ``bandwidth`` and this damping ratio.

    With an observer the controller also learns, at that rate, the torques that its model does not
    explain, such as those of a payload, and adds them.  Joints at a stop and those that friction
    holds teach it nothing, and it learns no more than the drives exert.  What moves must have less
    than ``2 damping / (bandwidth period)`` times the inertia of the model in every direction, 40
    times by default, or the chain swings, within the limits of its drives.

    The robot moves by steps that let dry friction stick and break away, and stops hold it without a
    rebound at the position limits.  Of a parallel robot that is so at its drives, and all loops are
    closed after each step; dry friction of passive joints brakes them, and lets them creep at rest.

    Parameters
    ----------
    model : SerialChain or DynamicSystem
        What the controller knows: a chain, or a parallel robot as ``ParallelDynamics``, of n
        joints, m of them with drives; all of a chain.
    plant : SerialChain or DynamicSystem, optional
        What moves; default the model.  It may carry a payload that the model does not know.
    control : str, optional
        One of CONTROLS.
    bandwidth : float, optional
        In rad/s.
    damping : float, optional
        1 = critical.
    kp, kd : array_like, shape (m,), optional
        Gains of errors and of their rates: for computed torque in 1/s^2 and 1/s, else in N m/rad
        and N m s/rad, or N/m and N s/m.
    observer : float, optional
        Rate at which torques that the model does not explain are learned, in rad/s; 0 = not at all.
    period : float, optional
        Period of the controller (s).
    substeps : int, optional
        Steps of the robot in each period.
    gravity : array_like, shape (3,), optional
        In the axes of the base (m/s^2).
    """

    model: SerialChain | DynamicSystem
    plant: SerialChain | DynamicSystem | None = None
    control: str = CONTROLS[0]
    bandwidth: float = 50.0
    damping: float = 1.0
    kp: ArrayLike | None = None
    kd: ArrayLike | None = None
    observer: float = 0.0
    period: float = 1e-3
    substeps: int = 1
    gravity: ArrayLike = GRAVITY
    _systems: tuple[DynamicSystem, DynamicSystem] = field(init=False, repr=False)
    _servo: CompiledServo = field(init=False, repr=False)
    _effort: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        model = dynamic_system(self.model)
        plant = model if self.plant is None else dynamic_system(self.plant)
        given = [len(model.joint_names), len(model.drive_names)]
        if type(plant) is not type(model):
            raise BadValueError("plant", self.plant, "what the model is: a chain or no chain")
        if [len(plant.joint_names), len(plant.drive_names)] != given:
            expected = f"{given[0]}, as many as of the model"
            raise WrongSizeError("joints of the plant", len(plant.joint_names), expected)
        mode = CONTROLS.index(as_choice("control", self.control, CONTROLS))
        positive_number("period", self.period)
        expected = "a number that is not negative, in rad/s"
        real_within("observer", self.observer, expected, 0.0, LARGEST)
        expected = f"a whole number from 1 to {_MOST_SUBSTEPS}"
        whole_number("substeps", self.substeps, 1, _MOST_SUBSTEPS, expected)
        effort = np.where(np.isfinite(model.effort), model.effort, np.inf)
        gravity = np.array(as_finite("gravity", self.gravity, (3,)))
        law = ServoLaw(mode, self._gains(model, mode), effort, gravity)
        object.__setattr__(self, "plant", self.model if self.plant is None else self.plant)
        object.__setattr__(self, "_systems", (model, plant))
        object.__setattr__(self, "_servo", model.compiled_servo(plant, law))
        object.__setattr__(self, "_effort", effort)

    def _gains(self, model: DynamicSystem, mode: int) -> Array:
        m = len(model.drive_names)
        frequency = positive_number("bandwidth", self.bandwidth)
        damping = positive_number("damping", self.damping)
        for name, value, unit in (("bandwidth", frequency, " rad/s"), ("damping", damping, "")):
            if value > LARGEST_SERVO_RATE:
                raise BadValueError(name, value, f"at most {LARGEST_SERVO_RATE:g}{unit}")
        stiffness = viscosity = np.ones(m)
        if mode == kernels.PD_WITH_GRAVITY and m > 0:
            turn = frequency * positive_number("period", self.period)
            stiffness, viscosity = effective_inertias(model, turn, damping)
        gains = np.array([frequency**2 * stiffness, 2.0 * damping * frequency * viscosity])
        for row, (name, given) in enumerate((("kp", self.kp), ("kd", self.kd))):
            if given is not None:
                gains[row] = as_single(name, given, (m,))
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
        """Drive the robot along what is wanted, from a state that is brought to the end.

        Parameters
        ----------
        q : ndarray of float64, shape (n,)
            Values of all joints (rad or m), within the position limits of the plant, and all loops
            closed; overwritten by those at the end.
        qd : ndarray of float64, shape (m,)
            Rates of the drives; overwritten, too.
        wanted : array_like, shape (k, 3, m)
            Values, rates and accelerations of the drives at the beginning of each period.
        period : float, optional
            Period of the controller in this run (s); default its own.
        held : array_like of bool, shape (m,), optional
            Drives that brakes hold where they are.
        observed : ndarray of float64, shape (m,), optional
            Torques (N m or N) that the observer has learned before; overwritten by those at the
            end.  Default none.
        """
        plant = self._systems[1]
        m = len(plant.drive_names)
        wanted = np.ascontiguousarray(as_finite("wanted", wanted, (3, m)))
        if wanted.ndim != 3:
            raise WrongSizeError("wanted", wanted.shape, f"(k, 3, {m})")
        learned = np.zeros(m) if observed is None else observed
        _check_state(q=(q, len(plant.joint_names)), qd=(qd, m), observed=(learned, m))
        step = positive_number("period", self.period if period is None else period)
        share = -math.expm1(-self.observer * step)
        timing = Timing(step, int(self.substeps), share)
        state = DrivenState(q, qd, learned)
        run = self._servo(state, wanted, _stops(plant, q, held), timing)
        done = len(run.q)
        reason = "" if done == len(wanted) else run.lost
        if done < len(wanted) and not run.lost:
            reason = (
                f"the motion ran away after {done * step:.6g} s, with rates of up to "
                f"{np.abs(qd).max():.3g} rad/s or m/s; {LARGEST_SERVO_RATE:g} is the most"
            )
        saturated = np.abs(run.effort) >= self._effort
        return ControlledMotion(run.q, run.rates, run.effort, saturated, reason, bool(run.lost))


def _check_state(**arrays: tuple[Array, int]) -> None:
    """Check arrays that the end of a motion overwrites, each with its length."""
    for name, (array, size) in arrays.items():
        if not isinstance(array, np.ndarray) or array.dtype != np.float64:
            raise BadValueError(name, array, "an array of float64, to be overwritten")
        if array.shape != (size,):
            raise WrongSizeError(name, array.shape, f"({size},)")
        if not np.isfinite(array).all():
            raise NonFiniteError(name, array)


def _stops(system: DynamicSystem, q: Array, held: ArrayLike | None) -> Array:
    """Return the stops (2, m) where they hold.

    A joint beyond its limits, to be thrown back, stands at one; brakes are stops on both sides.
    """
    at = system.drives_at
    place = q[at]
    stops = np.stack([np.minimum(system.lower[at], place), np.maximum(system.upper[at], place)])
    if held is not None:
        brakes = np.asarray(held)
        if brakes.shape != place.shape or brakes.dtype != np.bool_:
            raise BadValueError("held", held, f"{len(place)} of True and False")
        stops[:, brakes] = place[brakes]
    return stops
