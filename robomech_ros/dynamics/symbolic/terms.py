"""Polynomials in parameters, cosines and sines, in a form that vanishes where the sum does.

Products are formed in a polynomial ring with ``s^2 = 1 - c^2`` for the cosine c and sine s of each
angle.  Where several joints have parallel axes, the answer is written with the cosines and sines of
sums of their angles: ``c2 c3 - s2 s3`` becomes ``c23``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from operator import sub
from typing import Any

import numpy as np
import sympy
from sympy.polys.rings import PolyRing

# Polynomials of SymPy's rings, which have no types.
Poly = Any
# Fractions with greater denominators are numbers that were measured.
_LONGEST_DENOMINATOR = 64
_Harmonics = dict[tuple[int, ...], tuple[Fraction, Fraction]]


@dataclass(frozen=True)
class Angle:
    """An angle whose cosine and sine are generators; angles of one group are added up."""

    symbol: sympy.Symbol
    group: int


@dataclass(eq=False)
class TermRing:
    """The ring of some parameters and of the cosines and sines of some angles.

    ``times`` is the product of arrays of polynomials, entry by entry.
    """

    parameters: Sequence[sympy.Symbol]
    angles: Sequence[Angle]
    times: Any = field(init=False)
    _ring: Any = field(init=False)
    _places: Mapping[sympy.Symbol, int] = field(init=False)

    def __post_init__(self) -> None:
        names = list(self.parameters)
        for angle in self.angles:
            names += [sympy.Symbol(f"cos_{angle.symbol}"), sympy.Symbol(f"sin_{angle.symbol}")]
        self._ring = PolyRing(names or [sympy.Symbol("unused")], sympy.QQ)
        self.times = np.frompyfunc(self.product, 2, 1)
        first = len(self.parameters)
        self._places = {one: i for i, one in enumerate(self.parameters)} | {
            angle.symbol: first + 2 * k for k, angle in enumerate(self.angles)
        }

    def number(self, value: sympy.Rational | int) -> Poly:
        """Return a constant."""
        return self._ring.ground_new(sympy.QQ.from_sympy(sympy.Rational(value)))

    def parameter(self, symbol: sympy.Symbol) -> Poly:
        """Return a parameter."""
        return self._ring.gens[self._places[symbol]]

    def cosine(self, symbol: sympy.Symbol) -> Poly:
        """Return the cosine of an angle."""
        return self._ring.gens[self._places[symbol]]

    def sine(self, symbol: sympy.Symbol) -> Poly:
        """Return the sine of an angle."""
        return self._ring.gens[self._places[symbol] + 1]

    def product(self, one: Poly, other: Poly) -> Poly:
        """Multiply, and write squares of sines by cosines."""
        if not one or not other:
            return self._ring.zero
        return self._reduced(one * other)

    def derivative(self, poly: Poly, symbol: sympy.Symbol) -> Poly:
        """Differentiate by a parameter or an angle."""
        place = self._places[symbol]
        gens = self._ring.gens
        if place < len(self.parameters):
            return poly.diff(gens[place])
        c, s = gens[place], gens[place + 1]
        return self._reduced(poly.diff(s) * c - poly.diff(c) * s)

    def expression(self, poly: Poly) -> sympy.Expr:
        """Write a polynomial with cosines and sines of sums of angles, ordered by these."""
        sorted_by_angles: dict[tuple[Any, ...], Poly] = {}
        for monomial, coefficient in poly.terms():
            head = monomial[: len(self.parameters)]
            rest = (0,) * (len(monomial) - len(head))
            for basis, factor in self._angular(monomial[len(head) :]).items():
                share = sympy.QQ(factor.numerator, factor.denominator) * coefficient
                term = self._ring.term_new((*head, *rest), share)
                sorted_by_angles[basis] = sorted_by_angles.get(basis, self._ring.zero) + term
        terms = [
            _factored(part) * self._trigonometric(basis)
            for basis, part in sorted(sorted_by_angles.items())
            if part
        ]
        return sympy.Add(*terms)

    def _reduced(self, poly: Poly) -> Poly:
        for k in range(len(self.angles)):
            place = len(self.parameters) + 2 * k
            high = {m: v for m, v in poly.items() if m[place + 1] > 1}
            if not high:
                continue
            c = self._ring.gens[place]
            kept = self._ring.from_dict({m: v for m, v in poly.items() if m[place + 1] < 2})
            halves: dict[int, dict[tuple[int, ...], Any]] = {}
            for monomial, value in high.items():
                exponent = monomial[place + 1]
                lowered = (*monomial[: place + 1], exponent % 2, *monomial[place + 2 :])
                row = halves.setdefault(exponent // 2, {})
                row[lowered] = row.get(lowered, 0) + value
            for power, row in halves.items():
                kept += self._ring.from_dict(row) * (1 - c**2) ** power
            poly = kept
        return poly

    def _angular(self, exponents: tuple[int, ...]) -> dict[tuple[Any, ...], Fraction]:
        """Write a product of powers of cosines and sines in the basis of its groups."""
        found: dict[tuple[Any, ...], Fraction] = {(): Fraction(1)}
        for members in self._groups():
            powers = tuple((exponents[2 * k], exponents[2 * k + 1]) for k in members)
            own: dict[tuple[Any, ...], Fraction] | None
            if len(members) == 1:
                own = {(("power", members, powers[0]),): Fraction(1)} if any(powers[0]) else None
            else:
                own = {
                    ((kind, members, sums),) if any(sums) else (): value
                    for (kind, sums), value in _sums(powers).items()
                }
            if own is not None:
                found = {
                    before + after: x * y for before, x in found.items() for after, y in own.items()
                }
        return found

    def _groups(self) -> list[tuple[int, ...]]:
        groups: dict[int, list[int]] = {}
        for k, angle in enumerate(self.angles):
            groups.setdefault(angle.group, []).append(k)
        return [tuple(members) for members in groups.values()]

    def _trigonometric(self, basis: tuple[Any, ...]) -> sympy.Expr:
        factors = []
        for kind, members, exponents in basis:
            symbols = [self.angles[k].symbol for k in members]
            if kind == "power":
                factors.append(sympy.cos(symbols[0]) ** exponents[0])
                factors.append(sympy.sin(symbols[0]) ** exponents[1])
            else:
                angle = sum(n * symbol for n, symbol in zip(exponents, symbols, strict=True))
                factors.append(sympy.cos(angle) if kind == "cos" else sympy.sin(angle))
        return sympy.Mul(*factors)


def _factored(poly: Poly) -> sympy.Expr:
    """Take the common factor of all terms out of their sum; long fractions become decimals."""
    common = tuple(map(min, zip(*poly.monoms(), strict=True)))
    rest = poly.ring.from_dict(
        {tuple(map(sub, monomial, common)): value for monomial, value in poly.terms()}
    )
    content, rest = rest.primitive()
    if content.denominator > _LONGEST_DENOMINATOR:
        content, rest = sympy.QQ(1), rest * content
    if rest.LC < 0:
        content, rest = -content, -rest
    product = poly.ring.term_new(common, content).as_expr() * rest.as_expr()
    long = [one for one in product.atoms(sympy.Rational) if one.q > _LONGEST_DENOMINATOR]
    return product.xreplace({one: sympy.Float(float(one)) for one in long})


@cache
def _sums(powers: tuple[tuple[int, int], ...]) -> dict[tuple[str, tuple[int, ...]], Fraction]:
    """Write a product of ``cos^a sin^b`` of several angles by cosines and sines of their sums."""
    harmonics: _Harmonics = {(0,) * len(powers): (Fraction(1), Fraction(0))}
    half = Fraction(1, 2)
    for k, (cosines, sines) in enumerate(powers):
        # cos = (e + 1/e) / 2 and sin = (e - 1/e) / 2i, with e = exp(i angle).
        for _ in range(cosines):
            harmonics = _times(harmonics, k, (half, Fraction(0)), (half, Fraction(0)))
        for _ in range(sines):
            harmonics = _times(harmonics, k, (Fraction(0), -half), (Fraction(0), half))
    found: dict[tuple[str, tuple[int, ...]], Fraction] = {}
    for sums, (real, imaginary) in harmonics.items():
        first = next((n for n in sums if n), 0)
        if first == 0:
            found["cos", sums] = real
        elif first > 0:
            found["cos", sums], found["sin", sums] = 2 * real, -2 * imaginary
    return {key: value for key, value in found.items() if value}


def _times(
    harmonics: _Harmonics, k: int, up: tuple[Fraction, Fraction], down: tuple[Fraction, Fraction]
) -> _Harmonics:
    product: _Harmonics = {}
    for sums, (a, b) in harmonics.items():
        for step, (x, y) in ((1, up), (-1, down)):
            key = (*sums[:k], sums[k] + step, *sums[k + 1 :])
            real, imaginary = product.get(key, (Fraction(0), Fraction(0)))
            product[key] = (real + a * x - b * y, imaginary + a * y + b * x)
    return product
