"""One walk of the demonstration: twists that follow a path, and what the robot says of itself."""

from collections import deque

import numpy as np
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

from robomech_interfaces.msg import FootContacts
from robomech_ros.nodes.common.messages.message_fields import NANO
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, twist_vector
from robomech_ros.nodes.demonstration.client import DemoClient, seconds_of, twist_message
from robomech_ros.nodes.demonstration.path_follower import PathFollower
from robomech_ros.nodes.demonstration.suite import DemoFailedError
from robomech_ros.rolling.arcs import moved
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array, BoolArray

_DEPTH = 1000
# So often (s) a twist is sent.
_TWIST_PERIOD = 0.05
# So much longer than planned (s, and parts of the plan) a walk may take.
_PATIENCE, _TIME_FACTOR = 60.0, 3.0


class Walk:
    """Walks along a path, and keeps what is published meanwhile.

    - ``client``: client whose node publishes and subscribes.
    - ``lead``: parameter of the walker: time until a twist takes effect (s).
    """

    def __init__(self, client: DemoClient, lead: float) -> None:
        self._client, self._lead, node = client, lead, client.node
        self._sent: deque[tuple[float, Array]] = deque()
        self._poses: list[tuple[float, Array]] = []
        self._contacts: list[tuple[float, BoolArray, Array]] = []
        self._margins: list[float] = []
        self._still = False
        self._twists = node.create_publisher(TwistStamped, "cmd_vel", 10)
        node.create_subscription(Odometry, "odom", self._odometry, _DEPTH)
        node.create_subscription(FootContacts, "foot_contacts", self._feet, _DEPTH)
        node.create_subscription(
            Float64, "walker/stability_margin", lambda one: self._margins.append(one.data), _DEPTH
        )

    def _odometry(self, message: Odometry) -> None:
        self._still = not twist_vector(message.twist.twist).any()
        self._poses.append((seconds_of(message), matrix_from_pose(message.pose.pose)))

    def _feet(self, message: FootContacts) -> None:
        places = np.array([(one.x, one.y, one.z) for one in message.feet])
        self._contacts.append((seconds_of(message), np.array(message.contacts), places))

    def wait_until_it_stands(self) -> None:
        """Wait until all feet are down and the trunk is at rest."""
        known = len(self._poses)

        def stands() -> bool:
            reported = len(self._poses) > known and self._contacts and self._margins
            return bool(reported and self._still and self._contacts[-1][1].all())

        if not self._client.wait(stands, _PATIENCE):
            raise DemoFailedError(f"after {_PATIENCE:g} s the robot does not stand on all feet")

    def follow(self, follower: PathFollower, seconds: float) -> float:
        """Walk along a path from where the robot stands, and stop.

        - ``seconds``: planned duration (s).

        Returns the time that it took (s).
        """
        begin, started = rigid_inverse(self._poses[-1][1]), self._now()
        patience = _PATIENCE + _TIME_FACTOR * seconds

        def look() -> None:
            now = self._now()
            if self._sent and now < self._sent[-1][0] + _TWIST_PERIOD:
                return
            stamp, trunk = self._poses[-1]
            away = begin @ trunk
            heading = float(np.arctan2(away[1, 0], away[0, 0]))
            pose = self._ahead(np.array([*away[:2, 3], heading]), stamp - self._lead, now)
            self._send(follower.command(stamp, pose), now)

        if not self._client.wait(lambda: follower.arrived, patience, look):
            text = f"after {patience:.0f} s {follower.gone:.2f} m of the way are done"
            raise DemoFailedError(f"the walk did not arrive: {text}")
        self._send(np.zeros(3), self._now())
        took = self._now() - started
        self.wait_until_it_stands()
        return took

    def _now(self) -> float:
        """Return the ROS time (s)."""
        return float(self._client.node.get_clock().now().nanoseconds / NANO)

    def _ahead(self, pose: Array, since: float, now: float) -> Array:
        """Return the pose (x, y, heading) to which twists lead that were sent from a time on."""
        while len(self._sent) > 1 and self._sent[1][0] <= since:
            self._sent.popleft()
        times = [*(max(one, since) for one, _ in self._sent), now]
        for (_, twist), begin, end in zip(self._sent, times, times[1:], strict=False):
            pose = moved(pose, twist * (end - begin))
        return pose

    def _send(self, twist: Array, now: float) -> None:
        self._twists.publish(twist_message(twist))
        self._sent.append((now, twist))

    @property
    def trunk(self) -> tuple[Array, Array]:
        """ROS times (s), shape (m,), and poses of the trunk by odometry (m), (m, 4, 4)."""
        # More come meanwhile.
        times, poses = zip(*self._poses, strict=True)
        return np.array(times), np.array(poses)

    @property
    def feet(self) -> tuple[Array, BoolArray, Array]:
        """ROS times (s), (m,), which feet stand, (m, k), and where all are (m), (m, k, 3)."""
        times, contacts, places = zip(*self._contacts, strict=True)
        return np.array(times), np.array(contacts), np.array(places)

    @property
    def margins(self) -> Array:
        """The stability margins (m), shape (m,)."""
        return np.array(self._margins)
