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

__all__ = ["STRANGER", "StateWatch", "Watch", "why_it_does_not_move"]

# Rounding of numbers, and positions (rad or m) that are the same.
ROUNDING, _SAME = 1e-6, 1e-8
# Stamps may lag behind the clock of motions by this part, and the shortest time between two (s).
_DRIFT, _SHORTEST = 2e-3, 1e-9
# States that may wait to be looked at while this process is held up.
_DEPTH = 1000
# The frame of joint states that are not the robot's.
STRANGER = "stranger"
# A service, its type and a request, to the answer; None where none comes.
Call = Callable[[str, Any, Any], Any]


class StateWatch:
    """Compares each state of a robot with its limits, and with the state before.

    Parameters
    ----------
    joints : PublishedJoints

    Attributes
    ----------
    fault : str
        What was wrong first; empty if nothing was.
    seen : int
        How many states there were.
    velocity : float
        The greatest share of a velocity limit so far, by velocities and by positions.
    """

    def __init__(self, joints: PublishedJoints) -> None:
        self.fault, self.seen, self.velocity = "", 0, 0.0
        self._joints = joints
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
        found = [
            self._outside(q),
            self._open(q),
            self._too_fast("velocity", shares[0], ROUNDING),
            self._too_fast("change of position by its stamps", shares[1], _DRIFT),
        ]
        self.fault = self.fault or next((f"joint_states: {one}" for one in found if one), "")
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
        if self._last is None or time < self._last[0]:
            return np.zeros(len(q))
        span = max(time - self._last[0], _SHORTEST)
        ways = np.abs(np.array((q - self._last[1], q - self._joints.home)))
        shares = np.maximum(ways - _SAME, 0.0) / (span * self._joints.velocity)
        return np.asarray(shares[np.argmin(shares.max(axis=1))])

    def _too_fast(self, what: str, shares: Array, rounding: float) -> str:
        if (shares <= 1.0 + rounding).all():
            return ""
        k = int(np.argmax(shares))
        return f"{what} of {self._joints.names[k]} is {shares[k]:.6g} times its limit"


class Watch(StateWatch):
    """Looks at all that comes on the topic joint_states, but what strangers publish.

    Given points may ask for more than the limits of acceleration, as in ros2_control.
    """

    def __init__(self, node: Node, robot: KnownRobot) -> None:
        super().__init__(robot.published)
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
