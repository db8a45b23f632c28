"""Markers in the scene: bodies, arrows and lines beside the robot."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from robomech_ros.rvs.model.bodies.solids import Solid, box, cylinder, sphere
from robomech_ros.rvs.model.running.live_robot import ViewMarker
from robomech_ros.rvs.page.mesh_nodes import add_mesh
from robomech_ros.rvs.page.node_space import placed


class MarkerNodes:
    """The markers of several sources.

    - ``path_of``: returns the name of the node of a link.
    """

    def __init__(self, scene: Any, path_of: Callable[[str], str]) -> None:
        self._scene, self._path_of = scene, path_of
        self._nodes: dict[str, list[Any]] = {}

    def show(self, source: str, markers: Sequence[ViewMarker]) -> None:
        """Draw the markers of a source, instead of those it had."""
        for node in self._nodes.pop(source, ()):
            node.remove()
        self._nodes[source] = [
            self._add(f"{self._path_of(marker.link)}/{source}_{number}", marker)
            for number, marker in enumerate(markers)
        ]

    def _add(self, path: str, marker: ViewMarker) -> Any:
        colour = tuple(round(255 * part) for part in marker.colour[:3])
        where = placed(marker.pose)
        if marker.kind == "text":
            # Constant size on the screen, so that distant labels are legible, too.
            place = where["position"]
            return self._scene.add_label(path, marker.text, position=place, anchor="bottom-left")
        if marker.kind == "lines":
            ends = marker.points.reshape(-1, 2, 3)
            width = marker.measures[0]
            return self._scene.add_line_segments(path, ends, colour, thickness=width, **where)
        if marker.kind == "arrow":
            shaft, head, length = marker.measures
            sizes = {"shaft_radius": 0.5 * shaft, "head_radius": 0.5 * head, "head_length": length}
            ends = marker.points.reshape(-1, 2, 3)
            return self._scene.add_arrows(path, ends, colour, **sizes, **where)
        makers: dict[str, Callable[[], Solid]] = {
            "sphere": lambda: sphere(0.5),
            "box": lambda: box(1.0, 1.0, 1.0),
            "cylinder": lambda: cylinder(0.5, 1.0),
        }
        solid, alpha = makers[marker.kind](), marker.colour[3]
        solid = Solid(solid.vertices * np.asarray(marker.measures), solid.faces)
        return add_mesh(self._scene, path, solid, colour, alpha, side="double", **where)
