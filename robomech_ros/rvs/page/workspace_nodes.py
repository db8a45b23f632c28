"""The workspace in the scene: its section, the surface that this sweeps, and points of a map."""

from collections.abc import Callable
from typing import Any

import numpy as np

from robomech_ros.rvs.model.bodies.solids import box
from robomech_ros.rvs.model.workspace.reach_points import ReachPoints
from robomech_ros.rvs.model.workspace.workspace_views import SectionView
from robomech_ros.rvs.page.mesh_nodes import add_batch, add_mesh
from robomech_ros.rvs.page.node_space import NodeSpace, place_node
from robomech_ros.typing import Array

SURFACE_COLOUR, OPACITY = (60, 130, 200), 0.16
ROLE_COLOURS = {"outer": (25, 95, 190), "inner": (205, 45, 45), "interior": (130, 130, 140)}
# Thickness of curves, in reaches, and sides of the cubes at points, in distances between these.
THICKNESS, CUBE = 0.004, 0.3
# Lights brighten a colour; cubes must look like their legend.
DIMMED = 0.6


class WorkspaceNodes:
    """The nodes.

    - ``clicked``: called with the browser (viser.ClientHandle) and the position (3,) of a clicked
      point (m).
    """

    def __init__(self, space: NodeSpace, clicked: Callable[[Any, Array], None]) -> None:
        self._space, self._clicked = space, clicked
        self._curves: Any = None
        self._surface: Any = None
        self._points: Any = None
        # The shown points, for the camera to hold them.
        self._outline, self._cloud = np.zeros((0, 3)), np.zeros((0, 3))

    @property
    def extent(self) -> Array:
        """Points (k, 3) around all that is shown, in the base of the arm (m)."""
        return np.vstack([self._outline, self._cloud])

    def show_boundary(self, view: SectionView, *, cut: bool) -> None:
        """Show the section and its surface, in place of those before."""
        self.hide_boundary()
        lines, roles = view.segments()
        colours = np.array([ROLE_COLOURS[role] for role in roles], dtype=np.uint8)
        both = np.repeat(colours[:, None], 2, axis=1)
        self._curves = self._space.add_lines("workspace_section", lines, both, THICKNESS)
        solid = view.surface(cut=cut)
        self._outline = view.space.section.in_base(lines.reshape(-1, 3))
        if solid is not None:
            self._outline = solid.vertices
            scene, name = self._space.scene, f"{self._space.base}/workspace_surface"
            look = {"side": "double"}
            self._surface = add_mesh(scene, name, solid, SURFACE_COLOUR, OPACITY, **look)

    def hide_boundary(self) -> None:
        """Show no boundary."""
        for node in (self._curves, self._surface):
            if node is not None:
                node.remove()
        self._curves = self._surface = None
        self._outline = np.zeros((0, 3))

    def place_section(self, T: Array) -> None:
        """Turn, or slide, the section to the pose (4, 4) of its plane in the base (m)."""
        if self._curves is not None:
            place_node(self._curves, T)

    def show_points(self, shown: ReachPoints) -> None:
        """Show points of a map, in place of those before."""
        self.hide_points()
        if not len(shown.points):
            return
        side = CUBE * shown.spacing
        self._points = add_batch(
            self._space.scene,
            f"{self._space.base}/reach_map",
            box(side, side, side),
            len(shown.points),
            batched_positions=shown.points.astype(np.float32),
            batched_colors=(DIMMED * shown.colours).astype(np.uint8),
            flat_shading=True,
        )
        points = self._cloud = shown.points

        @self._points.on_click
        async def _(event: Any) -> None:
            index = event.instance_index
            if index is not None and index < len(points):
                self._clicked(event.client, points[index])

    def hide_points(self) -> None:
        """Show no map."""
        if self._points is not None:
            self._points.remove()
            self._points = None
            self._cloud = np.zeros((0, 3))
