"""Robots of the demonstration: an arm, or a parallel robot."""

from typing import TYPE_CHECKING, TypeAlias

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.demonstration.postures import pick_and_place
from robomech_ros.nodes.demonstration.report import TipPath
from robomech_ros.robots import PRISMATIC, SerialChain
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.nodes.demonstration.demo_platform import DemoPlatform


class DemoArm:
    """An arm; `DemoPlatform` has the same methods.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.

    Attributes
    ----------
    title : str
        One-line description of the robot.
    shown : sequence of int
        Numbers of the joints that are printed and plotted.
    """

    def __init__(self, chain: SerialChain) -> None:
        self.model = chain
        self.name, self.base = chain.name, chain.base
        self.joint_names, self.units = chain.joint_names, chain.units
        self.shown = range(chain.n)
        joints = "".join("P" if kind == PRISMATIC else "R" for kind in chain.types)
        self.title = f"{chain.name}: {chain.n} joints {joints}, {chain.base} to {chain.tip}"

    def home(self) -> Array:
        """Start posture, shape (n,), rad or m."""
        return self.model.home()

    def pose(self, q: Array) -> Array:
        """Pose of the tip in the base (4, 4), of joints (n,)."""
        return forward_kinematics(self.model, q)

    def targets(self) -> tuple[Array, Array]:
        """Poses (4, 4) where to pick and where to place."""
        pick, place = pick_and_place(self.model)
        return self.pose(pick), self.pose(place)

    def path_to_place(self, pick: Array, place: Array) -> TipPath | None:
        """Return None: the way of the tip is left to the joints."""

    def path_onward(self, place: Array) -> TipPath | None:
        """Return None: an arm ends at place."""


DemoRobot: TypeAlias = "DemoArm | DemoPlatform"
