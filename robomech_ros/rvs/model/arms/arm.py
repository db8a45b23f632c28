"""The displayed arm: its posture, the pose to which it is dragged, and the study of that pose."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import SelfMotionCurve, self_motion_curve
from robomech_ros.numerics.arrays import finite_number
from robomech_ros.robots import PRISMATIC, SerialChain
from robomech_ros.rvs.model.bodies.visual_model import VisualModel
from robomech_ros.rvs.model.draggable import OPEN_TURN, ROUNDING, DraggableRobot, slider_range
from robomech_ros.rvs.model.ghosts import RADIUS_SCALE, Ghosts
from robomech_ros.rvs.model.postures import study_pose
from robomech_ros.spatial import as_pose
from robomech_ros.typing import Array

# Half the travel of sliders of sliding joints without a limit (m).
OPEN_SLIDE = 1.0
# Conditions of a pose; an arm with fewer joints hardly ever reaches one exactly.
CONDITIONS = 6


class ArmView(DraggableRobot):
    """An arm with its present posture and the desired pose of its tip.

    - ``q``: initial posture (rad or m), shape (n,); default its home.
    - ``others``: joints beside the chain, such as those of a gripper (rad or m).
    """

    def __init__(self, chain: SerialChain, q: ArrayLike | None = None) -> None:
        joints, ends = chain.joint_names, (chain.base, chain.tip)
        rows = zip(joints, chain.lower.tolist(), chain.upper.tolist(), chain.types, strict=True)
        travels = {
            name: slider_range(low, high, 0.0, OPEN_SLIDE if kind == PRISMATIC else OPEN_TURN)
            for name, low, high, kind in rows
        }
        super().__init__(chain.name, *ends, travels, chain.units, joints, chain.home())
        self.chain = chain
        self.others: dict[str, float] = {}
        if q is not None:
            self._q = self.checked(q)
        self._curve: SelfMotionCurve | None = None
        self._look_around()

    def follow(self, q: Array) -> None:
        """Take the joint values of a robot (rad or m), clipped to the limits."""
        self.move_to(np.clip(q, self.chain.lower, self.chain.upper))

    @property
    def posture_contacts(self) -> tuple[str, ...]:
        """Texts that name the bodies in contact in each posture of the study; empty for none."""
        if self.world is None:
            return super().posture_contacts
        self.world.place_others(self.others)
        return tuple(self.world.contact(posture.q) for posture in self.study.postures)

    @property
    def faulty_links(self) -> tuple[str, ...]:
        """Links that are in contact."""
        return () if self.world is None else self.world.touching(self._q)

    def positions_of(self, q: Array) -> dict[str, float]:
        """Return the joints of a posture (n,) and those beside the arm, by name."""
        return {**self.others, **super().positions_of(q)}

    @property
    def tip(self) -> Array:
        """Pose of the tip: ``T_base_tip`` (m), shape (4, 4)."""
        return forward_kinematics(self.chain, self._q)

    def checked(self, q: ArrayLike) -> Array:
        """Check a posture."""
        values = np.array(q, dtype=np.float64)
        forward_kinematics(self.chain, values)
        lower, upper = self.chain.lower, self.chain.upper
        inside = (values >= lower - ROUNDING) & (values <= upper + ROUNDING)
        if not inside.all():
            k = int(np.argmin(inside))
            expected = f"{lower[k]:.6g} to {upper[k]:.6g} {self.units[k]}"
            raise BadValueError(f"joint '{self.joint_names[k]}'", float(values[k]), expected)
        return np.clip(values, lower, upper)

    def like(self, chain: SerialChain) -> ArmView:
        """Return another arm in the same posture, or at home if it has no such posture."""
        same = chain.joint_names == self.chain.joint_names
        inside = same and bool(((self._q >= chain.lower) & (self._q <= chain.upper)).all())
        return ArmView(chain, self._q if inside else None)

    def set_joint(self, joint: int, value: float) -> None:
        """Move one joint; see ``DraggableRobot``."""
        values = self._q.copy()
        what = f"joint '{self.chain.joint_names[joint]}'"
        values[joint] = finite_number(what, value, self.chain.units[joint])
        self.move_to(values)

    def move_to(self, q: ArrayLike) -> None:
        """Take a posture; raises as :meth:`checked` does."""
        self._q = self.checked(q)
        self._look_around()

    def ghosts(self, seen: VisualModel, radius_scale: float | None = None) -> Ghosts:
        """Return the pieces of ghosts."""
        scale = RADIUS_SCALE if radius_scale is None else radius_scale
        return Ghosts(seen.tree.chain(self.base, self.end), seen.shapes, scale)

    def drag(self, T: ArrayLike) -> None:
        """Move the tip to a pose, in the posture nearest to the present one.

        If no posture reaches it, the arm stays, unless it has too few joints for poses in general:
        then it goes to the posture that misses the pose least.
        """
        study = study_pose(self.chain, as_pose(T), self._q)
        self._curve_known = False
        nearest = study.nearest_posture
        if nearest is not None:
            self._q = self.checked(nearest.q)
        elif self.chain.n < CONDITIONS and study.nearest is not None:
            self._q = self.checked(study.nearest)
        self._study = study

    def release(self) -> None:
        """Release the gizmo; if the arm could not follow, it returns to the tip."""
        self._look_around()

    def self_motion(self) -> SelfMotionCurve | None:
        """Return the self-motion of the arm at its pose; None if there is none.

        It begins at the last set posture; :meth:`slide` moves the arm along it.
        """
        if not self._curve_known:
            self._curve, self._curve_known = self_motion_curve(self.chain, self._q), True
        return self._curve

    def slide(self, length: float) -> None:
        """Move along the self-motion; see ``DraggableRobot``."""
        wanted = finite_number("self-motion", length, "rad or m")
        curve = self.self_motion()
        if curve is None:
            super().slide(length)
            return
        self._q = curve.at(wanted)
        self._study = study_pose(self.chain, self.tip, self._q)

    def _look_around(self) -> None:
        self._curve_known = False
        self._study = study_pose(self.chain, self.tip, self._q)
