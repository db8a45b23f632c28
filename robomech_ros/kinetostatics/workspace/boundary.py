"""The boundary of what the positioning part of an arm reaches."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from robomech_ros.kinetostatics.workspace.curve_pieces import CurvePiece, cut_curves, values_in
from robomech_ros.kinetostatics.workspace.limited_boundary import LimitedBoundary
from robomech_ros.kinetostatics.workspace.nearest import NearestOnCurves
from robomech_ros.kinetostatics.workspace.planar_tip import PlanarTip, planar_tip
from robomech_ros.kinetostatics.workspace.point_postures import PointPostures
from robomech_ros.kinetostatics.workspace.section import (
    WorkspaceSection,
    raise_on_surface,
    section_of,
)
from robomech_ros.printing import Printed
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.typing import Array, ArrayLike, BoolArray, IntArray

Role = Literal["outer", "inner", "interior"]

# Ends of curves nearer to each other than this, over the arm's size, are joined.
_JOINED = 1e-5
# The same of the tip of a planar arm of three joints, whose curves overlap where they touch.
_JOINED_CUTS = 2e-2
_PLANAR_JOINTS = 3
# Points nearer to the plane of a planar arm than this, over the arm's size, are in it.
_IN_PLANE = 1e-6

# m.
_FARTHEST = 1e100


@dataclass(frozen=True, eq=False)
class BoundaryCurve:
    """A smooth piece of a curve that divides the section of a workspace.

    Parameters
    ----------
    role : {"outer", "inner", "interior"}
        Whether it bounds what is reached towards the outside, towards a void, or divides it.
    cause : str
        ``"singular"``, or the joint and its limit, such as ``"joint_2 lower"``.
    points : ndarray, shape (k, 2)
        rho and z, or x and y (m); the side with more postures is on the left.
    q : ndarray, shape (k, 2) or (k, 3)
        Values of joints 2 and 3 there, of a planar arm of joints 1 and 2 or of all three (rad or
        m).
    more, fewer : int
        Postures on either side, the first of three joints being free; 1 and 0 where a planar arm
        of three joints reaches a point in a continuum of postures, and where not at all.
    """

    role: Role
    cause: str
    points: Array
    q: Array
    more: int
    fewer: int


@dataclass(frozen=True, eq=False)
class Workspace(Printed):
    """Points that the positioning joints of an arm can reach.

    Points are given in the base of the chain (m). Make one with :func:`workspace_boundary`.

    Parameters
    ----------
    name : str
        The robot.
    coordinates : tuple of two str
        ``("rho", "z")``: distance from axis 1 and height along it; ``("x", "y")`` across the
        slide where the first joint is one, all in the frame of joint 1; or in the plane of a planar
        arm, from joint 1, with the axes of :func:`planar_rows`.
    curves : tuple of BoundaryCurve
        They divide the section into regions with different numbers of postures.
    cusps, nodes : ndarray, shape (k, 2)
        Where curves of singular postures have cusps, and where curves cross (m); none are listed
        of a planar arm of three joints.
    least_reach, greatest_reach : float
        Least and greatest distance of the point from the origin of joint 1, whose limits left
        aside (m); along a slide they are measured across it.
    section : WorkspaceSection
        The geometry.
    tip : PlanarTip, optional
        What a planar arm of three joints reaches with its tip.
    """

    name: str
    coordinates: tuple[str, str]
    curves: tuple[BoundaryCurve, ...]
    cusps: Array
    nodes: Array
    least_reach: float
    greatest_reach: float
    section: WorkspaceSection
    tip: PlanarTip | None = None

    def solution_count(self, points: ArrayLike) -> IntArray:
        """Count the postures of these joints, inside all limits, at points (..., 3) (m).

        The continuum of postures of a planar arm of three joints counts as one.
        """
        rows = as_finite("points", points, (3,))
        flat = rows.reshape(-1, 3)
        counts: IntArray = self._postures.count(flat)
        counts[self._beyond(self.section.in_frame(flat)) > 0.0] = 0
        return counts.reshape(rows.shape[:-1])

    def contains(self, points: ArrayLike) -> BoolArray:
        """Tell which of points (..., 3) can be reached (m)."""
        return self.solution_count(points) > 0

    def section_count(self, coordinates: ArrayLike) -> IntArray:
        """Count postures at points (..., 2) of the section, the first of three being free (m)."""
        rows = as_finite("coordinates", coordinates, (2,))
        points = self.section.on_section(rows.reshape(-1, 2))
        counts: IntArray = self._free_postures.count(points)
        return counts.reshape(rows.shape[:-1])

    def distance(self, points: ArrayLike) -> Array:
        """Return the distance from the nearest boundary, positive inside and negative outside.

        Parameters
        ----------
        points : array_like, shape (..., 3)
            m.

        Returns
        -------
        ndarray, shape (...)
            m; limits of all these joints included.  Exact to a millionth of the arm's size; but
            where the first joint has limits, to some thousandths inside, if the nearest point is
            on an edge, and to a thousandth at a few places outside.  What is beside the plane of
            a planar arm is outside.  Coordinates beyond 1e100 m count as 1e100 m.
        """
        rows = as_finite("points", points, (3,))
        # Squares of distances must be finite.
        flat = np.clip(rows, -_FARTHEST, _FARTHEST).reshape(-1, 3)
        local = self.section.in_frame(flat)
        inside = self._postures.count(flat) > 0
        if self.tip is not None:
            found = self.tip.distance(flat)
        elif self.section.round[0]:
            found, *_ = self.nearest.find(self.section.coordinates(local))
        else:
            found = self._limited.distance(local, inside)
        signed: Array = np.where(inside, found, -found)
        beyond = self._beyond(local)
        away = -np.hypot(beyond, np.minimum(signed, 0.0))
        return np.where(beyond > 0.0, away, signed).reshape(rows.shape[:-1])

    def swept(self, azimuth: float, *, curve: BoundaryCurve) -> Array:
        """Return a curve's points (k, 3) in the base, turned by an azimuth (rad) or slid (m)."""
        x, y = curve.points.T
        if self.section.slides[0]:
            local = np.column_stack((x, y, np.full(len(x), azimuth)))
        else:
            local = np.column_stack((np.cos(azimuth) * x, np.sin(azimuth) * x, y))
        return self.section.in_base(local)

    def _beyond(self, local: Array) -> Array:
        """Return distances (m) of points (m, 3) in joint 1's frame from a planar arm's plane."""
        height = np.abs(local[:, 2])
        inside = height <= _IN_PLANE * self.section.size
        return np.where(inside | (not self.section.flat), 0.0, height)

    def to_dict(self) -> dict[str, Any]:
        """Return the curves and features as plain numbers, lists and text, fit for JSON or YAML."""
        return {
            "name": self.name,
            "coordinates": list(self.coordinates),
            "least_reach": self.least_reach,
            "greatest_reach": self.greatest_reach,
            "cusps": self.cusps.tolist(),
            "nodes": self.nodes.tolist(),
            "curves": [
                vars(curve) | {"points": curve.points.tolist(), "q": curve.q.tolist()}
                for curve in self.curves
            ],
        }

    @cached_property
    def nearest(self) -> NearestOnCurves:
        """Search for nearest points of the curves beside which nothing is reached."""
        pieces = [piece for piece in self._pieces if piece.fewer == 0]
        return NearestOnCurves(self.section, pieces)

    @cached_property
    def _pieces(self) -> list[CurvePiece]:
        return [
            CurvePiece(_joint_of(curve), "", curve.q, curve.points, curve.more, curve.fewer)
            for curve in self.curves
        ]

    @cached_property
    def _postures(self) -> PointPostures | PlanarTip:
        return self.tip or PointPostures(self.section, first_free=False)

    @cached_property
    def _free_postures(self) -> PointPostures | PlanarTip:
        return self.tip or PointPostures(self.section, first_free=True)

    @cached_property
    def _limited(self) -> LimitedBoundary:
        postures = PointPostures(self.section, first_free=False)
        return LimitedBoundary(self.section, self._pieces, postures)


def _joint_of(curve: BoundaryCurve) -> int:
    """Return 1 or 2 where the value of joint 2 or 3 is constant along a curve, else 0."""
    still = np.ptp(curve.q, axis=0) == 0.0
    return int(np.argmax(still)) + 1 if still.any() else 0


def workspace_boundary(chain: SerialChain, *, respect_limits: bool = True) -> Workspace:
    r"""Find the boundary of what the positioning part of an arm reaches.

    .. math:: \det\,[e_1 \times r_1,\; e_2 \times r_2,\; e_3 \times r_3] = 0

    The part is the first three joints, and the point is what they place: the centre of a
    spherical wrist, or the tip of an arm of three joints.  Its singular postures, and those with
    a joint at a limit, are curves in the plane section that the first joint sweeps.  Of a planar
    arm two or three joints place its tip, and the section is its plane.

    Parameters
    ----------
    chain : SerialChain
        An arm with a spherical wrist after any three joints, or one of three joints; also arms of
        four and five joints whose later axes pass through one point; planar arms of two joints, or
        of three of which the last turns, where the curves are those between what is reached and
        what is not.
    respect_limits : bool, optional
        Whether the limits of turning joints count; those of slides always do, except for the one
        that moves a section.

    Raises
    ------
    BadValueError
        The arm has no such part, or the part moves on a surface only.
    MissingLimitsError
        A slide has no end, and so has the workspace.

    See Also
    --------
    reach_limits : how far and how near the tip comes.
    orientation_workspace : which orientations there are at a point.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.4.1.

    Examples
    --------
    >>> from robomech_ros.kinetostatics import workspace_boundary
    >>> from robomech_ros.robots import chain_from_dh
    >>> arm = chain_from_dh(a=[0.5, 0.3], b=[0.0, 0.0], alpha=[0.0, 0.0])
    >>> space = workspace_boundary(arm)
    >>> round(space.least_reach, 6), round(space.greatest_reach, 6)
    (0.2, 0.8)
    >>> space.contains([[0.6, 0.0, 0.0], [0.9, 0.0, 0.0]])
    array([ True, False])
    """
    section = section_of(chain, respect_limits=respect_limits)
    if section.flat and chain.n == _PLANAR_JOINTS:
        return _of_planar_tip(chain, section, planar_tip(chain, respect_limits=respect_limits))
    return _of_section(chain, section)


def positioning_boundary(chain: SerialChain) -> Workspace:
    """Find the boundary of what :func:`positioning_part` reaches with its point.

    It is :func:`workspace_boundary` but for a planar arm of three joints: the axis of the last.
    """
    return _of_section(chain, section_of(chain))


def _of_planar_tip(chain: SerialChain, section: WorkspaceSection, tip: PlanarTip) -> Workspace:
    """Return the workspace of the tip of a planar arm in the frame of a section of two joints."""
    section = replace(section, size=max(pair.section.size for pair in tip.pairs))
    pieces, causes, values = [], [], []
    for pair, own in zip(tip.pairs, tip.pieces, strict=True):
        for piece in own:
            points = section.coordinates(section.in_frame(pair.section.on_section(piece.points)))
            q = pair.arm_values(piece.q)
            if pair.section.base[:3, 2] @ section.base[:3, 2] < 0.0:
                points, q = points[::-1], q[::-1]  # seen from the other side
            found = [one for one in (pair.cause, _cause(pair.section, piece)) if one]
            causes.append(", ".join(one for one in found if one != "singular") or "singular")
            pieces.append(replace(piece, points=points))
            values.append(q)
    roles = _roles(pieces, section.size, _JOINED_CUTS)
    curves = tuple(
        BoundaryCurve(role, cause, piece.points, q, 1, 0)
        for role, cause, piece, q in zip(roles, causes, pieces, values, strict=True)
    )
    origin = section.in_base(np.zeros((1, 3)))
    least = 0.0 if tip.count(origin)[0] else float(tip.distance(origin)[0])
    greatest = max(float(np.linalg.norm(piece.points, axis=1).max()) for piece in pieces)
    nowhere = np.zeros((0, 2))
    names = ("x", "y")
    return Workspace(chain.name, names, curves, nowhere, nowhere, least, greatest, section, tip)


def _of_section(chain: SerialChain, section: WorkspaceSection) -> Workspace:
    pieces, cusps, nodes = _divided(section)
    if not pieces:
        raise_on_surface(chain)
    roles = _roles(pieces, section.size)
    curves = tuple(
        BoundaryCurve(role, _cause(section, piece), piece.points, piece.q, piece.more, piece.fewer)
        for role, piece in zip(roles, pieces, strict=True)
    )
    least, greatest = _reach(section, pieces)
    coordinates = ("x", "y") if section.slides[0] else ("rho", "z")
    return Workspace(chain.name, coordinates, curves, cusps, nodes, least, greatest, section)


def _divided(section: WorkspaceSection) -> tuple[list[CurvePiece], Array, Array]:
    """Divide a section in units of the arm's size: steps and tolerances suit one of some metres."""
    unit = section.size
    pieces, cusps, nodes = cut_curves(section.over(unit))
    placed = []
    for piece in pieces:
        q = values_in(section, piece.q, piece.joint, piece.limit)
        placed.append(replace(piece, q=q, points=section.image(q[:, 0], q[:, 1])))
    return placed, cusps * unit, nodes * unit


def _cause(section: WorkspaceSection, piece: CurvePiece) -> str:
    return f"{section.names[piece.joint]} {piece.limit}" if piece.limit else "singular"


def _reach(section: WorkspaceSection, pieces: list[CurvePiece]) -> tuple[float, float]:
    """Return the least and the greatest distance from the origin of the section."""
    found, *_ = NearestOnCurves(section, pieces).find(np.zeros((1, 2)))
    inside = PointPostures(section, first_free=True).count(section.on_section(np.zeros((1, 2))))[0]
    points = np.concatenate([piece.points for piece in pieces])
    return (0.0 if inside else float(found[0])), float(np.linalg.norm(points, axis=1).max())


def _roles(pieces: list[CurvePiece], size: float, joined: float = _JOINED) -> list[Role]:
    """Tell outer boundaries from those of voids, by the way loops of boundaries go round."""
    roles: list[Role] = ["interior"] * len(pieces)
    unused = [k for k, piece in enumerate(pieces) if piece.fewer == 0]
    while unused:
        loop = [unused.pop(0)]
        while True:
            end = pieces[loop[-1]].points[-1]
            gaps = [np.abs(pieces[k].points[0] - end).max() for k in unused]
            if not gaps or min(gaps) > joined * size:
                break
            loop.append(unused.pop(int(np.argmin(gaps))))
        path = np.concatenate([pieces[k].points for k in loop])
        start = pieces[loop[0]].points[0]
        # An open curve ends on axis 1, where the way back adds nothing.
        closed = np.concatenate((path, start[None]))
        area = 0.5 * ((closed[1:, 0] + closed[:-1, 0]) * np.diff(closed[:, 1])).sum()
        for k in loop:
            roles[k] = "outer" if area > 0.0 else "inner"
    return roles
