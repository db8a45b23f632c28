"""The displayed parallel robot: its joints, and the study of its platform."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import Status
from robomech_ros.outcomes import Code
from robomech_ros.parallel import Mechanism, ParallelRobot
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.rvs.model.bodies.visual_model import VisualModel
from robomech_ros.rvs.model.draggable import (
    OPEN_TURN,
    ROUNDING,
    DraggableRobot,
    SliderRange,
    slider_range,
)
from robomech_ros.rvs.model.platforms.ghosts import PlatformGhosts
from robomech_ros.rvs.model.platforms.lists import PlatformList
from robomech_ros.rvs.model.postures import PoseStudy, pose_summary
from robomech_ros.spatial import as_pose, matrix_from_axis_angle, pose_error
from robomech_ros.typing import Array

# Travel of a drive without a limit, in sizes of the robot.
OPEN_SIZES = 2.0
# Columns of a twist [angular; linear].
TWIST, ANGULAR, ABOUT_Z = 6, 3, 2
# Factor of the gizmo of a platform that only rotates.
AROUND = 3.0
# Negligible entries of twists, relative to the largest; steps towards an unreachable pose.
NOTHING, STEPS = 1e-9, 8


class PlatformView(DraggableRobot):
    """A parallel robot with its present posture, all loops closed."""

    kind, slider_noun = "parallel", "drive"

    def __init__(self, robot: ParallelRobot | Mechanism) -> None:
        self.robot, self.mechanism = robot, robot.mechanism
        mechanism = robot.mechanism
        super().__init__(
            mechanism.name,
            mechanism.base_link,
            mechanism.platform_link,
            _travels(mechanism, mechanism.home()),
            [mechanism.units[k] for k in mechanism.drive_index],
            mechanism.joint_names,
            mechanism.home(),
        )
        twists = np.abs(self.mechanism.twist_matrix(self._q)).max(axis=1)
        self._motions = tuple(np.flatnonzero(twists > NOTHING * twists.max()).tolist())
        self._list: PlatformList | None = None
        self._study = self._at_rest()
        # The limb that ended the last drag, from 0; None without one.
        self._faulty: int | None = None

    def follow(self, q: Array) -> None:
        """Take the joint values of a robot (rad or m)."""
        self._q, self._faulty = q, None
        self._study = self._at_rest()

    @property
    def values(self) -> Array:
        """Positions of the drives (rad or m)."""
        return np.asarray(self._q[self.mechanism.drive_index])

    @property
    def tip(self) -> Array:
        """Pose of the platform: ``T_base_platform`` (m), shape (4, 4)."""
        return self.mechanism.pose(self._q)

    @property
    def faulty_links(self) -> tuple[str, ...]:
        """The links of the limb that ended the last drag."""
        if self._faulty is None:
            return ()
        return tuple(self.mechanism.limbs[self._faulty].chain.links[1:-1])

    def gizmo(self, scale: float) -> dict[str, Any]:
        """Return the options of the gizmo: a size (m), and handles for the platform's motions."""
        turns = [k for k in range(ANGULAR) if k in self._motions]
        slides = [k for k in range(ANGULAR) if k + ANGULAR in self._motions]
        if not slides:
            # Larger than the platform, which is at the common point of all axes.
            return {"scale": AROUND * scale, "disable_axes": True, "disable_sliders": True}
        if turns == [ABOUT_Z]:
            return {"scale": scale, "active_axes": (True, True, False)}
        return {"scale": scale, "disable_rotations": not turns}

    def set_joint(self, joint: int, value: float) -> None:
        """Move one drive, the assembly mode stays; see ``DraggableRobot``."""
        drives, what = self.values, f"drive '{self.joint_names[joint]}'"
        drives[joint] = self.checked_slide(joint, value)
        found = self.mechanism.close(drives, self._q)
        if found.status != Code.NONE:
            raise BadValueError(what, value, f"what the robot can follow: {found.reason}")
        self._check_inside(found.q)
        self.follow(found.q)

    def move_to(self, q: ArrayLike) -> None:
        """Take a posture (n,) whose loops are closed."""
        given = np.array(q, dtype=np.float64)
        self._check_inside(given)
        self.follow(given)

    def drag(self, T: ArrayLike) -> None:
        """Move the platform to a pose, as near to the present posture as possible.

        Motions that the platform does not have are left out; one whose motions depend on each other
        goes to about the nearest pose.  If a limb does not reach, the robot stays, and the study
        names it.
        """
        target = self._possible(as_pose(T))
        found = self.mechanism.postures(target, seed=self._q)
        if len(found):
            self.follow(found.q[0])
            self._study = replace(self._study, target=target)
            return
        if self.mechanism is self.robot and self.mechanism.dof < TWIST:
            # Its motions depend on each other, so it hardly ever reaches a pose exactly.
            self.move_to(self._nearest(target))
            return
        self._faulty = int(np.argmax(found.excess)) if found.excess.any() else None
        self._study = pose_summary(target, f"Stopped: {found.reason}.", Status.OUT_OF_REACH)

    def release(self) -> None:
        """Release the gizmo; if the robot could not follow, it returns to the platform."""
        self.follow(self._q)

    def know(self, found: PlatformList) -> None:
        """Show a list of postures, even if the robot has moved since."""
        self._list = found
        if self._faulty is None:
            self._study = self._at_rest(self._study.target)

    def ghosts(self, seen: VisualModel, radius_scale: float | None = None) -> PlatformGhosts:
        """Return the pieces of ghosts."""
        return PlatformGhosts(self.mechanism, seen.reach, radius_scale or 1.0)

    def _at_rest(self, target: Array | None = None) -> PoseStudy:
        at = self.tip if target is None else target
        if self._list is None:
            return pose_summary(at, "Looking for other postures ...")
        known = self._list
        return pose_summary(at, known.text, postures=known.postures, complete=known.complete)

    def _possible(self, T: Array) -> Array:
        """Remove motions that the platform does not have."""
        present, motions = self.tip, self._motions
        for k in range(3):
            if k + ANGULAR not in motions:
                T[k, 3] = present[k, 3]
        if set(range(ANGULAR)) <= set(motions):
            return T
        R = present[:3, :3]
        if ABOUT_Z in motions:
            R = matrix_from_axis_angle([0.0, 0.0, 1.0], math.atan2(T[1, 0], T[0, 0]))
        T[:3, :3] = R
        return T

    def _nearest(self, T: Array) -> Array:
        """Follow the drives towards a pose, in the sense of least squares."""
        mechanism, q = self.mechanism, self._q
        scale = np.repeat((mechanism.size, 1.0), 3)
        for _ in range(STEPS):
            missing = scale * pose_error(T, mechanism.pose(q))
            step = np.linalg.lstsq(scale[:, None] * mechanism.twist_matrix(q), missing)[0]
            found = mechanism.close(q[mechanism.drive_index] + step, q)
            if found.status != Code.NONE:
                break
            q = found.q
        return q

    def _check_inside(self, q: Array) -> None:
        mechanism = self.mechanism
        off = mechanism.limit_excess(q)
        worst = int(np.argmax(off))
        if off[worst] > ROUNDING:
            low, high = float(mechanism.lower[worst]), float(mechanism.upper[worst])
            unit = mechanism.units[worst]
            expected = (
                f"{low:.6g} to {high:.6g} {unit}, or in its cone: {off[worst]:.3g} {unit} off"
            )
            joint = f"joint '{mechanism.joint_names[worst]}'"
            raise BadValueError(joint, float(q[worst]), expected)


def _travels(mechanism: Mechanism, home: Array) -> dict[str, SliderRange]:
    """Return the limits of each drive, or a range about its home."""
    travels = {}
    for name, index in zip(mechanism.actuated, mechanism.drive_index.tolist(), strict=True):
        about = (0.0, OPEN_TURN)
        if mechanism.types[index] == PRISMATIC:
            about = (float(home[index]), OPEN_SIZES * mechanism.size)
        low, high = (float(row[index]) for row in (mechanism.lower, mechanism.upper))
        travels[name] = slider_range(low, high, *about)
    return travels
