"""Parents and sizes of the nodes of a page, and poses of nodes."""

from typing import Any, NamedTuple

import numpy as np

from robomech_ros.spatial import position_quaternion_from_pose
from robomech_ros.typing import Array


class NodeSpace(NamedTuple):
    """A scene, the node above new nodes, and the size by which they are scaled."""

    #: viser.SceneApi.
    scene: Any
    #: Node above them: the base of the arm, the palm, or the ground.
    base: str
    #: Size of the robot (m); sizes of nodes are fractions of it.
    reach: float

    def add_lines(self, name: str, ends: Array, colour: Any, width: float) -> Any:
        """Add line segments (k, 2, 3) (m) of one colour, or one at each end; return the node."""
        points, thickness = ends.astype(np.float32), width * self.reach
        path = f"{self.base}/{name}"
        return self.scene.add_line_segments(path, points, colour, thickness=thickness)


def placed(T: Array) -> dict[str, Array]:
    """Return a pose (4, 4) as the position and the quaternion of a node, scalar first."""
    position, quaternion = position_quaternion_from_pose(T)
    return {"position": position, "wxyz": np.roll(quaternion, 1)}


def place_node(node: Any, T: Array) -> None:
    """Move a node of viser to a pose (4, 4) (m)."""
    for name, value in placed(T).items():
        setattr(node, name, value)
