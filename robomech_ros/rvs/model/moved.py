"""What is moved on a page: an arm by its tip, or a parallel robot by its platform."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.kinetostatics import SelfMotionCurve
from robomech_ros.rvs.model.arm import Travel
from robomech_ros.rvs.model.ghosts import GhostMaker
from robomech_ros.rvs.model.postures import PoseStudy
from robomech_ros.rvs.model.seen_robot import SeenRobot

__all__ = ["Moved"]

Array = NDArray[np.float64]


class Moved(Protocol):
    """A robot with its present posture; not for several threads at a time."""

    @property
    def name(self) -> str:
        """What it is called."""

    @property
    def base(self) -> str:
        """The link in which poses are."""

    @property
    def end(self) -> str:
        """The link that is dragged."""

    @property
    def q(self) -> Array:
        """Present posture, all joints (rad or m)."""

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The joints that sliders move."""

    @property
    def units(self) -> tuple[str, ...]:
        """Of these joints."""

    @property
    def state_joints(self) -> tuple[str, ...]:
        """The joints of a posture."""

    @property
    def lists_postures(self) -> bool:
        """Whether postures are listed, of which one can be taken."""

    @property
    def room(self) -> float:
        """Side of the square around it that is to be seen (m); 0 for what it fills itself."""

    def follow(self, q: Array) -> None:
        """Be where a robot is, all joints (rad or m)."""

    @property
    def values(self) -> Array:
        """Where these joints are (rad or m)."""

    @property
    def positions(self) -> dict[str, float]:
        """All joints by name (rad or m)."""

    def positions_of(self, q: Array) -> dict[str, float]:
        """Name the joints of a posture."""

    @property
    def study(self) -> PoseStudy:
        """What is known of the pose that the end has or is dragged to."""

    @property
    def target(self) -> Array:
        """Where the gizmo is, in the base (m), shape (4, 4)."""

    @property
    def tip(self) -> Array:
        """Where the end is, in the base (m), shape (4, 4)."""

    @property
    def faulty_links(self) -> tuple[str, ...]:
        """Links that are in the way of what was asked for."""

    def gizmo(self, scale: float) -> dict[str, Any]:
        """Give the options of the gizmo, of viser's transform controls: a size (m), handles."""

    def travel(self, joint: int) -> Travel:
        """Give between what a slider moves."""

    def set_joint(self, joint: int, value: float) -> None:
        """Move one joint (rad or m)."""

    def move_to(self, q: ArrayLike) -> None:
        """Take a posture (rad or m)."""

    def go_home(self) -> None:
        """Go to where it began."""

    def drag(self, T: ArrayLike) -> None:
        """Bring the end to a pose (4, 4), in the base (m)."""

    def release(self) -> None:
        """Let go of the gizmo."""

    def take(self, number: int) -> None:
        """Take one of the postures of the study, counted from 0."""

    def self_motion(self) -> SelfMotionCurve | None:
        """Give how it can move while its end stays; None if it cannot."""

    def slide(self, length: float) -> None:
        """Move along the self-motion."""

    def ghosts(self, seen: SeenRobot) -> GhostMaker:
        """Give the pieces of ghosts."""
