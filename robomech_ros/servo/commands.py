"""The commands of a servo."""

from collections.abc import Callable
from dataclasses import dataclass

from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class TwistCommand:
    """Move the tip.

    Attributes
    ----------
    twist : ndarray, shape (6,)
        Angular velocity, then velocity of the tip's origin (rad/s and m/s).
    axes : callable
        Gives for q the rotation ``R_base_axes`` of the axes in which the twist is expressed, or
        None for the base.
    until : float
        When it is stale (s).
    """

    twist: Array
    axes: Callable[[Array], Array | None]
    until: float


@dataclass(frozen=True, eq=False)
class JointCommand:
    """Move the joints.

    Attributes
    ----------
    rates : ndarray, shape (n,)
        rad/s or m/s.
    until : float
        When it is stale (s).
    """

    rates: Array
    until: float


@dataclass(frozen=True, eq=False)
class PoseCommand:
    """Move the tip to a pose, on a straight line, and stand there.

    Attributes
    ----------
    target : ndarray, shape (4, 4)
        ``T_base_tip`` (m).
    linear_speed, angular_speed : float
        At most so fast, m/s and rad/s, above 0; both motions end together.
    until : float
        When it is stale (s).
    """

    target: Array
    linear_speed: float
    angular_speed: float
    until: float


Command = TwistCommand | JointCommand | PoseCommand
