"""Postures of mechanisms that several tests share."""

import numpy as np

from robomech_ros.outcomes import Code


def postures_near_home(mechanism, count, seed=1, reach=0.05):
    """Postures with closed loops, for drives moved at random from home."""
    rng = np.random.default_rng(seed)
    home = mechanism.home()
    drives = home[mechanism.drive_index]
    weights = mechanism.loops.weights[mechanism.drive_index]
    found = []
    while len(found) < count:
        given = drives + reach * rng.uniform(-1.0, 1.0, mechanism.dof) / weights
        closed = mechanism.close(given, home)
        if closed.status == Code.NONE:
            found.append(closed.q)
    return np.array(found)
