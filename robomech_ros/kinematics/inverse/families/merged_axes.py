"""Reduce a chain with mimic joints to an arm of fewer joints, which move independently.

Turns about neighbouring parallel axes add up, and an offset between two of them turns by the sum
of the turns before it.  Offsets with equal sums are merged, which leaves an arm with one joint for
each different sum.  This removes the rods of a palletizer, which keep its hand level: turns by q,
-q, r and -r leave three joints, which turn by q, r - q and -r.  Slides along one direction add up
as well.  The arm reaches every posture of the chain, with the joint values ``rows @ q``.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from robomech_ros.kinematics.inverse.families.six_joints import chain_of
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC, shift, turn_about_z, unpack_chain
from robomech_ros.typing import Array, IntArray

# Axes with such a sine between them are parallel, and offsets (m) of this length are none.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class MergedArm:
    """An arm of p joints that reaches all postures of a chain of n drives, and others.

    The rows (p, n) are the joint values of the arm for unit values of the drives.
    """

    chain: SerialChain
    rows: Array


@lru_cache(maxsize=64)
def merged_arm(chain: SerialChain) -> MergedArm:
    """Return the arm with the fewest joints that reaches all postures of a chain with followers."""
    assert chain.coupling is not None
    A, offsets, types = chain.coupling.matrix, chain.coupling.offset, chain.coupling.types
    constants = unpack_chain(chain.packed)
    links: list[Array] = []
    kinds: list[int] = []
    rows: list[Array] = []
    before = constants[0]
    for first, last in _runs(constants, types):
        run = slice(first, last + 1)
        poses = [np.eye(4)]
        for constant in constants[first + 1 : last + 1]:
            poses.append(poses[-1] @ constant)
        add_up = _slides if types[first] == PRISMATIC else _turns
        steps, sums, after = add_up(np.array(poses), A[run], offsets[run])
        for step, row in zip(steps, sums, strict=True):
            links.append(before @ step)
            kinds.append(int(types[first]))
            rows.append(row)
            before = np.eye(4)
        before = before @ after @ constants[last + 1]
    links.append(before)
    return MergedArm(chain_of(np.array(links), kinds), np.array(rows).reshape(-1, chain.n))


def _runs(constants: Array, types: IntArray) -> Iterator[tuple[int, int]]:
    """List the first and last joint of each run of parallel turns and of parallel slides."""
    first = 0
    for i in range(1, len(types) + 1):
        parallel = np.hypot(*constants[i][:2, 2]) < _ROUNDING
        if i == len(types) or types[i] != types[first] or not parallel:
            yield first, i - 1
            first = i


def _turns(poses: Array, A: Array, offsets: Array) -> tuple[list[Array], list[Array], Array]:
    """Add up turns about parallel axes, at these poses in the frame of the first (r, 4, 4).

    Returns the constant in front of each joint that remains, its row, and the last constant.
    """
    signs = np.sign(poses[:, 2, 2])
    sums, angles = np.cumsum(signs[:, None] * A, axis=0), np.cumsum(signs * offsets)
    # Axis positions; offsets turn as t = sum of R(sum_k) v_k, less R(last) of the last.
    points = np.zeros((len(poses), 4))
    points[:, :2] = poses[:, :2, 3]
    parts: dict[tuple[float, ...], Array] = {}
    for k in range(len(poses) - 1):
        offset = turn_about_z(angles[k]) @ (points[k + 1] - points[k])
        key = tuple(np.round(sums[k], 12) + 0.0)
        parts[key] = parts.get(key, np.zeros(4)) + offset
    still, last = (0.0,) * A.shape[1], tuple(np.round(sums[-1], 12) + 0.0)
    step = parts.pop(still, np.zeros(4))
    rest = parts.pop(last, np.zeros(4))
    moved = [(key, part) for key, part in parts.items() if np.linalg.norm(part) > _ROUNDING]
    if moved or last != still:
        moved.append((last, np.zeros(4)))
    steps, rows, before = [], [], np.zeros(A.shape[1])
    for key, part in moved:
        steps.append(shift(step[:3]))
        rows.append(np.array(key) - before)
        before, step = np.array(key), part
    # Pose of the last frame at zero: only the offsets of the coupling turn it.
    turned = turn_about_z(angles[-1])
    after = shift((step + rest - turned @ points[-1])[:3]) @ turned @ poses[-1]
    return steps, rows, after


def _slides(poses: Array, A: Array, offsets: Array) -> tuple[list[Array], list[Array], Array]:
    """Add up slides along one direction, drive by drive; the result is that of :func:`_turns`."""
    signs = np.sign(poses[:, 2, 2])
    total = signs @ A
    moving = np.flatnonzero(total)
    rows = [np.eye(len(total))[drive] * total[drive] for drive in moving]
    along = np.array([0.0, 0.0, float(signs @ offsets)])
    return [np.eye(4)] * len(rows), rows, shift(along) @ poses[-1]
