"""How regular the cycles of the simulated controller are, by the stamps of its joint states."""

from __future__ import annotations

import struct
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

CONTROLLER = "joint_trajectory_controller"
RATE = 500.0
# Ours and its peers are watched in turn, for 60 s altogether.
ROUNDS = 3
SECONDS = 20.0
CORE = 0
PATIENCE = 60.0
SETTLE_SECONDS = 2.0
SWING = 0.2  # rad, of every joint around the middle of its limits
HALF_PERIOD = 1.0  # s
DEPTH = 10_000
# A serialised JointState: four bytes of encapsulation, then seconds and nanoseconds of its stamp.
STAMP = struct.Struct("<iI")
STAMP_PLACE = 4


@dataclass(frozen=True)
class Regularity:
    """Cycles while the robot moves.

    Attributes
    ----------
    rate, seconds : float
        Wanted cycles per second, and how long they were watched (s).
    jitter : float
        99th percentile of what two cycles are apart more or less than wanted, s.
    missed : float
        Share of the cycles that were left out.
    core : float
        Share of one core that the process took.
    """

    rate: float
    seconds: float
    jitter: float
    missed: float
    core: float


def on_one_core(command: Sequence[str]) -> tuple[str, ...]:
    """Return the command that runs another on one core only."""
    return ("taskset", "-c", str(CORE), *command)


class Watcher:
    """Keeps the robot in motion and takes the stamps of its states.

    Parameters
    ----------
    node : Node
        For subscription and publisher.
    executor : SingleThreadedExecutor
        Spins the node.
    chain : SerialChain
        The robot.
    """

    def __init__(self, node: Node, executor: SingleThreadedExecutor, chain: SerialChain) -> None:
        self._executor = executor
        self._chain = chain
        self._stamps: list[bytes] = []
        # Raw, so that the watcher takes little time itself.
        self._states = node.create_subscription(
            JointState, "joint_states", self._take, DEPTH, raw=True
        )
        topic = f"{CONTROLLER}/joint_trajectory"
        self._node = node
        self._publisher = node.create_publisher(JointTrajectory, topic, 10)

    def _take(self, message: bytes) -> None:
        self._stamps.append(message[STAMP_PLACE : STAMP_PLACE + STAMP.size])

    def wait(self, alive: Callable[[], bool]) -> None:
        """Wait until the robot is there."""
        deadline = time.monotonic() + PATIENCE
        while not (self._stamps and self._publisher.get_subscription_count()):
            self._executor.spin_once(timeout_sec=0.1)
            if not alive() or time.monotonic() > deadline:
                raise SystemExit(f"no joint states of {CONTROLLER} within {PATIENCE:g} s")

    def measure(self, seconds: float = SECONDS) -> Array:
        """Have the robot move for some time (s); returns the stamps (s) of its cycles."""
        self._publisher.publish(self._swinging(seconds + 2.0 * SETTLE_SECONDS))
        self._spin(SETTLE_SECONDS)
        self._stamps.clear()
        self._spin(seconds)
        stamps = np.array([STAMP.unpack(stamp) for stamp in self._stamps])
        seconds_of_all: Array = stamps[:, 0] - stamps[0, 0] + 1e-9 * stamps[:, 1]
        return seconds_of_all

    def close(self) -> None:
        """Watch no more."""
        self._node.destroy_subscription(self._states)
        self._node.destroy_publisher(self._publisher)

    def _spin(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def _swinging(self, seconds: float) -> JointTrajectory:
        """Return a trajectory by quintics from side to side, which ends in the middle."""
        middle = self._chain.home()
        message = JointTrajectory(joint_names=list(self._chain.joint_names))
        still = [0.0] * self._chain.n
        count = int(seconds / HALF_PERIOD)
        for k in range(1, count + 1):
            side = 0.0 if k == count else SWING * (-1.0) ** k
            point = JointTrajectoryPoint(positions=(middle + side).tolist())
            point.velocities = point.accelerations = still
            point.time_from_start.sec, part = divmod(round(k * HALF_PERIOD * 1e9), 10**9)
            point.time_from_start.nanosec = part
            message.points.append(point)
        return message


def regularity(rounds: Sequence[Array], core: float) -> Regularity:
    """Judge the stamps (s) of successive cycles of several rounds, and the share of a core."""
    period = 1.0 / RATE
    apart = np.concatenate([np.diff(stamps) for stamps in rounds])
    span = sum(float(stamps[-1] - stamps[0]) for stamps in rounds)
    jitter = float(np.quantile(np.abs(apart - period), 0.99))
    return Regularity(RATE, float(round(span)), jitter, 1.0 - len(apart) * period / span, core)
