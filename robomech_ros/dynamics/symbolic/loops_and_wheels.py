"""Symbolic dynamics of the planar 3-RRR and of rolling robots.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 12.3 to 12.5.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy

from robomech_ros.dynamics.symbolic.constrained_systems import SymbolicBody, SymbolicSystem
from robomech_ros.numerics.arrays import whole_number

_UP = sympy.diag(0, 0, 1)


def symbolic_planar_3rrr() -> SymbolicSystem:
    r"""Derive the dynamics of the planar 3-RRR in a horizontal plane.

    Limb i has links of length l_1 and l_2 at the angles theta_i and psi_i from the x axis, and ends
    at the point (x_i, y_i) of the platform, which is at the angle phi.  Mass centres are c_1 and
    c_2 along the links, and at the origin of the platform.  With the twist
    :math:`t = [\omega, v_x, v_y]` of the platform, the closure of limb i is

    .. math::

       [\, u_i \cdot E b_i, \; \cos\psi_i, \; \sin\psi_i \,]\, t
       = l_1 \sin(\psi_i - \theta_i)\, \dot\theta_i

    so :math:`K t = J \dot\theta` and t = n u with ``h = K^-1`` and ``n = h J``.  The rates of the
    distal links are q u.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 12.3 and 12.4.

    Examples
    --------
    >>> from robomech_ros.dynamics.symbolic import symbolic_planar_3rrr
    >>> symbolic_planar_3rrr().bodies[0].T[[2, 4], 0]
    Matrix([
    [  1],
    [c_1]])
    """
    dimensions = _real("l_1 l_2 c_1 c_2 x_1 y_1 x_2 y_2 x_3 y_3")
    masses = m1, m2, mp, I1, I2, Ip = _real("m_1 m_2 m_P I_1 I_2 I_P")
    theta, psi, (phi,) = _real("theta_1:4"), _real("psi_1:4"), _real("phi,")
    rates, omega, turning = _real("thetadot_1:4"), *_real("omega,"), _real("psidot_1:4")
    l1, l2, c1, c2, *corners = dimensions
    sin, cos = sympy.sin, sympy.cos
    moving = dict(zip((*theta, *psi, phi), (*rates, *turning, omega), strict=True))
    x, y = corners[::2], corners[1::2]
    arms = [x[i] * sin(psi[i] - phi) - y[i] * cos(psi[i] - phi) for i in range(3)]
    along = [x[i] * cos(psi[i] - phi) + y[i] * sin(psi[i] - phi) for i in range(3)]
    K = sympy.Matrix([[arms[i], cos(psi[i]), sin(psi[i])] for i in range(3)])
    across = sympy.Matrix([[along[i], -sin(psi[i]), cos(psi[i])] for i in range(3)])
    J = sympy.diag(*(l1 * sin(psi[i] - theta[i]) for i in range(3)))
    own = sympy.diag(*(l1 * cos(psi[i] - theta[i]) for i in range(3)))
    named, u = _Definitions(), sympy.Matrix(rates)
    k = named.matrix("k", K[:, 0]).row_join(K[:, 1:])
    h = named.matrix("h", k.adjugate() / named.add("Delta", k.det()))
    n = named.matrix("n", h * J)
    q = named.matrix("q", (across * n - own) / l2)
    named.matrix("omega", n[0, :] * u, [omega])
    named.matrix("psidot", q * u, turning)
    n_dot = named.matrix("ndot", h * (_rate(J, moving) - _rate(K, moving) * n))
    known = _rate(across, moving) * n + across * n_dot - _rate(own, moving)
    q_dot = named.matrix("qdot", known / l2)
    moving |= dict(zip([*n, *q], [*n_dot, *q_dot], strict=True))
    e, flat = sympy.eye(3), sympy.zeros(1, 3)
    bodies = []
    for i in range(3):
        T = _planar(e[i, :], flat, c1 * e[i, :])
        bodies.append(_body(f"proximal link {i + 1}", m1, I1 * _UP, T, rates[i], moving))
    for i in range(3):
        T = _planar(q[i, :], J[i, :], own[i, :] + c2 * q[i, :])
        bodies.append(_body(f"distal link {i + 1}", m2, I2 * _UP, T, turning[i], moving))
    T = _planar(*(n[i, :] for i in range(3)))
    bodies.append(_body("platform", mp, Ip * _UP, T, sympy.S.Zero, moving))
    symbols = (*dimensions, *theta, *psi, phi)
    return SymbolicSystem(rates, symbols, masses, named.known, tuple(bodies))


def symbolic_two_wheels(casters: int = 1) -> SymbolicSystem:
    r"""Derive the dynamics of the robot with two driven wheels and casters.

    Wheels 1 (left) and 2 (right), of radius r, are l apart; the platform's mass centre is at
    (x_C, y_C) from the middle of the axle, x forward.  Caster k has its pivot at (x_k, y_k), the
    trail d_k, the radius r_k, and the angle psi_k of its bracket from x; p_k is the distance of
    the bracket's mass centre behind the pivot.  Masses and inertias are m_P, I_P of the platform;
    m_W, J_W (about the axle) and H_W (about the vertical) of a driven wheel; m_k, J_k and H_k of
    the wheel of caster k; m_Bk and I_Bk of its bracket.  Brackets turn at the rates s u in an
    inertial frame, caster wheels at the rates w u.

    Parameters
    ----------
    casters : int, optional
        Number of casters, 0 to 9.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 12.5.1.

    Examples
    --------
    >>> from robomech_ros.dynamics.symbolic import symbolic_two_wheels
    >>> print(symbolic_two_wheels(casters=0).coupling[0, 1])
    -m_P*omega*r**2*x_C/l
    """
    count = whole_number("casters", casters, "a whole number from 0 to 9", 0, 9)
    symbols = r, l, x, y = _real("r l x_C y_C")  # noqa: E741
    masses = mp, Ip, mw, Jw, Hw = _real("m_P I_P m_W J_W H_W")
    rates, omega = _real("thetadot_1:3"), *_real("omega,")
    half, named = sympy.Rational(1, 2), _Definitions()
    base = sympy.Matrix([[-r / l, r / l], [r * half, r * half], [0, 0]])
    named.matrix("omega", base[0, :] * sympy.Matrix(rates), [omega])
    T = _planar(base[0, :], *_velocity(x, y, base))
    bodies = [_body("platform", mp, Ip * _UP, T, omega, {})]
    for i, side in enumerate((half * l, -half * l)):
        T = _planar(base[0, :], *_velocity(sympy.S.Zero, side, base))
        T[1, i] = 1
        bodies.append(_body(f"wheel {i + 1}", mw, _round(Jw, Hw), T, omega, {}))
    for k in range(1, count + 1):
        own = _real(f"x_{k} y_{k} d_{k} r_{k} p_{k} psi_{k}")
        heavy = _real(f"m_{k} J_{k} H_{k} m_B{k} I_B{k}")
        bodies += _caster(k, own, heavy, base, named)
        symbols, masses = (*symbols, *own), (*masses, *heavy)
    return SymbolicSystem(rates, symbols, masses, named.known, tuple(bodies))


def _caster(
    k: int,
    own: Sequence[sympy.Symbol],
    heavy: Sequence[sympy.Symbol],
    base: sympy.Matrix,
    named: _Definitions,
) -> list[SymbolicBody]:
    """Return wheel and bracket of a caster, in the axes of the bracket."""
    x, y, trail, radius, behind, psi = own
    mass, spin, across, bracket, about = heavy
    forward, left = _velocity(x, y, base)
    c, s = sympy.cos(psi), sympy.sin(psi)
    turns = named.matrix(f"s_{k}", (c * left - s * forward) / trail)
    rolls = named.matrix(f"w_{k}", (c * forward + s * left) / radius)
    u = sympy.Matrix(_real("thetadot_1:3"))
    (turning,) = named.matrix(f"Omega_{k}", turns * u, _real(f"Omega_{k},"))
    # The bracket turns against the platform by Omega - omega.
    slope = turning - sympy.Symbol("omega", real=True)
    turns_dot = named.matrix(f"sdot_{k}", -radius * rolls * slope / trail)
    rolls_dot = named.matrix(f"wdot_{k}", trail * turns * slope / radius)
    moving = dict(zip([*turns, *rolls], [*turns_dot, *rolls_dot], strict=True))
    wheel = _planar(turns, radius * rolls, sympy.zeros(1, 2))
    wheel[1, :] = rolls
    frame = _planar(turns, radius * rolls, (trail - behind) * turns)
    return [
        _body(f"wheel of caster {k}", mass, _round(spin, across), wheel, turning, moving),
        _body(f"bracket of caster {k}", bracket, about * _UP, frame, turning, moving),
    ]


def symbolic_omnidirectional() -> SymbolicSystem:
    r"""Derive the dynamics of the robot with three omnidirectional wheels, 120 degrees apart.

    Wheel i, of radius r, is at the distance rho from the centre and rolls along the circle;
    positive rates of all turn the robot clockwise.  The mass centre of the platform is at the
    centre.  Masses and inertias are m_P, I_P of the platform, m_W of a wheel, J_W about its axle
    and H_W about the vertical; rollers have no mass.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 12.5.2.

    Examples
    --------
    >>> from robomech_ros.dynamics.symbolic import symbolic_omnidirectional
    >>> robot = symbolic_omnidirectional()
    >>> robot.inertia[0, 0] - robot.inertia[1, 1]
    0
    """
    symbols = r, rho = _real("r rho")
    masses = mp, Ip, mw, Jw, Hw = _real("m_P I_P m_W J_W H_W")
    rates, omega = _real("thetadot_1:4"), *_real("omega,")
    cosines, sines = zip(
        *((sympy.cos(a), sympy.sin(a)) for a in (0, 2 * sympy.pi / 3, 4 * sympy.pi / 3)),
        strict=True,
    )
    # Rolling directions at a right angle behind the azimuths: K t = r u.
    K = sympy.Matrix([[-rho, sines[i], -cosines[i]] for i in range(3)])
    base, named = K.inv() * r, _Definitions()
    named.matrix("omega", base[0, :] * sympy.Matrix(rates), [omega])
    T = _planar(*(base[i, :] for i in range(3)))
    bodies = [_body("platform", mp, Ip * _UP, T, omega, {})]
    for i in range(3):
        # In the axes of the wheel: along its rolling direction, and its axle, which is outward.
        outward = cosines[i] * base[1, :] + sines[i] * base[2, :]
        e = sympy.eye(3)[i, :]
        T = _planar(base[0, :], r * e, outward)
        T[1, :] = e
        bodies.append(_body(f"wheel {i + 1}", mw, _round(Jw, Hw), T, omega, {}))
    return SymbolicSystem(rates, symbols, masses, named.known, tuple(bodies))


class _Definitions:
    """Abbreviations in order of definition."""

    def __init__(self) -> None:
        self.known: dict[sympy.Symbol, sympy.Expr] = {}

    def add(self, name: str, expression: sympy.Expr) -> sympy.Symbol:
        symbol = sympy.Symbol(name, real=True)
        self.known[symbol] = expression
        return symbol

    def matrix(
        self, name: str, matrix: sympy.Matrix, symbols: Sequence[sympy.Symbol] | None = None
    ) -> sympy.Matrix:
        """Name all entries: by their row, their column or both, or by given symbols."""
        rows, columns = matrix.shape
        if symbols is None:
            indices = [
                "".join(str(x + 1) for x, n in ((i, rows), (j, columns)) if n > 1)
                for i in range(rows)
                for j in range(columns)
            ]
            joint = "" if "_" in name else "_"
            symbols = [sympy.Symbol(f"{name}{joint}{index}", real=True) for index in indices]
        self.known |= dict(zip(symbols, matrix, strict=True))
        return sympy.Matrix(rows, columns, symbols)


def _real(names: str) -> tuple[sympy.Symbol, ...]:
    return tuple(sympy.symbols(names, real=True))


def _rate(matrix: sympy.Matrix, moving: Mapping[sympy.Symbol, sympy.Expr]) -> sympy.Matrix:
    """Differentiate by time, with the rates of the moving symbols."""
    total = sympy.zeros(*matrix.shape)
    for symbol in matrix.free_symbols & moving.keys():
        total += matrix.diff(symbol) * moving[symbol]
    return total


def _planar(turn: sympy.Matrix, x: sympy.Matrix, y: sympy.Matrix) -> sympy.Matrix:
    """Stack rows (1, m) of a turn about the vertical and of velocities to twists (6, m)."""
    flat = sympy.zeros(1, turn.cols)
    return sympy.Matrix.vstack(flat, flat, turn, x, y, flat)


def _velocity(
    x: sympy.Expr, y: sympy.Expr, base: sympy.Matrix
) -> tuple[sympy.Matrix, sympy.Matrix]:
    """Return the velocities (1, m) of a point of the platform along x and y."""
    return base[1, :] - y * base[0, :], base[2, :] + x * base[0, :]


def _round(spin: sympy.Expr, across: sympy.Expr) -> sympy.Matrix:
    """Return the inertia of a wheel whose axle is the second axis."""
    return sympy.diag(across, spin, across)


def _body(
    name: str,
    mass: sympy.Expr,
    inertia: sympy.Matrix,
    T: sympy.Matrix,
    turning: sympy.Expr,
    moving: Mapping[sympy.Symbol, sympy.Expr],
) -> SymbolicBody:
    """Make a body whose axes turn at a rate about the vertical."""
    quarter = sympy.Matrix([[0, -1, 0], [1, 0, 0], [0, 0, 0]])
    carried = turning * sympy.diag(quarter, quarter) * T
    return SymbolicBody(name, mass, inertia, T, carried + _rate(T, moving))
