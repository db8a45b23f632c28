"""The states that a simulation keeps."""

from typing import Any

import numpy as np

from robomech_ros.typing import Array


class Record:
    """States at the increasing times (m,) asked for (s), or where those are None at the steps."""

    def __init__(self, times: Array | None) -> None:
        self.times = times
        self.t: list[float] = []
        self.states: list[Array] = []
        self.last: tuple[float, Array] = 0.0, np.empty(0)

    def close(self) -> None:
        """Add where the motion came to."""
        t, state = self.last
        if not self.t or self.t[-1] < t:
            self.t.append(t)
            self.states.append(state)

    def add(self, t: float, state: Array, dense: Any) -> None:
        """Add what a step to a time (s) passed; dense gives the states in it, if there is one."""
        self.last = t, np.array(state)
        if self.times is None:
            self.t.append(t)
            self.states.append(np.array(state))
            return
        for wanted in self.times[len(self.t) :]:
            if wanted > t:
                break
            self.t.append(float(wanted))
            self.states.append(np.array(state if dense is None else dense(wanted)))
