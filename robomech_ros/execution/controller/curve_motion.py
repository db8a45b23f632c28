"""Moves joints along a curve at a pace that changes, slows them down on it, or holds them.

With the pace p = ds/dt along a curve q(s) the joints have the velocity q' p and the acceleration
q'' p^2 + q' dp/dt.
"""

from robomech_ros.execution.controller.simulated_joints import SimulatedJoints
from robomech_ros.execution.controller.trajectory_goal import TrajectoryGoal
from robomech_ros.execution.joints import State, at_rest, paced_state
from robomech_ros.execution.time_scaling import paced_step
from robomech_ros.typing import Array


class CurveMotion:
    """Desired and actual positions of n joints, which stand, with limits of acceleration (n,).

    The desired state is where the curve is, the actual one where the sensors show the joints. The
    pace is how fast the curve is followed: 1, or less while slowing down or scaled. The scale is
    the pace to be reached, 0 to 1; it may be set at any time.
    """

    def __init__(self, simulated_joints: SimulatedJoints, acceleration: Array) -> None:
        self._joints = simulated_joints
        self._acceleration = acceleration
        self.pace = self.scale = 1.0
        self.desired = self.actual = at_rest(simulated_joints.position)

    def begin(self) -> None:
        """Get ready for another curve."""
        # A curve that begins moving begins with the speed that the joints have.
        self.pace = 1.0 if self.desired.velocity.any() else self.scale
        self._joints.count_anew()

    def state_at(self, goal: TrajectoryGoal, time: float, rate: float = 0.0) -> State:
        """Return the state at a time (s) of a goal's curve, while the pace changes by `rate`."""
        return paced_state(goal.curve.sample(time), self.pace, rate)

    def go_on(self, goal: TrajectoryGoal, span: float) -> None:
        """Follow the curve of a goal for `span` (s)."""
        rate = self._advance(goal, self.scale, span)
        self.desired = self.state_at(goal, goal.time, rate)
        self.hold(span)

    def slow_down(self, goal: TrajectoryGoal, span: float) -> bool:
        """Slow down on the curve of a goal for `span` (s); returns whether it stands then."""
        rate = self._advance(goal, 0.0, span)
        if self.pace <= 0.0 or goal.time >= goal.curve.duration:
            self.pace = 0.0
            self.desired = at_rest(goal.curve.sample(goal.time).position)
        else:
            self.desired = self.state_at(goal, goal.time, rate)
        self.hold(span)
        return self.pace <= 0.0

    def _advance(self, goal: TrajectoryGoal, pace: float, span: float) -> float:
        """Move on for `span` (s) towards a pace; returns how fast the pace changes (1/s)."""
        goal.time, self.pace, rate = paced_step(
            goal.curve, goal.time, self.pace, pace, span, self._acceleration
        )
        return rate

    def hold(self, span: float) -> None:
        """Move the joints along the desired motion for `span` (s)."""
        self.actual = self._joints.follow(self.desired, span)

    def settle(self, position: Array) -> None:
        """Want the joints at rest at a position (rad or m) that they have reached."""
        self.desired = at_rest(position)
        self.hold(0.0)

    def stand(self) -> None:
        """Stop the joints where they are."""
        self.desired, self.actual = at_rest(self._joints.position), self._joints.stand()

    def put(self, position: Array, shown: Array | None = None) -> None:
        """Place the joints at rest elsewhere (rad or m), at once; see `SimulatedJoints.put`."""
        self.desired, self.actual = at_rest(position), self._joints.put(position, shown)
