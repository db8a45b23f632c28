"""The boundary in space of an arm whose first joint has limits, too.

It consists of walls, which the first joint sweeps from the curves of the section, and of sheets,
which the other two sweep while the first is at a limit; of both, those parts count beside which
there are points that cannot be reached.
"""

import numpy as np

from robomech_ros.kinetostatics.workspace.curve_pieces import CurvePiece
from robomech_ros.kinetostatics.workspace.nearest import NearestOnCurves
from robomech_ros.kinetostatics.workspace.point_postures import PointPostures
from robomech_ros.kinetostatics.workspace.reach import moved_by_joint
from robomech_ros.kinetostatics.workspace.section import WorkspaceSection
from robomech_ros.typing import Array, BoolArray

# How far beside a surface it is looked whether a point can be reached, over the arm's size.
_BESIDE = 2e-5
# Samples of a sheet in each direction; distance between those of a wall, over the arm's size.
_SHEET = 120
_SPACING = 1.0 / 60.0
_STEPS = 20


class LimitedBoundary:
    """Nearest points of the boundary in space, of a section whose first joint has limits.

    The pieces are all that divide the section, and the postures keep within the limits.
    """

    def __init__(
        self, section: WorkspaceSection, pieces: list[CurvePiece], postures: PointPostures
    ) -> None:
        from scipy.spatial import cKDTree

        self._section, self._postures = section, postures
        self._walls = [NearestOnCurves(section, [piece]) for piece in pieces]
        sheets, sheet_normals = self._sheet_samples()
        walls, wall_normals = self._wall_samples(pieces)
        self._sheets = [(cKDTree(self._points(q)), q) for q in np.split(sheets, 2)]
        q = np.concatenate((sheets, walls))
        normals = np.concatenate((sheet_normals, wall_normals))
        points = self._points(q)
        kept = self._divides(points, normals)
        self._q, self._points_kept = q[kept], points[kept]
        self._on_sheet = (np.arange(len(q)) < len(sheets))[kept]
        self._tree = cKDTree(self._points_kept)

    def distance(self, points: Array, inside: BoolArray) -> Array:
        """Return the distance (m,) of points (m, 3) in the frame of joint 1 from the boundary (m).

        Which of them are inside tells what it is the distance from: what can be reached, or what
        cannot.  Where the nearest point of an inside one is on the edge between two surfaces it is
        exact to some thousandths of the arm's size; from outside it is exact to a millionth, but
        where another part of a wall is nearest than the one joint 1 cannot lead here, to a
        thousandth.
        """
        found, nearest = self._tree.query(points)
        on_sheet = self._on_sheet[nearest] & inside
        if on_sheet.any():
            q = self._q[nearest[on_sheet]]
            found[on_sheet] = self._on_sheets(points[on_sheet], q, found[on_sheet], dividing=True)
        outside = ~inside
        if outside.any():
            for tree, q in self._sheets:
                start = q[tree.query(points[outside])[1]]
                found[outside] = self._on_sheets(
                    points[outside], start, found[outside], dividing=False
                )
        return self._on_walls(points, inside, found)

    def _on_sheets(self, points: Array, q: Array, found: Array, *, dividing: bool) -> Array:
        """Improve the distances from sheets, from postures q (m, 3) on (Newton's method).

        Where they are to be dividing, those parts count beside which something is not reached;
        else all of them, since all is reached.
        """
        section = self._section
        q = q.copy()
        first = q[:, 0]
        turned = self._moved(points, -first)
        # Slides go in parts of the arm's size.
        units = np.where(section.slides[1:], section.size, 1.0)
        for _ in range(_STEPS):
            q[:, 1:] += np.clip(self._towards(turned, q, units), -0.1, 0.1) * units
            bounded = np.clip(q[:, 1:], section.lower[1:], section.upper[1:])
            q[:, 1:] = np.where(section.round[1:], q[:, 1:], bounded)
        p, pu, pv = section.derivatives(q[:, 1], q[:, 2], 1)
        apart = np.linalg.norm(turned - p.T, axis=1)
        better = apart < found
        if dividing:
            normal = self._moved(_unit(np.cross(pu.T, pv.T)), first, turns_only=True)
            better[better] = self._divides(self._points(q[better]), normal[better])
        return np.where(better, apart, found)

    def _towards(self, points: Array, q: Array, units: Array) -> Array:
        """Return steps (m, 2) of joints 2 and 3 that bring them nearer to points, in units.

        A joint that stands at a limit and would go beyond it is left there.
        """
        section = self._section
        p, pu, pv, puu, puv, pvv = section.derivatives(q[:, 1], q[:, 2])
        gap = points - p.T
        J = np.stack((pu.T, pv.T), axis=2) * units
        slope = np.einsum("kij,ki->kj", J, gap)
        at_lower, at_upper = q[:, 1:] <= section.lower[1:], q[:, 1:] >= section.upper[1:]
        held = ((at_lower & (slope < 0.0)) | (at_upper & (slope > 0.0))) & ~section.round[1:]
        bend = np.einsum("abki,ki->kab", np.array(((puu.T, puv.T), (puv.T, pvv.T))), gap)
        square = np.einsum("kia,kib->kab", J, J)
        H = square - bend * np.outer(units, units)
        convex = (H[:, 0, 0] > 0.0) & (np.linalg.det(H) > 1e-6 * np.linalg.det(square))
        H = np.where(convex[:, None, None], H, square)
        slope[held] = 0.0
        H[held[:, 0] | held[:, 1], 0, 1] = H[held[:, 0] | held[:, 1], 1, 0] = 0.0
        return np.einsum("kij,kj->ki", np.linalg.pinv(H, rcond=1e-12), slope)

    def _on_walls(self, points: Array, inside: BoolArray, found: Array) -> Array:
        """Improve distances by the nearest points of walls, at the azimuth or height as it is."""
        coordinates = self._section.coordinates(points)
        if not self._walls:
            return found
        near = [wall.find(coordinates) for wall in self._walls]
        distances = np.stack([distance for distance, *_ in near])
        for index in np.argsort(distances, axis=0):
            distance = distances[index, np.arange(len(points))]
            open_ = np.flatnonzero(distance < found)
            if not len(open_):
                break
            chosen = list(zip(open_, index[open_], strict=True))
            feet = np.stack([near[k][1][j] for j, k in chosen])
            q = np.stack([near[k][3][j] for j, k in chosen])
            normal = np.stack([self._walls[k].normals[near[k][2][j]] for j, k in chosen])
            at, across = self._beside(points[open_], feet, normal)
            sides = self._reached_beside(at, across)
            # One of coincident curves is kept: another one may lead here if it cannot.
            bounds = np.where(
                inside[open_], sides[0] != sides[1], sides[0] | sides[1] | self._attains(at, q)
            )
            found[open_[bounds]] = distance[open_[bounds]]
        return found

    def _attains(self, points: Array, q: Array) -> BoolArray:
        """Return whether joint 1 can move the point, set by joints 2 and 3, to points (k, 3)."""
        section = self._section
        (p,) = section.derivatives(q[:, 0], q[:, 1], 0)
        if section.slides[0]:
            first = points[:, 2] - p[2]
        else:
            first = np.arctan2(points[:, 1], points[:, 0]) - np.arctan2(p[1], p[0])
            first = section.lower[0] + np.remainder(first - section.lower[0], 2.0 * np.pi)
        return (first >= section.lower[0]) & (first <= section.upper[0])

    def _beside(self, points: Array, feet: Array, normal: Array) -> tuple[Array, Array]:
        """Return points of the section, and directions, at the azimuth or height of points."""
        if self._section.slides[0]:
            at = np.column_stack((feet, points[:, 2]))
            return at, np.column_stack((normal, np.zeros(len(feet))))
        azimuth = np.arctan2(points[:, 1], points[:, 0])
        c, s = np.cos(azimuth), np.sin(azimuth)
        return (
            np.column_stack((c * feet[:, 0], s * feet[:, 0], feet[:, 1])),
            np.column_stack((c * normal[:, 0], s * normal[:, 0], normal[:, 1])),
        )

    def _divides(self, points: Array, normals: Array) -> BoolArray:
        """Return whether only one side of surfaces can be reached."""
        sides = self._reached_beside(points, normals)
        return sides[0] != sides[1]

    def _reached_beside(self, points: Array, normals: Array) -> list[BoolArray]:
        """Return whether the points on both sides of surfaces can be reached."""
        step = _BESIDE * self._section.size
        return [
            self._postures.count(self._section.in_base(points + sign * step * normals)) > 0
            for sign in (1.0, -1.0)
        ]

    def _sheet_samples(self) -> tuple[Array, Array]:
        section = self._section
        grids = [
            lower + (upper - lower) * (np.arange(_SHEET) + 0.5) / _SHEET
            for lower, upper in zip(section.lower[1:], section.upper[1:], strict=True)
        ]
        u, v = (grid.ravel() for grid in np.meshgrid(*grids, indexing="ij"))
        _, pu, pv = section.derivatives(u, v, 1)
        normal = _unit(np.cross(pu.T, pv.T))
        rows, normals = [], []
        for bound in (section.lower[0], section.upper[0]):
            first = np.full(len(u), bound)
            rows.append(np.column_stack((first, u, v)))
            normals.append(self._moved(normal, first, turns_only=True))
        return np.concatenate(rows), np.concatenate(normals)

    def _wall_samples(self, pieces: list[CurvePiece]) -> tuple[Array, Array]:
        section = self._section
        rows, normals = [np.zeros((0, 3))], [np.zeros((0, 3))]
        spacing = _SPACING * section.size
        span = section.upper[0] - section.lower[0]
        for piece in pieces:
            lengths = np.linalg.norm(np.diff(piece.points, axis=0), axis=1)
            along = np.concatenate(([0.0], np.cumsum(lengths)))
            count = max(2, round(along[-1] / spacing))
            index = np.unique(np.searchsorted(along, along[-1] * (np.arange(count) + 0.5) / count))
            normal = NearestOnCurves(section, [piece]).normals[index]
            radius = 1.0 if section.slides[0] else max(piece.points[:, 0].max(), spacing)
            steps = max(8, round(span * radius / spacing))
            values = section.lower[0] + span * (np.arange(steps) + 0.5) / steps
            first, k = np.meshgrid(values, np.arange(len(index)), indexing="ij")
            first, k = first.ravel(), k.ravel()
            q = np.column_stack((first, piece.q[index][k]))
            points = self._points(q)
            _, across = self._beside(points, piece.points[index][k], normal[k])
            rows.append(q)
            normals.append(across)
        return np.concatenate(rows), np.concatenate(normals)

    def _points(self, q: Array) -> Array:
        (p,) = self._section.derivatives(q[:, 1], q[:, 2], 0)
        return self._moved(p.T, q[:, 0])

    def _moved(self, vectors: Array, first: Array, *, turns_only: bool = False) -> Array:
        """Apply joint 1 to vectors (k, 3); a slide leaves directions as they are."""
        if self._section.slides[0]:
            shift = np.zeros_like(vectors)
            shift[:, 2] = 0.0 if turns_only else first
            return vectors + shift
        return moved_by_joint(True, first, vectors)


def _unit(vectors: Array) -> Array:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1), 1e-300)[:, None]
