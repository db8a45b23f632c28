"""Shows the posture last analysed, and the boundary of the workspace, as markers."""

from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from visualization_msgs.msg import Marker, MarkerArray

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import SingularityReport, Workspace, point_jacobian
from robomech_ros.nodes.common.robot_description import LATCHED
from robomech_ros.nodes.kinematics.markers import (
    boundary_markers,
    marker_array,
    posture_markers,
    surface_markers,
)
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.parallel.kinetostatics.workspace_surface import WorkspaceSurface


_NO_TWISTS = np.empty((0, 6))


class MarkerPublisher:
    """Publishes ``~/markers``.

    Parameters
    ----------
    node : Node
        Owner of the publisher.
    base : str
        Frame of the base of all chains.
    on_watched : callable
        Coroutine that runs when somebody subscribes.
    """

    def __init__(self, node: Node, base: str, on_watched: Callable[[], Awaitable[object]]) -> None:
        self._base, self._on_watched = base, on_watched
        self._posture: list[Marker] = []
        self._boundary: list[Marker] = []
        self._publisher = node.create_publisher(
            MarkerArray,
            "~/markers",
            LATCHED,
            callback_group=ReentrantCallbackGroup(),
            event_callbacks=PublisherEventCallbacks(matched=self._matched),
        )

    def show_posture(
        self, chain: SerialChain, q: Array, point: Array, report: SingularityReport
    ) -> None:
        """Show what a point (3,) of the tip link can do in a posture q (n,)."""
        T = forward_kinematics(chain, q)
        J = point_jacobian(chain, q, point)
        at = T[:3, :3] @ point + T[:3, 3]
        self._posture = posture_markers(self._base, at, J, report.lost_directions, _NO_TWISTS)
        self._show()

    def show_platform(self, at: Array, J: Array | None, lost: Array, free: Array) -> None:
        """Show what a point of a platform at a place (3,) can do; see `posture_markers`."""
        self._posture = posture_markers(self._base, at, J, lost, free)
        self._show()

    def show_boundary(self, space: Workspace) -> None:
        """Show the boundary of a workspace, unless that was done."""
        if not self._boundary:
            self._boundary = boundary_markers(self._base, space)
            self._show()

    def show_surface(self, space: "WorkspaceSurface") -> None:
        """Show the boundary of a platform's positions in place of the last one."""
        self._boundary = surface_markers(self._base, space)
        self._show()

    def _show(self) -> None:
        """Publish all markers there are."""
        self._publisher.publish(marker_array([*self._posture, *self._boundary]))

    async def _matched(self, matched: Any) -> None:
        if matched.current_count:
            await self._on_watched()
