"""The state machine that follows trajectories: hold, wait, move, slow down, settle.

It knows neither ROS nor a clock: whoever owns it says what time it is.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.execution.controller.joining import join, join_in_steps
from robomech_ros.execution.controller.saturation import saturation_text
from robomech_ros.execution.controller.simulated_joints import JointSimulation, Plant, at_rest
from robomech_ros.execution.controller.smoothing import braking_time
from robomech_ros.execution.controller.supervision import verdict
from robomech_ros.execution.controller.trajectory_goal import End, Job, Outcome
from robomech_ros.execution.joints import Joints, State
from robomech_ros.execution.pacing import paced_step
from robomech_ros.execution.stopping import slowed_down
from robomech_ros.execution.tolerance import Tolerances
from robomech_ros.outcomes import Code
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.sample import FloatArray
from robomech_ros.trajectory.waypoints import Waypoints

__all__ = ["Follower", "FollowerSettings", "Phase"]


class Phase(Enum):
    """What the robot is doing."""

    HOLDING = "holding"
    MOVING = "moving"
    STOPPING = "stopping"


@dataclass(frozen=True)
class FollowerSettings:
    """What the owner decides.

    Attributes
    ----------
    start_tolerance : float
        How far the first point may be from the present position, rad or m.
    lag : float
        Time constant with which the simulated joints follow what is wanted, s; 0 = exactly.
    longest_wait : float
        How far in the future a trajectory may begin, s.
    command_timeout : float
        How long after its end a trajectory may be under way, s; 0 = any time.
    interpolate : bool
        Whether the joints move from point to point; else they are told one point after the other.
    wait_for_stamp : bool
        Whether the present motion goes on until a later one begins; else that one replaces it when
        it comes, and its first point is reached at the time that its stamp gives.
    """

    start_tolerance: float = 0.01
    lag: float = 0.0
    longest_wait: float = 3600.0
    command_timeout: float = 0.0
    interpolate: bool = True
    wait_for_stamp: bool = True


class Follower:
    """Moves simulated joints along trajectories.

    Parameters
    ----------
    joints : Joints
        Names and limits of n joints.
    position : ndarray, shape (n,)
        Where they are at first, rad or m.
    settings : FollowerSettings
        What the owner decides.
    now : float
        The time, s, on any clock.
    plant : Plant, optional
        Moves the joints by forces.

    Attributes
    ----------
    wanted, actual : State
        Where the trajectory is and where the joints are.
    phase : Phase
        What the robot is doing.
    active, waiting : Job or None
        The trajectory that is being followed, and the one whose time has not come.
    simulation : JointSimulation
        The joints themselves.
    now, held_since : float
        The time up to which it has moved, and since when it has held if it does, s.
    pace : float
        How fast the curve is followed: 1, or less while slowing down or scaled.
    scale : float
        The pace that is wanted, 0 to 1; it may be set at any time.
    """

    def __init__(
        self,
        joints: Joints,
        position: FloatArray,
        settings: FollowerSettings | None = None,
        now: float = 0.0,
        plant: Plant | None = None,
    ) -> None:
        self.joints = joints
        self.settings = settings or FollowerSettings()
        self.phase = Phase.HOLDING
        self.active: Job | None = None
        self.waiting: Job | None = None
        self.now = self.held_since = now
        self.pace = self.scale = 1.0
        self._ending: tuple[End, int, str] = (End.ABORTED, Code.PREEMPTED, "")
        self.simulation = JointSimulation(position, self.settings.lag, plant)
        self.wanted = self.actual = at_rest(position)

    def start(
        self,
        waypoints: Waypoints,
        tolerances: Tolerances,
        now: float,
        delay: float = 0.0,
        on_end: Callable[[Outcome], None] = lambda outcome: None,
        by: str = "a newer trajectory",
    ) -> Job:
        """Accept a trajectory, which then replaces whatever is being done, or refuse it.

        Parameters
        ----------
        waypoints : Waypoints
            Checked, joints in the order of the robot.
        tolerances : Tolerances
            What the motion is held to.
        now : float
            The time, s.
        delay : float
            When to begin, from now, s; negative if it should have begun already.  Until then the
            present motion goes on, if the settings want that.
        on_end : callable
            Called once, with the outcome.
        by : str
            Who sends it, for the text of the trajectory that it replaces.

        Returns
        -------
        Job

        Raises
        ------
        RobomechError
            It is refused; nothing has changed.
        """
        if delay > self.settings.longest_wait:
            allowed = f"at most {self.settings.longest_wait:g} s from now"
            raise BadValueError("header.stamp", f"{delay:.6g} s from now", allowed)
        self.advance(now)
        late = max(-delay, 0.0)
        delay = max(delay, 0.0)
        if not self.settings.wait_for_stamp:
            waypoints, delay = replace(waypoints, times=waypoints.times + delay), 0.0
        curve = self._joined(waypoints, self._expected(delay), late)
        job = Job(waypoints, tolerances, self.now + delay, curve, late, on_end)
        if self.settings.interpolate and waypoints.velocities is not None:
            job.braking = braking_time(waypoints.velocities[-1], self.joints)
        if delay > 0.0:
            self._drop_waiting(f"replaced by {by}")
            self.waiting = job
        else:
            self._drop_waiting(f"replaced by {by}")
            self._begin(job, f"preempted by {by}")
        return job

    def advance(self, now: float) -> None:
        """Let time pass until `now` (s); a clock that goes backwards stands still."""
        span = now - self.now
        self.now = now
        if not span > 0.0:
            return
        job = self.waiting
        if job is not None and now >= job.begin:
            since = min(now - job.begin, span)
            # A clock that jumped may have passed over the begin.
            job.late += now - job.begin - since
            self._step(span - since)
            self._begin_waiting(job)
            self._step(since)
        else:
            self._step(span)

    def clock_jumped(self, by: float) -> None:
        """Take note that the time of stamps jumped by `by` (s), and that of motions did not.

        The motion under way goes on from where it is, and says so; what waits keeps to its stamp.
        """
        if self.active is not None:
            how = "forward" if by > 0.0 else "back"
            self.active.remark = (
                f"the clock jumped {how} by {abs(by):.4g} s on the way, and the robot went on from "
                "where it was"
            )
        if self.waiting is not None:
            self.waiting.begin -= by

    def stop(self, end: End, code: int, text: str, job: Job | None = None) -> bool:
        """Slow down on the path, hold, and end the motion with this outcome.

        Parameters
        ----------
        end, code, text
            The outcome, told when the robot stands.
        job : Job, optional
            Only if it is this one that moves or waits.

        Returns
        -------
        bool
            Whether there was anything to stop.
        """
        waited = self.waiting is not None and job in (None, self.waiting)
        if waited:
            self._drop_waiting(text, end, code)
        if self.active is None or (job is not None and job is not self.active):
            return waited
        if self.phase is not Phase.STOPPING:
            self.phase = Phase.STOPPING
            self._ending = (end, code, text)
        return True

    def halt(self, code: int, text: str) -> None:
        """Hold where the joints are, at once, and abort whatever was to be done."""
        self._drop_waiting(text, code=code)
        self._stand()
        self._end(End.ABORTED, code, text)

    def reset(self, position: FloatArray, text: str) -> None:
        """Put the joints somewhere else (rad or m), at once."""
        self.halt(Code.PREEMPTED, text)
        self.wanted, self.actual = at_rest(position), self.simulation.put(position)

    def _expected(self, delay: float) -> State:
        """Where the robot will be after `delay` (s) if nothing comes between."""
        if delay <= 0.0 or self.active is None or self.phase is Phase.STOPPING:
            return self.wanted
        return self.at(self.active, self.active.time + self.pace * delay)

    def at(self, job: Job, time: float, rate: float = 0.0) -> State:
        """Give the state at a time (s) of a job's curve, at a pace that changes by `rate` (1/s)."""
        sample, pace = job.curve.sample(time), self.pace
        acceleration = sample.acceleration * pace * pace + sample.velocity * rate
        return State(sample.position, sample.velocity * pace, acceleration)

    def _joined(self, waypoints: Waypoints, present: State, late: float) -> PiecewisePolynomial:
        settings = self.settings
        joined = join if settings.interpolate else join_in_steps
        return joined(waypoints, present, self.joints, settings.start_tolerance, late)

    def _begin(self, job: Job, text: str) -> None:
        if self.phase is Phase.STOPPING:
            self._end(*self._ending)
        else:
            self._end(End.ABORTED, Code.PREEMPTED, text)
        # A curve that begins moving begins with the speed that the joints have.
        self.pace = 1.0 if self.wanted.velocity.any() else self.scale
        self.active, self.phase = job, Phase.MOVING
        self.simulation.count_anew()

    def _begin_waiting(self, job: Job) -> None:
        self.waiting = None
        try:
            job.curve = self._joined(job.waypoints, self.wanted, job.late)
        except RobomechError as error:
            text = f"when its time had come: {error}"
            job.finish(End.ABORTED, Code.REJECTED, text, self.actual.position)
            return
        self._begin(job, "preempted by a trajectory that was to begin now")

    def _drop_waiting(self, text: str, end: End = End.ABORTED, code: int = Code.PREEMPTED) -> None:
        job, self.waiting = self.waiting, None
        if job is not None:
            job.finish(end, code, f"before it began: {text}", self.actual.position)

    def _end(self, end: End, code: int, text: str) -> None:
        job, self.active, self.phase = self.active, None, Phase.HOLDING
        self.held_since = self.now
        if job is not None:
            limited = saturation_text(self.simulation.at_limit, self.joints.names)
            text = "; ".join(part for part in (text, limited) if part)
            job.finish(end, code, text, self.actual.position)

    def _step(self, span: float) -> None:
        """Move for `span` (s)."""
        job = self.active
        if job is None:
            self._follow(span)
            return
        if self.phase is Phase.STOPPING:
            self._slow_down(job, span)
            self._follow(span)
            if self.pace <= 0.0:
                # Joints that lag behind stay where they are, as ros2_control lets them.
                self._stand()
                self._end(*self._ending)
            return
        job.time, self.pace, rate = paced_step(
            job.curve, job.time, self.pace, self.scale, span, self.joints.acceleration
        )
        self.wanted = self.at(job, job.time, rate)
        self._follow(span)
        self._supervise(job)

    def _slow_down(self, job: Job, span: float) -> None:
        """Integrate the pace along the curve."""
        job.time, self.pace, drop = slowed_down(
            job.curve, job.time, self.pace, span, self.joints.acceleration
        )
        sample, pace = job.curve.sample(job.time), self.pace
        if pace <= 0.0 or job.time >= job.curve.duration:
            self.pace = 0.0
            self.wanted = at_rest(sample.position)
            return
        acceleration = sample.acceleration * pace * pace - sample.velocity * drop
        self.wanted = State(sample.position, sample.velocity * pace, acceleration)

    def _follow(self, span: float) -> None:
        """Let the joints follow what is wanted."""
        self.actual = self.simulation.follow(self.wanted, span)

    def _stand(self) -> None:
        """Have the joints stand where they are."""
        self.wanted, self.actual = at_rest(self.simulation.position), self.simulation.stand()

    def _supervise(self, job: Job) -> None:
        """End or give up the motion where that is due."""
        found = verdict(job, self.wanted, self.actual, self.joints)
        over, allowed = job.time - job.arrival, self.settings.command_timeout
        if found is None and 0.0 < allowed < over:
            text = f"still not at its goal {over:.4g} s after its end, allowed are {allowed:g} s"
            found = Code.TIMED_OUT, text
        if found is None:
            return
        code, text = found
        if code:
            self.stop(End.ABORTED, code, text)
            return
        self.wanted = at_rest(job.goal)
        self._follow(0.0)
        self._end(End.REACHED, Code.NONE, "")
