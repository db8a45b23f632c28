"""Meshes in the scene, without shadows: one of its own, and many of one shape."""

from typing import Any

import numpy as np

from robomech_ros.rvs.model.bodies.solids import Solid

NO_SHADOWS: dict[str, Any] = {"cast_shadow": False, "receive_shadow": False}


def add_mesh(
    scene: Any, name: str, solid: Solid, colour: tuple[int, ...], alpha: float = 1.0, **options: Any
) -> Any:
    """Add a solid of one colour (0 to 255) to a scene; gives the node.

    - ``colour``: red, green and blue.
    - ``alpha``: from 0 to 1.
    - ``**options``: options of ``add_mesh_simple``.
    """
    return scene.add_mesh_simple(
        name,
        solid.vertices,
        solid.faces,
        color=colour,
        opacity=alpha if alpha < 1.0 else None,
        **NO_SHADOWS,
        **options,
    )


def add_batch(scene: Any, name: str, solid: Solid, count: int = 1, **options: Any) -> Any:
    """Add copies of a solid, to be placed, to a scene; options are of its batches of meshes."""
    first: dict[str, Any] = {
        "batched_wxyzs": np.tile((1.0, 0.0, 0.0, 0.0), (count, 1)).astype(np.float32),
        "batched_positions": np.zeros((count, 3), dtype=np.float32),
        "batched_colors": np.zeros((count, 3), dtype=np.uint8),
    }
    return scene.add_batched_meshes_simple(
        name, solid.vertices, solid.faces, lod="off", **NO_SHADOWS, **(first | options)
    )
