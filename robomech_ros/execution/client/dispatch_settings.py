"""Settings of a dispatcher."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class DispatchSettings:
    """How many deliveries may wait, and when one has arrived or is given up.

    Attributes
    ----------
    capacity : int
        How many trajectories may wait.
    start_tolerance, goal_tolerance : float
        How far the joints may be from start and goal, rad or m.
    controller_timeout : float
        How long the controller may be away before waiting clients hear of it, s.
    arrival_timeout : float
        How long after its end a motion may take to arrive, s.
    standstill_timeout : float
        How long the robot may stand away from the goal while a trajectory sent by topic should
        move it, s; then it was stopped.
    max_duration : float
        How long a trajectory may last at the speed at which it is executed, s.
    """

    capacity: int = 50
    start_tolerance: float = 0.01
    goal_tolerance: float = 0.01
    controller_timeout: float = 3.0
    arrival_timeout: float = 2.0
    standstill_timeout: float = 1.0
    max_duration: float = np.inf
