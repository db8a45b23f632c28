"""Batches of inverse kinematics in short turns, between which the node serves others."""

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robomech_interfaces.msg import ErrorCode
from robomech_ros.kinematics import inverse_kinematics_batch
from robomech_ros.kinematics.families import family_of
from robomech_ros.nodes.pauses import Turns
from robomech_ros.robots import SerialChain

__all__ = ["BatchResult", "solve_in_turns"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
# Solutions (m, c, n), how many each pose has (m,), and the code of each (m,).
BatchResult = tuple[Array, Indices, Indices]

# Poses of a portion: one takes 10 us where the solution is in closed form, up to 1 ms where it is
# to be explained why there is none, and up to 30 ms where there is no closed form.
_PORTION, _ITERATIVE_PORTION = 64, 1


async def solve_in_turns(
    chain: SerialChain,
    T: Array,
    allowed: float,
    turns: Turns,
    **options: Any,
) -> tuple[BatchResult, int]:
    """Solve many poses and let others work in between.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    T : ndarray, shape (m, 4, 4)
        Wanted poses of the tip in the base (m).
    allowed : float
        Time (s) after which the poses that are left get the code TIMED_OUT.
    turns : Turns
        Those of the node that does it.
    **options
        Of `inverse_kinematics_batch`.

    Returns
    -------
    result : tuple
        What `inverse_kinematics_batch` returns for all poses.
    done : int
        How many poses were worked on.
    """
    size = _PORTION if family_of(chain).closed_form else _ITERATIVE_PORTION
    portions: list[BatchResult] = []
    start = time.monotonic()
    done = 0
    while done < len(T) or not portions:
        portions.append(inverse_kinematics_batch(chain, T[done : done + size], **options))
        done = min(done + size, len(T))
        if time.monotonic() - start > allowed:
            break
        await turns.end_if_over()
    q, count, status = (np.concatenate(parts) for parts in zip(*portions, strict=True))
    left = len(T) - done
    if left:
        q = np.concatenate([q, np.full((left, *q.shape[1:]), np.nan)])
        count = np.concatenate([count, np.zeros(left, count.dtype)])
        status = np.concatenate([status, np.full(left, ErrorCode.TIMED_OUT, status.dtype)])
    return (q, count, status), done
