"""Execution requests from received messages, and the messages in which they are sent."""

import copy
from dataclasses import dataclass

import numpy as np
from builtin_interfaces.msg import Time
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_ros.errors import UnknownJointError, WrongSizeError
from robomech_ros.execution.client.execution_request import ExecutionRequest, Transport
from robomech_ros.execution.received_trajectory import read_waypoints
from robomech_ros.nodes.common.messages.joint_messages import received_trajectory
from robomech_ros.nodes.common.messages.message_fields import NANO, duration_from_seconds, floats
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.typing import Array


@dataclass
class ExecutionReader:
    """Turns received trajectories into execution requests."""

    clock: MotionClock  #: The clock of the stamps.
    max_points: int  #: Largest number of points of a trajectory.
    max_duration: float  #: Longest duration of a trajectory (s).
    #: Names of all joints of the robot; empty until the robot is known.
    robot_joints: tuple[str, ...] = ()

    def read(
        self, message: JointTrajectory, transport: Transport, *, ignore_collisions: bool = False
    ) -> ExecutionRequest:
        """Convert a received trajectory to an execution request, or raise a RobomechError."""
        names = list(message.joint_names)
        if not names:
            raise WrongSizeError("joint_names", 0, "at least one joint")
        for name in names:
            if self.robot_joints and name not in self.robot_joints:
                raise UnknownJointError(name, self.robot_joints)
        waypoints = read_waypoints(
            received_trajectory(message), names, self.max_points, self.max_duration
        )
        delay = self.clock.until(message.header.stamp, self.clock.now())
        return ExecutionRequest(message, names, waypoints, transport, delay, ignore_collisions)


def message_from_execution(execution: ExecutionRequest, now: int) -> JointTrajectory:
    """Make the message of an execution request.

    - ``execution``: the execution request to be sent.
    - ``now``: ROS time of `sent_at` (ns); the stamp of a message at another pace counts from it.

    Returns the received message, unless it is sent at another pace.
    """
    if not execution.paced:
        return execution.trajectory
    header = copy.copy(execution.trajectory.header)
    if execution.paced_on_way:
        header.stamp = _stamp(now, execution.delay)
    waypoints = execution.waypoints
    points = [
        JointTrajectoryPoint(
            positions=floats(waypoints.positions[k]),
            velocities=_row(waypoints.velocities, k),
            accelerations=_row(waypoints.accelerations, k),
            time_from_start=duration_from_seconds(time),
        )
        for k, time in enumerate(waypoints.times.tolist())
    ]
    return JointTrajectory(header=header, joint_names=list(execution.names), points=points)


def _stamp(now: int, delay: float) -> Time:
    """Return the stamp `delay` (s) from now; 0, which means at once, where there is none."""
    if delay <= 0.0:
        return Time()
    seconds, nanoseconds = divmod(now + round(delay * NANO), NANO)
    return Time(sec=seconds, nanosec=nanoseconds)


def _row(rows: Array | None, k: int) -> object:
    """Return a row; nothing where it is NaN."""
    if rows is None or np.isnan(rows[k]).any():
        return []
    return floats(rows[k])
