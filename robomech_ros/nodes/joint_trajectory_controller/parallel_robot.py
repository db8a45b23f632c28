"""A simulated parallel robot: trajectories command its drives, and all joints close the loops."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robomech_ros import parallel
from robomech_ros.errors import LimitExceededError, RobomechError
from robomech_ros.execution.controller.joining import completed
from robomech_ros.execution.controller.state_check import Margin
from robomech_ros.execution.joints import State, at_rest
from robomech_ros.execution.rejections import JointMismatchError, TrajectoryRefusedError
from robomech_ros.nodes.common.joints.closed_loop_positions import ClosedLoopPositions
from robomech_ros.nodes.common.messages.error_codes import OutcomeError
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.joint_trajectory_controller.robot import SimulatedRobot, dynamic_plant
from robomech_ros.nodes.joint_trajectory_controller.settings import (
    ControllerSettings,
    check_simulation,
)
from robomech_ros.outcomes import Code
from robomech_ros.parallel import Mechanism, follow_drives
from robomech_ros.parallel.motion.drive_paths import OPEN
from robomech_ros.robots import PRISMATIC
from robomech_ros.trajectory.limits import Limits
from robomech_ros.trajectory.tolerances import POSITION_SLACK
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array

# Passive joints that a trajectory names may be off by this (rad, m).
_PASSIVE_TOLERANCE = 1e-3
# A trajectory of few points is looked at in so many places at least, along its curve.
_MIN_SAMPLES = 200
_TURN = 2.0 * math.pi


def checked_drives(
    mechanism: Mechanism, received: Waypoints, passive: Sequence[str], posture: Array
) -> Waypoints:
    """Check a trajectory from a posture on, and return the part of the drives.

    - ``mechanism``: mechanism of n joints and m drives.
    - ``received``: waypoints of the drives, then of passive joints; NaN for missing drives.
    - ``passive``: names of these passive joints.
    - ``posture``: all joints now (rad or m), loops closed, shape (n,).

    Returns the part of the drives.

    Raises LimitExceededError: a drive would leave its limits. OutcomeError: the motion crosses a
    singularity, or a passive joint leaves its limits; the text names the point before.
    TrajectoryRefusedError: the drives do not move a passive joint to its given position, as in
    another assembly mode.
    """
    m = mechanism.dof
    _require_limits(mechanism, received.positions[:, :m])
    drives = replace(
        received,
        positions=received.positions[:, :m],
        velocities=None if received.velocities is None else received.velocities[:, :m],
        accelerations=None if received.accelerations is None else received.accelerations[:, :m],
    )
    whole = completed(drives, at_rest(posture[mechanism.drive_index]))
    # Between points, too, where they are few.
    between = math.ceil(_MIN_SAMPLES / len(whole.times))
    parts = [np.linspace(a, b, between, endpoint=False) for a, b in pairwise(whole.times)]
    times = np.concatenate([*parts, whole.times[-1:]])
    followed = follow_drives(mechanism, whole.curve.sample(times).position, posture)
    last = len(whole.times) - 1
    if followed.stop is not None:
        reached = int(np.searchsorted(whole.times, times[followed.stop])) - 1
        where = f"after points[{reached}] of {last}" if reached >= 0 else "to points[0]"
        text = f"the trajectory cannot be followed {where}: {followed.reason}"
        raise OutcomeError(followed.status, text)
    rows = followed.q[np.searchsorted(times, whole.times)]
    _require_agreement(mechanism, rows, received.positions[:, m:], passive)
    return drives


def _require_limits(mechanism: Mechanism, positions: Array) -> None:
    """Refuse positions (k, m) of drives outside their limits; NaN is where one is not named."""
    lower, upper = (row[mechanism.drive_index] for row in (mechanism.lower, mechanism.upper))
    excess = np.maximum(lower - positions, positions - upper)
    bad = np.argwhere(excess > POSITION_SLACK)
    if not len(bad):
        return
    k = int(bad[0, 0])
    j = int(np.nanargmax(excess[k]))
    value, low, high = float(positions[k, j]), float(lower[j]), float(upper[j])
    unit = mechanism.units[int(mechanism.drive_index[j])]
    limit = low if value < low else high
    raise LimitExceededError(f"points[{k}]: position", mechanism.actuated[j], value, limit, unit)


def _require_agreement(
    mechanism: Mechanism, rows: Array, given: Array, passive: Sequence[str]
) -> None:
    """Refuse passive joints (k, p) that are not where the drives move them, rows (k, n)."""
    if not passive:
        return
    index = [mechanism.joint_names.index(name) for name in passive]
    apart = given - rows[:, index]
    turns = mechanism.types[index] != PRISMATIC
    apart = np.abs(np.where(turns, apart - _TURN * np.round(apart / _TURN), apart))
    bad = np.argwhere(apart > _PASSIVE_TOLERANCE)
    if not len(bad):
        return
    k = int(bad[0, 0])
    column = int(np.argmax(apart[k]))
    unit = mechanism.units[index[column]]
    other = ": the trajectory starts in another assembly mode than the robot is in" if not k else ""
    raise TrajectoryRefusedError(
        f"points[{k}]: joint '{passive[column]}' is passive and at {given[k, column]:.6g} {unit}, "
        f"but the drives move it to {rows[k, index[column]]:.6g} {unit}{other}"
    )


class ParallelRobot(SimulatedRobot):
    """The drives of a mechanism of n joints, and where all joints are then.

    Raises ParameterError: the initial position does not fit the robot, or parameters do not go
    together. MissingInertiaError: the robot is to be simulated with its dynamics, and nothing is
    known of its platform.
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
