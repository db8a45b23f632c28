"""A robot that a page can move: an arm by its tip, a platform, an object in a hand."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError
from robomech_ros.kinetostatics import SelfMotionCurve
from robomech_ros.numerics.arrays import finite_number
from robomech_ros.robots.robot_kinds import ARM
from robomech_ros.rvs.model.bodies.visual_model import VisualModel
from robomech_ros.rvs.model.ghosts import GhostMaker, NoGhosts
from robomech_ros.rvs.model.postures import PoseStudy
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.rvs.model.world import WorldView

# Half the travel of sliders of turning joints without a limit (rad).
OPEN_TURN = 2.0 * math.pi
# A typed number may exceed a limit by the rounding of shown values (rad or m): fields
# have four decimals, or two of degrees.
ROUNDING = 9e-5


class SliderRange(NamedTuple):
    """Range of a joint's slider (rad or m)."""

    low: float
    high: float


def slider_range(low: float, high: float, middle: float, most: float) -> SliderRange:
    """Return the limits of a joint, or a range about a middle where it has none (rad or m)."""
    low = low if math.isfinite(low) else min(middle - most, high - most)
    return SliderRange(low, high if math.isfinite(high) else max(middle + most, low + most))


class DraggableRobot(ABC):
    """A robot with its present posture; not for several threads at a time.

    - ``name``: name of the robot.
    - ``base``, ``end``: the link that poses refer to, and the link that is dragged.
    - ``travels``: joints that sliders move, and their ranges.
    - ``units``: units of these joints, "rad" or "m".
    - ``state_joints``: names of the n joints of a posture.
    - ``home``: initial posture (rad or m), shape (n,).
    - ``lists_postures``: whether postures are listed for selection.
    - ``slider_noun``: name of a slider in errors.
    - ``room``: least side of the ground around the robot (m).
    """

    #: Kind of the robot in its document; empty for an arm.
    kind: ClassVar[str] = ARM
    lists_postures, slider_noun, room = True, "joint", 0.0
    #: The objects around the robot; None if they are not known.
    world: WorldView | None = None
    _study: PoseStudy

    def __init__(
        self,
        name: str,
        base: str,
        end: str,
        travels: Mapping[str, SliderRange],
        units: Sequence[str],
        state_joints: Sequence[str],
        home: Array,
    ) -> None:
        self.name, self.base, self.end = name, base, end
        self.joint_names, self.units = tuple(travels), tuple(units)
        self.state_joints = tuple(state_joints)
        self._travels = tuple(travels.values())
        self._q = self._home = home

    @property
    def q(self) -> Array:
        """Present posture, all joints (rad or m)."""
        return self._q

    @property
    def values(self) -> Array:
        """Positions of the joints that sliders move (rad or m)."""
        return self._q

    @property
    def positions(self) -> dict[str, float]:
        """All joints by name (rad or m)."""
        return self.positions_of(self.q)

    def positions_of(self, q: Array) -> dict[str, float]:
        """Return the joints of a posture (n,) by name."""
        return dict(zip(self.state_joints, q.tolist(), strict=True))

    @property
    def study(self) -> PoseStudy:
        """Study of the pose that the end has or is dragged to."""
        return self._study

    @property
    def posture_contacts(self) -> tuple[str, ...]:
        """Texts that name the bodies in contact in each posture of the study; empty for none."""
        return ("",) * len(self.study.postures)

    @property
    def target(self) -> Array:
        """Pose of the gizmo in the base (m), shape (4, 4)."""
        return self.study.target

    @property
    @abstractmethod
    def tip(self) -> Array:
        """Pose of the end in the base (m), shape (4, 4)."""

    @property
    def faulty_links(self) -> tuple[str, ...]:
        """Links that block the requested motion."""
        return ()

    def gizmo(self, scale: float) -> dict[str, Any]:
        """Return the options of viser's transform controls: a size (m), handles."""
        return {"scale": scale}

    def travel(self, joint: int) -> SliderRange:
        """Return the range of a slider."""
        return self._travels[joint]

    def checked_slide(self, joint: int, value: float) -> float:
        """Check a value of a slider (rad or m), and round it into its range."""
        what, unit = f"{self.slider_noun} '{self.joint_names[joint]}'", self.units[joint]
        given, (low, high) = finite_number(what, value, unit), self.travel(joint)
        if not low - ROUNDING <= given <= high + ROUNDING:
            raise BadValueError(what, value, f"{low:.6g} to {high:.6g} {unit}")
        return min(max(given, low), high)

    @abstractmethod
    def set_joint(self, joint: int, value: float) -> None:
        """Move one joint (rad or m); a BadValueError if the robot cannot follow, and it stays."""

    @abstractmethod
    def move_to(self, q: ArrayLike) -> None:
        """Take a posture (n,) (rad or m); a BadValueError if a joint is outside its limits."""

    def follow(self, q: Array) -> None:
        """Take all joint values of a robot (rad or m)."""
        self.move_to(q)

    def go_home(self) -> None:
        """Return to the first posture."""
        self.follow(self._home)

    @abstractmethod
    def drag(self, T: ArrayLike) -> None:
        """Move the end to a pose (4, 4), in the base (m).

        Raises RobomechError: the matrix is not a pose, or the robot cannot take it and stays.
        """

    def release(self) -> None:
        """Release the gizmo."""
        return

    def take(self, number: int) -> None:
        """Take one of the postures of the study, counted from 0; the nearest if there is none."""
        known = [posture.q for posture in self.study.postures]
        if not known and self.study.nearest is not None:
            known = [self.study.nearest]
        if number not in range(len(known)):
            expected = f"1 to {len(known)}" if known else "nothing: there is none"
            raise BadValueError("posture", number + 1, expected)
        self.move_to(known[int(number)])

    def self_motion(self) -> SelfMotionCurve | None:
        """Return its self-motion at the present pose; None if there is none."""
        return None

    def slide(self, length: float) -> None:
        """Move along the self-motion (rad or m from its beginning), as far as limits allow."""
        raise BadValueError("self-motion", length, "an arm of more than six joints")

    def ghosts(self, seen: VisualModel, radius_scale: float | None = None) -> GhostMaker:
        """Return the maker of ghosts at a factor of their radii; by default it makes none."""
        return NoGhosts()
