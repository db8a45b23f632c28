"""Robots of the demonstration: an arm, or a parallel robot."""

from collections.abc import Sequence
from typing import Protocol

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.demonstration.postures import pick_and_place
from robomech_ros.nodes.demonstration.report import TipPath
from robomech_ros.robots import PRISMATIC, SerialChain
from robomech_ros.typing import Array


class DemoRobot(Protocol):
    """A robot of n joints."""

    @property
    def name(self) -> str:
        """Name of the robot."""

    @property
    def base(self) -> str:
        """Its base link."""

    @property
    def title(self) -> str:
        """One-line description of the robot."""

    @property
    def joint_names(self) -> Sequence[str]:
        """All joints."""

    @property
    def units(self) -> Sequence[str]:
        """Units of all joints, ``"rad"`` or ``"m"``."""

    @property
    def shown(self) -> Sequence[int]:
        """Numbers of the joints that are printed and plotted."""

    def home(self) -> Array:
        """Start posture, shape (n,), rad or m."""

    def pose(self, q: Array) -> Array:
        """Pose of the tip in the base (4, 4), of joints (n,)."""

    def targets(self) -> tuple[Array, Array]:
        """Poses (4, 4) where to pick and where to place."""

    def path_to_place(self, pick: Array, place: Array) -> TipPath | None:
        """Return the path of the tip from pick to place; None where only the joints matter."""

    def path_onward(self, place: Array) -> TipPath | None:
        """Return a path of the tip that begins at place; None for no more."""


class DemoArm:
    """An arm.

    Parameters
    ----------
    chain : SerialChain
    """

    def __init__(self, chain: SerialChain) -> None:
        self._chain = chain
        self.name, self.base = chain.name, chain.base
        self.joint_names, self.units = chain.joint_names, chain.units
        self.shown = range(chain.n)
        joints = "".join("P" if kind == PRISMATIC else "R" for kind in chain.types)
        self.title = f"{chain.name}: {chain.n} joints {joints}, {chain.base} to {chain.tip}"

    def home(self) -> Array:
        """Start posture, shape (n,), rad or m."""
        return self._chain.home()

    def pose(self, q: Array) -> Array:
        """Pose of the tip in the base (4, 4), of joints (n,)."""
        return forward_kinematics(self._chain, q)

    def targets(self) -> tuple[Array, Array]:
        """Poses (4, 4) where to pick and where to place."""
        pick, place = pick_and_place(self._chain)
        return self.pose(pick), self.pose(place)

    def path_to_place(self, pick: Array, place: Array) -> TipPath | None:
        """Leave the way to the joints."""

    def path_onward(self, place: Array) -> TipPath | None:
        """End at place."""
