"""How long the servo takes from a command to the stream that follows it, between processes."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

JOINT = "waist"
SPEED = 0.1  # rad/s
COMMANDS = 300
# Long enough for the velocity to be constant again, s.
BETWEEN = 0.35
KEPT_UP = 0.03
PATIENCE = 120.0
# A message begins so many periods before its newest point: the parameter `lead` of the servo.
LEAD = 2


@dataclass(frozen=True)
class Latency:
    """How long a command takes.

    Attributes
    ----------
    median, largest_of_99 : float
        From sending it to receiving the first message that follows it (s).
    motion : float
        Until the motion itself changes by that message, the median (s).
    messages : int
        How many were received.
    """

    median: float
    largest_of_99: float
    motion: float
    messages: int


class Operator:
    """Commands one joint to and fro, and sees when the stream turns.

    Parameters
    ----------
    node : Node
        Gets publisher and subscription.
    executor : SingleThreadedExecutor
        Spins it.
    """

    def __init__(self, node: Node, executor: SingleThreadedExecutor) -> None:
        self._executor = executor
        self._commands = node.create_publisher(JointState, "servo/joint_velocity_cmds", 1)
        topic = "joint_trajectory_controller/joint_trajectory"
        node.create_subscription(JointTrajectory, topic, self._take, 10)
        self._speeds = (0.0, 0.0)
        self._turns_at = 0.0
        self._messages = 0

    def _take(self, message: JointTrajectory) -> None:
        """See how fast the joint is at the first point of a message, and at its newest one.

        What comes after that is the plan to stop.
        """
        self._messages += 1
        points, place = message.points, list(message.joint_names).index(JOINT)
        newest = min(LEAD, len(points) - 1)
        self._speeds = points[0].velocities[place], points[newest].velocities[place]
        begin = points[max(newest - 1, 0)].time_from_start
        stamp = message.header.stamp
        self._turns_at = stamp.sec + begin.sec + 1e-9 * (stamp.nanosec + begin.nanosec)

    def _command(self, speed: float) -> None:
        self._commands.publish(JointState(name=[JOINT], velocity=[speed]))

    def _keep_up(self, speed: float, seconds: float, alive: Callable[[], bool]) -> None:
        """Repeat a command for a while."""
        end = time.perf_counter() + seconds
        due = 0.0
        while (now := time.perf_counter()) < end and alive():
            if now >= due:
                self._command(speed)
                due = now + KEPT_UP
            self._executor.spin_once(0.002)

    def measure(self, alive: Callable[[], bool]) -> Latency:
        """Turn round COMMANDS times while the servo is alive."""
        begin = time.monotonic()
        while not self._messages:
            self._keep_up(SPEED, 0.1, alive)
            if time.monotonic() > begin + PATIENCE or not alive():
                raise SystemExit("the servo does not move the robot")
        speed, seconds, motions = SPEED, [], []
        for _ in range(COMMANDS):
            # Not in step with the periods of the servo.
            self._keep_up(speed, BETWEEN + 0.01 * (len(seconds) * 0.618 % 1.0), alive)
            speed = -speed
            sent, sent_at = time.perf_counter(), time.time()
            self._command(speed)
            while time.perf_counter() < sent + 1.0:
                self._executor.spin_once(0.001)
                before, after = self._speeds
                if (after - before) * speed > 1e-9:
                    seconds.append(time.perf_counter() - sent)
                    motions.append(self._turns_at - sent_at)
                    break
        if len(seconds) < 0.9 * COMMANDS:
            raise SystemExit(f"only {len(seconds)} of {COMMANDS} commands were seen to be followed")
        return Latency(
            statistics.median(seconds),
            statistics.quantiles(seconds, n=100)[98],
            statistics.median(motions),
            self._messages,
        )
