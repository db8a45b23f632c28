"""The equations of chapters 4 and 9 as expressions, derived from the loop by SymPy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy

from robomech_ros.dynamics.model import GRAVITY
from robomech_ros.dynamics.symbolic.parameters import SymbolicParameters, symbolic_parameters
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.equations.decoupled_table import decoupled_table
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_choice


@dataclass(frozen=True, eq=False)
class SymbolicLoop:
    """Links and target of an arm of six revolute joints.

    Parameters
    ----------
    parameters : SymbolicParameters
        Symbols theta_i, a_i, b_i and alpha_i, and what they stand for.
    rotation : sympy.Matrix, shape (3, 3)
        Symbols q_11 .. q_33 of the rotation Q of the last frame in the first.
    position : sympy.Matrix, shape (3, 1)
        Symbols p_x, p_y and p_z of its position p (m).
    """

    parameters: SymbolicParameters
    rotation: sympy.Matrix
    position: sympy.Matrix

    def link_rotation(self, i: int) -> sympy.Matrix:
        """Write Q_i, frame i + 1 in frame i, for i from 1 to 6."""
        c, s, lam, mu, _, _ = self._row(i)
        return sympy.Matrix([[c, -lam * s, mu * s], [s, lam * c, -mu * c], [0, mu, lam]])

    def link_position(self, i: int) -> sympy.Matrix:
        """Write a_i, from the origin of frame i to that of frame i + 1, in frame i (m)."""
        c, s, _, _, a, b = self._row(i)
        return sympy.Matrix([a * c, a * s, b])

    def link_vector(self, i: int) -> sympy.Matrix:
        """Write b_i = Q_i^T a_i = [a_i, b_i mu_i, b_i lambda_i], which does not turn (m)."""
        _, _, lam, mu, a, b = self._row(i)
        return sympy.Matrix([a, b * mu, b * lam])

    @cached_property
    def last_axis(self) -> sympy.Matrix:
        """Direction of axis 6 in the first frame, ``Q [0, mu_6, lambda_6]``."""
        _, _, lam, mu, _, _ = self._row(6)
        return self.rotation * sympy.Matrix([0, mu, lam])

    @cached_property
    def last_origin(self) -> sympy.Matrix:
        """Origin of frame 6 in the first frame (m): the wrist centre of decoupled arms."""
        return self.position - self.rotation * self.link_vector(6)

    def _row(self, i: int) -> tuple[sympy.Expr, ...]:
        """Return cos theta, sin theta, cos alpha, sin alpha, a and b."""
        link, write = self.parameters.links[i - 1], self.parameters.ring.expression
        return tuple(write(one) for one in (*link.turn, *link.twist, link.a, link.b))


@dataclass(frozen=True, eq=False)
class SymbolicDecoupled:
    """The equations of chapter 4 of an arm with a spherical wrist.

    Parameters
    ----------
    loop : SymbolicLoop
    centre : sympy.Matrix, shape (3, 1)
        Symbols x, y and z of the wrist centre in the first frame (m).
    axis : sympy.Matrix, shape (3, 1)
        Symbols xi, eta and zeta of the direction of axis 6 in frame 4.
    """

    loop: SymbolicLoop
    centre: sympy.Matrix
    axis: sympy.Matrix

    @cached_property
    def wrist_centre(self) -> sympy.Matrix:
        """Wrist centre of a target, shape (3, 1) (m)."""
        return self.loop.last_origin

    @cached_property
    def first(self) -> sympy.Matrix:
        """A .. E of the first equation, shape (1, 5) (m^2): a distance free of joint 2."""
        reached = self.loop.link_vector(2) + self._behind
        wanted = self.centre - self.loop.link_position(1)
        return self._coefficients(reached.dot(reached) - wanted.dot(wanted))

    @cached_property
    def second(self) -> sympy.Matrix:
        """F .. J of the second equation, shape (1, 5) (m): a height free of joint 2."""
        reached = self.loop.link_position(2) + self.loop.link_rotation(2) * self._behind
        wanted = self.loop.link_rotation(1).T * (self.centre - self.loop.link_position(1))
        return self._coefficients(reached[2] - wanted[2])

    @cached_property
    def conic(self) -> sympy.Matrix:
        """K, L, M, N, P and Q, shape (1, 6) (m^4): what is left without joint 1.

        Cosine and sine of joint 1 by Cramer's rule, their squares summed up; the mixed term
        A F + B G vanishes.
        """
        (A, B, C, D, E), (F, G, H, I, J) = self.first, self.second  # noqa: E741
        x, y, _ = self.centre
        squares = (F**2 + G**2, A**2 + B**2, (A * G - B * F) ** 2)
        u, v, w = (sympy.cancel(one / (x**2 + y**2)) for one in squares)
        entries = [
            u * C**2 + v * H**2,
            u * D**2 + v * I**2,
            2 * (u * C * D + v * H * I),
            2 * (u * C * E + v * H * J),
            2 * (u * D * E + v * I * J),
            u * E**2 + v * J**2 - w,
        ]
        return sympy.Matrix([entries])

    @cached_property
    def quartic(self) -> sympy.Matrix:
        """R .. V of the quartic in tan(theta_3 / 2), highest first, shape (1, 5) (m^4)."""
        K, L, M, N, P, Q = self.conic
        return sympy.Matrix([[K - N + Q, 2 * (P - M), 2 * (Q + 2 * L - K), 2 * (M + P), K + N + Q]])

    @cached_property
    def orientation(self) -> sympy.Matrix:
        """Coefficients of the quadratic in tan(theta_4 / 2), highest first, shape (1, 3)."""
        tau = sympy.Symbol("tau", real=True)
        four = self.loop.parameters.variables[3]
        lam5 = self.loop.link_rotation(5)[2, 2]
        left = lam5 - self.loop.link_rotation(4)[:, 2].dot(self.axis)
        halved = left.subs(
            {sympy.cos(four): (1 - tau**2) / (1 + tau**2), sympy.sin(four): 2 * tau / (1 + tau**2)}
        )
        poly = sympy.Poly(sympy.cancel(halved * (1 + tau**2)), tau)
        return sympy.Matrix([[poly.coeff_monomial(tau**k) for k in (2, 1, 0)]])

    @property
    def _behind(self) -> sympy.Matrix:
        """From the origin of frame 3 to the wrist centre, in frame 3."""
        loop = self.loop
        return loop.link_position(3) + loop.link_rotation(3) * loop.link_position(4)

    def _coefficients(self, expression: sympy.Expr) -> sympy.Matrix:
        """Return those of cos and sin of joints 1 and 3, and what is left."""
        one, _, three = self.loop.parameters.variables[:3]
        symbols = sympy.symbols("c_1 s_1 c_3 s_3", real=True)
        waves = (sympy.cos(one), sympy.sin(one), sympy.cos(three), sympy.sin(three))
        c1, s1, c3, s3 = symbols
        plain = sympy.expand(expression).xreplace(dict(zip(waves, symbols, strict=True)))
        squares = {one**2: 1 - other**2 for one, other in ((s1, c1), (s3, c3))}
        for sine in plain.atoms(sympy.sin):
            squares[sine**2] = 1 - sympy.cos(sine.args[0]) ** 2
        poly = sympy.Poly(sympy.expand(plain.subs(squares)), *symbols)
        return sympy.Matrix([[poly.coeff_monomial(term) for term in (*symbols, 1)]])


@dataclass(frozen=True, eq=False)
class SymbolicClosure:
    """The fourteen closure equations of chapter 9: ``left = right``, in frame 3.

    Parameters
    ----------
    loop : SymbolicLoop
    left : sympy.Matrix, shape (14, 1)
        p, l, p x l, (p.p) l - 2 (p.l) p, p.p and p.l of joints 3, 4 and 5 (m, 1, ...).
    right : sympy.Matrix, shape (14, 1)
        The same of joints 1 and 2 and the target.
    """

    loop: SymbolicLoop
    left: sympy.Matrix
    right: sympy.Matrix


def symbolic_decoupled(chain: SerialChain, *, parameters: str = "names") -> SymbolicDecoupled:
    """Derive the positioning and orientation equations of an arm with a spherical wrist.

    Parameters
    ----------
    chain : SerialChain
        Six revolute joints, the last three with axes through one point.
    parameters : {"names", "numbers"}, optional
        Symbols of the Denavit-Hartenberg table, or their values; what vanishes is 0 and right
        angles are exact either way.

    Returns
    -------
    SymbolicDecoupled
        Its expressions are derived when they are first asked for.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 4.4.1 and 4.4.2.

    Examples
    --------
    >>> from robomech_ros.dynamics.symbolic import symbolic_decoupled
    >>> from robomech_ros.robots import load_robot
    >>> puma = symbolic_decoupled(load_robot("puma560"))
    >>> puma.second
    Matrix([[y, -x, 0, 0, b_3]])
    >>> puma.orientation
    Matrix([[-eta, -2*xi, eta]])
    """
    decoupled_table(chain)
    loop = _loop(chain, parameters)
    centre = sympy.Matrix(sympy.symbols("x y z", real=True))
    return SymbolicDecoupled(loop, centre, sympy.Matrix(sympy.symbols("xi eta zeta", real=True)))


def symbolic_closure(chain: SerialChain, *, parameters: str = "names") -> SymbolicClosure:
    """Write down the fourteen closure equations of an arm of six revolute joints.

    Parameters
    ----------
    chain : SerialChain
        Chain of six revolute joints.
    parameters : {"names", "numbers"}, optional
        As for `symbolic_decoupled`.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 9.2.2.

    Examples
    --------
    >>> from robomech_ros.dynamics.symbolic import symbolic_closure
    >>> from robomech_ros.robots import load_robot
    >>> closure = symbolic_closure(load_robot("diestro"))
    >>> closure.left.shape, closure.left[5]
    ((14, 1), sin(theta_4)*sin(theta_5))
    """
    loop = _loop(chain, parameters)
    l, p = loop.link_rotation(5)[:, 2], loop.link_position(5)  # noqa: E741
    for i in (4, 3):
        l = loop.link_rotation(i) * l  # noqa: E741
        p = loop.link_position(i) + loop.link_rotation(i) * p
    left = _fourteen(l, p)
    l, p = loop.last_axis, loop.last_origin  # noqa: E741
    for i in (1, 2):
        l = loop.link_rotation(i).T * l  # noqa: E741
        p = loop.link_rotation(i).T * p - loop.link_vector(i)
    return SymbolicClosure(loop, left, _fourteen(l, p))


def _loop(chain: SerialChain, parameters: str) -> SymbolicLoop:
    check_chain(chain)
    by_name = as_choice("parameters", parameters, ("names", "numbers")) == "names"
    if chain.n != 6 or chain.types.any():
        raise BadValueError("chain", chain.name, "an arm of six revolute joints")
    entries = [[sympy.Symbol(f"q_{i}{j}", real=True) for j in (1, 2, 3)] for i in (1, 2, 3)]
    position = sympy.Matrix(sympy.symbols("p_x p_y p_z", real=True))
    symbols = symbolic_parameters(chain, GRAVITY, by_name=by_name)
    return SymbolicLoop(symbols, sympy.Matrix(entries), position)


def _fourteen(l: sympy.Matrix, p: sympy.Matrix) -> sympy.Matrix:  # noqa: E741
    square, along = p.dot(p), p.dot(l)
    rows: Sequence[sympy.Expr] = (*p, *l, *p.cross(l), *(square * l - 2 * along * p), square, along)
    return sympy.Matrix(rows)
