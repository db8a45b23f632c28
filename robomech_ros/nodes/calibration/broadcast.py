"""The result on /tf_static, which is latched, and calibration markers for viewers."""

from typing import Any

import numpy as np
from geometry_msgs.msg import Point
from rclpy.node import Node
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from robomech_ros.nodes.calibration.samples import Frames, PublishedFrame, Samples
from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix, stamped_transform
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.frames.listener import FrameListener
from robomech_ros.nodes.frames.tree import NoTransformError
from robomech_ros.rvs.model.calibration_view import calibration_markers, sample_markers
from robomech_ros.rvs.model.running.live_robot import ViewMarker
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array

_KINDS = {
    "box": Marker.CUBE,
    "sphere": Marker.SPHERE,
    "lines": Marker.LINE_LIST,
    "text": Marker.TEXT_VIEW_FACING,
}


class ResultBroadcaster:
    """Tells tf where the sensor is, as long as nobody else does.

    Drivers of cameras publish frames above the one that sees: then the uppermost of them gets the
    robot's frame as its parent, since a frame with two parents would tear tf apart.

    - ``listener``: what tf has already.
    """

    def __init__(self, node: Node, listener: FrameListener) -> None:
        self._clock, self._listener = node.get_clock(), listener
        #: The transform published on tf last; None if none was.
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
        path = tree.path_to_root(sensor)
        own = self.placed.child if self.placed is not None else ""
        top = own if own in path else path[-1]
        if top != own and parent in tree and tree.path_to_root(parent)[-1] == top:
            raise NoTransformError(
                f"tf has the sensor's frame {sensor!r} below {path[1] if len(path) > 1 else top!r} "
                "already, by somebody else: stop that, or calibrate another frame"
            )
        found = tree.between(top, sensor)
        if found.stamp is not None:
            raise NoTransformError(f"the sensor's frame {sensor!r} moves in {top!r}, by /tf")
        return top, found.pose


def marker_message(samples: Samples, frames: Frames) -> MarkerArray:
    """Replace the drawing by the samples, and by the result if it is of these samples."""
    base, hand, solution = frames.base, frames.hand, samples.solved
    if solution is None:
        drawn = sample_markers(samples.robot, samples.tracking, base)
    else:
        drawn = calibration_markers(solution.result, solution.tracking, base, hand)
    clear = Marker(header=Header(frame_id=base), action=Marker.DELETEALL)
    return MarkerArray(markers=[clear, *(_marker(one) for one in drawn)])


def _marker(drawn: ViewMarker) -> Any:
    marker = Marker(ns=drawn.name, type=_KINDS[drawn.kind], action=Marker.ADD, text=drawn.text)
    marker.header.frame_id, marker.pose = drawn.link, pose_from_matrix(drawn.pose)
    marker.scale.x, marker.scale.y, marker.scale.z = drawn.measures
    marker.color = ColorRGBA(**dict(zip("rgba", drawn.colour, strict=True)))
    marker.points = [Point(x=x, y=y, z=z) for x, y, z in drawn.points.tolist()]
    return marker
