"""Load on each joint in its own axes, as polynomials: mass, moments and inertia.

The frame of joint i here is frame i of the table turned by theta_i, so that it moves with link i
and the angle of the joint itself appears nowhere in what it carries.
"""

from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.symbolic.parameters import SymbolicLink, SymbolicParameters
from robomech_ros.dynamics.symbolic.poses import (
    Matrix,
    Vector,
    cross,
    polynomials,
    rotated,
    rotation,
    translation,
)
from robomech_ros.dynamics.symbolic.terms import Poly, TermRing


@dataclass(frozen=True, eq=False)
class _Composite:
    """Mass, first moments (3,) and inertia (3, 3) about the origin of a frame."""

    mass: Poly
    first: Vector
    inertia: Matrix


def symbolic_mass_rows(parameters: SymbolicParameters) -> Matrix:
    """Derive the mass matrix, without the rotors, from what the joints carry.

    The momentum of what joint k carries, for a unit rate of joint k, is seen by the axes of the
    joints before it.
    """
    ring, links, n = parameters.ring, parameters.links, len(parameters.links)
    rows = polynomials(ring, np.zeros((n, n), int))
    carried = _carried(parameters)
    for k in range(n):
        moment, force = _momentum(ring, carried[k], parameters.revolute[k])
        for j in range(k, -1, -1):
            rows[j, k] = rows[k, j] = moment[2] if parameters.revolute[j] else force[2]
            if j > 0:
                # Into frame j - 1 of joint j's neighbour, turned with its link.
                turn, step = _step(ring, links[j - 1])
                back = _turn(ring, links[j])
                moment = rotated(ring, turn, rotated(ring, back, moment))
                force = rotated(ring, turn, rotated(ring, back, force))
                moment = moment + cross(ring, step, force)
    return rows


def potential_moment(parameters: SymbolicParameters) -> Vector:
    """Derive the sum of mass times mass centre of all links in frame 1 (kg m)."""
    ring = parameters.ring
    first, mass = polynomials(ring, [0, 0, 0]), ring.number(0)
    for link in reversed(parameters.links):
        # In frame i + 1 so far, then in frame i.
        first = first + ring.times(link.mass, polynomials(ring, link.com))
        mass = mass + link.mass
        first = rotated(ring, rotation(ring, link), first)
        first = first + ring.times(mass, translation(ring, link))
    return first


def _carried(parameters: SymbolicParameters) -> list[_Composite]:
    ring, links = parameters.ring, parameters.links
    found: list[_Composite] = []
    for i in range(len(links) - 1, -1, -1):
        # In frame i + 1: the link's own body, and what the next joint carries.
        own = _own(ring, links[i])
        if found:
            own = _sum(own, _rotated(ring, found[-1], _turn(ring, links[i + 1])))
        turn, step = _step(ring, links[i])
        found.append(_shifted(ring, _rotated(ring, own, turn), step))
    return found[::-1]


def _own(ring: TermRing, link: SymbolicLink) -> _Composite:
    xx, xy, xz, yy, yz, zz = link.inertia
    nothing = polynomials(ring, np.zeros((4, 3), int))
    point = _Composite(link.mass, nothing[0], nothing[1:])
    body = _shifted(ring, point, polynomials(ring, link.com))
    about = polynomials(ring, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return _Composite(body.mass, body.first, body.inertia + about)


def _momentum(ring: TermRing, carried: _Composite, turns: bool) -> tuple[Vector, Vector]:
    """Return angular momentum about the origin and linear momentum for a unit rate about z."""
    z = polynomials(ring, [0, 0, 1])
    if turns:
        return carried.inertia[:, 2], cross(ring, z, carried.first)
    return cross(ring, carried.first, z), np.asarray(ring.times(carried.mass, z))


def _turn(ring: TermRing, link: SymbolicLink) -> Matrix:
    c, s = link.turn
    return polynomials(ring, [[c, -s, 0], [s, c, 0], [0, 0, 1]])


def _step(ring: TermRing, link: SymbolicLink) -> tuple[Matrix, Vector]:
    """Turn about X by alpha_i, and the way (a_i, 0, b_i) before."""
    c, s = link.twist
    turn = polynomials(ring, [[1, 0, 0], [0, c, -s], [0, s, c]])
    return turn, polynomials(ring, [link.a, 0, link.b])


def _sum(one: _Composite, other: _Composite) -> _Composite:
    mass, first = one.mass + other.mass, one.first + other.first
    return _Composite(mass, first, one.inertia + other.inertia)


def _rotated(ring: TermRing, body: _Composite, R: Matrix) -> _Composite:
    # R J R^T: turn the columns, then those of the transpose.
    inertia = rotated(ring, R, rotated(ring, R, body.inertia).T)
    return _Composite(body.mass, rotated(ring, R, body.first), inertia)


def _shifted(ring: TermRing, body: _Composite, p: Vector) -> _Composite:
    """See a body from an origin from which its own lies at p."""
    times, m, h = ring.times, body.mass, body.first
    mixed = times(p[:, None], h)
    inertia = body.inertia - times(m, times(p[:, None], p)) - mixed - mixed.T
    inertia[np.diag_indices(3)] += times(m, times(p, p).sum()) + 2 * times(p, h).sum()
    return _Composite(m, h + times(m, p), inertia)
