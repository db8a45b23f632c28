"""Pose of a robot over the ground and its limits, for the page while it has a viewer."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float64

from robomech_interfaces.msg import FootContacts
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.common.status_report import TOPIC
from robomech_ros.nodes.middleware.polled_subscription import Inbox
from robomech_ros.nodes.rvs.mobile.mobile_robots import MobileRobot
from robomech_ros.nodes.rvs.poll_thread import DEPTH, PollThread
from robomech_ros.nodes.rvs.settings import RvsSettings
from robomech_ros.rvs.model.running.live_robot import Stance
from robomech_ros.rvs.model.running.observed_robot import on_plane
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.rvs.layers.live_mobile_robot import LiveMobileRobotLayer

# Diagnostics that wait at the most: they come from many nodes.
_REPORT_DEPTH = 100
# The margin that walking machines keep, until they say so themselves (m).
_BOUND = 0.01


class MobileRobotFeed(PollThread):
    """Reads odometry, joint states, contacts and diagnostics, from a thread of its own."""

    def __init__(
        self,
        node: Node,
        mobile_robot: MobileRobot,
        settings: RvsSettings,
        view: LiveMobileRobotLayer,
    ) -> None:
        super().__init__(node, settings, view, mobile_robot.followed.joints)
        self._view, self._robot = view, mobile_robot
        self._odometry = Inbox(node, Odometry, mobile_robot.odometry, DEPTH)
        self._reports = Inbox(node, DiagnosticArray, TOPIC, _REPORT_DEPTH)
        self._reporter = node.resolve_topic_name(mobile_robot.node).lstrip("/")
        self._contacts = self._margins = None
        if mobile_robot.legged is not None:
            self._contacts = Inbox(node, FootContacts, "foot_contacts", DEPTH)
            self._margins = Inbox(node, Float64, f"{mobile_robot.node}/stability_margin", DEPTH)
        self._T: Array | None = None
        self._margin, self._bound, self._gait = math.nan, _BOUND, ""
        self._placed_at = -math.inf
        self._thread.start()

    def show(self, now: float) -> None:
        """Show where the robot is, and on which feet it stands."""
        for message in self._odometry.take():
            self._T = matrix_from_pose(message.pose.pose, "odometry")
            self._placed_at = now
        if self._T is not None and now in (self._updated_at, self._placed_at):
            placed = self._robot.followed.placed(self._T)
            known = self._monitor.known_positions(self._joints)
            self._view.show_pose({**known, **placed}, on_plane(self._T))
        if self._margins is None or self._contacts is None:
            return
        for margin in self._margins.take():
            self._margin = margin.data
        contacts = list(self._contacts.take())
        if contacts and self._T is not None and math.isfinite(self._margin):
            self._view.show_stance(self._stance(contacts[-1], self._T))

    def fault(self, now: float) -> str:
        """Show what limits the robot, and say what is wrong with odometry or joint states."""
        self._read_reports()
        for topic, at in ((self._odometry.topic, self._placed_at), (self._topic, self._updated_at)):
            if math.isinf(at):
                return f"Nothing yet on '{topic}': where the robot is is not known."
            if now - at > self._settings.state_timeout:
                return f"Nothing on '{topic}' for {now - at:.0f} s: the robot may be elsewhere."
        return ""

    def _stance(self, message: FootContacts, T: Array) -> Stance:
        from robomech_ros.rvs.model.walking.support import Support

        legs = self._robot.legged
        assert legs is not None
        found = {
            name: (stands, (foot.x, foot.y, foot.z))
            for name, stands, foot in zip(
                message.names, message.contacts, message.feet, strict=True
            )
        }
        missing = [name for name in legs.leg_names if name not in found]
        if missing:
            raise RobomechError(f"foot_contacts does not name {', '.join(missing)}")
        contacts = np.array([found[name][0] for name in legs.leg_names], dtype=np.bool_)
        feet = as_finite("feet", [found[name][1] for name in legs.leg_names], (3,))
        centre = (T[:3, :3] @ legs.mass_centre + T[:3, 3])[:2]
        support = Support(legs.leg_names, feet, contacts, centre)
        return Stance(support, self._margin, self._bound, self._gait)

    def _read_reports(self) -> None:
        latest = None
        for message in self._reports.take():
            for status in message.status:
                if status.name.partition(":")[0] == self._reporter:
                    latest = status
        if latest is None:
            return
        values = {one.key: one.value for one in latest.values}
        self._bound = _number(values.get("stability bound (m)", ""), self._bound)
        self._gait = values.get("gait", "")
        limited = values.get("limited by", "").split(", ")
        links = [f"{name}_link" for name in self._joints if name in limited]
        warns = latest.level != DiagnosticStatus.OK
        text = f"{latest.message[:1].upper()}{latest.message[1:]}."
        self._view.show_condition(text, links, warns=warns)


def _number(text: Any, otherwise: float) -> float:
    try:
        number = float(text)
    except ValueError:
        return otherwise
    return number if math.isfinite(number) else otherwise
