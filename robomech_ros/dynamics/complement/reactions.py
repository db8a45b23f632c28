"""Multipliers of constraints: the reactions in joints, loops and wheels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.checked_states import refuse_large
from robomech_ros.errors import WrongSizeError
from robomech_ros.spatial.arrays import as_finite, of_shape
from robomech_ros.typing import Array, ArrayLike

# Singular values below this part of the largest are those of constraints that say the same twice.
_RANK = 1e-9


@dataclass(frozen=True, eq=False)
class ConstraintReactions:
    """Reactions of the constraints.

    Attributes
    ----------
    multipliers : ndarray, shape (c,)
        One for each row of K: a moment (N m) or a force (N) by the row's kind.
    unique : bool
        Whether these are the only ones.  In an overconstrained system they are not, for rigid
        bodies: then these are those with the least sum of squares.
    redundant : int
        How many constraints follow from the others.
    remainder : float
        Largest part of the wrenches that the constraints do not exert (N m or N): rounding, for
        wrenches that are those of these constraints.
    """

    multipliers: Array
    unique: bool
    redundant: int
    remainder: float


def constraint_reactions(K: ArrayLike, wrenches: ArrayLike) -> ConstraintReactions:
    r"""Find the multipliers of constraints from the wrenches that keep them, ``K^T x = w``.

    Parameters
    ----------
    K : array_like, shape (c, 6 r)
        Constraint matrix, ``K t = 0``; a row [n, f] on a body is the moment and the force that a
        unit of its multiplier exerts on the body.
    wrenches : array_like, shape (6 r,)
        Of :meth:`ConstrainedBodies.constraint_wrenches` (N m and N).

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., sections 7.5 and 12.3.

    Examples
    --------
    Two hinges in a line carry a door of 20 N; how they share it along the line is not known:

    >>> import numpy as np
    >>> from robomech_ros.dynamics import constraint_reactions
    >>> found = constraint_reactions([[0, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 1]], [0, 0, 0, 0, 0, 20])
    >>> np.round(found.multipliers, 6).tolist(), found.unique, found.redundant
    ([10.0, 10.0], False, 1)
    """
    matrix, given = as_finite("K", K, ()), as_finite("wrenches", wrenches, ())
    if matrix.ndim != 2 or not matrix.size:
        raise WrongSizeError("K", matrix.shape, "(c, 6 r) of one constraint or more")
    of_shape("wrenches", given, matrix.shape[1:])
    refuse_large("K", matrix)
    refuse_large("wrenches", given)
    multipliers, _, rank, _ = np.linalg.lstsq(matrix.T, given, rcond=_RANK)
    redundant = len(matrix) - int(rank)
    remainder = float(np.abs(matrix.T @ multipliers - given).max())
    return ConstraintReactions(np.asarray(multipliers), redundant == 0, redundant, remainder)
