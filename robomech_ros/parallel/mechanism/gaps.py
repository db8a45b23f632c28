"""Where the loops of postures are open."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import OpenLoopsError
from robomech_ros.parallel.mechanism.motion import LoopMotion

__all__ = ["open_loops"]

Array = NDArray[np.float64]


def open_loops(
    mechanism: LoopMotion, q: Array, what: str, expected: str = "closed loops"
) -> OpenLoopsError:
    """Give the error that names the widest gap of postures, shape (..., n).

    Parameters
    ----------
    mechanism : LoopMotion
    q : ndarray, shape (..., n)
        All joints (rad or m).
    what : str
        What they are; of several postures the error counts them from 0.
    expected : str, optional
        The words after "expected".
    """
    with np.errstate(over="ignore", invalid="ignore"):
        errors = mechanism.loop_errors(q)
    widest = np.unravel_index(int(errors.max(axis=-1).argmax()), errors.shape[:-1])
    *at, limb = (int(k) for k in widest)
    distance, angle = errors[widest].tolist()
    which = "".join(f"[{k}]" for k in at)
    return OpenLoopsError(f"{what}{which}", limb + 1, distance, angle, expected)
