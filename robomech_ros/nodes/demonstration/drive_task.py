"""Driving closed paths through the node of a rolling robot, by what it publishes."""

import math
from typing import Any, NamedTuple

import numpy as np
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.qos import qos_profile_sensor_data

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.common.messages.pose_messages import twist_vector
from robomech_ros.nodes.demonstration.client import DemoClient, seconds_of, twist_message
from robomech_ros.nodes.demonstration.closed_paths import (
    ClosedPath,
    figure_of_eight,
    rounded_square,
)
from robomech_ros.nodes.demonstration.path_follower import PathFollower
from robomech_ros.nodes.demonstration.report import Reporter
from robomech_ros.nodes.demonstration.suite import DemoFailedError
from robomech_ros.nodes.mobile_base.drives import Interface
from robomech_ros.rolling import CommandLimiter, RollingBase, RollingRobot
from robomech_ros.typing import Array

# Radius of the paths, in least turning radii and in lengths of the base.
_RADIUS_FACTOR, _LENGTH_FACTOR = 1.3, 1.0
# Parts of the limits of velocity and of the others that are used; what is too fast is slowed down.
_VELOCITY_PART, _LIMIT_PART, _SLOWDOWN = 0.7, 0.5, 0.9
# The least speed that is driven (m/s).
_MIN_SPEED = 1e-3
# How long a path may take, in the time that it needs at its speed, and besides (s).
_TIME_FACTOR, _EXTRA_TIME = 5.0, 60.0
_TIMEOUT = 60.0
# At the end: how far off its beginning the base may be (m, rad), and odometry off the base.
_POSITION_ERROR, _HEADING_ERROR, _ODOMETRY_ERROR = 0.02, 0.02, 1e-6
# Quiet wheels: what rounding leaves of a twist (rad/s, m/s).
_REST_SPEED = 1e-9


def paths_for(base: RollingBase) -> tuple[float, tuple[ClosedPath, ClosedPath]]:
    """Return the paths of a base, and the radius at which they turn (m)."""
    places = np.array([wheel.position for wheel in base.wheels])
    size = max(float(np.ptp(places, axis=0).max()), float(base.radii.max()))
    radius = max(
        _LENGTH_FACTOR * size, _RADIUS_FACTOR * max(abs(1.0 / value) for value in base.curvatures)
    )
    turning = base.axle is None
    square = rounded_square(radius, turning=turning)
    return radius, (square, figure_of_eight(radius, looking_ahead=not turning))


def speed_on(robot: RollingRobot, path: ClosedPath, radius: float) -> tuple[float, float]:
    """Return a speed (m/s) and an acceleration (m/s^2) on a path, well within all limits.

    Raises BadValueError: the limits do not let the base go along the path.
    """
    base, limits = robot.base, robot.limits
    assert limits.acceleration is not None
    assert limits.deceleration is not None
    assert limits.jerk is not None
    used = slice(1, 2) if base.axle is not None else slice(1, 3)
    slowest = np.minimum(limits.acceleration, limits.deceleration)[used]
    acceleration = _LIMIT_PART * min(1.0, float(slowest.min()))
    jerk = _LIMIT_PART * float(limits.jerk[used].min())
    speed = min(2.0, math.sqrt(acceleration * radius), (jerk * radius**2) ** (1.0 / 3.0))
    for wheel in base.wheels:
        if wheel.kind == "steered":
            far = max(float(np.hypot(*wheel.position)), radius)
            speed = min(speed, _LIMIT_PART * wheel.max_steering_rate * radius**2 / far)
    limiter, twists = CommandLimiter(base, limits, 0.01), path.twists()
    while limiter.allowed(twists * speed / _VELOCITY_PART)[1]:
        speed *= _SLOWDOWN
        if speed < _MIN_SPEED:
            raise BadValueError(
                "limits", base.name, f"some that allow {path.name} at {_MIN_SPEED} m/s"
            )
    return speed, 0.5 * acceleration


class Driven(NamedTuple):
    """A path that was driven.

    - ``begin``, ``end``: ROS times (s).
    """

    path: ClosedPath
    begin: float
    end: float


class DriveTask:
    """Drives a base and records its poses.

    - ``interface``: topics of its drive.
    """

    def __init__(
        self, client: DemoClient, robot: RollingRobot, interface: Interface, reporter: Reporter
    ) -> None:
        self._client, self._robot, self._reporter = client, robot, reporter
        self._odometry: list[Array] = []
        self._true: list[Array] = []
        self._follower: PathFollower | None = None
        self._rests = False
        node = client.node
        command, odometry = (
            topic.replace("~", "mobile_base") for topic in (interface.command, interface.odometry)
        )
        self._commands = node.create_publisher(TwistStamped, command, 1)
        node.create_subscription(Odometry, odometry, self._answer, qos_profile_sensor_data)
        truth = "mobile_base/simulated_base"
        node.create_subscription(
            PoseStamped,
            truth,
            lambda message: self._true.append(_row(message, message.pose)),
            qos_profile_sensor_data,
        )

    def wait_until_up(self) -> None:
        """Wait for odometry and for a subscriber to commands."""

        def is_up() -> bool:
            known = self._odometry and self._true
            return bool(known and self._commands.get_subscription_count())

        if not self._client.wait(is_up, _TIMEOUT):
            topic = self._commands.topic_name
            raise DemoFailedError(
                f"after {_TIMEOUT:g} s no odometry comes, or '{topic}' has no subscriber"
            )

    @property
    def poses(self) -> Array:
        """Path of the base, shape (n, 4): ROS time (s), x, y (m), heading (rad), continuous."""
        rows = np.array(list(self._true))
        rows = rows[np.diff(rows[:, 0], prepend=-np.inf) > 0.0]
        return np.column_stack([rows[:, :3], np.unwrap(rows[:, 3])])

    def drive(self, path: ClosedPath, radius: float) -> Driven:
        """Drive a path, and check where the base arrives."""
        speed, acceleration = speed_on(self._robot, path, radius)
        follower = PathFollower(self._robot.base.axle, path, speed, acceleration, radius)
        begin = self._odometry[-1][0]
        seconds = path.length / speed
        patience = _TIME_FACTOR * seconds + _EXTRA_TIME
        self._reporter.say(
            f"{path.name}: {path.length:.1f} m at {speed:.2f} m/s, about {seconds:.0f} s"
        )
        self._follower = follower
        with self._reporter.progress(path.name, _pose_text) as show:

            def look() -> None:
                show(follower.gone / path.length, self._odometry[-1][1:])

            arrived = self._client.wait(lambda: follower.arrived and self._rests, patience, look)
            look()
        self._follower = None
        if not arrived:
            raise DemoFailedError(
                f"{path.name}: after {patience:.0f} s the base has gone {follower.gone:.2f} of "
                f"{path.length:.2f} m"
            )
        end = self._odometry[-1][0]
        self._check(path, follower.off)
        return Driven(path, begin, end)

    def _check(self, path: ClosedPath, off: float) -> None:
        """Compare the end with the beginning, by odometry and by the base itself."""
        if not self._client.wait(
            lambda: self._true[-1][0] >= self._odometry[-1][0] - 1e-6, _TIMEOUT
        ):
            raise DemoFailedError("the simulated base is no longer told")
        odometry = self._odometry[-1]
        true = min(self._true[-50:], key=lambda row: abs(row[0] - odometry[0]))
        for what, row in (("odometry", odometry), ("the simulated base", true)):
            away, turned = math.hypot(row[1], row[2]), abs(math.remainder(row[3], 2.0 * math.pi))
            if away > _POSITION_ERROR or turned > _HEADING_ERROR:
                raise DemoFailedError(
                    f"{path.name}: by {what} the base is {away:.3g} m and {turned:.3g} rad from "
                    f"where it began, expected at most {_POSITION_ERROR} m and {_HEADING_ERROR} rad"
                )
        apart = float(np.abs(odometry[1:3] - true[1:3]).max())
        if apart > _ODOMETRY_ERROR:
            raise DemoFailedError(f"odometry is {apart:.3g} m off the simulated base")
        self._reporter.say(
            f"{path.name}: back after {path.length:.1f} m, {away * 1e3:.1f} mm and "
            f"{turned * 1e3:.1f} mrad off; never more than {off * 1e3:.1f} mm beside the path; "
            f"odometry {apart:.0e} m off the simulated base"
        )

    def _answer(self, message: Odometry) -> None:
        row = _row(message, message.pose.pose)
        self._rests = bool(np.abs(twist_vector(message.twist.twist)).max() < _REST_SPEED)
        follower = self._follower
        if follower is not None:
            command = twist_message(follower.command(row[0], row[1:]))
            command.header.stamp = self._client.node.get_clock().now().to_msg()
            self._commands.publish(command)
        self._odometry.append(row)


def _pose_text(pose: Array) -> str:
    x, y, heading = pose
    return f"x {x:+.3f} m, y {y:+.3f} m, heading {math.remainder(heading, 2.0 * math.pi):+.3f} rad"


def _row(message: Any, pose: Any) -> Array:
    """Return time (s), x, y (m) and heading (rad) of a message and its pose on the ground."""
    heading = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
    return np.array([seconds_of(message), pose.position.x, pose.position.y, heading])
