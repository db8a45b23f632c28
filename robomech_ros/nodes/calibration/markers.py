"""Calibration markers for viewers."""

from __future__ import annotations

from typing import Any

from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from robomech_ros.nodes.calibration.samples import Frames, Samples
from robomech_ros.nodes.common.pose_messages import pose_from_matrix
from robomech_ros.rvs.model.calibration_view import calibration_markers, sample_markers
from robomech_ros.rvs.model.live_robot import ViewMarker

_KINDS = {
    "box": Marker.CUBE,
    "sphere": Marker.SPHERE,
    "lines": Marker.LINE_LIST,
    "text": Marker.TEXT_VIEW_FACING,
}


def marker_message(samples: Samples, frames: Frames) -> MarkerArray:
    """Draw the samples, and the result if it is that of these very samples.

    The message replaces all that was shown before.
    """
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
