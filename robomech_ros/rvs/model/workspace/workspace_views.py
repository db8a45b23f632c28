"""Displayed boundary of a workspace: its section, and the swept surface."""

import math
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinetostatics import Workspace, workspace_boundary
from robomech_ros.kinetostatics.workspace.positioning_part import positioning_part
from robomech_ros.robots import SerialChain
from robomech_ros.rvs.model.bodies.solids import Solid
from robomech_ros.rvs.model.curves.curve_drawing import thinned
from robomech_ros.rvs.model.curves.curve_problems import Axis
from robomech_ros.spatial import matrix_from_axis_angle
from robomech_ros.spatial.poses import assembled
from robomech_ros.typing import Array, BoolArray, IntArray

# Number of squares along the longer side of the section; each counts postures once.
SQUARES = 170
MARGIN = 0.06
# Least width of the drawn section, relative to its height.
NARROWEST = 0.3
# The surface: points along a curve are so far apart at least, in parts of the section's longer
# side, and strips so wide (rad, or parts of the way of a slide).
FINE, STRIP = 0.012, math.pi / 40.0
# Curves nearer to each other than this fraction of that side look like one.
SAME = 0.003
# Azimuth, about the first axis, of the middle of the sector that is left open, towards the eye at
# first, and half its width (rad).
OPENING = (-0.9, 0.9)


@dataclass(frozen=True, eq=False)
class SectionView:
    """A section with the numbers of postures in it."""

    chain: SerialChain
    space: Workspace
    #: The point that is placed, in the frame of the tip (m), shape (3,).
    in_tip: Array
    #: Axes of the drawing (m), which is at most as wide as it is high.
    axes: tuple[Axis, Axis]
    #: Edges of the squares, along both axes (m).
    edges: tuple[Array, Array]
    #: Postures of the first joints in the middle of each square, the first of three being free,
    #: shape (columns, rows).
    counts: IntArray

    def local(self, T: Array) -> Array:
        """Return the point (3,) in the frame of joint 1, the tip being at a pose (4, 4) (m)."""
        return self.space.section.in_frame(T[:3, :3] @ self.in_tip + T[:3, 3])

    def azimuth(self, T: Array) -> float:
        """Return the coordinate of the section through the point: angle (rad) or travel (m)."""
        x, y, z = self.local(T).tolist()
        return float(z) if self.space.section.slides[0] else math.atan2(y, x)

    def coordinates(self, T: Array) -> Array:
        """Return the coordinates (2,) of the point, the tip being at a pose (4, 4) (m)."""
        return self.space.section.coordinates(self.local(T))

    def plane(self, T: Array) -> Array:
        """Return the pose (4, 4), in the base, of the section through the point."""
        section, azimuth, z = self.space.section, self.azimuth(T), np.array([0.0, 0.0, 1.0])
        if section.slides[0]:
            return section.base @ assembled(np.eye(3), azimuth * z)
        return section.base @ assembled(matrix_from_axis_angle(z, azimuth), np.zeros(3))

    def target(self, coordinates: Array, T: Array) -> Array:
        """Return the pose of the tip (4, 4) that brings the point to coordinates (2,) (m).

        The orientation, and the azimuth or height of the point, are those of a pose T (4, 4).
        """
        local = np.append(coordinates, 0.0)
        if not self.space.section.slides[0]:
            local = np.array([coordinates[0], 0.0, coordinates[1]])
        wanted = np.array(T)
        point = (self.plane(T) @ (*local, 1.0))[:3]
        wanted[:3, 3] = point - T[:3, :3] @ self.in_tip
        return wanted

    def segments(self) -> tuple[Array, list[str]]:
        """Return the curves as lines (k, 2, 3) in the plane of the section (m), and their roles."""
        lines: list[Array] = []
        roles: list[str] = []
        for curve in self.space.curves:
            points = self._in_plane(self._thinned(curve.points))
            lines.append(np.stack([points[:-1], points[1:]], axis=1))
            roles += [curve.role] * (len(points) - 1)
        return np.concatenate(lines), roles

    def surface(self, *, cut: bool) -> Solid | None:
        """Return the surface that the boundary sweeps, in the base; None for a planar arm.

        - ``cut``: whether a sector is left open, so that one sees inside.
        """
        section = self.space.section
        if section.flat:
            return None
        low, high = float(section.lower[0]), float(section.upper[0])
        parts = [(low, high)]
        if cut and not section.slides[0]:
            parts = open_intervals(low, high)
        vertices: list[Array] = []
        faces: list[IntArray] = []
        # Only one of two coincident curves is drawn: both would show as patches.
        drawn: list[Array] = []
        for curve in self.space.curves:
            if curve.fewer:
                continue
            points = self._thinned(curve.points)
            new = self._apart(0.5 * (points[1:] + points[:-1]), drawn)
            drawn.append(curve.points)
            for first, last in parts:
                steps = max(2, math.ceil((last - first) / STRIP)) + 1
                ring = self._swept(points, np.linspace(first, last, steps))
                faces.append(_strips(steps, new) + sum(map(len, vertices)))
                vertices.append(section.in_base(ring))
        return Solid(np.concatenate(vertices), np.concatenate(faces))

    def _apart(self, points: Array, drawn: list[Array]) -> BoolArray:
        """Return a mask of points (k, 2) that are on no drawn curve."""
        if not drawn:
            return np.ones(len(points), dtype=bool)
        near = SAME * (self.axes[1].high - self.axes[1].low)
        across = points[:, None] - np.concatenate(drawn)
        return np.hypot(across[..., 0], across[..., 1]).min(axis=1) > near

    def _swept(self, points: Array, values: Array) -> Array:
        a, b = (np.tile(part, len(values)) for part in points.T)
        value = np.repeat(values, len(points))
        if self.space.section.slides[0]:
            return np.column_stack((a, b, value))
        return np.column_stack((np.cos(value) * a, np.sin(value) * a, b))

    def _in_plane(self, points: Array) -> Array:
        """Return points (k, 2) of the section in three coordinates of its plane."""
        (first, second), nothing = points.T, np.zeros(len(points))
        slides = self.space.section.slides[0]
        return np.column_stack((first, second, nothing) if slides else (first, nothing, second))

    def _thinned(self, points: Array) -> Array:
        return thinned(points, FINE * (self.axes[1].high - self.axes[1].low))


def section_view(chain: SerialChain) -> SectionView:
    """Find the boundary of an arm's workspace, and count the postures in its section."""
    space = workspace_boundary(chain)
    # For a planar arm of three joints the boundary is that of the tip itself.
    in_tip = np.zeros(3) if space.tip is not None else positioning_part(chain).in_tip
    points = np.concatenate([curve.points for curve in space.curves])
    low, high = points.min(axis=0), points.max(axis=0)
    width = float((high - low).max()) / SQUARES
    edges = []
    for first, last in zip(low.tolist(), high.tolist(), strict=True):
        edges.append(first + width * np.arange(math.ceil((last - first) / width) + 1))
    x, y = np.meshgrid(*(0.5 * (edge[1:] + edge[:-1]) for edge in edges), indexing="ij")
    counts = space.section_count(np.stack((x, y), axis=-1))
    return SectionView(chain, space, in_tip, _axes(space, low, high), (edges[0], edges[1]), counts)


def why_no_section(chain: SerialChain, error: RobomechError) -> str:
    """Say why an arm has no section, after an error of :func:`section_view`."""
    try:
        positioning_part(chain)
    except BadValueError:
        why = f"this arm has {counted(chain.n, 'joint')}"
        slides = [
            name for name, kind in zip(chain.joint_names[3:], chain.types[3:], strict=True) if kind
        ]
        if chain.coupling is not None:
            why = "joints of this arm follow others (mimic)"
        elif slides:
            why = f"joint '{slides[0]}' slides"
        elif chain.n == 2:
            why = "the two joints move no point in a plane"
        elif chain.n == 4:
            why = "axis 4 does not go through the tip"
        elif chain.n in (5, 6):
            why = f"axes 4{', 5' * (chain.n == 6)} and {chain.n} do not meet in one point"
        return (
            f"No boundary: {why}. It is drawn where the first three joints alone place a point, "
            "such as the centre of a wrist, in which the axes of all later joints meet."
        )
    return f"No boundary: {error}."


def open_intervals(low: float, high: float) -> list[tuple[float, float]]:
    """Return the azimuths from ``low`` to ``high`` (rad) outside the open sector."""
    middle, half = OPENING
    turn, left = 2.0 * math.pi, []
    start = low
    first = math.ceil((low - middle - half) / turn)
    for k in range(first, first + 3):
        begin, end = middle - half + turn * k, middle + half + turn * k
        if begin > start:
            left.append((start, min(begin, high)))
        start = max(start, end)
        if start >= high:
            break
    return left


def is_in_opening(azimuths: Array) -> BoolArray:
    """Return a mask of azimuths (rad) in the open sector."""
    middle, half = OPENING
    away = np.remainder(azimuths - middle + np.pi, 2.0 * np.pi) - np.pi
    return np.abs(away) < half


def _axes(space: Workspace, low: Array, high: Array) -> tuple[Axis, Axis]:
    """Return axes around all curves with a margin; the first is not longer."""
    margin = MARGIN * float((high - low).max())
    low, high = low - margin, high + margin
    height = float((high - low).max())
    if not space.section.slides[0]:
        # On the left is the axis, if there is space, and nothing beyond it.
        low[0] = max(low[0], 0.0) if high[0] > height else 0.0
    widths = np.array([max(high[0] - low[0], NARROWEST * height), height])
    low[1] = 0.5 * (low[1] + high[1] - height)
    x, z = (
        Axis(name, "m", first, first + width)
        for name, first, width in zip(space.coordinates, low.tolist(), widths.tolist(), strict=True)
    )
    return x, z


def _strips(steps: int, wanted: BoolArray) -> IntArray:
    """Return the triangles between rows of points, where the gap between two of a row is wanted."""
    points = len(wanted) + 1
    corner = (np.arange(steps - 1)[:, None] * points + np.flatnonzero(wanted)).ravel()
    return np.concatenate([
        np.column_stack((corner, corner + 1, corner + points)),
        np.column_stack((corner + 1, corner + points + 1, corner + points)),
    ])  # fmt: skip
