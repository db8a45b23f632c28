"""Files of meshes that a URDF names: where they are, and their triangles.

A name leads into the package that it names, or below the folder of the URDF, and nowhere else.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote

import numpy as np

from robomech_ros.errors import RobomechError
from robomech_ros.regular_files import read_regular
from robomech_ros.rvs.model.solids import Solid

# Bytes of a file, and triangles in it: more than any maker's arm has, less than a browser bears.
LARGEST_MESH = 64 * 1024 * 1024
MOST_TRIANGLES = 2_000_000
# Archives, which others read too, may hold any size.
FORMATS = (".stl", ".obj", ".ply", ".glb", ".dae")

Colour = tuple[float, float, float, float]


class ColouredSolid(NamedTuple):
    """A part of a mesh; its colour (red, green, blue, alpha, 0 to 1) is None where it has none."""

    solid: Solid
    colour: Colour | None


class MeshError(RobomechError):
    """A mesh cannot be shown; the text says which and why."""

    def __init__(self, filename: str, why: str) -> None:
        super().__init__(f"mesh '{filename[:200]}' {why}")


def mesh_file(filename: str, folder: Path | None) -> Path:
    """Find the file that a URDF names.

    Parameters
    ----------
    filename : str
        ``package://name/...``, ``file:///...`` or a path.
    folder : Path or None
        That of the URDF, where it came from a file.

    Raises
    ------
    MeshError
        There is none, or the name leads out of its package and the URDF's folder.
    """
    if not filename or "\0" in filename:
        raise MeshError(filename, "has no name")
    if Path(unquote(filename)).suffix.lower() not in FORMATS:
        raise MeshError(filename, f"is none of {', '.join(FORMATS)}")
    try:
        return _found(filename, folder)
    except OSError as error:
        raise MeshError(filename, f"cannot be looked for ({error.strerror})") from None


def _found(filename: str, folder: Path | None) -> Path:
    places = list(_places(filename, folder))
    inside = [path for root, path in places if path.is_relative_to(root)]
    if places and not inside:
        raise MeshError(filename, "is outside of every package and of the folder of the URDF")
    for path in inside:
        if path.is_file():
            return path
    looked = ", ".join(str(path) for path in inside[:3]) or "AMENT_PREFIX_PATH, ROS_PACKAGE_PATH"
    raise MeshError(filename, f"is not there (looked for in {looked})")


def _places(filename: str, folder: Path | None) -> Iterator[tuple[Path, Path]]:
    """Yield where it may be: the folder that must contain it, and the path."""
    scheme, _, rest = filename.rpartition("://")
    if scheme in ("package", "model"):
        package, _, inside = unquote(rest).partition("/")
        if package in ("", ".", ".."):
            raise MeshError(filename, "names no package")
        for root in _package_folders(package, folder):
            yield root, _plain(root / inside)
    elif scheme == "file":
        path = _plain(Path("/") / unquote(rest).lstrip("/"))
        roots = [*_shares(), *([folder] if folder else [])]
        # Only the folder that contains it counts, if there is one.
        yield next((root for root in roots if path.is_relative_to(root)), Path("/nowhere")), path
    elif not scheme and folder is not None:
        yield folder, _plain(folder / filename)


def _plain(path: Path) -> Path:
    """Take `..` out of a path; links stay, as installed packages have them."""
    return Path(os.path.normpath(path))


def _package_folders(package: str, folder: Path | None) -> Iterator[Path]:
    for share in _shares():
        if (share / package).is_dir():
            yield share / package
    for entry in filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)):
        for root in (Path(entry), Path(entry) / package):
            if root.name == package and root.is_dir():
                yield _plain(root)
    if folder is not None:
        yield from (root for root in (folder, *folder.parents) if root.name == package)


def _shares() -> list[Path]:
    prefixes = filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep))
    return [_plain(Path(prefix) / "share") for prefix in prefixes]


def read_mesh(path: Path, filename: str) -> list[ColouredSolid]:
    """Read the triangles of a file (STL, OBJ, PLY, GLB; DAE where pycollada is installed).

    Parameters
    ----------
    path : Path
    filename : str
        What the URDF calls it, for messages.

    Raises
    ------
    MeshError
        It cannot be read, is too large, or has no triangle.
    """
    try:
        import trimesh
    except ImportError:
        raise MeshError(filename, "needs viser: pip install 'robomech_ros[view]'") from None
    try:
        data = io.BytesIO(read_regular(path, LARGEST_MESH))
        # Without a resolver nothing is read that the file refers to.
        scene = trimesh.load_scene(data, file_type=path.suffix.lower().lstrip("."))
        parts = scene.dump(concatenate=False)
    except Exception as error:
        # Its readers raise whatever their formats suggest.
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
