"""Motions of all joints of a parallel robot that its drives cause."""

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
    """Return the motion of all joints that a motion of the drives causes.

    - ``mechanism``: of n joints and d drives.
    - ``times``: s, shape (m,).
    - ``drives``, ``rates``, ``accelerations``: rad or m, and over s and s^2, shape (m, d); the
      latter two None if they are not known.
    - ``start``: posture from which the joints follow, rad or m, shape (n,).

    Returns the motion as far as the robot can follow.
    """
    q = follow_drives(mechanism, drives, start).q
    k, qd, qdd = len(q), None, None
    if rates is not None:
        qd, _ = mechanism.rates(q, rates[:k])
        if accelerations is not None:
            qdd, _ = mechanism.accelerations(q, qd, accelerations[:k])
    return Motion(mechanism, times[:k], q, (), qd, qdd)
