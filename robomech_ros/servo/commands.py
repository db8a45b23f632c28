"""The commands of a servo."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class TwistCommand:
    """Move the tip with a twist (6,), angular first (rad/s and m/s), until it is stale (s).

    ``axes`` gives for q the rotation ``R_base_axes`` of the axes in which the twist is expressed,
    or None for the base.
    """

    twist: Array
    axes: Callable[[Array], Array | None]
    until: float


@dataclass(frozen=True, eq=False)
class JointCommand:
    """Move the joints at rates (n,), rad/s or m/s, until the command is stale (s)."""

    rates: Array
    until: float


@dataclass(frozen=True, eq=False)
class PoseCommand:
    """Move the tip to a pose ``T_base_tip`` (m), on a straight line, and stand there.

    It goes at most at these speeds, m/s and rad/s, above 0, until it is stale (s); both motions end
    together.
    """

    target: Array
    linear_speed: float
    angular_speed: float
    until: float


Command = TwistCommand | JointCommand | PoseCommand
