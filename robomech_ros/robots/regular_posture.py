"""A posture to begin with, for arms whose description gives none: regular, and inside the limits.

A fixed number of postures, spread evenly over the middle of the limits, are compared; the same arm
gets the same posture on every machine.

References
----------
Roberts, M., The unreasonable effectiveness of quasirandom sequences, 2018: the sequence used here.
"""

from collections.abc import Callable

import numpy as np

from robomech_ros.robots.chain_layout import REVOLUTE
from robomech_ros.typing import Array, BoolArray, IntArray

_SAMPLES = 512
# The part of the range of each joint in which postures are looked for.
_INNER = 0.8
# Below this part of the largest singular value a direction counts as lost in all postures.
_LOST = 1e-6
# Half of the range (m) of a slide without limits in which postures are looked for.
_SLIDE = 0.5
# How much a posture counts less at the ends of all ranges, and with a joint below the base by
# more than a part of all lengths.
_FAR, _BELOW = 0.3, 0.5
# The middle is taken where it is at least this part as good as the best: it looks familiar.
_GOOD = 0.3
_LOW = 0.02
# Numbers in a row of a packed chain: type, rotation and origin.
_WIDTH = 13


def regular_posture(
    packed: Array,
    types: IntArray,
    lower: Array,
    upper: Array,
    joint_values: Callable[[Array], Array] = lambda q: q,
) -> Array:
    """Return a posture far from singular ones and from the limits, near the middle of these.

    - ``packed``: the chain as :func:`pack_chain` lays it out, shape (n + 1, 13).
    - ``types``: 0 revolute, 1 prismatic, shape (n,).
    - ``lower``, ``upper``: limits (rad or m), infinite where there is none, shape (n,).
    - ``joint_values``: gives the values (k, m) of all joints on the chain at those (k, n) that move
      by themselves.

    Returns an array (n,) (rad or m): the middle of the limits if that is regular, else rounded to
    hundredths.
    """
    n = len(lower)
    if not n:
        return np.zeros(0)
    middle, half = _windows(types != REVOLUTE, lower, upper)
    away = _spread(n) * _INNER
    # Turning or moving the whole arm makes no posture more regular.
    away[:, 0] = 0.0
    q = np.ascontiguousarray(middle + away * half)
    ratios = _conditioning(packed, types, q) * _standing(packed[:, :_WIDTH], joint_values(q))
    score = ratios * (1.0 - _FAR * np.abs(away).mean(axis=1))
    if score[0] >= _GOOD * score.max():
        return q[0]
    return np.clip(np.round(q[int(np.argmax(score))], 2), lower, upper)


def _windows(slides: BoolArray, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Find the middles and halves of the ranges, of one turn at most where joints turn."""
    with np.errstate(invalid="ignore"):
        middle = np.where(np.isfinite(upper - lower), 0.5 * (lower + upper), 0.0)
    half = np.where(slides, _SLIDE, np.pi)
    middle = np.clip(middle, lower, upper)
    finite = np.isfinite(upper - lower)
    half[finite] = np.minimum(0.5 * (upper - lower), np.where(slides, np.inf, np.pi))[finite]
    return middle, half


def _spread(n: int) -> Array:
    """Spread points evenly over the cube from -1 to 1 in n directions; the first is its middle."""
    root = 2.0
    for _ in range(50):
        root = (1.0 + root) ** (1.0 / (n + 1))
    steps = root ** -np.arange(1.0, n + 1.0)
    cells: Array = (0.5 + np.arange(_SAMPLES)[:, None] * steps) % 1.0
    return 2.0 * cells - 1.0


def _standing(packed: Array, values: Array) -> Array:
    """Return 1 for postures with all joints above the base, less for others."""
    # Compiled code is loaded only where somebody asks for this posture.
    from robomech_ros._kernels.chain.serial import forward

    lowest, poses = np.zeros(len(values)), np.empty((len(values), 4, 4))
    rows, joints = np.ascontiguousarray(packed), np.ascontiguousarray(values)
    for count in range(2, len(rows) + 1):
        forward(rows[:count], joints, poses)
        lowest = np.minimum(lowest, poses[:, 2, 3])
    reach = np.linalg.norm(rows[:, -3:], axis=1).sum()
    return np.where(lowest < -_LOW * reach, _BELOW, 1.0)


def _conditioning(packed: Array, types: IntArray, q: Array) -> Array:
    """Return least over largest singular values, lengths over the mean axis distance."""
    from robomech_ros._kernels.chain.serial import jacobian

    J = np.empty((len(q), 6, q.shape[1]))
    jacobian(packed, q, J, np.empty((4, 4)))
    arms = np.linalg.norm(J[:, 3:, types == REVOLUTE], axis=1)
    length = float(arms.mean()) if arms.size and arms.any() else 1.0
    J[:, 3:] /= length
    values = np.linalg.svd(J, compute_uv=False)
    rank = max(int((values > _LOST * values.max()).sum(axis=1).max()), 1)
    return values[:, rank - 1] / np.maximum(values[:, 0], np.finfo(float).tiny)
