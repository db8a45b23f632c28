"""A robot that is neither an arm nor parallel: joints of a tree, and a dragged link."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import Status
from robomech_ros.robots import RobotDescription
from robomech_ros.rvs.model.draggable import DraggableRobot, SliderRange
from robomech_ros.rvs.model.postures import PoseStudy, pose_summary
from robomech_ros.spatial import as_pose
from robomech_ros.typing import Array


class TreeView(DraggableRobot):
    """A robot with its present joints; not for several threads at a time.

    A view of a kind of robots overrides ``dragged``.

    - ``travels``: range of the slider of each joint (rad or m).
    - ``end``: the link that is dragged; its poses refer to the root.
    """

    def __init__(
        self, description: RobotDescription, travels: Mapping[str, SliderRange], end: str
    ) -> None:
        self.description = description
        unit_of = {
            joint.name: "m" if joint.type == "prismatic" else "rad" for joint in description.joints
        }
        home, joints = description.joint_positions(description.home), description.joint_names
        super().__init__(
            description.name,
            description.root,
            end,
            travels,
            [unit_of[name] for name in travels],
            joints,
            np.array([home[name] for name in joints], dtype=np.float64),
        )
        self._number = {name: k for k, name in enumerate(joints)}
        self._text, self._refused = "", False
        self._faulty: tuple[str, ...] = ()

    lists_postures = False

    @property
    def values(self) -> Array:
        """Positions of the joints with sliders (rad or m)."""
        return self._q[[self._number[name] for name in self.joint_names]]

    @property
    def tip(self) -> Array:
        """Pose of the dragged link (m), shape (4, 4)."""
        return np.asarray(self.description.link_poses(self.positions)[self.end])

    @property
    def study(self) -> PoseStudy:
        """Study of the pose."""
        status = Status.OUT_OF_REACH if self._refused else Status.SUCCESS
        return pose_summary(self.tip, self._text, status)

    @property
    def faulty_links(self) -> tuple[str, ...]:
        """Links that block the requested motion."""
        return self._faulty

    def report(self, text: str, faulty: Sequence[str] = (), *, refused: bool = False) -> None:
        """Set the sentence of the study, or the reason for a rejection; and mark links."""
        self._text, self._faulty, self._refused = text, tuple(faulty), refused

    def place(self, positions: Mapping[str, float]) -> None:
        """Set joints (rad or m); the others stay."""
        self._q = self._q.copy()
        for name, value in positions.items():
            self._q[self._number[name]] = value

    def set_joint(self, joint: int, value: float) -> None:
        """Move one joint; see ``DraggableRobot``."""
        self.place({self.joint_names[joint]: self.checked_slide(joint, value)})

    def move_to(self, q: ArrayLike) -> None:
        """Take a posture (n,) (rad or m)."""
        self.place(self.positions_of(np.array(q, dtype=np.float64)))

    def drag(self, T: ArrayLike) -> None:
        """Move the link to a pose (4, 4) in the root (m), as far as possible.

        Raises RobomechError: the matrix is not a pose, or the robot cannot take it and stays.
        """
        self.place(self.dragged(as_pose(T)))

    def dragged(self, T: Array) -> Mapping[str, float]:
        """Return the joints that change when the link moves to a pose."""
        raise BadValueError("pose", T.tolist(), f"none: '{self.end}' is not dragged")
