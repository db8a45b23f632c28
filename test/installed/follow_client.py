"""A client of follow_joint_trajectory, which drives a PUMA 560 and prints how its goals ended.

Runs as a process of its own, with the Python of either distribution; the robot follows with a lag.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import rclpy
from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance
from rclpy.action import ActionClient
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

CONTROLLER = "joint_trajectory_controller"
PATIENCE = 30.0
MOVE = 0.2
SLOWLY = 20.0


class Client:
    """Sends goals and waits for what comes of them."""

    def __init__(self) -> None:
        self.node = rclpy.create_node("follow_client")
        self.state: JointState | None = None
        self.feedback = 0
        self.node.create_subscription(JointState, "joint_states", self._take, 10)
        self.action = ActionClient(
            self.node, FollowJointTrajectory, f"{CONTROLLER}/follow_joint_trajectory"
        )

    def _take(self, message: JointState) -> None:
        self.state = message

    def until(self, condition: Any) -> None:
        """Spin until something is the case."""
        clock, begin = self.node.get_clock(), self.node.get_clock().now()
        while not condition():
            rclpy.spin_once(self.node, timeout_sec=0.1)
            if (clock.now() - begin).nanoseconds > PATIENCE * 1e9:
                sys.exit(f"nothing happened within {PATIENCE:g} s")

    def wait(self, future: Any) -> Any:
        """Spin until a future is done; returns its result."""
        self.until(future.done)
        return future.result()

    def send(self, change: float, duration: float, **tolerances: Any) -> Any:
        """Send a goal by one quintic from where the robot is; returns its handle."""
        self.until_still()
        start = list(self.state.position)
        still = [0.0] * len(start)
        points = [
            JointTrajectoryPoint(positions=place, velocities=still, accelerations=still)
            for place in (start, [angle + change for angle in start])
        ]
        points[1].time_from_start = seconds(duration)
        trajectory = JointTrajectory(joint_names=self.state.name, points=points)
        goal = FollowJointTrajectory.Goal(trajectory=trajectory, **tolerances)
        return self.wait(self.action.send_goal_async(goal, self._count))

    def _count(self, message: Any) -> None:
        self.feedback += 1

    def until_still(self) -> None:
        """Spin until the robot stands."""
        self.until(lambda: self.state and max(map(abs, self.state.velocity)) < 1e-4)

    def until_moving(self) -> None:
        """Spin until the robot moves."""
        self.until(lambda: max(map(abs, self.state.velocity)) > 1e-3)

    def outcome(self, handle: Any) -> list[Any]:
        """Return status, code and text of a goal."""
        answer = self.wait(handle.get_result_async())
        return [answer.status, answer.result.error_code, answer.result.error_string]


def seconds(value: float) -> Duration:
    """Make a duration message."""
    return Duration(sec=int(value), nanosec=round(value % 1.0 * 1e9))


def drive(client: Client) -> dict[str, Any]:
    """Have goals succeed, cancelled, preempted and violate their tolerances."""
    found = {"success": client.outcome(client.send(MOVE, 0.6))}
    handle = client.send(-MOVE, SLOWLY)
    client.until_moving()
    client.wait(handle.cancel_goal_async())
    found["cancel"] = client.outcome(handle)
    client.until_still()
    first = client.send(-MOVE, SLOWLY)
    client.until_moving()
    # It begins where the robot is then.
    point = JointTrajectoryPoint(positions=client.state.position, time_from_start=seconds(0.5))
    trajectory = JointTrajectory(joint_names=client.state.name, points=[point])
    goal = FollowJointTrajectory.Goal(trajectory=trajectory)
    second = client.wait(client.action.send_goal_async(goal))
    found["preempted"] = client.outcome(first)
    found["preempting"] = client.outcome(second)
    name = client.state.name[1]
    path = [JointTolerance(name=name, position=0.002)]
    found["path"] = client.outcome(client.send(-MOVE, 0.6, path_tolerance=path))
    goals = {"goal_tolerance": [JointTolerance(name=name, position=1e-9)]}
    goals["goal_time_tolerance"] = seconds(0.02)
    found["goal"] = client.outcome(client.send(MOVE, 0.6, **goals))
    handle = client.send(0.0, 0.1, path_tolerance=[JointTolerance(name="thumb", position=1.0)])
    found["thumb"] = client.outcome(handle)
    return {**found, "feedback": client.feedback}


def main() -> None:
    """Drive the robot and print what came of it."""
    rclpy.init()
    client = Client()
    try:
        if not client.action.wait_for_server(PATIENCE):
            sys.exit("no follow_joint_trajectory")
        print(json.dumps(drive(client)))
    finally:
        client.action.destroy()
        client.node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
