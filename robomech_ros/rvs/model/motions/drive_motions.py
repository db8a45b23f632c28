"""Motions of all joints of a parallel robot from motions of its drives."""

from robomech_ros.parallel import Mechanism, follow_drives
from robomech_ros.rvs.motion import Motion
from robomech_ros.typing import Array


def followed_motion(
    mechanism: Mechanism,
    times: Array,
    drives: Array,
    rates: Array | None,
    accelerations: Array | None,
    start: Array,
) -> Motion:
    """Compute the motion of all joints from a motion of the drives, as far as they can follow it.

    - ``mechanism``: mechanism of n joints and d drives.
    - ``times``: times (s), shape (m,).
    - ``drives``: positions of the drives (rad or m), shape (m, d).
    - ``rates``, ``accelerations``: their derivatives, shape (m, d); None if unknown.
    - ``start``: first posture of the motion (rad or m), shape (n,).
    """
    q = follow_drives(mechanism, drives, start).q
    k, qd, qdd = len(q), None, None
    if rates is not None:
        qd, _ = mechanism.rates(q, rates[:k])
        if accelerations is not None:
            qdd, _ = mechanism.accelerations(q, qd, accelerations[:k])
    return Motion(mechanism, times[:k], q, (), qd, qdd)
