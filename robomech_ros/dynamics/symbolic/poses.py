"""Poses of frames as matrices of polynomials: products of the book's Q_i and a_i."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robomech_ros.dynamics.symbolic.parameters import SymbolicLink, SymbolicParameters
from robomech_ros.dynamics.symbolic.terms import TermRing

# Arrays of polynomials.
Matrix = NDArray[np.object_]
Vector = NDArray[np.object_]


def symbolic_frames(parameters: SymbolicParameters) -> tuple[list[Matrix], list[Vector]]:
    """Multiply the poses of the frames from the first on.

    Returns frames 2 .. n + 1 in frame 1 (m), and the z axes of frames 1 .. n, about or along which
    joints move.
    """
    ring = parameters.ring
    pose = polynomials(ring, np.eye(4, dtype=int))
    poses, axes = [], []
    for link in parameters.links:
        axes.append(pose[:3, 2])
        step = polynomials(ring, np.eye(4, dtype=int))
        step[:3, :3], step[:3, 3] = rotation(ring, link), translation(ring, link)
        pose = rotated(ring, step.T, pose)
        poses.append(pose)
    return poses, axes


def polynomials(ring: TermRing, entries: Any) -> Matrix:
    """Make an array of polynomials and whole numbers."""
    constant = np.frompyfunc(lambda one: ring.number(one) if isinstance(one, int) else one, 1, 1)
    return np.asarray(constant(np.array(entries, object)), object)


def rotation(ring: TermRing, link: SymbolicLink) -> Matrix:
    """Write Q_i: frame i + 1 in frame i."""
    (c, s), (lam, mu) = link.turn, link.twist
    times = ring.product
    rows = [[c, -times(lam, s), times(mu, s)], [s, times(lam, c), -times(mu, c)], [0, mu, lam]]
    return polynomials(ring, rows)


def translation(ring: TermRing, link: SymbolicLink) -> Vector:
    """Write a_i: from the origin of frame i to that of frame i + 1, in frame i (m)."""
    c, s = link.turn
    return polynomials(ring, [ring.product(link.a, c), ring.product(link.a, s), link.b])


def rotated(ring: TermRing, R: Matrix, vectors: Matrix) -> Matrix:
    """Multiply a matrix (k, k) and vectors (..., k)."""
    return np.asarray(ring.times(R, vectors[..., None, :]).sum(axis=-1))


def cross(ring: TermRing, a: Vector, b: Vector) -> Vector:
    """Form the cross product a x b."""
    first = ring.times(np.roll(a, -1), np.roll(b, -2))
    return np.asarray(first - ring.times(np.roll(a, -2), np.roll(b, -1)))
