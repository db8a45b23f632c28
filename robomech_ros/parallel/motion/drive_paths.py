"""Ways of the drives, followed by all joints in one assembly mode."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.outcomes import Code
from robomech_ros.parallel.argument_checks import actuated
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.motion.singularity_check import named_singularity, singular_values
from robomech_ros.spatial.arrays import as_finite, real_number
from robomech_ros.trajectory.tolerances import POSITION_SLACK
from robomech_ros.typing import Array, ArrayLike

# Loops of a posture that somebody gives may be open by this (rad, m): rounding of messages.
OPEN = 1e-6
# Where the condition number is higher, nothing is left of the drives' hold on the platform: how far
# they are from where modes meet falls with its square, to what a path may be off.
LARGEST_CONDITION = 1e3


@dataclass(frozen=True, eq=False)
class DrivePath:
    """All joints of a mechanism along a way of its drives.

    Attributes
    ----------
    q : ndarray, shape (k, n)
        All joints (rad or m) of the first k points, loops closed; all points where nothing stops.
    status : Code
        ``NONE``; ``SINGULAR`` or ``LIMIT`` where the way cannot be gone on; ``NOT_CONVERGED`` where
        it is too long from one point to the next.
    reason : str
        What is singular, or which joint leaves its limits or cone by how much; empty for none.
    condition : float
        Largest condition number on the way.
    """

    q: Array
    status: Code
    reason: str
    condition: float

    @property
    def stop(self) -> int | None:
        """Number of the point that is not reached; None where all are."""
        return None if self.status is Code.NONE else len(self.q)


def follow_drives(
    mechanism: Mechanism,
    drives: ArrayLike,
    start: ArrayLike,
    *,
    condition: float = LARGEST_CONDITION,
) -> DrivePath:
    """Follow a way of the drives with all joints, in the assembly mode of its start.

    Between the points the drives go straight.

    Parameters
    ----------
    mechanism : Mechanism
        Mechanism of n joints and m drives.
    drives : array_like, shape (k, m)
        Positions of the drives (rad or m), one point after the other.
    start : array_like, shape (n,)
        All joints (rad or m), loops closed, at the first point or near.
    condition : float, optional
        Condition number of the twists of the platform, lengths over the size, above which a
        posture counts as singular.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.parallel import follow_drives, load_parallel
    >>> delta = load_parallel("delta").mechanism
    >>> home = delta.home()
    >>> way = home[delta.drive_index] + np.linspace(0.0, 0.3, 4)[:, None]
    >>> found = follow_drives(delta, way, home)
    >>> found.q.shape, found.stop
    ((4, 15), None)
    """
    first = require_closed(mechanism, start)
    way = as_finite("drives", drives, (mechanism.dof,))
    if way.ndim != 2:
        raise WrongSizeError("drives", way.shape, f"(k, {mechanism.dof})")
    most = real_number("condition", condition, "a number above 1")
    if not most > 1.0:
        raise BadValueError("condition", condition, "a number above 1")
    rows, q, status, reason = np.empty((len(way), mechanism.n)), first, Code.NONE, ""
    reached = 0
    for point in way:
        closed = mechanism.close(point, q)
        if closed.status is not Code.NONE:
            status, reason = closed.status, closed.reason
            if status is Code.SINGULAR:
                named = named_singularity(mechanism, first, closed.q)
                reason = f"a singularity is in the way, in which assembly modes meet: {named}"
            break
        q = rows[reached] = closed.q
        reached += 1
    rows = rows[:reached]
    highest, bad = _singular_row(mechanism, rows, most)
    if bad is not None:
        named = named_singularity(mechanism, first, rows[bad])
        status, rows = Code.SINGULAR, rows[:bad]
        reason = f"the condition number rises over {most:.6g}: {named}"
    out = _row_outside(mechanism, rows)
    if out is not None:
        status, reason, rows = Code.LIMIT, out[1], rows[: out[0]]
    return DrivePath(rows, status, reason, highest)


def require_closed(mechanism: Mechanism, start: ArrayLike) -> Array:
    """Check a posture (n,) to start from: its loops are closed, to rounding of messages."""
    if not isinstance(mechanism, Mechanism):
        raise BadValueError("mechanism", mechanism, "a Mechanism")
    posture = actuated("start", start, mechanism.n)
    if mechanism.loop_errors(posture).max() > OPEN:
        raise mechanism.open_loops(posture, "start", f"loops closed to {OPEN:g}")
    return posture


def _singular_row(mechanism: Mechanism, rows: Array, most: float) -> tuple[float, int | None]:
    """Return the largest condition number of rows (k, n), and the first that is too near."""
    if not len(rows):
        return 1.0, None
    values = singular_values(mechanism, rows)
    with np.errstate(divide="ignore"):
        conditions = values[:, 0] / values[:, -1]
    bad = np.flatnonzero(conditions > most)
    return float(conditions.max()), int(bad[0]) if len(bad) else None


def _row_outside(mechanism: Mechanism, rows: Array) -> tuple[int, str] | None:
    """Find the first row (n,) with a joint outside its limits or a cone, in words."""
    excess = mechanism.limit_excess(rows)
    bad = np.flatnonzero((excess > POSITION_SLACK).any(axis=1))
    if not len(bad):
        return None
    k = int(bad[0])
    joint = int(np.argmax(excess[k]))
    name, unit = mechanism.joint_names[joint], mechanism.units[joint]
    most = float(excess[:, joint].max())
    return k, f"joint '{name}' leaves its limits, by up to {most:.3g} {unit}"
