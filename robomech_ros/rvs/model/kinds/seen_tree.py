"""A robot that is neither an arm nor parallel: joints of a tree, and a link that is dragged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import Status
from robomech_ros.numerics.arrays import finite_number
from robomech_ros.robots import RobotDescription
from robomech_ros.rvs.model.arm import ROUNDING, Travel
from robomech_ros.rvs.model.ghosts import GhostMaker, GhostPieces, Rgb
from robomech_ros.rvs.model.postures import PoseStudy, ToldStudy
from robomech_ros.rvs.model.seen_robot import SeenRobot
from robomech_ros.spatial import as_pose

__all__ = ["NoGhosts", "SeenTree"]

Array = NDArray[np.float64]


class SeenTree:
    """A robot with its present joints; not for several threads at a time.

    What takes part of a kind overrides ``dragged``.

    Parameters
    ----------
    description : RobotDescription
    travels : mapping of str to Travel
        Between what each slider moves its joint (rad or m).
    end : str
        The link that is dragged, in the root.
    """

    def __init__(
        self, description: RobotDescription, travels: Mapping[str, Travel], end: str
    ) -> None:
        self.description, self._end = description, end
        self._travels = dict(travels)
        self._joints = description.joint_names
        self._units = {
            joint.name: "m" if joint.type == "prismatic" else "rad" for joint in description.joints
        }
        at = description.joint_positions(description.home)
        self._at = {name: float(at[name]) for name in self._joints}
        self._home = dict(self._at)
        self._text, self._refused = "", False
        self._faulty: tuple[str, ...] = ()

    # See ``Moved``.
    lists_postures = False

    @property
    def room(self) -> float:
        """Side of the square around it that is to be seen (m); 0 for what it fills itself."""
        return 0.0

    @property
    def name(self) -> str:
        """What the robot is called."""
        return self.description.name

    @property
    def base(self) -> str:
        """The root, in which poses are."""
        return self.description.root

    @property
    def end(self) -> str:
        """The link that is dragged."""
        return self._end

    @property
    def q(self) -> Array:
        """All joints (rad or m), shape (n,)."""
        return np.array([self._at[name] for name in self._joints])

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The joints that sliders move."""
        return tuple(self._travels)

    @property
    def units(self) -> tuple[str, ...]:
        """Of these joints."""
        return tuple(self._units[name] for name in self._travels)

    @property
    def state_joints(self) -> tuple[str, ...]:
        """All joints."""
        return self._joints

    @property
    def values(self) -> Array:
        """Where the joints with sliders are (rad or m)."""
        return np.array([self._at[name] for name in self._travels])

    @property
    def positions(self) -> dict[str, float]:
        """All joints by name (rad or m)."""
        return dict(self._at)

    def positions_of(self, q: Array) -> dict[str, float]:
        """Name the joints of a posture (n,)."""
        return dict(zip(self._joints, q.tolist(), strict=True))

    @property
    def tip(self) -> Array:
        """Where the link that is dragged is (m), shape (4, 4)."""
        return np.asarray(self.description.link_poses(self._at)[self._end])

    @property
    def target(self) -> Array:
        """Where the gizmo is: at that link (m), shape (4, 4)."""
        return self.tip

    @property
    def study(self) -> PoseStudy:
        """What is told of it."""
        status = Status.OUT_OF_REACH if self._refused else Status.SUCCESS
        return ToldStudy(self.tip, (), True, status, "", text=self._text)

    @property
    def faulty_links(self) -> tuple[str, ...]:
        """Links that are in the way of what was asked for."""
        return self._faulty

    def tell(self, text: str, faulty: Sequence[str] = (), *, refused: bool = False) -> None:
        """Say what is known, in a sentence, or why something is refused; and mark links."""
        self._text, self._faulty, self._refused = text, tuple(faulty), refused

    def place(self, positions: Mapping[str, float]) -> None:
        """Put joints where they are (rad or m); the others stay."""
        self._at.update({name: float(value) for name, value in positions.items()})

    def follow(self, q: Array) -> None:
        """Be where a robot is, all joints (rad or m)."""
        self.place(self.positions_of(q))

    def gizmo(self, scale: float) -> dict[str, Any]:
        """Give the options of the gizmo: a size (m)."""
        return {"scale": scale}

    def travel(self, joint: int) -> Travel:
        """Give between what a slider moves."""
        return self._travels[self.joint_names[joint]]

    def set_joint(self, joint: int, value: float) -> None:
        """Move one joint (rad or m).

        Raises
        ------
        BadValueError
            It is no finite number, or outside the travel: the joint stays.
        """
        name = self.joint_names[joint]
        what, unit = f"joint '{name}'", self._units[name]
        given = finite_number(what, value, unit)
        low, high = self._travels[name]
        if not low - ROUNDING <= given <= high + ROUNDING:
            raise BadValueError(what, value, f"{low:.6g} to {high:.6g} {unit}")
        self.place({name: min(max(given, low), high)})

    def move_to(self, q: ArrayLike) -> None:
        """Take a posture (n,) (rad or m)."""
        self.follow(np.array(q, dtype=np.float64))

    def go_home(self) -> None:
        """Go to where it began."""
        self.place(self._home)

    def drag(self, T: ArrayLike) -> None:
        """Bring the link to a pose (4, 4), as far as it can, in the root (m).

        Raises
        ------
        RobomechError
            It is no pose, or the robot cannot take it: it stays.
        """
        self.place(self.dragged(as_pose(T)))

    def dragged(self, T: Array) -> Mapping[str, float]:
        """Give the joints that change as the link is brought to a pose.

        Raises
        ------
        BadValueError
            The link is not moved so.
        """
        raise BadValueError("pose", T.tolist(), f"none: '{self._end}' is not dragged")

    def release(self) -> None:
        """Let go of the gizmo, which is where the robot is."""

    def take(self, number: int) -> None:
        """Refuse to take a posture: none is listed.

        Raises
        ------
        BadValueError
        """
        raise BadValueError("posture", number + 1, "nothing: there is none")

    def self_motion(self) -> None:
        """Give nothing: no link is held."""

    def slide(self, length: float) -> None:
        """Refuse to move along a self-motion.

        Raises
        ------
        BadValueError
        """
        raise BadValueError("self-motion", length, "an arm of more than six joints")

    def ghosts(self, seen: SeenRobot) -> GhostMaker:
        """Give the pieces of ghosts: none."""
        return NoGhosts()


class NoGhosts:
    """Ghosts of a robot that has none."""

    pieces = 0

    def placed(self, postures: Sequence[Array], colours: Sequence[Rgb]) -> GhostPieces:
        """Place no piece."""
        empty = np.empty((0, 3))
        return GhostPieces(empty, np.empty((0, 4)), empty, np.empty((0, 3), dtype=np.uint8))

    def middles(self, postures: Sequence[Array]) -> Array:
        """Write no number."""
        return np.empty((0, 3))
