"""Cusps and self-intersections of the curves that divide a section, to rounding."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomech_ros.kinetostatics.workspace.section import WorkspaceSection
from robomech_ros.typing import Array, BoolArray, IntArray

_NEWTON = 12
_TINY = 1e-30  # step of complex differentiation
# Branches cross where the gradient of det J21 is below this fraction of its largest.
_FLAT = 1e-7
# Cells in which segments are compared, over the arm's size.
_CELL = 1.0 / 150.0
# Segments at a smaller angle (rad) touch or coincide; they do not cross.
_TRANSVERSAL = 1e-2
# Coordinates that are apart by less, over the arm's size, are one.
_SAME = 1e-9
# Longest chord over the arm's size, times a few: how far a refined crossing may be from chords'.
_NEAR = 1.0 / 100.0
_ASTRAY = 0.2  # and the joint values (rad or m)
# Width of cells, over the arm's size, with one refined crossing of two branches.
_APART = 1.0 / 500.0


@dataclass(frozen=True, eq=False)
class Branch:
    """A curve q (k, 2) of values of joints 2 and 3 (rad or m), and its image (k, 2) (m).

    The joint is 1 or 2 (from 0) where its value is constant along the curve, else 0; the limit is
    ``"lower"`` or ``"upper"``, or empty where the arm is singular.
    """

    joint: int
    limit: str
    q: Array
    points: Array

    @staticmethod
    def of(section: WorkspaceSection, joint: int, limit: str, q: Array) -> "Branch":
        """Make one from joint values (k, 2)."""
        return Branch(joint, limit, q, section.image(q[:, 0], q[:, 1]))


def cusps_of(section: WorkspaceSection, curve: Array) -> tuple[Array, IntArray, IntArray]:
    """Find the cusps of the image of a curve (k, 2) on which det J21 vanishes.

    There the direction that moves nothing is tangent to the curve.  Returns the curve with a vertex
    at each cusp, and the indices of crossings with other branches and of cusps.
    """
    _, fu, fv = section.determinant_gradient(curve[:, 0], curve[:, 1])
    steep = np.hypot(fu, fv)
    flat = steep <= _FLAT * steep.max()
    weights = _weights(section, curve)
    here = _tangency(section, curve[:-1], weights[:-1])
    there = _tangency(section, curve[1:], weights[:-1])
    change = (here > 0.0) != (there > 0.0)
    change &= ~flat[:-1] & ~flat[1:]
    found = [
        (k, _cusp(section, 0.5 * (curve[k] + curve[k + 1]), weights[k]))
        for k in np.flatnonzero(change)
    ]
    placed = [
        (k, cusp)
        for k, cusp in found
        if np.abs(cusp - curve[k]).max() <= 3.0 * np.abs(curve[k + 1] - curve[k]).max()
    ]
    steps = np.array([k + 1 for k, _ in placed], dtype=np.int64)
    marks = np.zeros(len(curve), np.int64)
    marks[flat] = 1
    if placed:
        curve = np.insert(curve, steps, np.array([cusp for _, cusp in placed]), axis=0)
        marks = np.insert(marks, steps, 2)
    return curve, np.flatnonzero(marks == 1), np.flatnonzero(marks == 2)


def _weights(section: WorkspaceSection, curve: Array) -> Array:
    """Return the image's tangents, shape (k, 2), in the smooth coordinates of the section."""
    au, av, _, _, _, bu, bv, *_ = section.regular(curve[:, 0], curve[:, 1])
    rows = np.stack((np.stack((au, av), -1), np.stack((bu, bv), -1)), axis=1)
    longer = np.argmax((rows**2).sum(axis=2), axis=1)
    along = rows[np.arange(len(rows)), longer]
    return np.einsum("kij,kj->ki", rows, along)


def _tangency(section: WorkspaceSection, q: Array, weights: Array) -> Array:
    """Return the derivative of det J21 along the direction that moves nothing, shape (...)."""
    u, v = q[..., 0], q[..., 1]
    au, av, _, _, _, bu, bv, *_ = section.regular(u, v)
    _, fu, fv = section.determinant_gradient(u, v)
    x, y = weights[..., 0], weights[..., 1]
    return (x * av + y * bv) * fu - (x * au + y * bu) * fv


def _cusp(section: WorkspaceSection, q: Array, weights: Array) -> Array:
    for _ in range(_NEWTON):
        f, fu, fv = section.determinant_gradient(q[0], q[1])
        g = _tangency(section, q, weights)
        gu = _tangency(section, q + np.array((1j * _TINY, 0.0)), weights).imag / _TINY
        gv = _tangency(section, q + np.array((0.0, 1j * _TINY)), weights).imag / _TINY
        q = q - np.linalg.lstsq(np.array(((fu, fv), (gu, gv))), np.array((f, g)), rcond=None)[0]
    return q


@dataclass(frozen=True, eq=False)
class Crossing:
    """Crossing of the images of two branches, or of two parts of one.

    Parameters
    ----------
    branches : tuple of two int
    at : tuple of two float
        Index of a vertex of each, plus the share of the segment after it.
    q : ndarray, shape (2, 2)
        Joint values on each (rad or m).
    point : ndarray, shape (2,)
        In the section (m).
    """

    branches: tuple[int, int]
    at: tuple[float, float]
    q: Array
    point: Array


def intersections(section: WorkspaceSection, branches: list[Branch]) -> list[Crossing]:
    """Find where images of branches cross each other or themselves."""
    starts = np.concatenate([branch.points[:-1] for branch in branches])
    ends = np.concatenate([branch.points[1:] for branch in branches])
    owner = np.repeat(np.arange(len(branches)), [len(b.points) - 1 for b in branches])
    number = np.concatenate([np.arange(len(b.points) - 1) for b in branches])
    pair = np.stack(_neighbours(starts, ends, _CELL * section.size))
    same = (owner[pair[0]] == owner[pair[1]]) & (np.abs(number[pair[0]] - number[pair[1]]) <= 2)
    pair = pair[:, ~same]
    share, crosses = _crossing(starts, ends, *pair)
    pair, share = pair[:, crosses], share[:, crosses]
    # Curves that coincide cross each other in every segment: one crossing a cell is enough.
    cells = np.floor(starts[pair[0]] / (_APART * section.size)).astype(np.int64)
    _, once = np.unique(np.column_stack((owner[pair].T, cells)), axis=0, return_index=True)
    pair, share = pair[:, once], share[:, once]
    low = np.concatenate([branch.q[:-1] for branch in branches])
    high = np.concatenate([branch.q[1:] for branch in branches])
    q = low[pair] + share[..., None] * (high - low)[pair]
    joint = np.array([branch.joint for branch in branches])[owner[pair]]
    q, point, sound = _nodes(section, joint, q)
    found: list[Crossing] = []
    for k in np.flatnonzero(sound):
        node = Crossing(
            (int(owner[pair[0, k]]), int(owner[pair[1, k]])),
            (float(number[pair[0, k]] + share[0, k]), float(number[pair[1, k]] + share[1, k])),
            q[:, k],
            point[k],
        )
        if not any(_is_same(section, node, other) for other in found):
            found.append(node)
    return found


def _is_same(section: WorkspaceSection, node: Crossing, other: Crossing) -> bool:
    apart = np.abs(node.point - other.point).max()
    if node.branches != other.branches or apart > _SAME * section.size:
        return False
    return abs(node.at[0] - other.at[0]) < 3.0


def _neighbours(starts: Array, ends: Array, cell: float) -> tuple[NDArray, NDArray]:
    """Return the pairs of segments, first < second, that have a cell of a grid in common."""
    low = np.floor(np.minimum(starts, ends) / cell).astype(np.int64)
    high = np.floor(np.maximum(starts, ends) / cell).astype(np.int64)
    low -= low.min(axis=0)
    high -= np.floor(np.minimum(starts, ends) / cell).astype(np.int64).min(axis=0)
    width = int(high[:, 1].max()) + 1
    keys, items = [], []
    for dx in range(int((high - low)[:, 0].max()) + 1):
        for dy in range(int((high - low)[:, 1].max()) + 1):
            inside = (low[:, 0] + dx <= high[:, 0]) & (low[:, 1] + dy <= high[:, 1])
            index = np.flatnonzero(inside)
            keys.append((low[index, 0] + dx) * width + low[index, 1] + dy)
            items.append(index)
    key, item = np.concatenate(keys), np.concatenate(items)
    order = np.argsort(key, kind="stable")
    key, item = key[order], item[order]
    groups = np.split(item, np.flatnonzero(np.diff(key)) + 1)
    first, second = [], []
    for group in groups:
        if len(group) > 1:
            i, j = np.triu_indices(len(group), 1)
            first.append(group[i])
            second.append(group[j])
    if not first:
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    a, b = np.concatenate(first), np.concatenate(second)
    pairs = np.unique(np.stack((np.minimum(a, b), np.maximum(a, b)), axis=1), axis=0)
    return pairs[:, 0], pairs[:, 1]


def _crossing(
    starts: Array, ends: Array, first: IntArray, second: IntArray
) -> tuple[Array, BoolArray]:
    """Return the shares of segments, shape (2, k), at which they cross, and whether they do."""
    a, b = (ends - starts)[first], (ends - starts)[second]
    gap = starts[second] - starts[first]
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    lengths = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
    usable = np.abs(cross) > _TRANSVERSAL * lengths
    safe = np.where(usable, cross, 1.0)
    share = (
        np.stack(
            (gap[:, 0] * b[:, 1] - gap[:, 1] * b[:, 0], gap[:, 0] * a[:, 1] - gap[:, 1] * a[:, 0])
        )
        / safe
    )
    inside = ((share >= -1e-9) & (share <= 1.0 + 1e-9)).all(axis=0)
    return share, usable & inside


def _nodes(section: WorkspaceSection, joint: IntArray, q: Array) -> tuple[Array, Array, BoolArray]:
    """Refine crossings q (2, k, 2) of branches by Newton's method in the four joint values.

    The joints (2, k) are those of :class:`Branch`.  Returns q, the points (k, 2) in the section
    (m), and whether branches cross there (k,).
    """
    start, began = section.image(q[0, :, 0], q[0, :, 1]), q
    for _ in range(_NEWTON):
        J = np.zeros((q.shape[1], 4, 4))
        values = np.zeros((q.shape[1], 4))
        for side, sign in ((0, 1.0), (1, -1.0)):
            u, v = q[side, :, 0], q[side, :, 1]
            place = slice(2 * side, 2 * side + 2)
            values[:, :2] += sign * section.image(u, v)
            J[:, :2, place] = sign * section.image_gradient(u, v)
            f, fu, fv = section.determinant_gradient(u, v)
            at_limit = joint[side] > 0
            values[:, 2 + side] = np.where(at_limit, 0.0, f)
            J[:, 2 + side, 2 * side] = np.where(at_limit, joint[side] == 1, fu)
            J[:, 2 + side, 2 * side + 1] = np.where(at_limit, joint[side] == 2, fv)
        scale = np.maximum(np.abs(J).max(axis=2), 1e-300)
        step = np.einsum("kij,kj->ki", np.linalg.pinv(J / scale[..., None]), values / scale)
        q = q - np.moveaxis(step.reshape(-1, 2, 2), 1, 0)
    points = section.image(q[0, :, 0], q[0, :, 1])
    other = section.image(q[1, :, 0], q[1, :, 1])
    turn = 2.0 * np.pi * section.round[1:]
    between = q[0] - q[1]
    between = between - turn * np.round(between / (2.0 * np.pi))
    lower, upper = section.lower[1:] - 1e-9, section.upper[1:] + 1e-9
    sound = np.abs(points - other).max(axis=1) <= 1e-13 * section.size
    sound &= np.abs(points - start).max(axis=1) <= _NEAR * section.size
    sound &= np.abs(q - began).max(axis=(0, 2)) <= _ASTRAY
    # Else a branch that begins at another, or a cusp.
    sound &= np.abs(between).max(axis=1) > 1e-5
    sound &= (section.round[1:] | ((q >= lower) & (q <= upper))).all(axis=(0, 2))
    return q, points, sound
