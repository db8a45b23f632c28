"""A robot that moves over the ground as it is commanded."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Protocol

from robomech_ros.typing import Array

# Of a twist: its name, its unit, and its place in [w, vx, vy].
AXES = (("turn", "rad/s", 0), ("forward", "m/s", 1), ("sideways", "m/s", 2))


class MobileRobotView(Protocol):
    """A robot that goes on in periods; not for several threads at a time.

    Attributes
    ----------
    kind, verb : str
        Of what kind it is, and what it does: drive, or walk.
    period : float
        s.
    command : ndarray, shape (3,)
        The twist [w, vx, vy] that it is to have (rad/s, m/s).
    """

    kind: ClassVar[str]
    verb: ClassVar[str]
    period: ClassVar[float]
    command: Array

    @property
    def most(self) -> Array:
        """Greatest velocities that sliders ask for, shape (3,) (rad/s, m/s); 0 for none."""

    @property
    def stands(self) -> bool:
        """Whether it does not move, and is on no way."""

    @property
    def moved_joint(self) -> int | None:
        """Number of the slider that moved it last, which is not set back meanwhile."""

    def drive(self, steps: int, *, brake: bool = False) -> None:
        """Follow the command for some periods within all limits, or stop within them."""

    def preview(self) -> None:
        """Say what becomes of the command."""

    def path_ahead(self) -> Array:
        """Return the way that the command goes from here, shape (m, 3) (m)."""

    @property
    def trail(self) -> Array:
        """Past positions, shape (m, 3) (m)."""

    def forget(self) -> None:
        """Begin a new trail."""

    def facts(self) -> list[tuple[str, str]]:
        """Write how it moves, for people."""


def twist_facts(twist: Array, most: Sequence[float] | Array) -> list[tuple[str, str]]:
    """Write the velocities [w, vx, vy] that there can be, for people."""
    # Adding 0 makes -0 a plain 0.
    return [(name, f"{twist[k] + 0.0:.3f} {unit}") for name, unit, k in AXES if most[k] or twist[k]]
