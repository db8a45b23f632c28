"""A picture of all postures in which an arm takes one pose."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.plotting.pictures import new_figure
from robomech_ros.robots import PRISMATIC, SerialChain
from robomech_ros.spatial import matrix_from_axis_angle
from robomech_ros.typing import Array

_MOST = 64
_DPI = 120
_PANEL = 2.7
_LINKS = ("#264653", "#2a7f8f", "#2a9d8f", "#8ab17d", "#e9c46a", "#f4a261", "#e76f51")
_AXES = ("#d62839", "#2b9348", "#1d4ed8")
_DARK, _GHOST = "#30343b", "#d9dce2"
# The face of a joint that is seen: where its axis points to, and where it comes from.
_FACES = {True: "#f4f5f7", False: "#ef476f"}
# Sizes as parts of the picture's width: a joint's length and radius, the hand's axes, the base.
_DRUM, _RADIUS, _TRIAD, _BASE = 0.05, 0.021, 0.13, 0.075
# A link is cut into so many pieces, so that nearer ones cover others.
_PIECES = 16
# The zorder of what is as near as the base, and how much a fill is above its outline.
_AT_BASE, _ABOVE = 20.0, 1e-6


@dataclass(frozen=True)
class _View:
    """A parallel projection: the rows are right, up and towards the eye, shape (3, 3)."""

    rows: Array

    def flat(self, points: Array) -> Array:
        """Project points, shape (..., 3), to the plane of the picture."""
        return points @ self.rows[:2].T

    def depth(self, point: Array) -> float:
        """Distance of a point from the camera (m)."""
        return float(point @ self.rows[2])


@dataclass(frozen=True)
class _Skeleton:
    """Joint origins and axes, shape (n, 3), the corners of each link, and the tip's pose."""

    origins: Array
    axes: Array
    links: list[Array]
    tip: Array


def plot_postures(
    path: str | Path,
    chain: SerialChain,
    q: ArrayLike,
    *,
    title: str = "",
    azimuth: float = -1.0,
    elevation: float = 0.4,
) -> Path:
    """Write a picture with one panel for every posture, the others in grey behind it.

    Links run along the axes and the common normals; drums are revolute joints, boxes prismatic
    ones, with a light face where the axis points to and a red one where it comes from. Red, green
    and blue arrows are the axes x, y and z of the tip.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    q : array_like, shape (k, n)
        The postures (rad or m), 1 to 64 of them.
    azimuth, elevation : float, optional
        Where the eye is, seen from the base: the angle from its x axis about z, and above its
        xy plane (rad).

    Raises
    ------
    BadValueError, WrongSizeError
        No posture or too many, or values that do not fit the chain.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from robomech_ros.plotting import plot_postures
    >>> from robomech_ros.robots import load_robot
    >>> with TemporaryDirectory() as folder:
    ...     plot_postures(Path(folder, "arm.png"), load_robot("puma560"), [[0.0] * 6]).name
    'arm.png'
    """
    postures = np.asarray(q, dtype=np.float64)
    if postures.ndim != 2 or postures.shape[1] != chain.n:
        raise WrongSizeError("q", postures.shape, f"(k, {chain.n})")
    if not 1 <= len(postures) <= _MOST:
        raise BadValueError("number of postures", len(postures), f"1 to {_MOST}")
    forward_kinematics(chain, postures)  # says what is wrong with values that are no numbers
    view = _View(_rows(azimuth, elevation))
    whole = chain.uncoupled
    skeletons = [_skeleton(whole, chain.joint_values(posture)) for posture in postures]
    columns = math.ceil(math.sqrt(len(postures)))
    rows = math.ceil(len(postures) / columns)
    height = _PANEL * rows + (0.45 if title else 0.0)
    figure = new_figure(_PANEL * columns, height, dpi=_DPI, facecolor="white")
    panels = np.atleast_1d(figure.subplots(rows, columns)).ravel()
    for ax in panels:
        ax.set_axis_off()
    (x, y), half = _frame(view, skeletons)
    for number, (ax, arm, posture) in enumerate(zip(panels, skeletons, postures, strict=False)):
        ax.set_aspect("equal")
        ax.set_xlim(x - half, x + half)
        ax.set_ylim(y - half, y + half)
        painter = _Painter(ax, view, 2.0 * half)
        for other in skeletons:
            painter.ghost(other)
        painter.arm(arm, whole)
        _caption(ax, number, posture, chain)
    if title:
        figure.suptitle(title, color=_DARK, fontsize=13)
    path = Path(path)
    figure.savefig(path)
    return path


def _rows(azimuth: float, elevation: float) -> Array:
    ca, sa, ce, se = (f(x) for x in (azimuth, elevation) for f in (math.cos, math.sin))
    return np.array([[-sa, ca, 0.0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]])


def _skeleton(chain: SerialChain, q: Array) -> _Skeleton:
    """Find the joints' axes and the corners of the links of one posture."""
    fixed = chain.transforms
    frame = fixed[0]
    frames = [frame]
    for value, kind, after in zip(q, chain.types, fixed[1:], strict=True):
        move = np.eye(4)
        if kind == PRISMATIC:
            move[2, 3] = value
        else:
            move[:3, :3] = matrix_from_axis_angle([0.0, 0.0, 1.0], value)
        frame = frame @ move @ after
        frames.append(frame)
    origins, axes = np.array([F[:3, 3] for F in frames]), np.array([F[:3, 2] for F in frames])
    links = [np.array([np.zeros(3), origins[0]])]
    for i in range(chain.n):
        along = axes[i] * (axes[i] @ (origins[i + 1] - origins[i]))
        links.append(np.array([origins[i], origins[i] + along, origins[i + 1]]))
    return _Skeleton(origins[:-1], axes[:-1], links, frames[-1])


def _frame(view: _View, skeletons: list[_Skeleton]) -> tuple[Array, float]:
    """Find the middle of the picture and half its width, so that every posture is inside."""
    points = view.flat(np.concatenate([np.concatenate(one.links) for one in skeletons]))
    low, high = points.min(axis=0), points.max(axis=0)
    half = 0.5 * float((high - low).max())
    return 0.5 * (low + high), 1.2 * half if half else 1.0


class _Painter:
    """Paints arms on the axes of a panel whose width (m) is given."""

    def __init__(self, ax: Any, view: _View, width: float) -> None:
        self._ax = ax
        self._view = view
        self._width = width

    def ghost(self, arm: _Skeleton) -> None:
        """Paint an arm as thin grey lines, behind everything."""
        points = self._view.flat(np.concatenate(arm.links))
        self._ax.plot(*points.T, color=_GHOST, linewidth=0.8, zorder=0, solid_joinstyle="round")

    def arm(self, arm: _Skeleton, chain: SerialChain) -> None:
        """Paint an arm; what is nearer to the eye covers the rest."""
        ring = _circle(np.zeros(3), np.array([0.0, 0.0, 1.0]), _BASE * self._width)
        self._ax.fill(*self._view.flat(ring).T, facecolor="#e3e6eb", edgecolor="#9aa1ac", zorder=5)
        last = max(len(arm.links) - 1, 1)
        for i, corners in enumerate(arm.links):
            for start, end in itertools.pairwise(corners):
                if np.linalg.norm(end - start) >= 1e-9 * self._width:
                    self._link(start, end, _LINKS[round(i * (len(_LINKS) - 1) / last)])
        joints = zip(arm.origins, arm.axes, chain.types, strict=True)
        for k, (origin, axis, kind) in enumerate(joints):
            # In front of the links that it carries, and of earlier joints at the same point.
            order = self._order(origin, 0.5 * _RADIUS + 2.0 * k * _ABOVE)
            self._joint(origin, axis, 4 if kind == PRISMATIC else 40, order)
        origin = arm.tip[:3, 3]
        for i, color in enumerate(_AXES):
            end = origin + _TRIAD * self._width * arm.tip[:3, i]
            ends, order = self._view.flat(np.array([origin, end])), self._order(end, _RADIUS)
            style = {"color": color, "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0, "zorder": order}
            arrow = {"arrowstyle": "-|>", "mutation_scale": 8, **style}
            self._ax.annotate("", ends[1], ends[0], arrowprops=arrow, zorder=order)

    def _order(self, point: Array, more: float = 0.0) -> float:
        """Return the zorder of what is at a point, and nearer by a part of the width."""
        return _AT_BASE + self._view.depth(point) / self._width + more

    def _link(self, start: Array, end: Array, color: str) -> None:
        points = start + np.linspace(0.0, 1.0, _PIECES + 1)[:, None] * (end - start)
        for begin, stop in itertools.pairwise(points):
            # A little longer, so that no seam shows between two pieces.
            more = 0.2 * (stop - begin)
            flat = self._view.flat(np.array([begin - more, stop + more]))
            for above, width, shade in ((0.0, 5.8, _DARK), (_ABOVE, 4.2, color)):
                order = self._order(0.5 * (begin + stop), above)
                style = {"color": shade, "linewidth": width, "solid_capstyle": "butt"}
                self._ax.plot(*flat.T, zorder=order, **style)

    def _joint(self, origin: Array, axis: Array, around: int, order: float) -> None:
        ahead = bool(axis @ self._view.rows[2] > 0.0)
        toward = axis if ahead else -axis
        half, radius = 0.5 * _DRUM * self._width * toward, _RADIUS * self._width
        near, far = (
            self._view.flat(_circle(origin + s * half, toward, radius, around)) for s in (1, -1)
        )
        points = np.concatenate((near, far))
        hull = points[ConvexHull(points).vertices]
        style = {"edgecolor": _DARK, "zorder": order}
        self._ax.fill(*hull.T, facecolor="#5b616b", linewidth=0.8, **style)
        style["zorder"] = order + _ABOVE
        self._ax.fill(*near.T, facecolor=_FACES[ahead], linewidth=0.6, **style)


def _circle(center: Array, axis: Array, radius: float, around: int = 40) -> Array:
    """Points of a circle about an axis, shape (around, 3)."""
    side = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    side /= np.linalg.norm(side)
    angles = np.arange(around) * (2.0 * math.pi / around) + math.pi / around
    across = np.cos(angles)[:, None] * side + np.sin(angles)[:, None] * np.cross(axis, side)
    return np.asarray(center + radius * across)


def _caption(ax: Any, number: int, q: Array, chain: SerialChain) -> None:
    """Write a panel's number and its joint values, angles in degrees, below it."""
    values = [
        f"{value:.3g} m" if kind == PRISMATIC else f"{round(math.degrees(value))}°"
        for value, kind in zip(q, chain.types, strict=True)
    ]
    style = {"transform": ax.transAxes, "ha": "center", "color": _DARK}
    ax.text(0.04, 0.97, str(number + 1), va="top", fontsize=11, weight="bold", **style)
    shown = "  ".join(values).replace("-", "\N{MINUS SIGN}")
    ax.text(0.5, 0.0, shown, va="top", fontsize=7.5, **style)
