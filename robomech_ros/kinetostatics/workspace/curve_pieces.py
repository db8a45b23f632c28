"""The curves of a section, cut where they meet, with the number of postures on either side."""

from dataclasses import dataclass

import numpy as np

from robomech_ros.kinetostatics.workspace.contours import edges_of_box, singular_contours
from robomech_ros.kinetostatics.workspace.cusps_and_nodes import Branch, cusps_of, intersections
from robomech_ros.kinetostatics.workspace.point_postures import PointPostures
from robomech_ros.kinetostatics.workspace.refinement import bisected
from robomech_ros.kinetostatics.workspace.section import WorkspaceSection
from robomech_ros.numerics.arrays import distinct
from robomech_ros.typing import Array, BoolArray

# How far beside a curve postures are counted, over the arm's size; and at how many points of it.
_BESIDE = 2e-5
_PROBES = 9
# Pieces that are shorter, or nowhere farther from axis 1, over the arm's size, divide nothing.
_NOTHING = 1e-7
# Ends nearer to each other than this, over the arm's size, are one point.
_JOINT = 1e-7
# Points nearer to axis 1 than this, over the arm's size, are on it, and ends as near are the same.
_ON_AXIS = 1e-6
# Vertices of the same curve are as near as this, over the arm's size.
_SPACING = 1.0 / 200.0


@dataclass(frozen=True, eq=False)
class CurvePiece(Branch):
    """A smooth part of a :class:`Branch` between points where curves meet.

    On its left there are ``more`` postures, on its right ``fewer``.
    """

    more: int
    fewer: int


def cut_curves(section: WorkspaceSection) -> tuple[list[CurvePiece], Array, Array]:
    """Find the pieces that divide a section, its cusps (k, 2) and its nodes (k, 2), in m."""
    branches, cuts, cusps = branches_of(section)
    if not branches:
        return [], np.zeros((0, 2)), np.zeros((0, 2))
    nodes = []
    for node in intersections(section, branches):
        for index, where, q in zip(node.branches, node.at, node.q, strict=True):
            cuts[index].append((where, q))
        nodes.append(node.point)
    postures = PointPostures(section, first_free=True)
    parts = [
        Branch.of(section, branch.joint, branch.limit, q)
        for branch, places in zip(branches, cuts, strict=True)
        for q in _cut(branch, places)
    ]
    pieces = [_counted(section, postures, part) for part in parts]
    size = section.size
    kept: list[CurvePiece] = []
    for piece in pieces:
        if piece is not None and not any(_coincide(piece, other, size) for other in kept):
            kept.append(piece)
    if not section.slides[0]:
        # On axis 1 curves are mirrored, which is no crossing.
        nodes = [node for node in nodes if node[0] > _ON_AXIS * size]
    once = [np.array(distinct(one, _JOINT * size)).reshape(-1, 2) for one in (cusps, nodes)]
    return kept, once[0], once[1]


def values_in(section: WorkspaceSection, q: Array, joint: int, limit: str) -> Array:
    """Return joint values (k, 2) found in units of the arm's size in its own (rad or m).

    Those at a limit, and slides at their ends, are there to the last digit, and not beyond.
    """
    lower, upper = section.lower[1:], section.upper[1:]
    q = q * np.where(section.slides[1:], section.size, 1.0)
    q = np.where(section.round[1:], q, np.clip(q, lower, upper))
    if limit:
        q[:, joint - 1] = (upper if limit == "upper" else lower)[joint - 1]
    return q


def branches_of(
    section: WorkspaceSection,
) -> tuple[list[Branch], list[list[tuple[float, Array]]], list[Array]]:
    """Return the curves, where each is to be cut besides at nodes, and the cusps."""
    branches: list[Branch] = []
    cuts: list[list[tuple[float, Array]]] = []
    cusps: list[Array] = []
    for contour in singular_contours(section):
        curve, crossings, sharp = cusps_of(section, contour.q)
        branch = Branch.of(section, contour.joint, "", curve)
        branches.append(branch)
        cuts.append([(float(k), curve[k]) for k in (*crossings, *sharp)])
        cusps.extend(branch.points[sharp])
    for joint, upper, curve in edges_of_box(section):
        branches.append(Branch.of(section, joint, "upper" if upper else "lower", curve))
        cuts.append(_where_singular(section, joint, curve))
    return branches, cuts, cusps


def _where_singular(
    section: WorkspaceSection, joint: int, curve: Array
) -> list[tuple[float, Array]]:
    """Find the places of a limit's curve at which the arm is singular."""

    def positive(rows: Array) -> BoolArray:
        return section.determinant(rows[:, 0], rows[:, 1]) > 0.0

    change = np.flatnonzero(np.diff(positive(curve)))
    low, _ = bisected(positive, curve[change], curve[change + 1], steps=60)
    other = 2 - joint
    span = curve[change + 1, other] - curve[change, other]
    share = (low[:, other] - curve[change, other]) / span
    return [(float(k + x), q) for k, x, q in zip(change, share, low, strict=True)]


def _cut(branch: Branch, places: list[tuple[float, Array]]) -> list[Array]:
    """Return the joint values of a branch between the places where it is cut."""
    parts = []
    start, opening = 0.0, branch.q[0]
    last = len(branch.q) - 1.0
    for where, q in [*sorted(places, key=lambda place: place[0]), (last, branch.q[-1])]:
        between = np.arange(np.floor(start) + 1, np.ceil(where)).astype(int)
        rows = np.concatenate((opening[None], branch.q[between], q[None]))
        if len(rows) > 2 or np.abs(rows[1] - rows[0]).max() > 0.0:
            parts.append(rows)
        start, opening = where, q
    return parts


def _counted(
    section: WorkspaceSection, postures: PointPostures, branch: Branch
) -> CurvePiece | None:
    """Count the postures on either side of a piece; None where it divides nothing."""
    points = branch.points
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    size = section.size
    if lengths.sum() <= _NOTHING * size:
        return None
    if not section.slides[0] and points[:, 0].max() <= _NOTHING * size:
        return None
    left, right = (
        int(np.bincount(postures.count(section.on_section(probes))).argmax())
        for probes in _probes(points, lengths, _BESIDE * size)
    )
    if left == right:
        return None
    q = branch.q
    if left < right:
        left, right, q, points = right, left, q[::-1], points[::-1]
    return CurvePiece(branch.joint, branch.limit, np.array(q), np.array(points), left, right)


def _probes(points: Array, lengths: Array, beside: float) -> tuple[Array, Array]:
    """Return points to the left and to the right of a polyline, evenly along it."""
    along = np.concatenate(([0.0], np.cumsum(lengths)))
    at = along[-1] * (np.arange(_PROBES) + 0.5) / _PROBES
    k = np.clip(np.searchsorted(along, at) - 1, 0, len(lengths) - 1)
    length = np.where(lengths[k] > 0.0, lengths[k], 1.0)
    share = ((at - along[k]) / length)[:, None]
    tangent = (points[k + 1] - points[k]) / length[:, None]
    normal = np.stack((-tangent[:, 1], tangent[:, 0]), axis=1)
    middle = points[k] + share * (points[k + 1] - points[k])
    # The chord is inside the curve by up to the sagitta, a small part of the step.
    step = min(beside, 0.2 * along[-1])
    return middle + step * normal, middle - step * normal


def _coincide(piece: CurvePiece, other: CurvePiece, size: float) -> bool:
    """Tell whether two pieces are the same curve: arms that reach it in two ways have it twice."""
    if (piece.more, piece.fewer) != (other.more, other.fewer):
        return False
    ends = piece.points[[0, -1]] - other.points[[0, -1]]
    if np.abs(ends).max() > _ON_AXIS * size:
        return False
    middle = piece.points[len(piece.points) // 2]
    nearest = np.linalg.norm(other.points - middle, axis=1).min()
    return bool(nearest <= _SPACING * size)
