"""The desired state of a follower's joints, now or at some time."""

from robomech_ros.execution.controller.follower import Phase, TrajectoryFollower
from robomech_ros.execution.controller.trajectory_goal import TrajectoryGoal
from robomech_ros.execution.joints import State, at_rest, paced_state
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.execution.time_scaling import paced_step


def past_the_end(follower: TrajectoryFollower, ahead: float) -> float:
    """Return how long (s) after the end of its trajectory a time from now is; 0 if it is not."""
    waiting, goal = follower.waiting, follower.active
    if waiting is not None and follower.now + ahead >= waiting.begin:
        return max(follower.now + ahead - waiting.begin - waiting.curve.duration, 0.0)
    if goal is None or follower.phase is Phase.STOPPING:
        return 0.0
    return max(goal.time + follower.motion.pace * ahead - goal.curve.duration, 0.0)


def desired_state(follower: TrajectoryFollower, ahead: float) -> State:
    """Return the state that is planned for some time (s) from now, if nothing comes between.

    After the end of a trajectory that is at rest at its last point. Negative times are the past of
    the trajectory under way; TrajectoryRefusedError before that, or before the robot came to stand,
    since what was planned then is not kept.
    """
    waiting = follower.waiting
    if waiting is not None and follower.now + ahead >= waiting.begin:
        return paced_state(waiting.curve.sample(follower.now + ahead - waiting.begin), 1.0, 0.0)
    goal, pace = follower.active, follower.motion.pace
    if goal is None:
        held = follower.now - follower.held_since
        if ahead < -held:
            raise _too_early(ahead, f"the robot has held since {held:.6g} s ago")
        return follower.desired
    if follower.phase is Phase.STOPPING:
        if ahead < 0.0:
            raise _too_early(ahead, "the robot is being stopped")
        return _while_stopping(follower, goal, ahead)
    time = goal.time + pace * ahead
    if time < 0.0:
        began = goal.time / pace
        raise _too_early(ahead, f"the trajectory under way began {began:.6g} s ago")
    return follower.motion.state_at(goal, time)


def _while_stopping(follower: TrajectoryFollower, goal: TrajectoryGoal, ahead: float) -> State:
    time, pace, rate = paced_step(
        goal.curve, goal.time, follower.motion.pace, 0.0, ahead, follower.joints.acceleration
    )
    sample = goal.curve.sample(time)
    if pace <= 0.0 or time >= goal.curve.duration:
        return at_rest(sample.position)
    return paced_state(sample, pace, rate)


def _too_early(ahead: float, since: str) -> TrajectoryRefusedError:
    return TrajectoryRefusedError(f"{-ahead:.6g} s ago is not known any more: {since}")
