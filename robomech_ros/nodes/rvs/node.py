"""The node that shows the running robot in a browser, and has it moved from there."""

from functools import partial
from typing import Any

from rclpy.node import Node

from robomech_ros.errors.formatting import counted
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.readiness import Readiness
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.common.robot.robot_source import when_robot_known
from robomech_ros.nodes.common.status_report import NodeHealth, StatusReport
from robomech_ros.nodes.process.run import run_node
from robomech_ros.nodes.rvs.mobile.mobile_robots import MOVERS, MobileRobot
from robomech_ros.nodes.rvs.mobile.running_mobile_robot import RunningMobileRobot
from robomech_ros.nodes.rvs.running_robot import RunningRobot
from robomech_ros.nodes.rvs.settings import RvsSettings
from robomech_ros.robots.robot_kinds import ARM, check_name, kind_of
from robomech_ros.rvs.opening import live_page_of, mobile_page_of, require_viser

# Period of checks that asked nodes are still there (s).
_LOOK = 1.0


class RvsNode(Node):
    """Shows the running robot on a page, plans, executes and jogs from there."""

    SETTINGS = RvsSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("rvs", **options)
        require_viser()
        self._settings = NodeParameters(self, RvsSettings).settings
        check_name(self._settings.robot_description, (ARM, "parallel", *MOVERS))
        load = MOVERS.get(kind_of(self._settings.robot_description))
        if load is None:
            when_robot_known(self, self._settings, self._serve, parallel=True)
            return
        self._serve_mobile_robot(load(self._settings))
        Readiness(self)

    def _serve(self, model: RobotModel) -> None:
        settings = self._settings
        robot = RunningRobot(self, model, settings)
        described = model.description, model.robot or model.chain
        self._page = live_page_of(*described, robot, port=settings.port, host=settings.host)
        self._robot: RunningRobot | RunningMobileRobot = robot
        self.create_timer(_LOOK, robot.look)
        self._announce(model.chain.name, len(model.commanded.joint_names))

    def _serve_mobile_robot(self, mobile_robot: MobileRobot) -> None:
        settings, shown = self._settings, mobile_robot.followed
        robot = RunningMobileRobot(self, mobile_robot, settings)
        self._page = mobile_page_of(shown, robot, port=settings.port, host=settings.host)
        self._robot = robot
        self._announce(mobile_robot.name, len(shown.joints))

    def _announce(self, name: str, joints: int) -> None:
        StatusReport(self, "view", name, self._condition)
        # Not logged: the log goes to a topic that everybody reads, and the address has the token.
        print(f"{self.get_fully_qualified_name()}: open {self._page.url}", flush=True)
        self.get_logger().info(f"ready: {name}, {counted(joints, 'joint')}")

    @property
    def url(self) -> str:
        """The address of the page, with its token."""
        return self._page.url

    def listen_to_markers(self) -> list[str]:
        """Listen to markers from now on, as a page may ask for; gives the topics."""
        if not isinstance(self._robot, RunningRobot):
            return []
        self._robot.want_markers(True)
        return [self.resolve_topic_name(topic) for topic in self._settings.marker_topics]

    def _condition(self) -> NodeHealth:
        browsers, fault = self._page.browsers, self._robot.condition
        summary = counted(browsers, "browser") if browsers else "nobody looks"
        values = {
            "address": self._page.url.partition("?")[0],
            "browsers": browsers,
            "jogging": self._robot.jogs,
            "joint states": fault or "as they come",
        }
        return NodeHealth(f"{summary}; {fault}" if fault else summary, bool(fault), values)

    def stop(self) -> None:
        """End a jog; a motion that was sent goes on."""
        if hasattr(self, "_robot"):
            self._robot.let_go()

    def destroy_node(self) -> None:
        """Close the page, and take leave of ROS."""
        if hasattr(self, "_robot"):
            self._page.close()
            self._robot.close()
        super().destroy_node()


main = partial(run_node, RvsNode)

if __name__ == "__main__":
    raise SystemExit(main())
