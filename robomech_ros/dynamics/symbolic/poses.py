"""Poses of frames as matrices of polynomials: products of the book's Q_i and a_i."""

from collections.abc import Sequence

from robomech_ros.dynamics.symbolic.parameters import SymbolicLink, SymbolicParameters
from robomech_ros.dynamics.symbolic.terms import Poly, TermRing

Rows = list[list[Poly]]
Vector = list[Poly]


def symbolic_frames(parameters: SymbolicParameters) -> tuple[list[Rows], list[Vector]]:
    """Multiply the poses of the frames from the first on.

    Returns frames 2 .. n + 1 in frame 1 (m), and the z axes of frames 1 .. n, about or along which
    joints move.
    """
    ring = parameters.ring
    zero, one = ring.number(0), ring.number(1)
    pose: Rows = [[one if i == j else zero for j in range(4)] for i in range(4)]
    poses, axes = [], []
    for link in parameters.links:
        axes.append([pose[i][2] for i in range(3)])
        own = rotation(ring, link)
        origin = translation(ring, link)
        step = [[*own[i], origin[i]] for i in range(3)] + [[zero, zero, zero, one]]
        columns = [list(column) for column in zip(*step, strict=True)]
        pose = [rotated(ring, columns, row) for row in pose]
        poses.append(pose)
    return poses, axes


def rotation(ring: TermRing, link: SymbolicLink) -> Rows:
    """Write Q_i: frame i + 1 in frame i."""
    (c, s), (lam, mu) = link.turn, link.twist
    times = ring.product
    return [
        [c, -times(lam, s), times(mu, s)],
        [s, times(lam, c), -times(mu, c)],
        [ring.number(0), mu, lam],
    ]


def translation(ring: TermRing, link: SymbolicLink) -> Vector:
    """Write a_i: from the origin of frame i to that of frame i + 1, in frame i (m)."""
    c, s = link.turn
    return [ring.product(link.a, c), ring.product(link.a, s), link.b]


def rotated(ring: TermRing, R: Rows, vector: Sequence[Poly]) -> Vector:
    """Multiply a matrix and a vector."""
    return [add(ring, *(ring.product(a, b) for a, b in zip(row, vector, strict=True))) for row in R]


def cross(ring: TermRing, a: Sequence[Poly], b: Sequence[Poly]) -> Vector:
    """Form the cross product a x b."""
    times = ring.product
    return [
        times(a[1], b[2]) - times(a[2], b[1]),
        times(a[2], b[0]) - times(a[0], b[2]),
        times(a[0], b[1]) - times(a[1], b[0]),
    ]


def add(ring: TermRing, *terms: Poly) -> Poly:
    """Sum up polynomials."""
    return sum(terms, start=ring.number(0))
