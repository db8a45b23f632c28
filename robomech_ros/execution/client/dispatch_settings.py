"""Settings of a dispatcher."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class DispatchSettings:
    """Size of the queue, and conditions of arrival and failure (rad or m, and s).

    The joints may be off start and goal by the tolerances. Waiting clients are notified when the
    controller is away for ``controller_timeout``. A motion may arrive ``arrival_timeout`` after its
    end. A robot that stands off its goal for ``standstill_timeout``, while a trajectory sent by
    topic should move it, was stopped. ``max_duration`` is that at the speed of the execution.
    """

    capacity: int = 50
    start_tolerance: float = 0.01
    goal_tolerance: float = 0.01
    controller_timeout: float = 3.0
    arrival_timeout: float = 2.0
    standstill_timeout: float = 1.0
    max_duration: float = np.inf
