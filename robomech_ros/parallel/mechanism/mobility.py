"""Freedoms of closed loops, by the rank of their conditions in a posture."""

from collections.abc import Sequence

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinetostatics import jacobian
from robomech_ros.outcomes import Code
from robomech_ros.parallel.mechanism.loops import Loops
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

# Part of the greatest singular value below which one is zero.
_ZERO = 1e-8
# How far from home other postures are looked for (rad; of the size).
_REACHES = (0.1, 0.03, 0.01, 0.001)


def limb_twists(chains: Sequence[SerialChain], loops: Loops, q: Array) -> Array:
    """Return how joints (n,) move the ends of limbs, (limbs, 6, n), lengths over the size."""
    ends = np.zeros((len(chains), 6, len(q)))
    for i, chain in enumerate(chains):
        own = loops.joints_of(i)
        ends[i, :, own] = jacobian(chain, q[own])
    ends[:, 3:] /= loops.size
    return ends / loops.weights


def freedoms(chains: list[SerialChain], loops: Loops, q: Array) -> tuple[int, int]:
    """Count the freedoms of a closed posture (n,), and those that move the platform."""
    n, ends = len(q), limb_twists(chains, loops, q)
    values, rows = np.linalg.svd((ends[1:] - ends[0]).reshape(-1, n))[1:]
    rank = int((values > _ZERO * values[0]).sum())
    free = rows[rank:]
    moves = np.linalg.svd(ends[0] @ free.T, compute_uv=False)
    return n - rank, int((moves > _ZERO * max(1.0, float(values[0]))).sum())


def check_drives(chains: list[SerialChain], loops: Loops, home: Array) -> None:
    """Refuse limbs with more or fewer drives than freedoms, and drives that hold no platform."""
    count = int(loops.drives.max()) + 1
    q = _beside(loops, home)
    free, moving = freedoms(chains, loops, q)
    if free != count:
        expected = f"{free}, the freedoms that the closed loops leave"
        if moving < free:
            expected += f", of which {free - moving} move limbs only, not the platform"
        raise BadValueError("number of drives", count, expected)
    try:
        loops.rates(q, np.eye(count))
    except BadValueError:
        names = [name for chain in chains for name in chain.joint_names]
        driven = [name for name, drive in zip(names, loops.drives, strict=True) if drive >= 0]
        expected = "other joints: these do not hold the platform, in whatever posture"
        raise BadValueError("actuated joints", driven, expected) from None


def _beside(loops: Loops, home: Array) -> Array:
    """Return a posture near home that is not special, if the drives lead to one."""
    rng = np.random.default_rng(7)
    driven = np.flatnonzero(loops.drives >= 0)
    drives = home[driven]
    for reach in _REACHES:
        moved = drives + reach * rng.uniform(-1.0, 1.0, len(drives)) / loops.weights[driven]
        closed = loops.close(moved, home)
        if closed.status == Code.NONE:
            return closed.q
    return home
