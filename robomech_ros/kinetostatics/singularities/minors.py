"""The largest minors of the Jacobian as functions of the joints, and bounds of them.

In the frame of the tip the minors of an arm are of degree two in the cosine and sine of each angle
and in each displacement: turning one joint turns the columns of the joints before it as twists,
and of those only two angular and two linear components turn.
"""

import functools
import itertools
import math
from dataclasses import dataclass

import numpy as np
from scipy.special import comb

from robomech_ros.errors import BadValueError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics.forward import forward_kinematics
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.kinetostatics.jacobians import jacobian
from robomech_ros.kinetostatics.singularities.generic_rank import generic_rank
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array, IntArray

_MOST_JOINTS = 8
# A minor this small (of the largest) in all postures, or a coefficient this small (of the largest),
# is rounding.
_NO_MINOR = 1e-12
_NO_COEFFICIENT = 1e-14
# Rounding of bounds, over the sum of all coefficients: sampling, the change to Bernstein form and
# the halving lose a digit or two for each of up to six joints.
_ROUNDING = 1e-11
# Angles at which a polynomial of degree two in cosine and sine is known, and displacements, over
# the size, for one of degree two.
_ANGLES = 2.0 * math.pi / 5.0 * np.arange(5)
_SLIDES = np.array([-1.0, 0.0, 1.0])
# 1, cos x, sin x, cos 2x, sin 2x times (1 + t^2)^2, in powers of t = tan(x/2); and the first three
# times 1 + t^2.
_QUARTIC = np.array(
    [
        [1.0, 0.0, 2.0, 0.0, 1.0],
        [1.0, 0.0, 0.0, 0.0, -1.0],
        [0.0, 2.0, 0.0, 2.0, 0.0],
        [1.0, 0.0, -6.0, 0.0, 1.0],
        [0.0, 4.0, 0.0, -4.0, 0.0],
    ]
)
_QUADRATIC = np.array([[1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [0.0, 2.0, 0.0]])


@dataclass(frozen=True, eq=False)
class Minors:
    """The largest minors of an arm's Jacobian, linear rows over its size (m), in the tip's frame.

    Each has a set of rows and one of columns (m, r), and depends on the values of the ``joints``.
    The tensor (m, ...) has one axis for each of these: coefficients of 1, cos q, sin q and perhaps
    cos 2q, sin 2q, or of powers of q over the size.  Bounds of a combination of minors, its weights
    of norm 1, may be off by the margin.
    """

    chain: SerialChain
    size: float
    row_sets: IntArray
    column_sets: IntArray
    joints: tuple[int, ...]
    tensor: Array
    margin: float

    @property
    def count(self) -> int:
        """Number of minors."""
        return len(self.row_sets)

    def at(self, q: Array) -> Array:
        """Evaluate the minors in one posture, shape (m,)."""
        values: Array = _evaluated(self.chain, q[None], self.size, self.row_sets, self.column_sets)
        return values[:, 0]

    def bernstein(self, middle: Array, reach: Array) -> Array:
        """Return Bernstein coefficients (m, ...) over a box around the middle (k,) (rad or m).

        The reach (k,) is half of each interval, of an angle the tangent of a quarter of it.  Minors
        are multiplied by ``(1 + t^2)^d`` for each angle with functions up to cos dq.
        """
        tensor = self.tensor
        for axis, joint in enumerate(self.joints, start=1):
            i, count = axis - 1, tensor.shape[axis]
            if self.chain.types[joint] == PRISMATIC:
                powers = _shifted(count, middle[i] / self.size, reach[i] / self.size)
            else:
                basis = _QUARTIC if count == 5 else _QUADRATIC
                powers = _turned(count, middle[i]) @ basis * reach[i] ** np.arange(count)
            change = powers @ _from_powers(count - 1)
            tensor = np.moveaxis(np.moveaxis(tensor, axis, -1) @ change, -1, axis)
        return tensor


@functools.lru_cache(maxsize=16)
def minors_of(chain: SerialChain) -> Minors:
    """Find the largest minors of an arm that do not always vanish."""
    chain.require_uncoupled(
        instead="with mimic joints nearest_singular_posture finds singular postures, without proof"
    )
    if not 1 <= chain.n <= _MOST_JOINTS:
        named = f"{chain.name} with {counted(chain.n, 'joint')}"
        raise BadValueError("chain", named, f"one of 1 to {_MOST_JOINTS} joints")
    size, rank = arm_size(chain), generic_rank(chain)
    pairs = itertools.product(
        itertools.combinations(range(6), rank), itertools.combinations(range(chain.n), rank)
    )
    row_sets, column_sets = (np.array(sets) for sets in zip(*pairs, strict=True))
    inner = tuple(range(1, chain.n - 1))
    slides = [chain.types[joint] == PRISMATIC for joint in inner]
    nodes = [size * _SLIDES if slide else _ANGLES for slide in slides]
    q = np.zeros((math.prod(len(one) for one in nodes), chain.n))
    if inner:
        q[:, 1:-1] = np.stack(np.meshgrid(*nodes, indexing="ij"), axis=-1).reshape(len(q), -1)
    values = _evaluated(chain, q, size, row_sets, column_sets)
    largest = np.abs(values).max(axis=1)
    kept = largest > _NO_MINOR * largest.max()
    tensor = values[kept].reshape(-1, *(len(one) for one in nodes))
    for axis, slide in enumerate(slides, start=1):
        tensor = np.moveaxis(np.moveaxis(tensor, axis, -1) @ _to_coefficients(slide), -1, axis)
    joints, short = _trimmed(tensor, inner, slides)
    dropped = float(np.abs(tensor).sum() - np.abs(short).sum())
    margin = _ROUNDING * float(np.abs(short).sum()) + 4.0 ** len(inner) * max(dropped, 0.0)
    return Minors(chain, size, row_sets[kept], column_sets[kept], joints, short, margin)


def _evaluated(
    chain: SerialChain, q: Array, size: float, row_sets: IntArray, column_sets: IntArray
) -> Array:
    """Return minors (m, k) in postures (k, n); the first joint and the last are set to zero."""
    q = q.copy()
    q[:, 0] = q[:, -1] = 0.0
    halves = jacobian(chain, q).reshape(len(q), 2, 3, chain.n)
    turn = forward_kinematics(chain, q)[:, None, :3, :3]
    J: Array = (np.swapaxes(turn, -1, -2) @ halves).reshape(len(q), 6, chain.n)
    J[:, 3:] /= size
    if len(q) == 1:
        one: Array = np.linalg.det(J[0][row_sets[:, :, None], column_sets[:, None, :]])
        return one[:, None]
    return np.array(
        [
            np.linalg.det(J[:, rows[:, None], columns])
            for rows, columns in zip(row_sets, column_sets, strict=True)
        ]
    )


def _to_coefficients(slide: bool) -> Array:
    """Return the matrix from values at the nodes to coefficients, both as rows."""
    if slide:
        at_nodes = _SLIDES[:, None] ** np.arange(3)
    else:
        x = _ANGLES
        at_nodes = np.column_stack(
            (np.ones(5), np.cos(x), np.sin(x), np.cos(2.0 * x), np.sin(2.0 * x))
        )
    return np.linalg.inv(at_nodes).T


def _trimmed(
    tensor: Array, joints: tuple[int, ...], slides: list[bool]
) -> tuple[tuple[int, ...], Array]:
    """Leave out functions that do not occur, and joints of which none does."""
    least = _NO_COEFFICIENT * float(np.abs(tensor).max())
    kept, axis = [], 1
    for joint, slide in zip(joints, slides, strict=True):
        others = tuple(k for k in range(tensor.ndim) if k != axis)
        used = np.flatnonzero(np.abs(tensor).max(axis=others) > least).max()
        count = used + 1 if slide or used == 0 else (3 if used < 3 else 5)
        tensor = np.take(tensor, range(count), axis=axis)
        if count == 1:
            tensor = tensor.squeeze(axis)
        else:
            kept.append(joint)
            axis += 1
    return tuple(kept), tensor


def _turned(count: int, middle: float) -> Array:
    """Return functions of q = middle + x as combinations, in rows, of those of x."""
    turn = np.eye(count)
    for k in range(1, (count + 1) // 2):
        c, s = math.cos(k * middle), math.sin(k * middle)
        turn[2 * k - 1 : 2 * k + 1, 2 * k - 1 : 2 * k + 1] = [[c, -s], [s, c]]
    return turn


def _shifted(count: int, middle: float, reach: float) -> Array:
    """Return powers of middle + reach u, in rows, in powers of u."""
    j = np.arange(count)
    i = j[:, None]
    return np.asarray(comb(i, j) * middle ** np.maximum(i - j, 0) * reach**j)


@functools.lru_cache(maxsize=8)
def _from_powers(degree: int) -> Array:
    """Return the Bernstein coefficients, in rows, of the powers of u over -1 <= u <= 1."""
    k = np.arange(degree + 1)
    i = k[:, None]
    # Those of powers of s = (u + 1) / 2.
    unit = comb(k, i) / comb(degree, i)
    return np.asarray(comb(i, k) * 2.0**k * (-1.0) ** (i - k) @ unit)
