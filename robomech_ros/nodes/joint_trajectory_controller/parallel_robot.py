"""A simulated parallel robot: trajectories command its drives, and all joints close the loops."""

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.execution.joints import State
from robomech_ros.execution.refusals import JointMismatchError
from robomech_ros.nodes.common.error_codes import OutcomeError
from robomech_ros.nodes.common.loop_positions import LoopPositions
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.joint_trajectory_controller.loop_checks import checked_drives
from robomech_ros.nodes.joint_trajectory_controller.robot import SimulatedRobot, dynamic_plant
from robomech_ros.nodes.joint_trajectory_controller.settings import (
    ControllerSettings,
    check_simulation,
)
from robomech_ros.outcomes import Code
from robomech_ros.parallel import Mechanism
from robomech_ros.trajectory.limits import Limits
from robomech_ros.trajectory.waypoints import Waypoints

if TYPE_CHECKING:
    from robomech_ros.parallel import ParallelDynamics

__all__ = ["ParallelRobot"]

Array = NDArray[np.float64]


class ParallelRobot(SimulatedRobot):
    """The drives of a mechanism of n joints, and where all joints are then.

    Parameters
    ----------
    mechanism : Mechanism
        The robot.
    settings : ControllerSettings
        Parameters of the node.
    clock : MotionClock
        The time.

    Raises
    ------
    ParameterError
        The initial position does not fit the robot, or parameters do not go together.
    MissingInertiaError
        The robot is to be simulated with its dynamics, and nothing is known of its platform.
    """

    def __init__(
        self, mechanism: Mechanism, settings: ControllerSettings, clock: MotionClock
    ) -> None:
        check_simulation(settings)
        self.mechanism = mechanism
        self._start = self._posture = _initial_posture(settings, mechanism)
        self._rates = np.zeros(mechanism.n)
        drives = mechanism.drive_index
        limits = Limits.of(mechanism).only(drives.tolist())
        plant = dynamic_plant(partial(_with_bodies, mechanism), settings, self._start)
        super().__init__(mechanism.name, limits, self._start[drives], settings, clock, plant)

    @property
    def shown_names(self) -> tuple[str, ...]:
        """All joints, limb by limb."""
        return self.mechanism.joint_names

    def shown(self) -> State:
        """Give where all joints are; accelerations are not known."""
        return State(self._posture, self._rates, np.full(self.mechanism.n, np.nan))

    def shown_efforts(self) -> Array | None:
        """Give what drives exert (N m or N), NaN of passive joints; None without forces."""
        efforts = self.simulated_joints.effort
        if efforts is None:
            return None
        shown = np.full(self.mechanism.n, np.nan)
        shown[self.mechanism.drive_index] = efforts
        return shown

    def kept(self) -> Array:
        """Give all joints (n,), which tell the assembly mode, without the faults of sensors."""
        drives = self.simulated_joints.position
        if np.array_equal(drives, self._posture[self.mechanism.drive_index]):
            return self._posture
        return self.mechanism.close(drives, self._posture).q

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper limits (rad or m) of all joints."""
        return self.mechanism.lower, self.mechanism.upper

    def resume(self, kept: Array) -> None:
        """Stand where all joints (n,) of a process that was killed stood."""
        drives = kept[self.mechanism.drive_index]
        closed = self.mechanism.close(drives, kept)
        if closed.status is Code.NONE:
            self._stand(closed.q)
            super().resume(drives)

    def reset(self, text: str) -> None:
        """Put all joints back to where they were at start, at once."""
        self._stand(self._start)
        super().reset(text)

    def advance_to(self, time: float) -> None:
        """Move on to a time (s), and have the passive joints follow."""
        try:
            super().advance_to(time)
        except OutcomeError as error:
            self._stop_before(str(error))
            return
        self._close_loops()

    def _stand(self, q: Array) -> None:
        self._posture, self._rates = q, np.zeros(self.mechanism.n)
        if self._plant is not None:
            self._plant.assume(q)

    def _close_loops(self) -> None:
        """Find all joints for where the drives are; stop before a singular posture."""
        actual = self.follower.actual
        closed = self.mechanism.close(actual.position, self._posture)
        reason = closed.reason
        if closed.status is Code.NONE:
            try:
                self._rates = self.mechanism.rates(closed.q, actual.velocity)[0]
                self._posture = closed.q
                return
            except BadValueError as error:
                reason = str(error)
        self._stop_before(reason)

    def _stop_before(self, reason: str) -> None:
        """Have it stand where it was last, and end its motion."""
        text = f"stopped before a singular posture: {reason}"
        self._stand(self._posture)
        self.follower.halt(Code.SINGULAR, text)
        self.follower.motion.put(self._posture[self.mechanism.drive_index])

    def _read(self, trajectory: JointTrajectory) -> Waypoints:
        """Check a trajectory of the drives, on which the robot must keep its assembly mode."""
        named = {*trajectory.joint_names}
        passive = [name for name in self.mechanism.passive if name in named]
        missing = [name for name in self.joint_names if name not in named]
        known = named <= {*self.mechanism.joint_names}
        enough = self._settings.allow_partial_joints_goal and len(missing) < len(self.joint_names)
        if passive and known and missing and not enough:
            expected = (
                f"all drives, beside which passive joints as '{passive[0]}' may be named; missing: "
                f"{', '.join(missing)}"
            )
            raise JointMismatchError("joint_names", len(trajectory.joint_names), expected)
        received = self._waypoints_of(trajectory, [*self.joint_names, *passive])
        return checked_drives(self.mechanism, received, passive, self._posture)


def _initial_posture(settings: ControllerSettings, mechanism: Mechanism) -> Array:
    """Give all joints (n,) at start: those of the parameter, or of its drives, or home."""
    given = settings.initial_positions
    if not given:
        return mechanism.home()
    try:
        q = LoopPositions(mechanism).read(JointState(position=given), "initial_positions")
    except RobomechError as error:
        raise ParameterError("initial_positions", list(given), str(error)) from None
    for name, value, low, high, unit in zip(
        mechanism.joint_names, q, mechanism.lower, mechanism.upper, mechanism.units, strict=True
    ):
        if not low <= value <= high:
            allowed = f"from {low:.6g} to {high:.6g} {unit} for joint '{name}', not {value:.6g}"
            raise ParameterError("initial_positions", list(given), allowed)
    return q


def _with_bodies(mechanism: Mechanism) -> "ParallelDynamics":
    from robomech_ros.parallel import ParallelDynamics

    return ParallelDynamics(mechanism)
