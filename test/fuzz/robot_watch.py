"""Whether the robot obeys its limits, and still moves."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
from known_robot import KnownRobot
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger

from robomech_interfaces.srv import Execute, PlanJoint, SetSpeed

__all__ = ["STRANGER", "Watch", "why_it_does_not_move"]

# Rounding of positions and times in messages.
ROUNDING = 1e-6
# The frame of joint states that are not the robot's.
STRANGER = "stranger"
# A service, its type and a request, to the answer; None where none comes.
Call = Callable[[str, Any, Any], Any]


class Watch:
    """Looks whether the robot obeys its velocity limits.

    Given points may ask for more than the limits of acceleration, as in ros2_control.
    """

    def __init__(self, node: Node, robot: KnownRobot) -> None:
        self.fault, self.seen, self._robot = "", 0, robot
        self._known = set(robot.joint_names)
        # The greatest share of a limit so far.
        self.velocity = 0.0
        node.create_subscription(JointState, "joint_states", self._look, 100)

    def _look(self, message: JointState) -> None:
        if message.header.frame_id == STRANGER:
            return
        names, count = list(message.name), len(message.name)
        own = [name for name in names if name in self._known]
        if own != list(self._robot.joint_names):
            return
        if len(message.velocity) < count or len(message.position) < count:
            return
        self.seen += 1
        joints = [names.index(name) for name in own]
        rates = np.abs(message.velocity)[joints]
        share = float((rates / self._robot.velocity).max())
        self.velocity = max(self.velocity, share)
        if not np.isfinite(message.position).all() or not share <= 1.0 + ROUNDING:
            self.fault = self.fault or f"joint_states: velocity is {share:.6g} of its limit"


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
