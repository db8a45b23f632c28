"""The node of a walking machine: twists and poses in, joints, odometry and contacts out."""

from functools import partial
from typing import Any

from rclpy.node import Node

from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.readiness import Readiness
from robomech_ros.nodes.common.status_report import StatusReport
from robomech_ros.nodes.process.run import run_node
from robomech_ros.nodes.walker.driver import Driver
from robomech_ros.nodes.walker.settings import WalkerSettings, walker_of
from robomech_ros.walking import load_legged


class WalkerNode(Node):
    """Makes a walking machine follow twists within its stability margin."""

    SETTINGS = WalkerSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("walker", **options)
        settings = NodeParameters(self, WalkerSettings).settings
        robot = load_legged(settings.robot_description)
        walker = walker_of(robot, settings)
        self._motion_clock = MotionClock(self)
        self._driver = Driver(self, walker, self._motion_clock, settings)
        Readiness(self)
        StatusReport(self, "walk", robot.name, self._driver.condition)
        commands, controller = self._driver.topics
        self.get_logger().info(
            f"ready: {robot.name}, {len(robot.legs)} legs, gait {walker.gait}, margin at least "
            f"{walker.bound:g} m, commands on '{commands}', joints to '{controller}'"
        )
        self.create_timer(1.0 / settings.publish_rate, self._cycle, clock=self._motion_clock.clock)

    def _cycle(self) -> None:
        if self._motion_clock.runs:
            self._driver.cycle()


main = partial(run_node, WalkerNode)

if __name__ == "__main__":
    raise SystemExit(main())
