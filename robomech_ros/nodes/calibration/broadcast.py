"""The result on /tf_static: it is latched, so that who comes later hears it, too."""

from __future__ import annotations

from typing import Any

import numpy as np
from rclpy.node import Node

from robomech_ros.nodes.calibration.messages import stamped_transform
from robomech_ros.nodes.calibration.samples import PublishedFrame
from robomech_ros.nodes.common.robot_description import LATCHED
from robomech_ros.nodes.frames.listener import FrameListener
from robomech_ros.nodes.frames.tree import NoTransformError
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array


class ResultBroadcaster:
    """Tells tf where the sensor is, as long as nobody else does.

    Drivers of cameras publish frames above the one that sees: then the uppermost of them gets the
    robot's frame as its parent, since a frame with two parents would tear tf apart.

    Parameters
    ----------
    node : Node
        Owner of the publisher.
    listener : FrameListener
        What tf has already.
    """

    def __init__(self, node: Node, listener: FrameListener) -> None:
        self._clock, self._listener = node.get_clock(), listener
        #: What tf was told last; None if nothing.
        self.placed: PublishedFrame | None = None
        self._publisher: Any = None
        if not listener.missing:
            from tf2_msgs.msg import TFMessage

            self._kind = TFMessage
            self._publisher = node.create_publisher(TFMessage, "/tf_static", LATCHED)

    def publish(self, parent: str, sensor: str, T: Array) -> str:
        """Publish the pose (4, 4) of the sensor in its parent; says why it was not, else ""."""
        if self._publisher is None:
            return self._listener.missing
        if not sensor:
            return "the sensor has no frame, the parameter tracking_base_frame"
        try:
            top, pose = self._top(parent, sensor)
        except NoTransformError as error:
            return str(error)
        return self.place(PublishedFrame(parent, top, T @ rigid_inverse(pose)))

    def place(self, placed: PublishedFrame) -> str:
        """Publish this, whatever tf has; says why it was not, else ""."""
        if self._publisher is None:
            return self._listener.missing
        message = stamped_transform(placed.pose, placed.parent, placed.child)
        message.header.stamp = self._clock.now().to_msg()
        self._publisher.publish(self._kind(transforms=[message]))
        self.placed = placed
        return ""

    def _top(self, parent: str, sensor: str) -> tuple[str, Array]:
        """Find the uppermost frame of the sensor's, and the sensor in it; refuse a foreign one."""
        self._listener.look()
        tree = self._listener.tree
        if sensor not in tree:
            return sensor, np.eye(4)
        way = tree.path_to_root(sensor)
        own = self.placed.child if self.placed is not None else ""
        top = own if own in way else way[-1]
        if top != own and parent in tree and tree.path_to_root(parent)[-1] == top:
            raise NoTransformError(
                f"tf has the sensor's frame {sensor!r} below {way[1] if len(way) > 1 else top!r} "
                "already, by somebody else: stop that, or calibrate another frame"
            )
        found = tree.between(top, sensor)
        if found.stamp is not None:
            raise NoTransformError(f"the sensor's frame {sensor!r} moves in {top!r}, by /tf")
        return top, found.pose
