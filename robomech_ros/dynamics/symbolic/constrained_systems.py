"""Closed-form dynamics of systems with loops and wheels, by the natural orthogonal complement.

The twists of all bodies are ``t = T u`` for the rates u of the drives, so the equations of motion
are ``I u' + C u = tau`` with ``I = T^T M T`` and ``C = T^T M T' + T^T W M T``.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 12.3 to 12.5.
Saha and Angeles, Dynamics of nonholonomic mechanical systems using a natural orthogonal
complement, ASME J. Applied Mechanics 58 (1991), pp. 238-243.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy

from robomech_ros.errors import BadValueError
from robomech_ros.numerics.arrays import check_kind, finite_number
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array

_NAMES = {"inertia": "I", "coupling": "C", "shape": "T"}


@dataclass(frozen=True, eq=False)
class SymbolicBody:
    """A body of a system, in its own axes, which turn about the vertical.

    Parameters
    ----------
    name : str
    mass : Expr
    inertia : Matrix, shape (3, 3)
        About the mass centre.
    T, T_dot : Matrix, shape (6, m)
        Matrix from the rates to the twist [angular velocity; velocity of the mass centre], and its
        derivative in an inertial frame.
    """

    name: str
    mass: sympy.Expr
    inertia: sympy.Matrix
    T: sympy.Matrix
    T_dot: sympy.Matrix


@dataclass(frozen=True, eq=False)
class SymbolicSystem:
    """Equations of motion ``I u' + C u = tau`` of a system, for the rates u of its drives.

    Parameters
    ----------
    rates : tuple of Symbol
        u (rad/s).
    symbols : tuple of Symbol
        Dimensions and angles (m, rad).
    masses : tuple of Symbol
        Masses and inertias (kg, kg m^2).
    definitions : dict of Symbol to Expr
        Abbreviations, each in terms of symbols, rates and those before it.
    bodies : tuple of SymbolicBody
    """

    rates: tuple[sympy.Symbol, ...]
    symbols: tuple[sympy.Symbol, ...]
    masses: tuple[sympy.Symbol, ...]
    definitions: dict[sympy.Symbol, sympy.Expr]
    bodies: tuple[SymbolicBody, ...]

    @property
    def shape(self) -> sympy.Matrix:
        """Twist-shaping matrix T of all bodies, shape (6 r, m)."""
        return sympy.Matrix.vstack(*(body.T for body in self.bodies))

    @cached_property
    def inertia(self) -> sympy.Matrix:
        """Generalised inertia ``I = T^T M T``, shape (m, m) (kg m^2)."""
        return self._sum(lambda body: body.T.T * _momenta(body, body.T))

    @cached_property
    def coupling(self) -> sympy.Matrix:
        """Matrix ``C = T^T M T' + T^T W M T`` of Coriolis and centrifugal torques, (m, m)."""
        u = sympy.Matrix(self.rates)

        def part(body: SymbolicBody) -> sympy.Matrix:
            momentum, turn = _momenta(body, body.T), body.T[:3, :] * u
            gyroscopic = sympy.Matrix.hstack(
                *(turn.cross(momentum[:3, j]) for j in range(momentum.cols))
            )
            return body.T.T * _momenta(body, body.T_dot) + body.T[:3, :].T * gyroscopic

        return self._sum(part)

    def _sum(self, part: Callable[[SymbolicBody], sympy.Matrix]) -> sympy.Matrix:
        total = sympy.zeros(len(self.rates), len(self.rates))
        for body in self.bodies:
            total += part(body)
        return total.applyfunc(lambda entry: _collected(entry, self.masses))

    def expression(self, what: str) -> sympy.Matrix:
        """Return "inertia", "coupling" or "shape", the twist-shaping matrix T."""
        return getattr(self, as_choice("expression", what, tuple(_NAMES)))

    def text(self, what: str) -> str:
        """Return an expression as text, one entry a line, with its abbreviations."""
        matrix = self.expression(what)
        lines = [f"{_NAMES[what]}[{i}, {j}] = {entry}" for i, j, entry in _entries(matrix, what)]
        return "\n".join([*lines, *(f"# {s} = {e}" for s, e in self._used(matrix))])

    def latex(self, what: str) -> str:
        """Return an expression and its abbreviations as a LaTeX ``align*`` environment."""
        matrix = self.expression(what)
        pairs = [(f"{_NAMES[what]}_{{{i}{j}}}", entry) for i, j, entry in _entries(matrix, what)]
        pairs += [(sympy.latex(symbol), meant) for symbol, meant in self._used(matrix)]
        body = " \\\\\n".join(f"{left} &= {sympy.latex(right)}" for left, right in pairs)
        return f"\\begin{{align*}}\n{body}\n\\end{{align*}}"

    def compiled(self) -> Callable[[Mapping[str, float]], tuple[Array, Array]]:
        """Compile a function of the values of all symbols and rates.

        Returns
        -------
        callable
            From a mapping of names to numbers to I and C, shape (m, m) each; raises BadValueError
            for a missing or an unknown name.
        """
        arguments = (*self.symbols, *self.masses, *self.rates)
        names = [str(one) for one in arguments]
        definitions = list(self.definitions.items())
        both = sympy.lambdify(
            arguments,
            [self.inertia, self.coupling],
            modules="numpy",
            cse=lambda expressions: (definitions, expressions),
        )

        def evaluate(values: Mapping[str, float]) -> tuple[Array, Array]:
            check_kind("values", values, Mapping, "a mapping of names to numbers")
            if wrong := sorted(map(str, set(values) ^ set(names))):
                raise BadValueError("names of values", wrong, f"exactly {', '.join(names)}")
            numbers = np.array([finite_number(name, values[name], "in SI units") for name in names])
            with np.errstate(all="ignore"):
                found = [np.asarray(one, np.float64) for one in both(*numbers)]
            inertia, coupling = found
            if not (np.isfinite(inertia).all() and np.isfinite(coupling).all()):
                expected = "lengths other than 0, a regular posture, and no overflow"
                raise BadValueError("values", dict(values), expected)
            return inertia, coupling

        return evaluate

    def _used(self, matrix: sympy.Matrix) -> list[tuple[sympy.Symbol, sympy.Expr]]:
        """Return the abbreviations of an expression, nested ones too, in order of definition."""
        needed, found = set(matrix.free_symbols), []
        for symbol, meant in reversed(self.definitions.items()):
            if symbol in needed:
                needed |= meant.free_symbols
                found.append((symbol, meant))
        return found[::-1]


def _momenta(body: SymbolicBody, twists: sympy.Matrix) -> sympy.Matrix:
    """Return the momenta of a body for twists (6, m)."""
    return (body.inertia * twists[:3, :]).col_join(body.mass * twists[3:, :])


def _collected(expression: sympy.Expr, masses: Sequence[sympy.Symbol]) -> sympy.Expr:
    """Write an entry as a sum of masses and inertias times factors of the motion."""
    squares = sympy.Wild("x")
    flat = sympy.expand(expression).replace(sympy.sin(squares) ** 2, 1 - sympy.cos(squares) ** 2)
    parts = sympy.collect(sympy.expand(flat), masses, evaluate=False)
    return sympy.Add(*(mass * sympy.factor(part) for mass, part in parts.items()))


def _entries(matrix: sympy.Matrix, what: str) -> list[tuple[int, int, sympy.Expr]]:
    """List entries, from 1: the upper triangle of the inertia, and the nonzero entries of T."""
    return [
        (i + 1, j + 1, matrix[i, j])
        for i in range(matrix.rows)
        for j in range(i if what == "inertia" else 0, matrix.cols)
        if what != "shape" or matrix[i, j] != 0
    ]
