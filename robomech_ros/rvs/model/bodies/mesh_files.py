"""Triangles and colours of the mesh files that a URDF names."""

import io
from pathlib import Path
from typing import NamedTuple

import numpy as np

from robomech_ros.regular_files import read_regular
from robomech_ros.robots.urdf.mesh_files import MeshError
from robomech_ros.rvs.model.bodies.solids import Solid

# Most bytes and triangles of a file: above those of real arms, below the limit of a browser.
LARGEST_MESH = 64 * 1024 * 1024
MOST_TRIANGLES = 2_000_000

Colour = tuple[float, float, float, float]


class ColouredSolid(NamedTuple):
    """A part of a mesh, and its colour (red, green, blue, alpha, 0 to 1) or None."""

    solid: Solid
    colour: Colour | None


def read_mesh(path: Path, filename: str) -> list[ColouredSolid]:
    """Read the triangles of a file (STL, OBJ, PLY, GLB; DAE where pycollada is installed).

    - ``filename``: its name in the URDF, for messages.

    Raises MeshError: it cannot be read, is too large, or has no triangle.
    """
    try:
        import trimesh
    except ImportError:
        raise MeshError(filename, "needs viser: pip install 'robomech_ros[view]'") from None
    try:
        data = io.BytesIO(read_regular(path, LARGEST_MESH))
        # Without a resolver no referenced file is read.
        scene = trimesh.load_scene(data, file_type=path.suffix.lower().lstrip("."))
        parts = scene.dump(concatenate=False)
    except Exception as error:
        # Its readers raise many types of exceptions.
        why = f"{type(error).__name__}: {str(error)[:200]}"
        raise MeshError(filename, f"cannot be read ({why})") from None
    meshes = [part for part in parts if isinstance(part, trimesh.Trimesh) and len(part.faces)]
    if not meshes:
        raise MeshError(filename, "has no triangles")
    if sum(len(mesh.faces) for mesh in meshes) > MOST_TRIANGLES:
        raise MeshError(filename, f"has more than {MOST_TRIANGLES} triangles")
    if not all(np.isfinite(mesh.vertices).all() for mesh in meshes):
        raise MeshError(filename, "has vertices that are not finite")
    return [
        ColouredSolid(Solid(np.asarray(mesh.vertices), np.asarray(mesh.faces)), _colour(mesh))
        for mesh in meshes
    ]


def _colour(mesh: object) -> Colour | None:
    visual = getattr(mesh, "visual", None)
    if visual is None or not visual.defined:
        return None
    main = getattr(visual, "main_color", None)
    if main is None:
        main = getattr(getattr(visual, "material", None), "main_color", None)
    if main is None:
        return None
    red, green, blue, alpha = (np.asarray(main, dtype=float) / 255.0).tolist()
    return red, green, blue, alpha
