"""Fixed gains with which an arm neither chatters nor swings, whatever its posture."""

import sys

import numpy as np
from numpy.typing import NDArray

from robomech_ros.dynamics.systems import DynamicSystem
from robomech_ros.errors import BadValueError
from robomech_ros.typing import Array

# Postures from which the inertias come that fixed gains suit, fewer for arms of many joints, whose
# mass matrices have no more entries than that together.
_POSTURES = 4096
_MOST_ENTRIES = 200_000
# Of these so many in which the arm is not to chatter: those in which each joint feels least.
_WORST = 224
_ROUNDS = 50
# Postures of one round that are looked at one by one.
_PER_ROUND = 12
# Most that damping and half of the stiffness take off a rate in one period, over the rate: from 2
# on it grows.
_QUIET = 1.6
# Turn of an error's oscillation in a period (rad) beyond which no joint can be quiet.
_LARGEST_TURN = 2.0


def effective_inertias(system: DynamicSystem, turn: float, damping: float) -> tuple[Array, Array]:
    """Return the inertias (m,) with which drives of fixed gains are to be stiff, and to be damped.

    They are in kg m^2 or kg, for a turn that is the bandwidth times the period (rad), and a damping
    ratio.

    Joints that are nearly parallel feel much less inertia with the others free than with them at
    rest: stiff for the one and damped for the other, they neither chatter nor swing. Where an arm
    folds up they feel so little that they would chatter all the same: errors of each joint decay
    with a share of the bandwidth, such that no motion is quicker than the controller. Damping D and
    stiffness K in periods T are stable where T D + T^2 K / 2 is less than twice the inertia in
    every direction (Jury's criterion for ``v M v (z - 1)^2 + T v D v (z - 1) + T^2 v K v z``, with
    rates at the end of a period that act in it).
    """
    m = len(system.drive_names)
    count = min(_POSTURES, _MOST_ENTRIES // m**2)
    inertia = system.mass_matrix(system.sampled_postures(count))
    if np.linalg.matrix_rank(inertia, hermitian=True).min() < m:
        expected = "bodies or rotors that resist every motion"
        raise BadValueError("least inertia of the chain", 0.0, expected)
    inverse = np.linalg.inv(inertia)
    mobility = np.diagonal(inverse, axis1=1, axis2=2)
    stiff = np.median(1.0 / mobility, axis=0)
    damped = np.sqrt(stiff * np.median(np.diagonal(inertia, axis1=1, axis2=2), axis=0))
    worst = np.unique(np.argsort(mobility, axis=0)[-max(_WORST // m, 1) :])
    share = _quiet_shares(np.asarray(inverse[worst], np.float64), stiff, damped, turn, damping)
    return stiff * share**2, damped * share


def _quiet_shares(
    inverse: Array, stiff: Array, damped: Array, turn: float, damping: float
) -> Array:
    """Return the shares of the bandwidth (n,) that do not let an arm chatter.

    The arm's postures have these inverses of the mass matrix (k, n, n).
    """

    def strain(rows: NDArray[np.intp]) -> tuple[Array, Array]:
        turns = turn * share
        root = np.sqrt(2.0 * damping * turns * damped + 0.5 * turns**2 * stiff)
        ratios, directions = np.linalg.eigh(root[:, None] * inverse[rows] * root)
        return ratios[:, -1] / _QUIET, directions[:, :, -1]

    turn = min(turn, sys.float_info.max)
    share = np.full(len(stiff), _LARGEST_TURN / max(turn, _LARGEST_TURN))
    every = np.arange(len(inverse))
    for _ in range(_ROUNDS):
        excess = strain(every)[0]
        if excess.max() <= 1.0:
            break
        for k in np.argsort(-excess)[:_PER_ROUND]:
            now, direction = strain(every[k : k + 1])
            if now[0] > 1.0:
                # Each joint gives way by its part in the motion that would chatter most.
                share *= (now[0] * 1.001) ** -(direction[0] ** 2)
    return share
