"""The state machine that follows trajectories: hold, wait, move, slow down, settle.

It knows neither ROS nor a clock: its owner gives the time.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from enum import Enum

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.execution.controller.acceleration_ratio import STREAM, acceleration_ratio_of
from robomech_ros.execution.controller.curve_motion import CurveMotion
from robomech_ros.execution.controller.entry_path import EntryPath, entry_path
from robomech_ros.execution.controller.follower_settings import FollowerSettings
from robomech_ros.execution.controller.late_start import ScheduleShift
from robomech_ros.execution.controller.simulated_joints import SimulatedJoints
from robomech_ros.execution.controller.tolerance_check import verdict
from robomech_ros.execution.controller.trajectory_goal import End, GoalResult, TrajectoryGoal
from robomech_ros.execution.controller.transitions import braking_time
from robomech_ros.execution.joints import Joints, State
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.outcomes import Code
from robomech_ros.trajectory.waypoints import Waypoints
from robomech_ros.typing import Array

# After this time (s) another attempt is made to get onto a trajectory.
_AGAIN = 0.01
# A trajectory that is followed at its pace is no farther from its time than rounding (s).
_IN_STEP = 1e-6
# A jump of the clock by more than this is reported to waiting clients (s).
_REMARKABLE = 0.2
# For so long after a jump the senders of trajectories may be off by what they left out (s).
_UNSETTLED = 1.0


class Phase(Enum):
    """Activity of the robot."""

    HOLDING = "holding"
    MOVING = "moving"
    STOPPING = "stopping"


class TrajectoryFollower:
    """Moves simulated joints, which stand, along trajectories.

    ``motion`` has where the joints should be and are, and how fast they follow a curve. ``active``
    is the trajectory that is being followed, ``waiting`` the one whose time has not come. ``now``
    is the time up to which it has moved, on any clock, and ``held_since`` since when it has held if
    it does (s).
    """

    def __init__(
        self,
        joints: Joints,
        simulated_joints: SimulatedJoints,
        settings: FollowerSettings | None = None,
        now: float = 0.0,
    ) -> None:
        self.joints, self.simulated_joints = joints, simulated_joints
        self.settings = settings or FollowerSettings()
        self.motion = CurveMotion(simulated_joints, joints.acceleration)
        self.phase = Phase.HOLDING
        self.active: TrajectoryGoal | None = None
        self.waiting: TrajectoryGoal | None = None
        self.now = self.held_since = now
        self._unsettled_until = -math.inf
        self._ending: tuple[End, int, str] = (End.ABORTED, Code.PREEMPTED, "")

    @property
    def desired(self) -> State:
        """Desired state by the trajectory."""
        return self.motion.desired

    @property
    def actual(self) -> State:
        """Measured joint state."""
        return self.motion.actual

    def start(
        self,
        waypoints: Waypoints,
        tolerances: Tolerances,
        now: float,
        delay: float = 0.0,
        on_end: Callable[[GoalResult], None] = lambda result: None,
        by: str = "a newer trajectory",
        streamed: bool = False,
    ) -> TrajectoryGoal:
        """Accept a trajectory, which then replaces whatever is being done, or refuse it.

        The waypoints are checked, joints in the order of the robot. It begins ``delay`` (s) from
        now, negative if it should have begun already; until then the present motion goes on, if the
        settings want that. ``on_end`` is called once, with the result. ``by`` says who sends it,
        for the text of the trajectory that it replaces. Accelerations of one that may be
        ``streamed`` are not judged if it is short. Raises RobomechError, with nothing changed,
        where it is refused.
        """
        if delay > self.settings.longest_wait:
            allowed = f"at most {self.settings.longest_wait:g} s from now"
            raise BadValueError("header.stamp", f"{delay:.6g} s from now", allowed)
        self.advance(now)
        late, delay = max(-delay, 0.0), max(delay, 0.0)
        judged = not streamed or waypoints.times[-1] > STREAM
        if not self.settings.wait_for_stamp:
            waypoints, delay = replace(waypoints, times=waypoints.times + delay), 0.0
        present = self.desired
        if delay > 0.0 and self.active is not None and self.phase is Phase.MOVING:
            time = self.active.time + self.motion.pace * delay
            present = self.motion.state_at(self.active, time)
        way = self._find_entry_path(waypoints, present, late, self.now, streamed)
        strain = self._strain(waypoints, present, late) if judged else ""
        if way.blocked:
            self._let_go_by(way)
            delay, late = _AGAIN, late + _AGAIN
        begin = self.now + delay
        goal = TrajectoryGoal(waypoints, tolerances, begin, way.curve, late, on_end, strain=strain)
        goal.schedule, goal.streamed = way.schedule, streamed
        self._enter(goal, delay, by)
        return goal

    def _enter(self, goal: TrajectoryGoal, delay: float, by: str) -> None:
        """Begin a goal, or let it wait for so long (s), in place of what was there before."""
        last = goal.waypoints.velocities
        if self.settings.interpolate and last is not None:
            goal.braking = braking_time(last[-1], self.joints)
        self._drop_waiting(f"replaced by {by}")
        if delay > 0.0:
            self.waiting = goal
        else:
            self._begin(goal, f"preempted by {by}")

    def advance(self, now: float) -> None:
        """Advance the time to `now` (s); a clock that goes backwards stands still."""
        span = now - self.now
        self.now = now
        if not span > 0.0:
            return
        goal = self.waiting
        if goal is not None and now >= goal.begin:
            since = min(now - goal.begin, span)
            # A clock that jumped may have passed over the begin.
            goal.late += now - goal.begin - since
            self._step(span - since)
            self._begin_waiting(goal)
            self._step(since)
        else:
            self._step(span)

    def clock_jumped(self, by: float) -> None:
        """Note that the time of stamps jumped by `by` (s), and that of motions did not.

        The motion under way goes on from where it is, and says so; what waits keeps to its stamp.
        """
        self._unsettled_until = self.now + _UNSETTLED
        if self.active is not None and abs(by) > _REMARKABLE:
            how = "forward" if by > 0.0 else "back"
            self.active.remark = (
                f"the clock jumped {how} by {abs(by):.4g} s on the way, and the robot went on from "
                "where it was"
            )
        if self.waiting is not None:
            self.waiting.begin -= by

    def stop(self, end: End, code: int, text: str, goal: TrajectoryGoal | None = None) -> bool:
        """Slow down on the path, hold, and end the motion with this result once the robot stands.

        With a goal only if it is this one that moves or waits. Returns whether there was anything
        to stop.
        """
        waited = self.waiting is not None and goal in (None, self.waiting)
        if waited:
            self._drop_waiting(text, end, code)
        if self.active is None or (goal is not None and goal is not self.active):
            return waited
        if self.phase is not Phase.STOPPING:
            self.phase = Phase.STOPPING
            self._ending = (end, code, text)
        return True

    def halt(self, code: int, text: str) -> None:
        """Hold where the joints are, at once, and abort whatever was to be done."""
        self._drop_waiting(text, code=code)
        self.motion.stand()
        self._end(End.ABORTED, code, text)

    def reset(self, position: Array, text: str) -> None:
        """Put the joints somewhere else (rad or m), at once."""
        self.halt(Code.PREEMPTED, text)
        self.motion.put(position)

    def _begin(self, goal: TrajectoryGoal, text: str) -> None:
        if self.phase is Phase.STOPPING:
            self._end(*self._ending)
        else:
            self._end(End.ABORTED, Code.PREEMPTED, text)
        self.active, self.phase = goal, Phase.MOVING
        self.motion.begin()

    def _find_entry_path(
        self, waypoints: Waypoints, present: State, late: float, at: float, streamed: bool
    ) -> EntryPath:
        """Find the entry path at a time (s) up to which the robot has moved."""
        unsettled = streamed and self.now < self._unsettled_until
        before = self._present_schedule(at) if late > 0.0 or unsettled else None
        if unsettled and before is not None and not before.in_time:
            self._unsettled_until = self.now + _UNSETTLED
        return entry_path(waypoints, present, self.joints, self.settings, late, before, unsettled)

    def _strain(self, waypoints: Waypoints, present: State, late: float) -> str:
        """Refuse accelerations far above the limits, and describe those slightly above."""
        if not self.settings.interpolate:
            return ""
        strain = acceleration_ratio_of(waypoints, present, self.joints, late)
        if strain is None or not strain.remarkable:
            return ""
        strain.require(self.settings.max_acceleration_ratio)
        return str(strain)

    def _present_schedule(self, at: float) -> ScheduleShift | None:
        """Return the present schedule on a clock that is 0 at a time; None if slowed or at rest."""
        goal = self.active
        if goal is None or self.phase is not Phase.MOVING:
            return None
        if abs(at - goal.begin - goal.time) > _IN_STEP:
            return None
        schedule = goal.schedule or ScheduleShift(goal.curve)
        return schedule.since(goal.time)

    def _begin_waiting(self, goal: TrajectoryGoal) -> None:
        self.waiting = None
        try:
            at = goal.late, goal.begin, goal.streamed
            way = self._find_entry_path(goal.waypoints, self.desired, *at)
        except RobomechError as error:
            text = f"when its time had come: {error}"
            goal.finish(End.ABORTED, Code.REJECTED, text, self.actual.position)
            return
        if way.blocked:
            self._let_go_by(way)
            goal.begin, goal.late = goal.begin + _AGAIN, goal.late + _AGAIN
            self.waiting = goal
            return
        goal.curve, goal.schedule = way.curve, way.schedule
        self._begin(goal, "preempted by a trajectory that was to begin now")

    def _let_go_by(self, way: EntryPath) -> None:
        """Remember the path of a trajectory that cannot be followed yet."""
        goal = self.active
        if goal is not None and way.schedule is not None:
            goal.schedule = way.schedule.since(-goal.time)

    def _drop_waiting(self, text: str, end: End = End.ABORTED, code: int = Code.PREEMPTED) -> None:
        goal, self.waiting = self.waiting, None
        if goal is not None:
            goal.finish(end, code, f"before it began: {text}", self.actual.position)

    def _end(self, end: End, code: int, text: str) -> None:
        goal, self.active, self.phase = self.active, None, Phase.HOLDING
        self.held_since = self.now
        if goal is not None:
            limited = self.simulated_joints.saturation(self.joints.names)
            text = "; ".join(part for part in (text, limited) if part)
            goal.finish(end, code, text, self.actual.position)

    def _step(self, span: float) -> None:
        goal = self.active
        if goal is None:
            self.motion.hold(span)
        elif self.phase is not Phase.STOPPING:
            self.motion.go_on(goal, span)
            self._supervise(goal)
        elif self.motion.slow_down(goal, span):
            # Joints that lag behind stay where they are, as ros2_control lets them.
            self.motion.stand()
            self._end(*self._ending)

    def _supervise(self, goal: TrajectoryGoal) -> None:
        """End or give up the motion where that is due."""
        timeout = self.settings.command_timeout
        found = verdict(goal, self.desired, self.actual, self.joints, timeout)
        if found is None:
            return
        if found.code:
            self.stop(End.ABORTED, *found)
            return
        self.motion.settle(goal.last_position)
        self._end(End.REACHED, *found)
