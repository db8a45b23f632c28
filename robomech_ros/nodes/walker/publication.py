"""Published state of a walker: odometry, frames, contacts, margin and polygon."""

import math

import numpy as np
from geometry_msgs.msg import Point, Point32, PolygonStamped
from rclpy.node import Node
from std_msgs.msg import Float64

from robomech_interfaces.msg import FootContacts
from robomech_ros.nodes.common.messages.message_fields import NANO, fill_header
from robomech_ros.nodes.common.robot.odometry_frame import (
    POSE,
    TWIST,
    OdometryPublisher,
    full_covariance,
)
from robomech_ros.nodes.walker.settings import WalkerSettings
from robomech_ros.spatial import pose_logarithm
from robomech_ros.spatial.plain_poses import plain_pose
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array
from robomech_ros.walking import LeggedRobot, WalkUpdate, support_polygon

_DEPTH = 10


class Uncertainty:
    """Covariances of the place of the trunk in the plane, and of its twist.

    The motion of the trunk follows from the standing feet by least squares.  The way of each foot
    under the trunk has a variance in proportion to its length.

    - ``slip``: variance of the way of a foot for each metre (m^2/m).
    """

    def __init__(self, slip: float) -> None:
        self._slip = slip
        self._pose, self._twist = np.zeros((3, 3)), np.zeros((3, 3))
        self._before: Array | None = None

    @property
    def pose(self) -> Array:
        """Covariance of the pose in message order: 36 numbers (m^2, m rad, rad^2)."""
        return full_covariance(self._pose, POSE)

    @property
    def twist(self) -> Array:
        """Covariance of the twist since the last moment, in the trunk: 36 numbers."""
        return full_covariance(self._twist, TWIST)

    def forget(self) -> None:
        """Forget where the trunk was; what is uncertain so far remains."""
        self._before = None

    def add(self, update: WalkUpdate, seconds: float) -> None:
        """Add what may have slipped since the last moment, so many seconds ago."""
        T = update.trunk
        here = np.array([T[0, 3], T[1, 3], math.atan2(T[1, 0], T[0, 0])])
        before, self._before = self._before, here
        if before is None or seconds <= 0.0:
            return
        c, s = math.cos(before[2]), math.sin(before[2])
        dx, dy = here[:2] - before[:2]
        step = np.array(
            [math.remainder(here[2] - before[2], 2.0 * math.pi), c * dx + s * dy, c * dy - s * dx]
        )
        away = (update.feet[update.contacts, :2] - before[:2]) @ np.array([[c, -s], [s, c]])
        rows = np.zeros((len(away), 2, 3))
        rows[:, 0, 0], rows[:, 1, 0] = -away[:, 1], away[:, 0]
        rows[:, 0, 1] = rows[:, 1, 2] = 1.0
        lengths = np.linalg.norm(rows @ step, axis=1)
        solution = np.linalg.pinv(rows.reshape(-1, 3))
        spread = self._slip * (solution * np.repeat(lengths, 2)) @ solution.T
        onward = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
        turned = np.array([[0.0, c, -s], [0.0, s, c], [1.0, 0.0, 0.0]])
        grown = onward @ self._pose @ onward.T + turned @ spread @ turned.T
        self._pose = 0.5 * (grown + grown.T)
        self._twist = spread / seconds**2


class WalkPublication:
    """Publishes where a walking machine is."""

    def __init__(self, node: Node, robot: LeggedRobot, settings: WalkerSettings) -> None:
        prefix = settings.frame_prefix
        self._odom = prefix + settings.odom_frame_id
        frames, trunk = "/tf" if settings.enable_odom_tf else "", prefix + robot.trunk
        self._odometry = OdometryPublisher(node, "odom", frames, self._odom, trunk)
        self._names = list(robot.leg_names)
        self._contacts = node.create_publisher(FootContacts, "foot_contacts", _DEPTH)
        self._margin = node.create_publisher(Float64, "~/stability_margin", _DEPTH)
        self._polygon = node.create_publisher(PolygonStamped, "~/support_polygon", _DEPTH)
        self._before: tuple[int, Array] | None = None
        self._uncertainty = Uncertainty(settings.foot_slip)

    def publish(self, update: WalkUpdate, stamp: int) -> None:
        """Publish a moment of the walk, at a ROS time (ns)."""
        before, self._before = self._before, (stamp, update.trunk)
        seconds = 0.0 if before is None else (stamp - before[0]) / NANO
        self._uncertainty.add(update, seconds)
        twist = mean_twist(before[1] if before else update.trunk, update.trunk, seconds)
        covariances = self._uncertainty.pose, self._uncertainty.twist
        self._odometry.publish(plain_pose(update.trunk), twist, covariances, stamp)
        standing = [bool(one) for one in update.contacts]
        feet = [Point(x=x, y=y, z=z) for x, y, z in update.feet.tolist()]
        contacts = FootContacts(names=self._names, contacts=standing, feet=feet)
        fill_header(contacts.header, self._odom, stamp)
        self._contacts.publish(contacts)
        self._margin.publish(Float64(data=update.margin))
        polygon = PolygonStamped()
        fill_header(polygon.header, self._odom, stamp)
        corners = support_polygon(update.feet[update.contacts, :2])
        polygon.polygon.points = [Point32(x=x, y=y) for x, y in corners.tolist()]
        self._polygon.publish(polygon)

    def forget(self) -> None:
        """Forget where the trunk was: it begins anew."""
        self._before = None
        self._uncertainty.forget()


def mean_twist(before: Array, trunk: Array, seconds: float) -> Array:
    """Return the mean twist [w; v] of the trunk, in its own axes, since it was published last.

    That of a trunk that has not moved is exactly zero: people wait for that.
    """
    if seconds <= 0.0 or np.array_equal(before, trunk):
        return np.zeros(6)
    return np.asarray(pose_logarithm(rigid_inverse(before) @ trunk)) / seconds
