"""A simulated camera that answers with noise where it sees its target."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.message_fields import NANO
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose, stamped_transform
from robomech_ros.nodes.demonstration.client import DemoClient
from robomech_ros.robots import SerialChain
from robomech_ros.spatial import inverse_pose, matrix_from_rotation_vector, pose_exponential
from robomech_ros.typing import Array

CAMERA, MARKER = "camera", "marker"
# The topics in place of tf, where tf2_msgs is not installed.
HAND_TOPIC, MARKER_TOPIC = "camera/hand", "camera/marker"
# Between two images, s.
_PERIOD = 0.05
# Camera on the hand, and target for a fixed camera: logarithms of poses.
_ON_THE_HAND = (0.08, -0.05, 1.5, 0.05, -0.03, 0.06)
# Distance of the target, as a part of the arm's reach.
_DISTANCE = 0.35
# The target seen a quarter turn wrong, as happens with square ones.
_MISTAKE = (0.0, 0.0, 0.5 * np.pi, 0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Scene:
    """Poses of camera and target."""

    #: Whether the hand carries the camera, and the target stands; else it carries the target.
    in_hand: bool
    #: Pose of the camera in the hand, or in the base if it stands (m), shape (4, 4).
    camera: Array
    #: Pose of the target in the base, or in the hand if that carries it (m), shape (4, 4).
    target: Array
    #: Point in the base (m) about which the hand turns to keep the target in view, shape (3,).
    centre: Array

    def seen(self, hand: Array) -> Array:
        """Return the target in the camera, with the hand (4, 4) in the base."""
        moving = hand if self.in_hand else inverse_pose(hand)
        return inverse_pose(moving @ self.camera) @ self.target


def scene_of(chain: SerialChain, q: Array, in_hand: bool) -> Scene:
    """Put the target before the camera with the arm at positions q, shape (n,)."""
    hand = forward_kinematics(chain, q)
    reach = float(np.linalg.norm(hand[:3, 3])) or 1.0
    apart = np.eye(4)
    # Face to face: the target's z comes towards the camera.
    apart[:3, :3], apart[:3, 3] = np.diag([1.0, -1.0, -1.0]), (0.0, 0.0, _DISTANCE * reach)
    mounted = pose_exponential(_ON_THE_HAND)
    if in_hand:
        target = hand @ mounted @ apart
        return Scene(True, mounted, target, target[:3, 3])
    return Scene(False, hand @ mounted @ apart, mounted, hand[:3, 3])


class SimulatedCamera:
    """Looks at the joint states, and tells tf or a topic where the target is.

    - ``client``: receives the joint states and publishes.
    - ``noise``: deviation of each coordinate of its rotations (rad) and positions (m).
    - ``on_tf``: whether it publishes on /tf; else on topics, with the pose of the hand.
    - ``mistaken``: whether it takes the target for one that is turned by 90 degrees.
    """

    def __init__(
        self,
        client: DemoClient,
        chain: SerialChain,
        scene: Scene,
        noise: tuple[float, float],
        on_tf: bool,
    ) -> None:
        self._client, self._chain, self._scene, self._noise = client, chain, scene, noise
        self._rng = np.random.default_rng(1)
        self.mistaken = False
        node = client.node
        self._publishers: dict[str, Any] = {}
        if on_tf:
            from tf2_msgs.msg import TFMessage

            self._kind = TFMessage
            self._publishers["tf"] = node.create_publisher(TFMessage, "/tf", 10)
        else:
            for topic in (HAND_TOPIC, MARKER_TOPIC):
                self._publishers[topic] = node.create_publisher(PoseStamped, topic, 10)
        self._timer = node.create_timer(_PERIOD, self._answer)

    def _answer(self) -> None:
        """Publish what an image of this moment shows."""
        latest = self._client.latest
        if latest is None:
            return
        instant, q = latest
        hand = forward_kinematics(self._chain, q)
        seen = self._noisy(self._scene.seen(hand))
        if self.mistaken:
            seen = seen @ pose_exponential(_MISTAKE)
        sec, nanosec = divmod(round(instant * NANO), NANO)
        stamp = Time(sec=sec, nanosec=nanosec)
        if "tf" in self._publishers:
            message = stamped_transform(seen, CAMERA, MARKER)
            message.header.stamp = stamp
            self._publishers["tf"].publish(self._kind(transforms=[message]))
            return
        for topic, T, frame in ((HAND_TOPIC, hand, self._chain.base), (MARKER_TOPIC, seen, CAMERA)):
            pose = stamped_pose(T, frame)
            pose.header.stamp = stamp
            self._publishers[topic].publish(pose)

    def _noisy(self, T: Array) -> Array:
        rotation, position = self._noise
        noisy = T.copy()
        noisy[:3, :3] = T[:3, :3] @ matrix_from_rotation_vector(rotation * self._rng.normal(size=3))
        noisy[:3, 3] += position * self._rng.normal(size=3)
        return noisy
