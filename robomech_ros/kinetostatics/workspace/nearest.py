"""Nearest points of the curves that bound a section."""

import numpy as np

from robomech_ros.kinetostatics.workspace.curve_pieces import CurvePiece
from robomech_ros.kinetostatics.workspace.refinement import onto_zeros
from robomech_ros.kinetostatics.workspace.section import WorkspaceSection
from robomech_ros.typing import Array, IntArray

_STEPS = 5
_PROJECTIONS = 3
# A step on a curve goes this many vertices far at the most.
_REACH = 2.0


class NearestOnCurves:
    """Search for the nearest points of some pieces, better than their chords."""

    def __init__(self, section: WorkspaceSection, pieces: list[CurvePiece]) -> None:
        from scipy.spatial import cKDTree

        self._section = section
        self._q = np.concatenate([piece.q for piece in pieces])
        self._joint = np.repeat([piece.joint for piece in pieces], [len(p.q) for p in pieces])
        self.points = np.concatenate([piece.points for piece in pieces])
        self.normals = np.concatenate([_left(piece.points) for piece in pieces])
        steps = [np.linalg.norm(np.gradient(piece.q, axis=0), axis=1) for piece in pieces]
        self._steps = np.concatenate(steps)
        ends = [np.isin(np.arange(len(p.q)), (0, len(p.q) - 1)) for p in pieces]
        self.is_end = np.concatenate(ends)
        self._tree = cKDTree(self.points)

    def find(self, coordinates: Array) -> tuple[Array, Array, IntArray, Array]:
        """Find the nearest points to points (m, 2) of the section (m).

        Returns distances (m,) and nearest points (m, 2) in m; the vertex (m,) each is beside, in
        ``points``, ``normals`` (to the side with more postures) and ``is_end``; and the values of
        joints 2 and 3 there (m, 2).
        """
        distance, vertex = self._tree.query(coordinates)
        q, joint, longest = self._q[vertex], self._joint[vertex], _REACH * self._steps[vertex]
        start, feet, at = q, self.points[vertex], q
        for _ in range(_STEPS):
            q = self._nearer(coordinates, q, start, joint, longest)
            points = self._section.image(q[:, 0], q[:, 1])
            apart = np.linalg.norm(coordinates - points, axis=1)
            better = apart < distance
            distance = np.where(better, apart, distance)
            feet = np.where(better[:, None], points, feet)
            at = np.where(better[:, None], q, at)
        return distance, feet, vertex, at

    def _nearer(
        self, coordinates: Array, q: Array, start: Array, joint: IntArray, longest: Array
    ) -> Array:
        """Go along the curves to where the tangent is across the way to the points."""
        section = self._section
        u, v = q[:, 0], q[:, 1]
        _, fu, fv = section.determinant_gradient(u, v)
        along = np.stack((-fv, fu), axis=1)
        along[joint == 1] = (0.0, 1.0)
        along[joint == 2] = (1.0, 0.0)
        along /= np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
        velocity = np.einsum("kij,kj->ki", section.image_gradient(u, v), along)
        gap = coordinates - section.image(u, v)
        step = (gap * velocity).sum(axis=1) / np.maximum((velocity**2).sum(axis=1), 1e-300)
        moved = q + np.clip(step, -longest, longest)[:, None] * along
        moved = start + np.clip(moved - start, -longest[:, None], longest[:, None])
        bounded = ~section.round[1:]
        moved = np.where(bounded, np.clip(moved, section.lower[1:], section.upper[1:]), moved)
        singular = joint == 0
        if singular.any():
            found = onto_zeros(section.determinant_gradient, moved[singular], _PROJECTIONS)
            moved[singular] = found
        off = (bounded & ((moved < section.lower[1:]) | (moved > section.upper[1:]))).any(axis=1)
        off |= np.linalg.norm(moved - start, axis=1) > 2.0 * longest
        return np.where(off[:, None], q, moved)


def _left(points: Array) -> Array:
    tangent = np.gradient(points, axis=0)
    normal = np.stack((-tangent[:, 1], tangent[:, 0]), axis=1)
    return normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
