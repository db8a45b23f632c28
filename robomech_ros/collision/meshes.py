"""Meshes of triangles, from files or arrays, and the convex bodies that hold them."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.spatial import QhullError

from robomech_ros._kernels.collision.shapes import BOX
from robomech_ros.collision.convex_parts import convex_hull, convex_parts, is_closed
from robomech_ros.collision.hull_edges import hull_edges
from robomech_ros.collision.libraries import coal
from robomech_ros.collision.shapes import LARGEST, SMALLEST, Body, Shape
from robomech_ros.errors import BadValueError
from robomech_ros.regular_files import open_regular
from robomech_ros.robots.urdf.mesh_files import MeshError
from robomech_ros.spatial.arrays import as_single, check_finite, real_array
from robomech_ros.typing import Array, IntArray

# Most triangles of a mesh, and most bytes of its file: more make scenes slow and large.
MOST_TRIANGLES, _LARGEST_FILE = 200_000, 64 * 1024 * 1024
# Convex parts of a link whose mesh is not convex, and half the length (m) of one that is small.
_MOST_PARTS, _SMALL = 8, 0.05
# Bytes of a binary STL: the header, which ends with the number of triangles; and each triangle.
_STL_HEADER, _STL_TRIANGLE = 84, 50
# Relative enlargement of a hull that coal refuses in its exact form.
_UNEVEN = 1e-6


class Mesh(Shape):
    """Triangles, from a file or as arrays, and all that they enclose.

    Distances are those of the convex hull if it is apart from the other body, else those of the
    triangles.

    Parameters
    ----------
    path_or_vertices : path or array_like, shape (k, 3)
        A file in a format of coal (STL, OBJ, DAE, PLY and more), or vertices (m).
    faces : array_like of int, shape (m, 3), optional
        The vertices of each triangle.
    scale : array_like, shape (3,), optional
        Factors along x, y and z.

    Raises
    ------
    MeshError
        The file cannot be read, or has no triangles, or more than `MOST_TRIANGLES`.
    """

    def __init__(
        self,
        path_or_vertices: str | os.PathLike[str] | npt.ArrayLike,
        faces: npt.ArrayLike | None = None,
        *,
        scale: npt.ArrayLike = (1.0, 1.0, 1.0),
    ) -> None:
        factors = as_single("scale", scale, (3,))
        if not (np.abs(factors) > SMALLEST).all():
            raise BadValueError("scale", factors.tolist(), "three factors that are not 0")
        if isinstance(path_or_vertices, str | os.PathLike):
            if faces is not None:
                raise BadValueError("faces", "given", "none beside a path")
            self.name = str(path_or_vertices)
            self._mesh = _read(Path(path_or_vertices), factors)
        else:
            self.name = "mesh"
            self._mesh = _built(path_or_vertices, faces, factors)
        size = float(np.ptp(self.vertices, axis=0).max())
        if not SMALLEST < size < LARGEST:
            expected = f"{SMALLEST:g} to {LARGEST:g} m; a scale of 0.001 reads millimetres"
            raise BadValueError(f"size of {self.name}", size, expected)

    @property
    def vertices(self) -> Array:
        """Vertices (m), shape (k, 3)."""
        vertices: Array = self._mesh.vertices()
        return vertices

    @property
    def faces(self) -> IntArray:
        """The vertices of each triangle, shape (m, 3)."""
        triangles = (self._mesh.tri_indices(k) for k in range(self._mesh.num_tris))
        return np.array([[one[0], one[1], one[2]] for one in triangles])

    def parts(self) -> list[Body]:
        """Return convex bodies that hold all that the mesh encloses.

        A convex or small mesh, or one that is no closed surface, has a single part: its hull.
        """
        whole = self.body()
        triangles = whole.triangles
        if triangles is None or max(whole.sizes) < _SMALL or not is_closed(triangles):
            return [whole._replace(surface=None, triangles=None)]
        return [_hull(corners) for corners in convex_parts(triangles, _MOST_PARTS)]

    def body(self) -> Body:
        """Return the hull, with the surface if that is not convex."""
        vertices, faces = self.vertices, self.faces
        a, b, c = (vertices[faces[:, k]] for k in range(3))
        try:
            if not np.cross(b - a, c - a).any():
                raise BadValueError(self.name, "without area", "triangles with an area")
            around = convex_hull(vertices)
        except (QhullError, ValueError) as error:
            expected = "a mesh with a volume; a thin box stands for a plate"
            raise BadValueError(self.name, "flat", expected) from error
        found = _hull(vertices[around.vertices])
        if _is_convex(vertices, faces, around.volume):
            return found
        return found._replace(surface=self._mesh, triangles=vertices[faces])


def _read(path: Path, scale: Array) -> Any:
    if not path.is_file():
        raise MeshError(str(path), "is not there")
    _check_file(path)
    try:
        mesh = coal().MeshLoader().load(str(path), scale)
    except Exception as error:
        # The readers of coal raise many types of exceptions.
        text = str(error).partition("message: ")[2].strip().replace("\n", "; ")
        raise MeshError(str(path), f"cannot be read ({text[:200]})") from None
    if not mesh.num_tris or not np.isfinite(mesh.vertices()).all():
        raise MeshError(str(path), "has no triangles, or vertices that are not finite")
    check_triangles(str(path), mesh.num_tris)
    return mesh


def check_triangles(name: str, count: int) -> None:
    """Refuse a mesh with too many triangles."""
    if count > MOST_TRIANGLES:
        raise MeshError(
            name,
            f"has {count:,} triangles, at most {MOST_TRIANGLES:,} are accepted: simplify it, for "
            "example with MeshLab (Quadric Edge Collapse Decimation), or use simple shapes",
        )


def _check_file(path: Path) -> None:
    """Refuse a large file before reading it into memory."""
    try:
        size = path.stat().st_size
        with open_regular(path) as file:
            count = int.from_bytes(file.read(_STL_HEADER)[-4:], "little")
    except OSError as error:
        raise MeshError(str(path), f"cannot be read ({error.strerror})") from None
    if size == _STL_HEADER + _STL_TRIANGLE * count:
        check_triangles(str(path), count)
    if size > _LARGEST_FILE:
        text = (
            f"has {size / 1e6:.0f} MB, at most {_LARGEST_FILE / 1e6:.0f} MB are read: simplify it"
        )
        raise MeshError(str(path), text)


def _built(vertices: npt.ArrayLike, faces: npt.ArrayLike | None, scale: Array) -> Any:
    points = real_array("vertices", vertices)
    if points.ndim != 2 or points.shape[1:] != (3,):
        raise BadValueError("vertices", points.shape, "an array (k, 3)")
    check_finite("vertices", points)
    points = points * scale
    triangles = np.asarray(faces if faces is not None else np.empty((0, 3)))
    if triangles.ndim != 2 or triangles.shape[1:] != (3,) or not len(triangles):
        raise BadValueError("faces", triangles.shape, "an array (m, 3) of indices of vertices")
    expected = f"indices of the {len(points)} vertices, from 0"
    if triangles.dtype.kind not in "iu":
        raise BadValueError("faces", f"of type {triangles.dtype}", expected)
    for index in (int(triangles.min()), int(triangles.max())):
        if not 0 <= index < len(points):
            raise BadValueError("faces", index, expected)
    check_triangles("given as arrays", len(triangles))
    library = coal()
    listed, indices = library.StdVec_Vec3s(), library.StdVec_Triangle()
    for point in points:
        listed.append(point)
    for a, b, c in triangles.tolist():
        indices.append(library.Triangle(a, b, c))
    mesh = library.BVHModelOBBRSS()
    mesh.beginModel(len(triangles), len(points))
    mesh.addSubModel(listed, indices)
    mesh.endModel()
    return mesh


def _box_around(corners: Array) -> tuple[int, tuple[float, float, float], Array]:
    """Return a narrow box around points: its kind, half its sizes, and its pose."""
    middle = corners.mean(axis=0)
    boxes = []
    for axes in (np.eye(3), np.linalg.svd(corners - middle, full_matrices=False)[2]):
        turn = axes.T if np.linalg.det(axes) > 0.0 else axes.T * [1.0, 1.0, -1.0]
        along = corners @ turn
        low, high = along.min(axis=0), along.max(axis=0)
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = turn, turn @ (0.5 * (low + high))
        half = 0.5 * (high - low) + SMALLEST
        boxes.append((float(half.prod()), tuple(half.tolist()), pose))
    _, sizes, pose = min(boxes, key=lambda box: box[0])
    return BOX, sizes, pose


def _hull(points: Array) -> Body:
    corners, edges = hull_edges(points)
    try:
        hull = _convex(corners)
    except RuntimeError:
        # Coal allows 255 neighbours of a corner; a large round face can have more. Random outward
        # shifts of the corners make the face uneven.
        middle = corners.mean(axis=0)
        farther = 1.0 + _UNEVEN * np.random.default_rng(0).random((len(corners), 1))
        corners, edges = hull_edges(middle + farther * (corners - middle))
        hull = _convex(corners)
    return Body(hull, corners, edges, 0.0, *_box_around(corners), exact=False)


def _convex(corners: Array) -> Any:
    points = coal().StdVec_Vec3s()
    for corner in corners:
        points.append(corner)
    return coal().Convex.convexHull(points, True, "Qt")


def _is_convex(vertices: Array, faces: IntArray, hull_volume: float) -> bool:
    """Return whether a mesh is the surface of its convex hull, given the hull's volume (m^3)."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    middle = vertices.mean(axis=0)
    volume = float(np.einsum("ij,ij->i", a - middle, np.cross(b - middle, c - middle)).sum()) / 6.0
    return abs(volume) > (1.0 - 1e-6) * hull_volume
