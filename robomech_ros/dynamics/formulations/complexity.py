"""Number of operations of the recursive algorithms, counted as they run.

References
----------
Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 7.6.2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from robomech_ros.dynamics.formulations.plain_recursions import (
    PlainLink,
    cholesky_solution,
    composite_inertia,
    newton_euler,
    orthogonal_complement_inertia,
)
from robomech_ros.spatial.arrays import as_choice, whole_number
from robomech_ros.typing import Array

ALGORITHMS = (
    "inverse: newton-euler",
    "mass matrix: composite bodies",
    "mass matrix: orthogonal complement",
    "forward: composite bodies",
    "forward: orthogonal complement",
)
_MOST = 50


@dataclass
class Operations:
    """Operation counts; a division counts as a multiplication, a sign as nothing."""

    multiplications: int = 0
    additions: int = 0


@dataclass(frozen=True)
class Counted:
    """A number that counts in its tally what is done with it.

    The whole numbers 0 and 1 beside it are known beforehand: what they make superfluous is not
    counted.
    """

    value: float
    tally: Operations = field(repr=False)

    def __add__(self, other: Scalar) -> Counted:
        if isinstance(other, int) and other == 0:
            return self
        self.tally.additions += 1
        return Counted(self.value + _value(other), self.tally)

    __radd__ = __add__

    def __sub__(self, other: Scalar) -> Counted:
        return self + (-other)

    def __rsub__(self, other: Scalar) -> Counted:
        return -self + other

    def __neg__(self) -> Counted:
        return Counted(-self.value, self.tally)

    def __mul__(self, other: Scalar) -> Scalar:
        if isinstance(other, int) and other == 0:
            return 0
        if isinstance(other, int) and abs(other) == 1:
            return Counted(self.value * other, self.tally)
        self.tally.multiplications += 1
        return Counted(self.value * _value(other), self.tally)

    __rmul__ = __mul__

    def __truediv__(self, other: Scalar) -> Counted:
        self.tally.multiplications += 1
        return Counted(self.value / _value(other), self.tally)


Scalar: TypeAlias = "Counted | float | int"


def operation_counts(algorithm: str, n: int) -> Operations:
    """Count the operations of an algorithm for n revolute joints.

    The parameters are general: no twist is a right angle, no length 0, and the bodies have all
    products of inertia.  Only the base is at rest, with its first axis along gravity.  Sines,
    cosines and constants of the bodies are at hand.

    Parameters
    ----------
    algorithm : str
        One of :data:`ALGORITHMS`.
    n : int
        1 to 50.
    """
    chosen = as_choice("algorithm", algorithm, ALGORITHMS)
    n = whole_number("n", n, f"a whole number from 1 to {_MOST}", 1, _MOST)
    tally = Operations()

    def counted(value: float) -> Counted:
        return Counted(float(value), tally)

    rng = np.random.default_rng(n)
    a, b, alpha, theta = rng.uniform(0.3, 1.2, (4, n))
    bodies = rng.uniform(0.3, 1.2, (n, 10))
    bodies[:, 4:] = [3.0, 0.1, 0.2, 3.0, 0.3, 3.0]
    links = plain_links(a, b, alpha, theta, bodies, counted)
    rates = [[counted(one) for one in row] for row in rng.uniform(0.3, 1.2, (3, n))]
    gravity: list[Any] = [0, 0, counted(-9.81)]
    _run(chosen, links, rates, gravity)
    return tally


def _run(
    algorithm: str, links: Sequence[PlainLink], rates: Sequence[Any], gravity: Sequence[Any]
) -> Any:
    qd, qdd, tau = rates
    kind, method = algorithm.split(": ")
    if kind == "inverse":
        return newton_euler(links, qd, qdd, gravity)
    inertia = composite_inertia if method.startswith("composite") else orthogonal_complement_inertia
    matrix = inertia(links)
    if kind == "mass matrix":
        return matrix
    bias = newton_euler(links, qd, [0] * len(links), gravity)
    return cholesky_solution(matrix, [a - b for a, b in zip(tau, bias, strict=True)])


def plain_links(
    a: Array, b: Array, alpha: Array, theta: Array, bodies: Array, number: Any = float
) -> list[PlainLink]:
    """Lay out revolute links, by Denavit-Hartenberg parameters (n,), for the plain recursions.

    Bodies (n, 10) have mass (kg), mass centre from the origin of frame i + 1 in its axes (m), and
    the moments xx, xy, xz, yy, yz, zz about it (kg m^2).  ``number`` makes the numbers.
    """
    numbers = np.frompyfunc(number, 1, 1)
    links = []
    for i in range(len(a)):
        c, s = math.cos(alpha[i]), math.sin(alpha[i])
        step = np.array([a[i], b[i] * s, b[i] * c])
        inertia = bodies[i, [4, 5, 6, 5, 7, 8, 6, 8, 9]].reshape(3, 3)
        root = np.linalg.cholesky(inertia).T
        links.append(
            PlainLink(
                turn=(number(math.cos(theta[i])), number(math.sin(theta[i]))),
                twist=(number(c), number(s)),
                step=numbers(step),
                mass=number(bodies[i, 0]),
                com=numbers(step + bodies[i, 1:4]),
                inertia=numbers(inertia),
                root=np.where(np.tri(3, dtype=bool).T, numbers(root), 0),
                mass_root=number(math.sqrt(bodies[i, 0])),
            )
        )
    return links


def _value(number: Scalar) -> float:
    return number.value if isinstance(number, Counted) else float(number)
