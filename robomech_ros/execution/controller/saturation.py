"""Says in words which drives were at their limits, and for how long."""

from collections.abc import Sequence

import numpy as np

from robomech_ros.trajectory.sample import FloatArray

__all__ = ["saturation_text"]


def saturation_text(at_limit: FloatArray, names: Sequence[str]) -> str:
    """Name the joints whose drives were at their limits.

    Parameters
    ----------
    at_limit : ndarray, shape (n,)
        How long each was, s.
    names : sequence of str
        Of the joints.

    Returns
    -------
    str
        Empty where none was.
    """
    found = [int(joint) for joint in np.flatnonzero(at_limit)]
    each = [
        f"'{names[joint]}' was at its effort limit for {at_limit[joint]:.3g} s" for joint in found
    ]
    return ", ".join(f"joint {text}" for text in each)
