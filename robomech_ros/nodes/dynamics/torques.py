"""The torques of states and of whole trajectories, as requests ask for them."""

from itertools import pairwise

import numpy as np

from robomech_ros.dynamics import DynamicSystem
from robomech_ros.nodes.dynamics.messages import Motions
from robomech_ros.typing import Array

_NO_GRAVITY = (0.0, 0.0, 0.0)
# At which a torque summary looks besides the points; each takes some 200 bytes for a joint.
_MOST_INSTANTS = 100_000


def torque_shares(
    system: DynamicSystem, states: Motions, gravity: Array, wrench: Array
) -> dict[str, Array]:
    """Compute the torques of states, and what of them gravity, rates and accelerations take.

    Parameters
    ----------
    system : DynamicSystem
        Of m drives, with all that it carries.
    states : Motions
        k of them.
    gravity : ndarray, shape (3,)
        In the base (m/s^2).
    wrench : ndarray, shape (k, 6)
        What the surroundings exert on the tip, moment first, in the base (N m and N).

    Returns
    -------
    dict of str to ndarray, shape (k, m)
        By the name of the field of the response (N m or N).
    """
    q, qd, qdd, none = states.q, states.qd, states.qdd, np.zeros_like(states.qd)
    return {
        "effort": system.inverse(q, qd, qdd, gravity=gravity, tip_wrench=wrench),
        "gravity": system.inverse(q, none, none, gravity=gravity),
        "coriolis": system.inverse(q, qd, none, gravity=_NO_GRAVITY),
        "inertial": system.inverse(q, none, qdd, gravity=_NO_GRAVITY),
    }


def instants(times: Array, period: float) -> Array:
    """Divide the spans between instants; none is above a period (s), but there are not too many."""
    period = max(period, float(times[-1] - times[0]) / _MOST_INSTANTS)
    parts = [
        np.linspace(begin, end, max(int(np.ceil((end - begin) / period)), 1), endpoint=False)
        for begin, end in pairwise(times)
    ]
    return np.concatenate([*parts, times[-1:]])
