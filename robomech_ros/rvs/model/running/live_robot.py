"""A running robot: requests of a page to it, and its reports to a page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from robomech_ros.robots.gripper import GripperModel
from robomech_ros.rvs.model.running.jog import HoldHeartbeat
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.rvs.model.walking.support import Support


@dataclass(frozen=True, eq=False)
class ViewMarker:
    """A marker in the scene of the robot."""

    #: Unique among the markers that are shown together.
    name: str
    #: The link whose frame the pose refers to.
    link: str
    #: One of "sphere", "box", "cylinder", "arrow", "lines", "text".
    kind: str
    #: Pose in the frame of the link (m), shape (4, 4).
    pose: Array
    #: Diameters, or lengths of edges (m).  Lines: the first is the width.  Arrows: diameters of
    #: shaft and head, then the length of the head.  Text: the last is its height.
    measures: tuple[float, float, float]
    #: Ends of an arrow, or pairs of ends of lines, in the frame of the pose (m), shape (m, 3).
    points: Array
    #: Red, green, blue and alpha from 0 to 1.
    colour: tuple[float, float, float, float]
    #: Text of the label.
    text: str = ""


@dataclass(frozen=True)
class ServoState:
    """Latest state of the servo."""

    #: Sentence on what limits the motion; empty if nothing does.
    text: str
    #: Speed of the robot as a fraction of the commanded speed.
    scale: float


class LiveRobot(Protocol):
    """Running robot as a page uses it; methods return at once, and results go to the view."""

    def begin(self, view: Any) -> None:
        """Report to this page from now on."""

    def plan(self, q: Array) -> None:
        """Plan a motion from the robot's posture to another one (n,) (rad or m)."""

    def execute(self, q: Array) -> None:
        """Plan such a motion, and execute it."""

    def stop(self) -> None:
        """Stop whatever moves the robot."""

    @property
    def gripper(self) -> GripperModel | None:
        """Its gripper; None if it has none, or none that takes commands."""

    @property
    def gripper_moves(self) -> bool:
        """True if a command to the gripper is under way."""

    def move_gripper(self, value: float) -> None:
        """Open or close the gripper to a value of :attr:`gripper`."""

    def follow_world(self, view: Any) -> None:
        """Send the planning scene to this layer, now and after each change."""

    def move_object(self, name: str, pose: Array) -> None:
        """Move an object around the robot to a pose (4, 4) in the base (m)."""

    def let_plans_wait(self, waiting: bool) -> None:
        """Set whether plans are executed on request only, or at once."""

    def want_markers(self, wanted: bool) -> None:
        """Subscribe to markers, or unsubscribe."""

    def hold(self, beat: HoldHeartbeat, frame: str, speed: float) -> None:
        """Jog while the page repeats this call.

        - ``beat``: message of the page; ignored if its press has ended.
        - ``frame``: frame whose axes the tip moves along, one of "base", "tip".
        - ``speed``: fraction of the greatest jogging speed, from 0 to 1.
        """

    def let_go(self) -> None:
        """End the jog."""


@dataclass(frozen=True, eq=False)
class Stance:
    """Stability of a walking machine."""

    #: The feet, and the mass centre above them.
    support: Support
    #: Stability margin that the walker publishes (m).
    margin: float
    #: Least margin that the walker keeps (m).
    bound: float
    #: Name of the present gait; empty if it is not known.
    gait: str


class LiveMobileRobot(Protocol):
    """Running mobile robot as a page uses it; methods return at once, results go to the view."""

    def begin(self, view: Any) -> None:
        """Report to this page from now on."""

    def stop(self) -> None:
        """End the jog, and command to stand."""

    def choose_gait(self, gait: str) -> None:
        """Request another gait."""

    def move_trunk(self, shift: Sequence[float]) -> None:
        """Request a trunk pose relative to the level one: x, y, z (m), roll, pitch, yaw (rad)."""

    def hold(self, beat: HoldHeartbeat, speed: float) -> None:
        """Jog while this call is repeated, at a fraction of the greatest jogging speed."""

    def let_go(self) -> None:
        """End the jog."""
