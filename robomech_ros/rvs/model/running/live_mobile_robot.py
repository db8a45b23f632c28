"""A robot that runs and moves over the ground: what a page asks of it, and what it tells a page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from robomech_ros.rvs.model.jog import HoldHeartbeat

if TYPE_CHECKING:
    from robomech_ros.rvs.model.walking.support import Support


@dataclass(frozen=True, eq=False)
class Stance:
    """How safely a walking machine stands.

    Parameters
    ----------
    support : Support
        On which feet.
    margin : float
        As it says itself (m).
    bound : float
        That it keeps (m).
    gait : str
        In which it walks; empty if that is not known.
    """

    support: Support
    margin: float
    bound: float
    gait: str


class LiveMobileRobot(Protocol):
    """Running mobile robot as a page uses it; methods return at once, results go to the view."""

    def begin(self, view: Any) -> None:
        """Tell this page, from now on."""

    def stop(self) -> None:
        """End the jog, and command to stand."""

    def choose_gait(self, gait: str) -> None:
        """Have it walk in another gait."""

    def move_trunk(self, shift: Sequence[float]) -> None:
        """Have the trunk take a pose beside the level one: x, y, z (m), roll, pitch, yaw (rad)."""

    def hold(self, beat: HoldHeartbeat, speed: float) -> None:
        """Jog while this is said again and again, at a part of the greatest jogging speed."""

    def let_go(self) -> None:
        """End the jog."""
