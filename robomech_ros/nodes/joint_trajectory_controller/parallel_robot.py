"""A simulated parallel robot: trajectories command its drives, and all joints close the loops."""

import numpy as np
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robomech_ros import parallel
from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.state_check import Margin
from robomech_ros.execution.joints import State
from robomech_ros.execution.rejections import JointMismatchError
from robomech_ros.nodes.common.closed_loop_positions import ClosedLoopPositions
from robomech_ros.nodes.common.error_codes import OutcomeError
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.joint_trajectory_controller.loop_feasibility import checked_drives
from robomech_ros.nodes.joint_trajectory_controller.robot import SimulatedRobot, dynamic_plant
from robomech_ros.nodes.joint_trajectory_controller.settings import (
    ControllerSettings,
    check_simulation,
)
from robomech_ros.outcomes import Code
from robomech_ros.parallel import Mechanism
from robomech_ros.parallel.motion.drive_paths import OPEN
from robomech_ros.trajectory.limits import Limits
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array


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
        start = _initial_posture(settings, mechanism)
        plant = dynamic_plant(lambda: parallel.ParallelDynamics(mechanism), settings, start)
        drives = mechanism.drive_index
        limits = Limits.of(mechanism).only(drives.tolist())
        super().__init__(mechanism.name, limits, start[drives], settings, clock, plant, start)

    @property
    def shown_names(self) -> tuple[str, ...]:
        """All joints, limb by limb."""
        return self.mechanism.joint_names

    def shown_efforts(self) -> Array | None:
        """Return what drives exert (N m or N), NaN of passive joints; None without forces."""
        efforts = self.simulated_joints.effort
        if efforts is None:
            return None
        shown = np.full(self.mechanism.n, np.nan)
        shown[self.mechanism.drive_index] = efforts
        return shown

    def _checked_limits(self) -> tuple[Limits, Margin]:
        return Limits.of(self.mechanism), self.mechanism.limit_margin

    def _look(self) -> tuple[State, Array]:
        """Find all joints by where the drives are, and by where their sensors show them."""
        actual = self.follower.actual
        real = self._closed(self.simulated_joints.position, self._real)
        shown, rates = self._closed(actual.position, real), np.zeros(self.mechanism.n)
        if actual.velocity.any():
            rates = self.mechanism.rates(shown, actual.velocity)[0]
        # Accelerations of passive joints are not known.
        return State(shown, rates, np.full(self.mechanism.n, np.nan)), real

    def _closed(self, drives: Array, near: Array) -> Array:
        """Close the loops for places of the drives (m,), from all joints (n,) near by."""
        index = self.mechanism.drive_index
        if np.array_equal(drives, near[index]):
            return near
        closed = self.mechanism.close(drives, near)
        if closed.status is not Code.NONE:
            raise OutcomeError(closed.status, closed.reason)
        off = float(np.abs(closed.q[index] - drives).max())
        if not max(off, closed.error) <= OPEN:
            text = f"the loops do not close: gap {closed.error:.3g}, drives off by {off:.3g}"
            raise OutcomeError(Code.NOT_CONVERGED, f"{text}; at most {OPEN:g} is allowed")
        return closed.q

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
        return checked_drives(self.mechanism, received, passive, self._real)


def _initial_posture(settings: ControllerSettings, mechanism: Mechanism) -> Array:
    """Return all joints (n,) at start: those of the parameter, or of its drives, or home."""
    given = settings.initial_positions
    if not given:
        return mechanism.home()
    try:
        q = ClosedLoopPositions(mechanism).read(JointState(position=given), "initial_positions")
    except RobomechError as error:
        raise ParameterError("initial_positions", list(given), str(error)) from None
    for name, value, low, high, unit in zip(
        mechanism.joint_names, q, mechanism.lower, mechanism.upper, mechanism.units, strict=True
    ):
        if not low <= value <= high:
            allowed = f"from {low:.6g} to {high:.6g} {unit} for joint '{name}', not {value:.6g}"
            raise ParameterError("initial_positions", list(given), allowed)
    return q
