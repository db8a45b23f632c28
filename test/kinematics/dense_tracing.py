"""The nearest posture of self-motions, by tracing all branches densely, to compare with."""

import numpy as np
from independent_search import multi_start, turn_difference

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.inverse.redundant_arms.redundancy import Redundancy
from robomech_ros.kinetostatics import jacobian

__all__ = ["dense_branches", "nearest_of"]

# Length of a step (rad, of the joint that moves most), and how many there are to each side of a
# start.
_STEP, _STEPS = 0.04, 70
# Largest error of a posture's pose.
_ON_POSE = 1e-9
# Values of the parameter and random starts that give the starts, and how far apart these are.
_VALUES, _STARTS, _APART = 24, 60, 0.1
# Postures near the least that are looked at closer, in rounds with a finer grid each.
_CANDIDATES, _ROUNDS = 120, 9
_GRID = np.linspace(-1.0, 1.0, 17)


def dense_branches(chain, T, posture, seed=0):
    """Trace self-motions in small steps from very many postures.

    Parameters
    ----------
    chain : SerialChain
        Of seven joints.
    T : array, shape (4, 4)
        Pose of the tip in the base (m).
    posture : array, shape (7,)
        One that takes it (rad).
    seed : int, optional
        Of the random starts.

    Returns
    -------
    array, shape (k, 7)
        Postures with the pose, some 0.04 rad from their neighbours.
    """
    redundancy = Redundancy(chain, T)
    low, high, _ = redundancy.range()
    values = np.linspace(low, high, _VALUES, endpoint=False)
    rows = [redundancy.at(t) for t in values] + multi_start(chain, T[None], seed, _STARTS)
    starts = [posture]
    for one in np.vstack(rows):
        if turn_difference(chain, np.array(starts), one).min() > _APART:
            starts.append(one)
    sides = []
    for side in (1.0, -1.0):
        q, J = _on_pose(chain, T, np.array(starts))
        before = side * _directions(J)
        sides.append(q)
        for _ in range(_STEPS):
            g = _directions(J)
            g *= np.sign((g * before).sum(axis=1, keepdims=True))
            q, J = _on_pose(chain, T, q + _STEP * g, 2)
            before = g
            sides.append(q)
    rows = np.vstack(sides)
    # Steps across a singular posture may end beside the pose.
    return rows[np.abs(forward_kinematics(chain, rows) - T).max(axis=(1, 2)) < _ON_POSE]


def nearest_of(chain, T, branches, seed, metric, bounded=True):
    """Distance from the seed of the nearest posture on densely traced branches, inf if none.

    Parameters
    ----------
    chain, T
        As for :func:`dense_branches`.
    branches : array, shape (k, 7)
        What that has returned.
    seed : array, shape (7,)
        Where distances are measured from (rad).
    metric : {"linf", "l2"}
    bounded : bool, optional
        Whether limits hold.

    Returns
    -------
    float
    """
    norm = np.inf if metric == "linf" else 2
    q = seed + np.remainder(branches - seed + np.pi, 2.0 * np.pi) - np.pi
    if bounded:
        q = np.where(q < chain.lower - 1e-9, q + 2.0 * np.pi, q)
        q = np.where(q > chain.upper + 1e-9, q - 2.0 * np.pi, q)
    beyond = _beyond(chain, q) if bounded else np.zeros(len(q))
    away = np.linalg.norm(q - seed, norm, axis=1)
    least = away[beyond <= 0.0].min(initial=np.inf)
    centres = _candidates(q, away, (beyond < 1.5 * _STEP) & (away < least + 2.2 * _STEP))
    reach = _STEP
    for _ in range(_ROUNDS if len(centres) else 0):
        g = _directions(_on_pose(chain, T, centres, 1)[1])
        on_lines = (centres[:, None] + reach * _GRID[:, None] * g[:, None]).reshape(-1, 7)
        p, _ = _on_pose(chain, T, on_lines)
        good = np.abs(forward_kinematics(chain, p) - T).max(axis=(1, 2)) < 1e-13
        good &= np.abs(p - on_lines).max(axis=1) < reach
        value = np.linalg.norm(p - seed, norm, axis=1)
        if bounded:
            beyond = _beyond(chain, p)
            value = np.where(beyond <= 1e-10, value, 100.0 + beyond)
        value = np.where(good, value, np.inf).reshape(len(centres), -1)
        best = value.argmin(axis=1)
        rows = np.arange(len(centres))
        centres, value = p.reshape(*value.shape, 7)[rows, best], value[rows, best]
        least = min(least, value.min() if value.min() < 100.0 else np.inf)
        centres = centres[(value < least + 2.5 * reach) | (least == np.inf)]
        reach *= 0.25
        if not len(centres):
            break
    return least


def _candidates(q, away, near):
    """Pick postures in order of their distance, not too near to each other."""
    picked = []
    for k in np.flatnonzero(near)[np.argsort(away[near])]:
        if not picked or np.abs(q[picked] - q[k]).max(axis=1).min() > 0.45 * _STEP:
            picked.append(k)
            if len(picked) == _CANDIDATES:
                break
    return q[picked]


def _beyond(chain, q):
    return np.maximum(np.maximum(chain.lower - q, q - chain.upper), 0.0).max(axis=1)


def _directions(J):
    """Directions (k, 7) of the self-motion; the joint that moves most moves by one."""
    g = np.linalg.qr(np.swapaxes(J, 1, 2), mode="complete")[0][:, :, 6]
    return g / np.abs(g).max(axis=1, keepdims=True)


def _on_pose(chain, T, q, steps=3):
    """Newton steps of least norm from postures (k, 7) onto the pose; give the last Jacobians."""
    for _ in range(steps):
        poses = forward_kinematics(chain, q)
        turn = T[:3, :3] @ np.swapaxes(poses[:, :3, :3], 1, 2)
        axial = 0.5 * (turn - np.swapaxes(turn, 1, 2))
        shift = T[:3, 3] - poses[:, :3, 3]
        e = np.stack([axial[:, 2, 1], axial[:, 0, 2], axial[:, 1, 0], *shift.T], 1)
        J = jacobian(chain, q)
        damping = 1e-13 + 1e-3 * (e**2).sum(axis=1)
        square = J @ np.swapaxes(J, 1, 2) + damping[:, None, None] * np.eye(6)
        q = q + (np.swapaxes(J, 1, 2) @ np.linalg.solve(square, e[:, :, None]))[:, :, 0]
    return q, J
