"""Joints that trajectories of messages command: those of the arm, or those of its gripper."""

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.follower import TrajectoryFollower
from robomech_ros.execution.controller.simulated_joints import SimulatedJoints
from robomech_ros.execution.controller.state_check import Margin, StateCheck
from robomech_ros.execution.controller.trajectory_goal import End, GoalResult, TrajectoryGoal
from robomech_ros.execution.joints import Joints, State, at_rest
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.execution.received_trajectory import read_waypoints
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.nodes.common.messages.error_codes import OutcomeError, code_of
from robomech_ros.nodes.common.messages.joint_messages import received_trajectory
from robomech_ros.nodes.common.messages.message_fields import NANO
from robomech_ros.nodes.common.messages.rejection_status import Refusal, trajectory_label
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.joint_trajectory_controller.constraints import default_tolerances
from robomech_ros.nodes.joint_trajectory_controller.settings import (
    DYNAMIC,
    SPLINES,
    ControllerSettings,
    follower_settings,
)
from robomech_ros.outcomes import Code
from robomech_ros.trajectory.limits import Limits
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array

# Joints that forces move may overshoot their limits: of position by so much (rad or m), and of
# velocity by this part.
_OVERSHOOT, _OVERSPEED = 0.02, 0.2


@dataclass
class MotionCounts:
    """Counts of past events, for the diagnostics."""

    accepted: int = 0
    reached: int = 0
    ended_early: int = 0
    # Before any refusal, one named by the time of this start of the robot.
    refusal: Refusal = field(default_factory=lambda: Refusal(0, 0, "", "", str(time.time_ns())))
    last_end: str = ""

    def accept(self) -> None:
        """Count a trajectory that was accepted."""
        self.accepted += 1
        self.refusal = self.refusal._replace(code=0, text="", label="")

    def refuse(self, code: int, text: str, label: str) -> None:
        """Count a trajectory that was refused, with its label, for a reason."""
        last = self.refusal
        self.refusal = Refusal(last.number + 1, int(code), text, label, last.run)

    def end(self, result: GoalResult) -> None:
        """Count a motion that has ended."""
        said = f"; {result.text}" if result.text else ""
        self.end_with(not result.code, result.text if result.code else f"goal reached{said}")

    def end_with(self, reached: bool, text: str) -> None:
        """Count a motion that has reached its goal or not, as the text says."""
        self.reached += reached
        self.ended_early += not reached
        self.last_end = text


class CommandedJoints:
    """A follower that understands messages.

    Cycles come from another thread than callbacks: its lock is to be held while it or its follower
    is used, other than by `execute`.

    - ``place``: namespace of its topics and actions, such as ``~``.
    - ``joints``: names and limits of n joints.
    - ``simulated_joints``: the joints themselves, where a reset puts them.
    - ``lock``: shared by all joints that are commanded in one process.
    - ``start``: initial positions of all joints (rad or m); by default of the commanded ones only.
    - ``refuse_all``: why no trajectory is accepted any more; empty while trajectories are accepted.
    - ``fault``: why the joints hold and their state is not published; empty if it is published.
    """

    # The state that is published, and where all joints really are (rad or m).
    _shown: State
    _real: Array

    def __init__(
        self,
        place: str,
        joints: Joints,
        simulated_joints: SimulatedJoints,
        settings: ControllerSettings,
        clock: MotionClock,
        lock: "threading.RLock",
        start: Array | None = None,
    ) -> None:
        self.place = place
        self.joint_names: Sequence[str] = list(joints.names)
        self.lock = lock
        self.counts = MotionCounts()  #: Numbers of trajectories by outcome.
        self.refuse_all = self.fault = ""
        self.simulated_joints, self._settings, self._clock = simulated_joints, settings, clock
        #: Tolerances of trajectories that bring none.
        self.tolerances = default_tolerances(settings, self.joint_names, {})
        #: Moves the joints along trajectories.
        self.follower = TrajectoryFollower(
            joints, simulated_joints, follower_settings(settings), clock.now()
        )
        clock.on_jump(self.follower.clock_jumped)
        self._start = simulated_joints.position if start is None else start
        self._at = np.array([list(self.shown_names).index(name) for name in joints.names])
        limits, margin = self._checked_limits()
        if settings.interpolation_method != SPLINES:
            # The joints step to one point after the other.
            limits = replace(limits, velocity=np.full(len(limits.joint_names), np.inf))
        overshoot = (_OVERSHOOT, _OVERSPEED) if settings.simulation == DYNAMIC else ()
        self._check = StateCheck(limits, margin, *overshoot)
        self._accept(self._start)

    @property
    def time(self) -> float:
        """The present time, s, on the clock of the follower."""
        return self._clock.now()

    def advance(self) -> None:
        """Move on to the present time."""
        self.advance_to(self.time)

    def advance_to(self, time: float) -> None:
        """Move on to a time (s): one for all joints whose states have the same stamp.

        Every state is checked.  Before one that may not be published, the joints stop where they
        were, and their motion ends with an error.
        """
        try:
            self.follower.advance(time)
            state, real = self._look()
            if fault := self._check.fault(state.position, time):
                raise OutcomeError(Code.LIMIT, f"{fault}; the robot holds its last position")
        except RobomechError as error:
            code = code_of(error)
            why = "stopped before a singular posture: " if code is Code.SINGULAR else ""
            self.fault = f"{why}{error}"
            self.follower.halt(code, self.fault)
            self._assume(self._real)
            shown = self._shown.position
            self.follower.motion.put(self._real[self._at], shown[self._at])
            self._shown = at_rest(shown)
        else:
            self._shown, self._real, self.fault = state, real, ""
        self._check.keep(self._shown.position, time)

    def _look(self) -> tuple[State, Array]:
        """Return the state to be published, and where the joints really are (rad or m)."""
        return self.follower.actual, self.simulated_joints.position

    def _assume(self, real: Array) -> None:
        """Tell what moves the joints that these are their positions (rad or m)."""

    def _accept(self, real: Array) -> None:
        """Take positions of all joints (rad or m) as they are, since they were put there."""
        self._real, self._shown = real, at_rest(real)
        self._check.restart(real, self.follower.now)

    def _checked_limits(self) -> tuple[Limits, Margin | None]:
        """Return the limits of `shown_names`, and a function for how far inside they are."""
        return self.follower.joints.limits, None

    @property
    def shown_names(self) -> Sequence[str]:
        """The joints whose states are published: these, and those that they move."""
        return self.joint_names

    def shown(self) -> State:
        """Return where the joints of `shown_names` are; the lock is held."""
        return self._shown

    def shown_efforts(self) -> Array | None:
        """Return what their drives exert (N m or N); None where no forces are simulated."""
        return self.simulated_joints.effort

    def stamp(self) -> tuple[int, int]:
        """Return the ROS time (s and ns) of the follower's states, which may be some time ago."""
        return divmod(max(self._clock.stamp(self.follower.now), 0), NANO)

    def execute(
        self,
        trajectory: JointTrajectory,
        by: str,
        on_end: Callable[[GoalResult], None],
        tolerances: Callable[[Tolerances], Tolerances] = lambda default: default,
        streamed: bool = False,
    ) -> TrajectoryGoal:
        """Execute a trajectory from now on, or from its stamp on.

        - ``trajectory``: received trajectory, not yet checked.
        - ``by``: name of the sender, for the text about the motion that it replaces.
        - ``on_end``: called once, with the result.
        - ``tolerances``: returns the tolerances of the motion for the default ones.
        - ``streamed``: whether the trajectory may belong to a stream.

        Raises RobomechError: the trajectory is refused; the present motion goes on.
        """
        try:
            waypoints = self._read(trajectory)
            held_to = tolerances(self.tolerances)

            def end(result: GoalResult) -> None:
                self.counts.end(result)
                on_end(result)

            with self.lock:
                now = self._clock.now()
                delay = self._clock.until(trajectory.header.stamp, now)
                start = partial(
                    self.follower.start, waypoints, held_to, now, delay, end, by, streamed
                )
                goal = self._begin(start, by)
                self.counts.accept()
                return goal
        except RobomechError as error:
            with self.lock:
                self.counts.refuse(code_of(error), str(error), trajectory_label(trajectory))
            raise

    def _begin(self, start: Callable[[], TrajectoryGoal], by: str) -> TrajectoryGoal:
        """Start a trajectory of a sender in the follower; the lock is held."""
        return start()

    def _read(self, trajectory: JointTrajectory) -> Waypoints:
        """Check a trajectory; cycles go on while a long one is read, so without the lock."""
        return self._waypoints_of(trajectory, self.joint_names)

    def _waypoints_of(self, trajectory: JointTrajectory, joint_names: Sequence[str]) -> Waypoints:
        """Check what a trajectory says of some joints."""
        if self.refuse_all:
            raise TrajectoryRefusedError(self.refuse_all)
        settings = self._settings
        return read_waypoints(
            received_trajectory(trajectory),
            joint_names,
            settings.max_points,
            settings.max_duration,
            partial=settings.allow_partial_joints_goal,
            to_rest=not settings.allow_nonzero_velocity_at_trajectory_end,
        )

    def close(self, why: str) -> None:
        """Refuse all trajectories from now on, slow down, and hold; the lock is to be held."""
        self.refuse_all = why
        self.follower.stop(End.ABORTED, Code.PREEMPTED, why)

    def reset(self, text: str) -> None:
        """Put the joints back to where they were at start, at once."""
        self._put(self._start, text)

    def _put(self, real: Array, text: str) -> None:
        """Put all joints somewhere (rad or m), at once, and end what they are doing."""
        self._assume(real)
        self.follower.reset(real[self._at], text)
        self._accept(real)
