"""Checks every state of joints before it is published: inside their limits, and no jump."""

from collections.abc import Callable

import numpy as np

from robomech_ros.trajectory.limits import Limits
from robomech_ros.trajectory.tolerances import LIMIT_SLACK, POSITION_SLACK
from robomech_ros.typing import Array

# From positions of joints (n,) to how far each is inside its limits, rad or m.
Margin = Callable[[Array], Array]

# Rounding of positions (rad or m), and the shortest time between two states (s).
_ROUNDING, _SHORTEST = 1e-9, 1e-9


class StateCheck:
    """Compares each position of n joints with their limits, and with the position before.

    Joints that were put beyond a limit may stay as far beyond it. ``margin`` returns how far joints
    are inside their limits (n,) at a position (n,), rad or m; by default the distance to the nearer
    one of two. Joints may overshoot their limits by ``beyond`` (rad or m), and those of velocity by
    a part ``faster``.
    """

    def __init__(
        self,
        limits: Limits,
        margin: Margin | None = None,
        beyond: float = POSITION_SLACK,
        faster: float = LIMIT_SLACK,
    ) -> None:
        self.limits, self._beyond = limits, beyond
        self._margin = margin or (lambda q: np.minimum(q - limits.lower, limits.upper - q))
        self._fastest = limits.velocity * (1.0 + faster)

    def restart(self, position: Array, time: float) -> None:
        """Accept a position (n,) at a time (s), to which the joints were put."""
        self._least = np.minimum(self._margin(position), 0.0) - self._beyond
        self.keep(position, time)

    def keep(self, position: Array, time: float) -> None:
        """Note that a position (n,) is published at a time (s)."""
        self._position, self._time = position, time

    def fault(self, position: Array, time: float) -> str:
        """Return what is wrong with a position (n,) at a time (s); empty if it may be published."""
        spare = self._margin(position) - self._least
        # Comparisons with NaN are false.
        if not (spare >= 0.0).all():
            joint = int(np.argmin(spare))
            beyond = -float(spare[joint] + self._least[joint])
            return self._text(joint, f"would be {beyond:.3g}", 0, "beyond its limits")
        span = max(time - self._time, _SHORTEST)
        over = np.abs(position - self._position) - self._fastest * span
        if not (over <= _ROUNDING).all():
            joint = int(np.argmax(over))
            speed = abs(float(position[joint] - self._position[joint])) / span
            limit = f"faster than its limit of {self.limits.velocity[joint]:.4g}"
            return self._text(joint, f"would move at {speed:.3g}", 1, limit)
        return ""

    def _text(self, joint: int, what: str, order: int, limit: str) -> str:
        unit = self.limits.unit(joint, order)
        parts = f"joint '{self.limits.joint_names[joint]}'", what, unit, limit
        return " ".join(part for part in parts if part)
