"""Solutions of inverse kinematics by Newton steps from random starts, to compare others with."""

import numpy as np

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian

__all__ = ["multi_start", "turn_difference"]

# Largest entry of the pose reached minus the pose wanted, and postures that are the same (rad, m).
_REACHED = 1e-10
_SAME = 1e-4


def turn_difference(chain, q, p):
    """Largest difference of joint values, angles modulo a turn; shape of the leading axes."""
    difference = np.asarray(q) - np.asarray(p)
    turned = np.abs((difference + np.pi) % (2 * np.pi) - np.pi)
    return np.where(chain.types == 1, np.abs(difference), turned).max(axis=-1, initial=0.0)


def multi_start(chain, targets, seed=0, starts=300, steps=25):
    """Search from so many starts for each target, all at once.

    Parameters
    ----------
    chain : SerialChain
        The arm.
    targets : array-like, shape (m, 4, 4)
        Poses of the tip in the base frame.
    seed, starts, steps : int, optional
        Of the random starts; starts for each target; Newton steps at most.

    Returns
    -------
    list of numpy.ndarray
        For each target its distinct solutions, shape (k, n).
    """
    targets = np.asarray(targets)
    wanted = np.repeat(targets, starts, axis=0)
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, (len(wanted), chain.n))
    on_the_way = np.arange(len(wanted))
    for _ in range(steps):
        poses = forward_kinematics(chain, q[on_the_way])
        missing = np.abs(poses - wanted[on_the_way]).max(axis=(1, 2))
        arriving = missing < 1e-2 * _REACHED
        on_the_way, poses = on_the_way[~arriving], poses[~arriving]
        q[on_the_way] += _steps(chain, poses, wanted[on_the_way], q[on_the_way])
    reached = np.abs(forward_kinematics(chain, q) - wanted).max(axis=(1, 2)) < _REACHED
    return [
        _distinct(chain, postures[good])
        for postures, good in zip(
            q.reshape(len(targets), starts, chain.n), reached.reshape(-1, starts), strict=True
        )
    ]


def _steps(chain, poses, wanted, q):
    """Newton steps from postures with these poses, damped in proportion to the error."""
    turn = wanted[:, :3, :3] @ np.swapaxes(poses[:, :3, :3], 1, 2)
    axial = 0.5 * (turn - np.swapaxes(turn, 1, 2))
    shift = wanted[:, :3, 3] - poses[:, :3, 3]
    e = np.stack([axial[:, 2, 1], axial[:, 0, 2], axial[:, 1, 0], *shift.T], 1)[:, :, None]
    J = jacobian(chain, q)
    transposed = np.swapaxes(J, 1, 2)
    square = transposed @ J
    square += (1e-3 * (e**2).sum(axis=1, keepdims=True) + 1e-13) * np.eye(chain.n)
    step = np.linalg.solve(square, transposed @ e)[:, :, 0]
    length = np.abs(step).max(axis=1, keepdims=True)
    return step / np.maximum(1.0, length / 0.5)


def _distinct(chain, postures):
    """Leave of postures that are the same only the first."""
    found = []
    while len(postures):
        found.append(postures[0])
        postures = postures[turn_difference(chain, postures, postures[0]) > _SAME]
    return np.array(found).reshape(-1, chain.n)
