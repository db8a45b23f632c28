"""The simulated robot moved by its drives, with its mass, its friction and its load."""

import math
from typing import Any

import numpy as np

from robomech_ros.dynamics import ControlledArm, DynamicSystem
from robomech_ros.dynamics.systems import LostPostureError, dynamic_system
from robomech_ros.execution.controller.simulated_joints import DrivenMotion
from robomech_ros.execution.joints import State, at_rest
from robomech_ros.nodes.common.messages.error_codes import OutcomeError
from robomech_ros.nodes.joint_trajectory_controller.settings import ControllerSettings
from robomech_ros.outcomes import Code
from robomech_ros.robots import Body, SerialChain
from robomech_ros.typing import Array, BoolArray

# Longest period of the controller of the drives, and periods that are simulated in one go.
_PERIOD = 1e-3
_AT_ONCE = 10
# Longest simulated part of a stall of the process, its end, s.
_LONGEST = 10.0
# Rounding of quotients of times.
_ROUNDING = 1e-6


class MotionRanAwayError(OutcomeError):
    """The simulated motion has left all bounds; the robot stands where it was before."""


class DynamicPlant:
    """Moves joints by drives that a controller of torques commands, a thousand times a second.

    - ``robot``: robot of n joints and their bodies, as the controller of its m drives knows it.
    - ``settings``: type and speed of the controller, and the payload that it does not know of.
    - ``posture``: initial positions of all joints (rad or m), shape (n,).

    Raises MissingInertiaError: the mass of some links is not known; they are named. BadValueError:
    the mass and inertia of a body are impossible, or there are too many joints.
    """

    def __init__(
        self, robot: SerialChain | DynamicSystem, settings: ControllerSettings, posture: Array
    ) -> None:
        self._model = dynamic_system(robot)
        self._at, self.effort = self._model.drives_at, self._model.effort
        self._settings = settings
        self._plant, self._servo = self._servo_with(settings)
        # The kernels are compiled or loaded now, not in the first cycle.
        self.assume(posture)
        start = posture[self._at]
        self.put(start)
        self.drive(at_rest(start), at_rest(start), _PERIOD, None)
        self.assume(posture)
        self.put(start)

    def carry(self, settings: ControllerSettings) -> None:
        """Set the payload from these settings."""
        if _load(settings) != _load(self._settings):
            self._plant, self._servo = self._servo_with(settings)
        self._settings = settings

    def assume(self, posture: Array) -> None:
        """Place all joints (n,) at rest (rad or m), which sets the assembly mode."""
        self._q = np.array(posture, dtype=np.float64)
        self._rates, self._observed = np.zeros((2, len(self._at)))

    def put(self, position: Array) -> DrivenMotion:
        """Place the drives (m,) at rest (rad or m), held against gravity.

        Raises OutcomeError: the assembly mode of a parallel robot ends before; they stand where
        they were.
        """
        still = np.zeros(len(position))
        try:
            self.assume(self._plant.posture(np.array(position, dtype=np.float64), self._q))
        except LostPostureError as error:
            raise OutcomeError(Code.SINGULAR, str(error)) from None
        holding = self._plant.inverse(self._q, still, still, gravity=self._settings.gravity)
        return DrivenMotion(at_rest(self._q[self._at]), holding, still)

    def drive(
        self, before: State, command: State, span: float, held: BoolArray | None
    ) -> DrivenMotion:
        """Advance the time; see :class:`Plant`."""
        started = self._rates.copy()
        simulated = min(span, _LONGEST)
        periods = max(math.ceil(simulated / _PERIOD - _ROUNDING), 1)
        period = simulated / periods
        wanted = _between(before, command, simulated, periods)
        at_limit, effort = np.zeros(len(started)), np.zeros(len(started))
        for first in range(0, periods, _AT_ONCE):
            self._limit(wanted[first : first + _AT_ONCE])
            motion = self._servo.run(
                self._q,
                self._rates,
                wanted[first : first + _AT_ONCE],
                period=period,
                held=held,
                observed=self._observed,
            )
            if motion.reason:
                self._rates[:], self._observed[:] = 0.0, 0.0
                text = f"{motion.reason}; the robot stands where it was before"
                if motion.singular:
                    raise OutcomeError(Code.SINGULAR, text)
                raise MotionRanAwayError(Code.PATH_TOLERANCE, text)
            at_limit += period * motion.saturated.sum(axis=0)
            effort = motion.effort[-1]
        state = State(self._q[self._at], self._rates.copy(), (self._rates - started) / simulated)
        return DrivenMotion(state, effort, at_limit)

    def _limit(self, wanted: Array) -> None:
        """Keep what is wanted, shape (k, 3, m), so near that no drive is asked to be too fast.

        Errors are corrected at the rate of ``bandwidth / (2 damping)`` times them: where that is
        beyond the limit of the velocity, after a step or a brake that is released, the drives would
        come to their limits and lose the hold of an arm whose speed they cannot take off again.
        """
        fastest = np.where(np.isfinite(self._model.velocity), self._model.velocity, np.inf)
        near = fastest * 2.0 * self._settings.dynamic_damping / self._settings.dynamic_bandwidth
        place = self._q[self._at]
        far = np.abs(wanted[:, 0] - place) > near
        wanted[:, 0] = np.clip(wanted[:, 0], place - near, place + near)
        wanted[:, 1] = np.clip(wanted[:, 1], -fastest, fastest)
        # A joint that has to catch up should not follow the rates of where it should be.
        wanted[:, 1:][np.broadcast_to(far[:, None], (len(wanted), 2, far.shape[1]))] = 0.0

    def _servo_with(self, settings: ControllerSettings) -> tuple[DynamicSystem, ControlledArm]:
        """Return what moves, and its controller."""
        mass, com = _load(settings)
        load = Body(mass, np.array(com), np.zeros((3, 3)))
        plant = self._model.with_payload(load) if mass else self._model
        names = ("control", "bandwidth", "damping", "observer")
        options: dict[str, Any] = {name: getattr(settings, f"dynamic_{name}") for name in names}
        options |= {"period": _PERIOD, "gravity": settings.gravity}
        return plant, ControlledArm(self._model, plant, **options)


def _load(settings: ControllerSettings) -> tuple[float, tuple[float, ...]]:
    return settings.payload_mass, settings.payload_com


def _between(before: State, command: State, span: float, periods: int) -> Array:
    """Return what is wanted at the beginning of each period, shape (periods, 3, m).

    Positions follow cubics with the velocities of both ends, and velocities cubics with their
    accelerations, so that what a jump of the position adds to the velocity is left out.
    """
    s = np.arange(periods)[:, None] / periods
    first, second = (2.0 * s - 3.0) * s * s + 1.0, s * s * (3.0 - 2.0 * s)
    out, back = span * s * (1.0 - s) ** 2, span * s * s * (s - 1.0)
    rows = np.empty((periods, 3, len(before.position)))
    ends = [(state.position, state.velocity, state.acceleration) for state in (before, command)]
    for k in range(2):
        (value, rate), (value_after, rate_after) = (end[k : k + 2] for end in ends)
        rows[:, k] = first * value + second * value_after + out * rate + back * rate_after
    rows[:, 2] = (1.0 - s) * before.acceleration + s * command.acceleration
    return rows
