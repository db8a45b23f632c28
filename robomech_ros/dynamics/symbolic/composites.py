"""Load on each joint in its own axes, as polynomials: mass, moments and inertia.

The frame of joint i here is frame i of the table turned by theta_i, so that it moves with link i
and the angle of the joint itself appears nowhere in what it carries.
"""

from dataclasses import dataclass

from robomech_ros.dynamics.symbolic.parameters import SymbolicLink, SymbolicParameters
from robomech_ros.dynamics.symbolic.poses import (
    Rows,
    Vector,
    add,
    cross,
    rotated,
    rotation,
    translation,
)
from robomech_ros.dynamics.symbolic.terms import Poly, TermRing


@dataclass(frozen=True, eq=False)
class _Composite:
    """Mass, first moments (3) and inertia (3 x 3) about the origin of a frame."""

    mass: Poly
    first: Vector
    inertia: Rows


def symbolic_mass_rows(parameters: SymbolicParameters) -> list[list[Poly]]:
    """Derive the mass matrix, without the rotors, from what the joints carry.

    The momentum of what joint k carries, for a unit rate of joint k, is seen by the axes of the
    joints before it.
    """
    ring, links, n = parameters.ring, parameters.links, len(parameters.links)
    rows = [[ring.number(0)] * n for _ in range(n)]
    carried = _carried(parameters)
    for k in range(n):
        moment, force = _momentum(ring, carried[k], parameters.revolute[k])
        for j in range(k, -1, -1):
            rows[j][k] = rows[k][j] = moment[2] if parameters.revolute[j] else force[2]
            if j > 0:
                # Into frame j - 1 of joint j's neighbour, turned with its link.
                turn, step = _step(ring, links[j - 1])
                back = _turn(ring, links[j])
                moment = rotated(ring, turn, rotated(ring, back, moment))
                force = rotated(ring, turn, rotated(ring, back, force))
                lever = cross(ring, step, force)
                moment = [a + b for a, b in zip(moment, lever, strict=True)]
    return rows


def potential_moment(parameters: SymbolicParameters) -> Vector:
    """Derive the sum of mass times mass centre of all links in frame 1 (kg m)."""
    ring = parameters.ring
    first = [ring.number(0)] * 3
    mass = ring.number(0)
    for link in reversed(parameters.links):
        # In frame i + 1 so far, then in frame i.
        own = [ring.product(link.mass, one) for one in link.com]
        first = [a + b for a, b in zip(first, own, strict=True)]
        mass = mass + link.mass
        moved = rotated(ring, rotation(ring, link), first)
        offset = translation(ring, link)
        first = [a + ring.product(mass, p) for a, p in zip(moved, offset, strict=True)]
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
    about = _Composite(
        ring.number(0), [ring.number(0)] * 3, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    )
    zero = [[ring.number(0)] * 3 for _ in range(3)]
    point = _Composite(link.mass, [ring.number(0)] * 3, zero)
    return _sum(about, _shifted(ring, point, list(link.com)))


def _momentum(ring: TermRing, carried: _Composite, turns: bool) -> tuple[Vector, Vector]:
    """Return angular momentum about the origin and linear momentum for a unit rate about z."""
    z = [ring.number(0), ring.number(0), ring.number(1)]
    if turns:
        return [row[2] for row in carried.inertia], cross(ring, z, carried.first)
    return cross(ring, carried.first, z), [ring.number(0), ring.number(0), carried.mass]


def _turn(ring: TermRing, link: SymbolicLink) -> Rows:
    """Turn about Z by theta_i."""
    (c, s), zero = link.turn, ring.number(0)
    return [[c, -s, zero], [s, c, zero], [zero, zero, ring.number(1)]]


def _step(ring: TermRing, link: SymbolicLink) -> tuple[Rows, Vector]:
    """Turn about X by alpha_i, and the way (a_i, 0, b_i) before."""
    (c, s), zero = link.twist, ring.number(0)
    return [[ring.number(1), zero, zero], [zero, c, -s], [zero, s, c]], [link.a, zero, link.b]


def _sum(one: _Composite, other: _Composite) -> _Composite:
    return _Composite(
        one.mass + other.mass,
        [a + b for a, b in zip(one.first, other.first, strict=True)],
        [
            [a + b for a, b in zip(row, more, strict=True)]
            for row, more in zip(one.inertia, other.inertia, strict=True)
        ],
    )


def _rotated(ring: TermRing, body: _Composite, R: Rows) -> _Composite:
    # R J R^T: turn the columns, then those of the transpose.
    half = [rotated(ring, R, row) for row in body.inertia]
    columns = [list(column) for column in zip(*half, strict=True)]
    inertia = [rotated(ring, R, column) for column in columns]
    return _Composite(body.mass, rotated(ring, R, body.first), inertia)


def _shifted(ring: TermRing, body: _Composite, p: Vector) -> _Composite:
    """See a body from an origin from which its own lies at p."""
    times = ring.product
    m, h = body.mass, body.first
    square = add(ring, *(times(one, one) for one in p))
    dot = add(ring, *(times(a, b) for a, b in zip(p, h, strict=True)))
    inertia = [
        [
            body.inertia[i][j]
            - times(m, times(p[i], p[j]))
            - times(p[i], h[j])
            - times(h[i], p[j])
            + (times(m, square) + 2 * dot if i == j else ring.number(0))
            for j in range(3)
        ]
        for i in range(3)
    ]
    return _Composite(m, [a + times(m, b) for a, b in zip(h, p, strict=True)], inertia)
