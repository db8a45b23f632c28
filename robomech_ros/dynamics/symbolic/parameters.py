"""The parameters of a chain as symbols, in the book's notation, or as exact numbers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import sympy

from robomech_ros.dynamics.symbolic.terms import Angle, Poly, TermRing
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.forward_uncompiled import link_transforms
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import REVOLUTE
from robomech_ros.robots.dh_table import DHTable, link_transforms as table_transforms
from robomech_ros.robots.drives import Drive
from robomech_ros.typing import Array

# Below this (rad, m, kg m, or of the greatest moment) a parameter is rounding, and 0.
_NOTHING = 1e-9


@dataclass(frozen=True, eq=False)
class SymbolicLink:
    """A row of the table and the body of a link, as polynomials of a ring.

    Lengths a and b are in m, b the joint variable of a prismatic joint; turn and twist are cosine
    and sine of theta and alpha.  The mass centre is in frame i + 1 (m); the moments xx, xy, xz, yy,
    yz, zz are about it, in the axes of that frame (kg m^2).
    """

    a: Poly
    b: Poly
    turn: tuple[Poly, Poly]
    twist: tuple[Poly, Poly]
    mass: Poly
    com: tuple[Poly, ...]
    inertia: tuple[Poly, ...]


@dataclass(frozen=True, eq=False)
class SymbolicParameters:
    """Everything of a chain that expressions are made of.

    The variables are theta_i or b_i, with ``variables = q + offsets`` for the chain's own joint
    values q (n,), rad or m. ``values`` are what the other symbols stand for (SI units). Gravity is
    in frame 1 (m/s^2). The rotors are what the drives add to the diagonal of the mass matrix (kg
    m^2 or kg), the friction the torques that each joint takes (N m or N). ``base`` and ``tool`` are
    the first frame in the base and the tip in the last frame.
    """

    ring: TermRing
    links: tuple[SymbolicLink, ...]
    variables: tuple[sympy.Symbol, ...]
    rates: tuple[sympy.Symbol, ...]
    accelerations: tuple[sympy.Symbol, ...]
    revolute: tuple[bool, ...]
    offsets: Array
    values: dict[sympy.Symbol, float]
    gravity: tuple[Poly, ...]
    rotors: tuple[sympy.Expr, ...]
    friction: tuple[sympy.Expr, ...]
    base: sympy.Matrix
    tool: sympy.Matrix


@dataclass(eq=False)
class _Names:
    """Hands out symbols for numbers, or the numbers themselves where they are wanted."""

    by_name: bool
    values: dict[sympy.Symbol, float] = field(default_factory=dict)
    angles: list[Angle] = field(default_factory=list)

    def quantity(self, name: str, value: float, size: float = 1.0) -> sympy.Expr:
        if abs(value) <= _NOTHING * size:
            return sympy.Integer(0)
        if not self.by_name:
            return _exact(value)
        symbol = sympy.Symbol(name, real=True)
        self.values[symbol] = value
        return symbol

    def turn(self, name: str, angle: float, group: int) -> tuple[sympy.Expr, sympy.Expr]:
        """Cosine and sine of a constant angle: exact at right angles."""
        quarters = round(angle / (math.pi / 2))
        if abs(angle - quarters * math.pi / 2) <= _NOTHING:
            c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarters % 4]
            return sympy.Integer(c), sympy.Integer(s)
        if not self.by_name:
            return _exact(math.cos(angle)), _exact(math.sin(angle))
        symbol = sympy.Symbol(name, real=True)
        self.values[symbol] = angle
        return self.variable(symbol, group)

    def variable(self, symbol: sympy.Symbol, group: int) -> tuple[sympy.Expr, sympy.Expr]:
        self.angles.append(Angle(symbol, group))
        return sympy.cos(symbol), sympy.sin(symbol)


def symbolic_parameters(
    chain: SerialChain, gravity: Sequence[float], *, by_name: bool
) -> SymbolicParameters:
    """Name the parameters of a chain, or make exact numbers of them.

    Those that vanish are 0 and right angles exact, named or not; without bodies the masses are 0.
    Gravity is in the base (m/s^2).
    """
    chain.require_uncoupled()
    table = chain.dh
    if table is None:
        raise BadValueError("chain", chain.name, "a chain with at least one joint")
    names = _Names(by_name)
    variables = tuple(
        sympy.Symbol(f"{'theta' if kind == REVOLUTE else 'b'}_{i + 1}", real=True)
        for i, kind in enumerate(table.types)
    )
    rows = [_link_row(names, table, i, variables[i]) for i in range(chain.n)]
    bodies = [_body_row(names, chain, table, i) for i in range(chain.n)]
    weight = _gravity_row(names, table, np.asarray(gravity, dtype=np.float64))
    slides = [one for one, kind in zip(variables, table.types, strict=True) if kind != REVOLUTE]
    lengths = [one for one in names.values if one not in {a.symbol for a in names.angles}]
    ring = TermRing((*lengths, *slides), names.angles)
    links = tuple(_link(ring, row, body) for row, body in zip(rows, bodies, strict=True))
    rates = tuple(_derived(one, "dot") for one in variables)
    drives = _Names(by_name)
    return SymbolicParameters(
        ring=ring,
        links=links,
        variables=variables,
        rates=rates,
        accelerations=tuple(_derived(one, "ddot") for one in variables),
        revolute=tuple(bool(kind == REVOLUTE) for kind in table.types),
        offsets=np.where(table.types == REVOLUTE, table.theta, table.b),
        gravity=tuple(_poly(ring, one) for one in weight),
        rotors=tuple(
            drives.quantity(f"J_{i + 1}", drive.reflected_inertia)
            for i, drive in enumerate(chain.drives)
        ),
        friction=tuple(
            _friction(drives, i + 1, drive, rate)
            for i, (drive, rate) in enumerate(zip(chain.drives, rates, strict=True))
        ),
        values=names.values | drives.values,
        base=_exact_pose(table.base),
        tool=_exact_pose(table.tool),
    )


def _link(ring: TermRing, row: Sequence[sympy.Expr], body: Sequence[sympy.Expr]) -> SymbolicLink:
    """Turn what :func:`_link_row` and :func:`_body_row` give for a link into polynomials."""
    return SymbolicLink(
        a=_poly(ring, row[0]),
        b=_poly(ring, row[1]),
        turn=(_poly(ring, row[2]), _poly(ring, row[3])),
        twist=(_poly(ring, row[4]), _poly(ring, row[5])),
        mass=_poly(ring, body[0]),
        com=tuple(_poly(ring, one) for one in body[1:4]),
        inertia=tuple(_poly(ring, one) for one in body[4:]),
    )


def _link_row(
    names: _Names, table: DHTable, i: int, variable: sympy.Symbol
) -> tuple[sympy.Expr, ...]:
    """Return a, b, cos theta, sin theta, cos alpha, sin alpha."""
    k, group = i + 1, _group(table, i)
    a = names.quantity(f"a_{k}", float(table.a[i]))
    if table.types[i] == REVOLUTE:
        b, turn = names.quantity(f"b_{k}", float(table.b[i])), names.variable(variable, group)
    else:
        b, turn = variable, names.turn(f"theta_{k}", float(table.theta[i]), group)
    # A twist is in no sum of angles: groups of their own, numbered apart.
    twist = names.turn(f"alpha_{k}", float(table.alpha[i]), -k)
    return a, b, *turn, *twist


def _group(table: DHTable, i: int) -> int:
    """Find the first joint up to joint i from which on all axes are parallel."""
    while i > 0 and abs(math.sin(table.alpha[i - 1])) <= _NOTHING:
        i -= 1
    return i


def _body_row(names: _Names, chain: SerialChain, table: DHTable, i: int) -> tuple[sympy.Expr, ...]:
    """Return the mass, mass centre and moments of a body in frame i + 1; 0 without a body."""
    body, k = chain.bodies[i], i + 1
    if body is None:
        return (sympy.Integer(0),) * 10
    frame = table.base
    for step in table_transforms(table)[:k]:
        frame = frame @ step
    own = link_transforms(chain, np.zeros(chain.n))[i]
    seen = body.expressed_in(np.linalg.inv(frame) @ own)
    axes = ("xx", "xy", "xz", "yy", "yz", "zz")
    moments, size = seen.inertia[np.triu_indices(3)], float(np.abs(seen.inertia).max())
    return (
        names.quantity(f"m_{k}", seen.mass),
        *(names.quantity(f"{x}_{k}", float(v)) for x, v in zip("xyz", seen.com, strict=True)),
        *(
            names.quantity(f"I_{ax}{k}", float(v), size or 1.0)
            for ax, v in zip(axes, moments, strict=True)
        ),
    )


def _gravity_row(names: _Names, table: DHTable, gravity: Array) -> tuple[sympy.Expr, ...]:
    """Return gravity in frame 1: +-g along an axis of it, else g_x, g_y, g_z."""
    seen = table.base[:3, :3].T @ gravity
    size = float(np.abs(seen).max())
    along = np.flatnonzero(np.abs(seen) > _NOTHING * size)
    if len(along) == 1:
        g, sign = names.quantity("g", size), int(np.sign(seen[along[0]]))
        return tuple(sign * g if i == along[0] else sympy.Integer(0) for i in range(3))
    return tuple(
        names.quantity(f"g_{x}", float(v), size or 1.0) for x, v in zip("xyz", seen, strict=True)
    )


def _friction(names: _Names, k: int, drive: Drive, rate: sympy.Symbol) -> sympy.Expr:
    """Write viscous, Coulomb and Stribeck friction of joint k."""
    coulomb = names.quantity(f"tauC_{k}", drive.coulomb)
    more = names.quantity(f"tauS_{k}", max(drive.static - drive.coulomb, 0.0))
    if more != 0:
        width = names.quantity(f"vS_{k}", drive.stribeck_velocity)
        coulomb = coulomb + more * sympy.exp(-((rate / width) ** 2))
    return names.quantity(f"beta_{k}", drive.viscous) * rate + coulomb * sympy.sign(rate)


def _derived(symbol: sympy.Symbol, suffix: str) -> sympy.Symbol:
    head, number = str(symbol).split("_")
    return sympy.Symbol(f"{head}{suffix}_{number}", real=True)


def _exact(value: float) -> sympy.Rational:
    return sympy.Rational(repr(float(value)))


def _exact_pose(pose: Array) -> sympy.Matrix:
    """Make a pose of numbers, whole where they are, except for rounding."""

    def entry(value: float) -> sympy.Rational:
        whole = round(value)
        return sympy.Integer(whole) if abs(value - whole) <= _NOTHING else _exact(value)

    return sympy.Matrix(4, 4, [entry(float(value)) for value in pose.ravel()])


def _poly(ring: TermRing, value: sympy.Expr) -> Poly:
    """Return a number, plus or minus a symbol, or the cosine or sine of one, in the ring."""
    if value.is_Rational:
        return ring.number(value)
    if value.could_extract_minus_sign():
        return -_poly(ring, -value)
    if isinstance(value, sympy.cos):
        return ring.cosine(value.args[0])
    if isinstance(value, sympy.sin):
        return ring.sine(value.args[0])
    return ring.parameter(value)
