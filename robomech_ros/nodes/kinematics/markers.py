"""Markers of the mobility of the tip in a posture, and of the boundary of the workspace."""

from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from geometry_msgs.msg import Point
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from visualization_msgs.msg import Marker, MarkerArray

from robomech_ros.kinetostatics import Workspace, manipulability_ellipsoid
from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.kinematics.kinematic_results import PostureReport
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.parallel.kinetostatics.workspace_surface import WorkspaceSurface

_Colour = tuple[float, float, float, float]

# Half axis of the longest direction of an ellipsoid, and length of an arrow (m).
_LONGEST, _ARROW = 0.15, 0.25
# Least thickness of an ellipsoid over its longest axis: a flat one would be invisible.
_FLAT = 0.01
_WIDTH = 0.004
_VELOCITY, _FORCE = (0.1, 0.5, 0.9, 0.45), (0.9, 0.5, 0.1, 0.45)
_LOST_LINEAR, _LOST_ANGULAR = (0.9, 0.1, 0.1, 1.0), (0.8, 0.1, 0.8, 1.0)
_FREE_LINEAR, _FREE_ANGULAR = (0.9, 0.6, 0.0, 1.0), (0.0, 0.6, 0.6, 1.0)
_SURFACE = (0.2, 0.4, 0.6, 0.25)
_OUTER, _VOID = (0.1, 0.1, 0.1, 0.8), (0.8, 0.1, 0.1, 0.8)
# Half-planes in which the boundary is drawn, and vertices left out between those that are.
_PLANES, _EVERY = 8, 8


class MarkerPublisher:
    """Publishes the posture last analysed and the boundary of the workspace on ``~/markers``.

    - ``base``: frame of the base.
    - ``on_watched``: coroutine that runs when somebody subscribes.
    """

    def __init__(self, node: Node, base: str, on_watched: Callable[[], Awaitable[object]]) -> None:
        self._base, self._on_watched = base, on_watched
        self._posture: list[Marker] = []
        self._boundary: list[Marker] = []
        # Subscribers of another type or quality of service report that themselves.
        events = PublisherEventCallbacks(matched=self._matched, use_default_callbacks=False)
        options: Any = {"callback_group": ReentrantCallbackGroup(), "event_callbacks": events}
        self._publisher = node.create_publisher(MarkerArray, "~/markers", LATCHED, **options)

    def show_posture(self, markers: list[Marker]) -> None:
        """Show a posture in place of the last one."""
        self._posture = markers
        self._show()

    def show_boundary(self, markers: list[Marker]) -> None:
        """Show a boundary in place of the last one, unless it is the same."""
        if markers is not self._boundary and (markers or self._boundary):
            self._boundary = markers
            self._show()

    def _show(self) -> None:
        """Publish one message that replaces all that was shown before."""
        markers = [Marker(action=Marker.DELETEALL), *self._posture, *self._boundary]
        for marker in markers:
            marker.header.frame_id = self._base
        self._publisher.publish(MarkerArray(markers=markers))

    async def _matched(self, matched: Any) -> None:
        if matched.current_count:
            await self._on_watched()


def posture_markers(report: PostureReport) -> list[Marker]:
    """Make the ellipsoids of velocity and force of a point, and arrows of lost and free directions.

    The half axes of the first are the singular values of the linear rows of the Jacobian, those
    of the second their inverses; each is drawn with a longest half axis of 0.15 m.
    """
    position, J = report.position, report.jacobian
    markers: list[Marker] = []
    if J is not None and J[3:].any():
        found = manipulability_ellipsoid(J[3:])
        velocity = np.maximum(found.velocity / max(float(found.velocity[0]), 1e-300), _FLAT)
        force = velocity[-1] / velocity
        markers += [
            _ellipsoid("velocity_ellipsoid", position, found.axes, velocity, _VELOCITY),
            _ellipsoid("force_ellipsoid", position, found.axes, force, _FORCE),
        ]
    lost, free = report.lost_directions, report.free_directions
    markers += _arrows("lost_directions", position, lost, (_LOST_LINEAR, _LOST_ANGULAR))
    markers += _arrows("free_directions", position, free, (_FREE_LINEAR, _FREE_ANGULAR))
    return markers


def _arrows(
    name: str, position: Array, twists: Array, colours: tuple[_Colour, _Colour]
) -> list[Marker]:
    """Make arrows of the linear and the angular parts of twists (k, 6)."""
    markers: list[Marker] = []
    for twist in twists:
        for part, colour in zip((twist[3:], twist[:3]), colours, strict=True):
            length = float(np.linalg.norm(part))
            if length > 1e-3 * float(np.linalg.norm(twist)):
                arrow = _marker(name, len(markers), Marker.ARROW, colour)
                arrow.points = [_point(position), _point(position + _ARROW * part / length)]
                arrow.scale.x, arrow.scale.y, arrow.scale.z = 0.012, 0.024, 0.03
                markers.append(arrow)
    return markers


def boundary_markers(space: Workspace) -> list[Marker]:
    """Make line strips of the boundary, in eight half-planes about axis 1, or along the slide.

    Of a planar arm it is in its plane, once.
    """
    section = space.section
    if section.flat:
        values = np.zeros(1)
    elif section.slides[0]:
        values = np.linspace(section.lower[0], section.upper[0], _PLANES)
    else:
        span = section.upper[0] - section.lower[0]
        ends = _PLANES - int(not section.round[0])
        values = section.lower[0] + span * np.arange(_PLANES) / ends
    markers: list[Marker] = []
    for value in values:
        for curve in space.curves:
            if curve.role == "interior":
                continue
            colour = _OUTER if curve.role == "outer" else _VOID
            strip = _marker("workspace", len(markers), Marker.LINE_STRIP, colour)
            strip.scale.x = _WIDTH
            points = space.swept(float(value), curve=curve)
            kept = np.unique(np.append(np.arange(0, len(points), _EVERY), len(points) - 1))
            strip.points = [_point(point) for point in points[kept]]
            markers.append(strip)
    return markers


def surface_markers(space: "WorkspaceSurface") -> list[Marker]:
    """Make triangles of the boundary of a platform's positions, or lines where it is flat."""
    corners = space.boundary
    if not len(corners):
        return []
    flat = corners.shape[1] < 3
    if corners.shape[1] == 1:
        corners = space.facets
    kind, colour = (Marker.LINE_LIST, _OUTER) if flat else (Marker.TRIANGLE_LIST, _SURFACE)
    marker = _marker("workspace", 0, kind, colour)
    marker.scale.x = _WIDTH if flat else 1.0
    marker.scale.y = marker.scale.z = marker.scale.x
    marker.points = [_point(corner) for corner in corners.reshape(-1, 3)]
    return [marker]


def _ellipsoid(
    name: str, position: Array, axes: Array, half_axes: Array, colour: tuple[float, ...]
) -> Marker:
    marker = _marker(name, 0, Marker.SPHERE, colour)
    marker.pose = pose_from_matrix(assembled(axes, position))
    marker.scale.x, marker.scale.y, marker.scale.z = (2.0 * _LONGEST * half_axes).tolist()
    return marker


def _marker(name: str, number: int, kind: int, colour: tuple[float, ...]) -> Any:
    marker = Marker(ns=name, id=number, type=kind, action=Marker.ADD)
    marker.pose.orientation.w = 1.0
    marker.color.r, marker.color.g, marker.color.b, marker.color.a = colour
    return marker


def _point(values: Array) -> Point:
    x, y, z = values.tolist()
    return Point(x=x, y=y, z=z)
