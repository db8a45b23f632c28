"""The node of a rolling robot: twists in, wheels, odometry and frames out."""

import math
from contextlib import suppress
from functools import partial
from typing import Any

from rclpy.node import Node
from std_srvs.srv import Empty

from robomech_ros.nodes.common.messages.pose_messages import require_finite
from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.readiness import Readiness
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.common.status_report import NodeHealth, StatusReport
from robomech_ros.nodes.common.twist_input import TwistInput
from robomech_ros.nodes.mobile_base.drives import INTERFACES, chosen_robot
from robomech_ros.nodes.mobile_base.mobile_base import BaseOptions, MobileBase
from robomech_ros.nodes.mobile_base.publication import BasePublication
from robomech_ros.nodes.mobile_base.settings import (
    DYNAMIC,
    FORMER_NAMES,
    MobileBaseSettings,
    check_settings,
)
from robomech_ros.nodes.process.run import run_node

# Updates that are made up for at once; a base that was held up for longer goes on from where it is.
_MOST_UPDATES = 100
# Wheels that contradict each other by more than this (m/s) are worth a warning.
_SLIP_WARNING = 1e-3


class MobileBaseNode(Node):
    """Drives a simulated rolling robot by twists, as the controllers of ros2_control do."""

    SETTINGS = MobileBaseSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("mobile_base", **options)
        settings = NodeParameters(
            self, MobileBaseSettings, check=check_settings, former=FORMER_NAMES
        ).settings
        check_settings(settings)
        robot, joints = chosen_robot(settings)
        interface = INTERFACES[robot.drive]
        timeout = getattr(settings, interface.timeout_name)
        timeout = interface.timeout if math.isnan(timeout) else timeout
        self._period = 1.0 / settings.update_rate
        self._base = MobileBase(
            robot,
            interface,
            BaseOptions(
                period=self._period,
                timeout=timeout,
                open_loop=settings.open_loop,
                by_position=settings.position_feedback,
                window=settings.velocity_rolling_window_size if interface.mean else 1,
                dynamic=settings.simulation == DYNAMIC,
                wheel_position=settings.initial_wheel_position,
            ),
        )
        self._motion_clock = MotionClock(self)
        self._base.time = self._motion_clock.now()
        self._intake = TwistInput(self, interface.command, self._base.take, self._motion_clock)
        self._publication = BasePublication(self, self._base, joints, settings)
        self._updates_per_state = max(round(settings.update_rate / settings.publish_rate), 1)
        self._updates = 0
        Readiness(self)
        serve(self, Empty, "~/reset_odometry", self._reset_odometry)
        # Not in every release of control_msgs.
        with suppress(ImportError):
            from control_msgs.srv import SetOdometry

            serve(self, SetOdometry, "~/set_odometry", self._set_odometry)
        StatusReport(self, "motion", robot.base.name, self._condition)
        if timeout == 0.0 and interface.at_zero == "never":
            text = f"{interface.timeout_name} is 0: every command is too old, nothing will move"
            self.get_logger().warning(text)
        self.get_logger().info(
            f"ready: {robot.base.name}, drive {robot.drive}, {len(robot.base.driven)} driven "
            f"wheels, commands on '{self._intake.topic}'"
        )
        self.create_timer(self._period, self._cycle, clock=self._motion_clock.clock)

    def _cycle(self) -> None:
        if not self._motion_clock.runs:
            return
        self._intake.take()
        now, base = self._motion_clock.now(), self._base
        due = int((now - base.time) / self._period)
        if due > _MOST_UPDATES:
            base.time += (due - _MOST_UPDATES) * self._period
            due = _MOST_UPDATES
        for _ in range(due):
            base.update()
            stamp = self._motion_clock.stamp(base.time)
            self._publication.publish_commands(stamp)
            self._updates += 1
            if self._updates % self._updates_per_state == 0:
                self._publication.publish_states(stamp)

    def _reset_odometry(self, request: Any, response: Any) -> Any:
        self._base.place([0.0, 0.0, 0.0])
        return response

    def _set_odometry(self, request: Any, response: Any) -> Any:
        require_finite("odometry", request, ("x", "y", "yaw"))
        self._base.place([request.x, request.y, request.yaw])
        beside = any((request.z, request.roll, request.pitch))
        ignored = "; z, roll and pitch were ignored: the base stays on the ground" if beside else ""
        response.message = f"odometry continues at x, y and yaw{ignored}"
        response.success = True
        return response

    def _condition(self) -> NodeHealth:
        base, slip = self._base, self._base.odometry.slip
        limits = ", ".join((*base.motion.saturated, *base.simulated.saturated))
        summary = "moves" if base.motion.twist.any() else "stands"
        summary += ", without commands" if base.timed_out else ""
        trouble = self._intake.refusal or (f"limited by {limits}" if limits else "")
        if slip > _SLIP_WARNING:
            trouble = trouble or f"wheels slip by {slip:.3g} m/s"
        values = {
            "slip (m/s)": f"{slip:.6g}",
            "limited by": limits,
            "ignored commands": self._intake.refused,
            "last ignored": self._intake.refusal,
        }
        return NodeHealth(f"{summary}; {trouble}" if trouble else summary, bool(trouble), values)


main = partial(run_node, MobileBaseNode)

if __name__ == "__main__":
    raise SystemExit(main())
