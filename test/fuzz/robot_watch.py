"""Whether the robot obeys its limits, and still moves."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from known_robot import Array, KnownRobot, PublishedJoints
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger

from robomech_interfaces.srv import Execute, PlanJoint, SetSpeed

__all__ = ["STRANGER", "Resets", "StateWatch", "Watch", "why_it_does_not_move"]

# Rounding of numbers, and positions (rad or m) that are the same.
ROUNDING, _SAME = 1e-6, 1e-8
# Stamps may lag behind the clock of motions by this part, and the shortest time between two (s).
_DRIFT, _SHORTEST = 2e-3, 1e-9
# How far stamps of states may be off the time of this process (s).
_STAMPS_OFF = 2e-3
# States that may wait to be looked at while this process is held up.
_DEPTH = 1000
# The frame of joint states that are not the robot's.
STRANGER = "stranger"
# A service, its type and a request, to the answer; None where none comes.
Call = Callable[[str, Any, Any], Any]


class Resets:
    """When somebody may have put the robot home: from each request to its answer, in ROS time."""

    def __init__(self) -> None:
        self._spans: list[list[float]] = []

    def begin(self) -> Callable[[], None]:
        """Note that a reset is asked for; the function that is returned notes its answer."""
        span = [time.time(), np.inf]
        self._spans.append(span)

        def end() -> None:
            span[1] = time.time()

        return end

    def earliest(self, first: float, last: float) -> float:
        """Return when the first reset between two stamps may have been (s); infinite for none."""
        return min(
            (
                max(first, began - _STAMPS_OFF)
                for began, ended in self._spans
                if began - _STAMPS_OFF <= last and ended + _STAMPS_OFF >= first
            ),
            default=np.inf,
        )


class StateWatch:
    """Compares each state of a robot with its limits, and with the state before.

    Parameters
    ----------
    joints : PublishedJoints
    resets : Resets, optional
        When the robot may have jumped home; by default never.

    Attributes
    ----------
    fault : str
        What was wrong first; empty if nothing was.
    seen, wrong : int
        How many states there were, and in how many something was wrong.
    velocity : float
        The greatest share of a velocity limit so far, by velocities and by positions.
    """

    def __init__(self, joints: PublishedJoints, resets: Resets | None = None) -> None:
        self.fault, self.seen, self.wrong, self.velocity = "", 0, 0, 0.0
        self._joints, self._resets = joints, resets or Resets()
        self._last: tuple[float, Array] | None = None

    def look(self, names: Sequence[str], time: float, position: Array, velocity: Array) -> None:
        """Look at a state: names of joints, its stamp (s), positions and velocities."""
        joints, at = self._joints, {name: k for k, name in enumerate(names)}
        if not {*joints.names} <= {*names} or not len(names) == len(position) == len(velocity):
            return
        self.seen += 1
        order = [at[name] for name in joints.names]
        q, rates = np.asarray(position)[order], np.asarray(velocity)[order]
        shares = np.abs(rates) / joints.velocity, self._since_last(time, q)
        self.velocity = max(self.velocity, *(float(np.max(share)) for share in shares))
        faults = (
            self._outside(q),
            self._open(q),
            self._too_fast("velocity", shares[0], ROUNDING),
            self._too_fast("change of position by its stamps", shares[1], _DRIFT),
        )
        self.wrong += any(faults)
        if any(faults) and not self.fault:
            self.fault = f"joint_states at {time:.6f}: {next(filter(None, faults))}"
        self._last = time, q

    def _outside(self, q: Array) -> str:
        joints = self._joints
        outside = np.maximum(joints.lower - q, q - joints.upper)
        if joints.excess is not None and np.isfinite(q).all():
            outside = np.maximum(outside, joints.excess(q))
        if (outside <= ROUNDING).all():
            return ""
        k = int(np.argmax(outside))
        return f"{joints.names[k]} is at {q[k]:.6g}, {outside[k]:.3g} outside its limits"

    def _open(self, q: Array) -> str:
        if self._joints.gaps is None or not np.isfinite(q).all():
            return ""
        gap = float(self._joints.gaps(q).max())
        return "" if gap <= ROUNDING else f"loops are open by {gap:.3g}"

    def _since_last(self, time: float, q: Array) -> Array:
        """Return the speeds since the state before, or since a reset to home, over their limits."""
        if self._last is None:
            return np.zeros(len(q))
        shares = [self._speed(q - self._last[1], time - self._last[0])]
        reset = self._resets.earliest(self._last[0], time)
        if np.isfinite(reset):
            shares.append(self._speed(q - self._joints.home, time - reset))
        return min(shares, key=np.max)

    def _speed(self, way: Array, span: float) -> Array:
        way = np.maximum(np.abs(way) - _SAME, 0.0)
        return np.asarray(way / (max(span, _SHORTEST) * self._joints.velocity))

    def _too_fast(self, what: str, shares: Array, rounding: float) -> str:
        if (shares <= 1.0 + rounding).all():
            return ""
        k = int(np.argmax(shares))
        return f"{what} of {self._joints.names[k]} is {shares[k]:.6g} times its limit"


class Watch(StateWatch):
    """Looks at all that comes on the topic joint_states, but what strangers publish.

    Given points may ask for more than the limits of acceleration, as in ros2_control.
    """

    def __init__(self, node: Node, robot: KnownRobot, resets: Resets | None = None) -> None:
        super().__init__(robot.published, resets)
        node.create_subscription(JointState, "joint_states", self._take, _DEPTH)

    def _take(self, message: JointState) -> None:
        if message.header.frame_id != STRANGER:
            time = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
            self.look(message.name, time, message.position, message.velocity)


def why_it_does_not_move(call: Call, node: Node, robot: KnownRobot, servo: bool = True) -> str:
    """Plan a motion home and execute it; empty where that works."""
    why, factor = "", None
    with suppress(ImportError):  # without these messages nobody can slow the controller down
        from control_msgs.msg import SpeedScalingFactor

        topic = "joint_trajectory_controller/speed_scaling_input"
        factor = node.create_publisher(SpeedScalingFactor, topic, 10)
    for _ in range(5):
        if factor is not None:
            factor.publish(SpeedScalingFactor(factor=1.0))
        for name in ("trajectory_publisher/cancel", "trajectory_publisher/resume"):
            call(name, Trigger, Trigger.Request())
        if servo:
            call("servo/pause_servo", SetBool, SetBool.Request(data=False))
        call("trajectory_publisher/set_speed", SetSpeed, SetSpeed.Request(speed=1.0))
        call("joint_trajectory_controller/hold", Trigger, Trigger.Request())
        time.sleep(1.0)
        goal = JointState(name=list(robot.joint_names), position=robot.home.tolist())
        plan = call("trajectory_planner/plan_joint", PlanJoint, PlanJoint.Request(goal=goal))
        if plan is None or plan.error_code:
            why = "no plan" if plan is None else plan.error_msg
            continue
        request = Execute.Request(trajectory=plan.trajectory)
        done = call("trajectory_publisher/execute", Execute, request)
        if done is not None and done.error_code == 0:
            return ""
        why = "not executed" if done is None else done.error_msg
    return why
