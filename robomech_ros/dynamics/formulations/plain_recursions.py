"""Recursive algorithms in plain Python, on any kind of number, so that operations can be counted.

All joints are revolute.  Frame i + 1 of the table is fixed to link i, and what belongs to link i is
in its axes.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.4, 7.6 and 7.6.2.
Luh, Walker, Paul, On-line computational scheme for mechanical manipulators, ASME J. Dynamic
Systems, Measurement and Control 102, 1980.
Walker, Orin, Efficient dynamic computer simulation of robotic mechanisms, ibid. 104, 1982.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Floats, counted numbers, and the whole numbers 0 and 1 where they are known beforehand.
Number = Any
# Arrays of objects, whose entries count what is done with them.
Vector = NDArray[np.object_]
Matrix = NDArray[np.object_]
Numbers = Vector | Sequence[Number]
Rows = list[list[Number]]


@dataclass(frozen=True)
class PlainLink:
    """A link of a chain at given joint values.

    Turn and twist are cosine and sine of theta and of alpha.  The origin of frame i + 1 and the
    mass centre are as seen from that of frame i, ``step`` and ``com`` (m); the inertia is about the
    mass centre, its root the upper triangle R with ``R^T R`` that inertia.
    """

    turn: tuple[Number, Number]
    twist: tuple[Number, Number]
    step: Vector
    mass: Number
    com: Vector
    inertia: Matrix
    root: Matrix
    mass_root: Number


def newton_euler(
    links: Sequence[PlainLink],
    qd: Sequence[Number],
    qdd: Sequence[Number],
    gravity: Sequence[Number],
) -> list[Number]:
    """Compute the torques of a motion: twists outward, wrenches inward (section 7.4).

    Parameters
    ----------
    links : sequence of PlainLink
    qd, qdd : sequence of numbers
        rad/s, rad/s^2.
    gravity : sequence of 3 numbers
        In frame 1 (m/s^2).

    Returns
    -------
    list of numbers
        N m.
    """
    omega, alpha = np.zeros((2, 3), object)
    a = -np.array(gravity, object)
    forces, moments = [], []
    for link, rate, acceleration in zip(links, qd, qdd, strict=True):
        spin = np.array([omega[1] * rate, -(omega[0] * rate), acceleration], object)
        alpha = _into(link, alpha + spin)
        omega = _into(link, [omega[0], omega[1], omega[2] + rate])
        a = _into(link, a)
        change = _angular_acceleration(omega, alpha)
        forces.append((a + change @ link.com) * link.mass)
        moments.append(link.inertia @ alpha + _cross(omega, link.inertia @ omega))
        a = a + change @ link.step
    tau: list[Number] = []
    force, moment = np.zeros((2, 3), object)
    for i in range(len(links) - 1, -1, -1):
        link = links[i]
        moment = moment + moments[i] + _cross(link.step, force)
        moment = moment + _cross(link.com, forces[i])
        force, moment = _out_of(link, force + forces[i]), _out_of(link, moment)
        tau.append(moment[2])
    return tau[::-1]


def composite_inertia(links: Sequence[PlainLink]) -> Rows:
    """Compute the mass matrix from what each joint carries (Walker and Orin's third method)."""
    n = len(links)
    matrix: Rows = [[0] * n for _ in range(n)]
    mass: Number = 0
    centre, inertia = np.zeros(3, object), np.zeros((3, 3), object)
    for k in range(n - 1, -1, -1):
        link = links[k]
        # Bodies carried by joint k, from the origin of frame k, in the axes of its link.
        moved = link.step * mass + centre
        own = link.com * link.mass
        inertia = _summed(_shifted(inertia, mass, centre, link.step), link.inertia)
        inertia = _summed(inertia, _point(link.com, own))
        mass, centre = mass + link.mass, moved + own
        axis = _into(link, [0, 0, 1])
        force, moment = _cross(axis, centre), inertia @ axis
        for j in range(k, -1, -1):
            if j < k:
                moment = moment + _cross(links[j].step, force)
            moment, force = _out_of(links[j], moment), _out_of(links[j], force)
            matrix[j][k] = matrix[k][j] = moment[2]
        inertia, centre = _turned(link, inertia), _out_of(link, centre)
    return matrix


def orthogonal_complement_inertia(links: Sequence[PlainLink]) -> Rows:
    """Compute the mass matrix as ``P^T P`` with ``P = H T``, in link frames (section 7.6)."""
    n = len(links)
    matrix: Rows = [[0] * n for _ in range(n)]
    twists: list[tuple[Vector, Vector]] = []
    for i, link in enumerate(links):
        twists = [(_into(link, e), _into(link, v)) for e, v in twists]
        twists.append((_into(link, [0, 0, 1]), np.zeros(3, object)))
        rows = [
            np.concatenate((link.root @ e, (v + _cross(e, link.com)) * link.mass_root))
            for e, v in twists
        ]
        for j in range(i + 1):
            for k in range(j, i + 1):
                matrix[j][k] = matrix[k][j] = matrix[j][k] + rows[j] @ rows[k]
        twists = [(e, v + _cross(e, link.step)) for e, v in twists]
    return matrix


def cholesky_solution(matrix: Rows, right: Sequence[Number]) -> list[Number]:
    """Solve with a positive definite matrix by ``L D L^T``, without roots."""
    n = len(matrix)
    L: Rows = [[0] * n for _ in range(n)]
    D: list[Number] = []
    for j in range(n):
        parts = [L[j][k] * D[k] for k in range(j)]
        pivot = matrix[j][j]
        for k in range(j):
            pivot = pivot - parts[k] * L[j][k]
        D.append(pivot)
        for i in range(j + 1, n):
            value = matrix[i][j]
            for k in range(j):
                value = value - L[i][k] * parts[k]
            L[i][j] = value / pivot
    x = list(right)
    for i in range(n):
        for k in range(i):
            x[i] = x[i] - L[i][k] * x[k]
    x = [value / pivot for value, pivot in zip(x, D, strict=True)]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] = x[i] - L[k][i] * x[k]
    return x


def _into(link: PlainLink, v: Numbers) -> Vector:
    """From the axes of frame i to those of frame i + 1."""
    (c, s), (lam, mu) = link.turn, link.twist
    x, y = c * v[0] + s * v[1], c * v[1] - s * v[0]
    return np.array([x, lam * y + mu * v[2], lam * v[2] - mu * y], object)


def _out_of(link: PlainLink, v: Numbers) -> Vector:
    (c, s), (lam, mu) = link.turn, link.twist
    y, z = lam * v[1] - mu * v[2], mu * v[1] + lam * v[2]
    return np.array([c * v[0] - s * y, s * v[0] + c * y, z], object)


def _turned(link: PlainLink, matrix: Matrix) -> Matrix:
    """Turn a symmetric matrix out of the axes of frame i + 1: about x by alpha, z by theta."""
    (c, s), (lam, mu) = link.turn, link.twist
    matrix = _turned_in_plane(matrix, 1, 2, lam, mu)
    return _turned_in_plane(matrix, 0, 1, c, s)


def _turned_in_plane(matrix: Matrix, i: int, j: int, c: Number, s: Number) -> Matrix:
    k = 3 - i - j
    square, product = s * s, c * s
    shift = square * (matrix[j][j] - matrix[i][i]) - (product + product) * matrix[i][j]
    turned = matrix.copy()
    turned[i][i], turned[j][j] = matrix[i][i] + shift, matrix[j][j] - shift
    mixed = product * (matrix[i][i] - matrix[j][j]) + matrix[i][j]
    turned[i][j] = turned[j][i] = mixed - (square + square) * matrix[i][j]
    turned[i][k] = turned[k][i] = c * matrix[i][k] - s * matrix[j][k]
    turned[j][k] = turned[k][j] = s * matrix[i][k] + c * matrix[j][k]
    return turned


def _angular_acceleration(omega: Vector, alpha: Vector) -> Matrix:
    """Form the matrix of omega-dot x r + omega x (omega x r)."""
    x, y, z = omega
    xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
    rows = [
        [-(yy + zz), xy - alpha[2], xz + alpha[1]],
        [xy + alpha[2], -(xx + zz), yz - alpha[0]],
        [xz - alpha[1], yz + alpha[0], -(xx + yy)],
    ]
    return np.array(rows, object)


def _point(r: Vector, moment: Vector) -> Matrix:
    """Inertia of a point mass at r, with its first moment m r at hand."""
    x, y, z = moment * r
    xy, xz, yz = moment[0] * r[1], moment[0] * r[2], moment[1] * r[2]
    return np.array([[y + z, -xy, -xz], [-xy, x + z, -yz], [-xz, -yz, x + y]], object)


def _shifted(inertia: Matrix, mass: Number, first: Vector, p: Vector) -> Matrix:
    """See an inertia from an origin from which its own lies at p."""
    # With h + m p / 2 in the place of h, 2 p.h + m p.p and its products need one pass.
    half = 2 * first + p * mass
    x, y, z = half * p
    both = [p[i] * first[j] + half[i] * p[j] - first[i] * p[j] for i, j in ((0, 1), (0, 2), (1, 2))]
    more = [[y + z, -both[0], -both[1]], [-both[0], x + z, -both[2]], [-both[1], -both[2], x + y]]
    return _summed(inertia, np.array(more, object))


def _summed(A: Matrix, B: Matrix) -> Matrix:
    total, (i, j) = np.zeros((3, 3), object), np.triu_indices(3)
    total[i, j] = total[j, i] = A[i, j] + B[i, j]
    return total


def _cross(a: Numbers, b: Numbers) -> Vector:
    parts = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    return np.array(parts, object)
