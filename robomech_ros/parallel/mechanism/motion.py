"""Motions of closed loops: poses, rates and accelerations of all joints and of the platform."""

from __future__ import annotations

import numpy as np

from robomech_ros.errors import LoopClosureError
from robomech_ros.parallel.argument_checks import actuated as checked_drives
from robomech_ros.parallel.mechanism.loops import Loops
from robomech_ros.parallel.result import LoopClosure
from robomech_ros.spatial.arrays import as_finite
from robomech_ros.typing import Array, ArrayLike


class LoopMotion:
    """Positions and motion of the joints of closed loops, n joints with dof drives.

    Joint values q, shape (..., n), are those of all joints (rad or m). Methods of velocities and
    accelerations take such that close all loops, and raise what :meth:`rates` does.
    """

    def __init__(self, loops: Loops, n: int, dof: int) -> None:
        self.loops, self.n, self.dof = loops, n, dof

    def pose(self, q: ArrayLike) -> Array:
        """Compute ``T_base_platform`` (..., 4, 4) (m), by the joints of the first limb."""
        return np.ascontiguousarray(self.limb_poses(q)[..., 0, :, :])

    def limb_poses(self, q: ArrayLike) -> Array:
        """Compute where each limb holds the platform: the same pose where all loops are closed.

        The poses (..., limbs, 4, 4) are in the base (m).
        """
        return self.loops.limb_poses(self._all_joints("q", q))

    def loop_errors(self, q: ArrayLike) -> Array:
        """Measure how far each limb holds the platform from where the first one does.

        They are distances (m) and angles (rad), (..., limbs, 2); 0 for the first limb.
        """
        poses = self.limb_poses(q)
        away = poses - poses[..., :1, :, :]
        distance = np.linalg.norm(away[..., :3, 3], axis=-1)
        # A rotation by an angle changes its matrix by the norm 2 sqrt(2) sin(angle/2).
        chord = np.linalg.norm(away[..., :3, :3], axis=(-2, -1)) / np.sqrt(8.0)
        return np.stack((distance, 2.0 * np.arcsin(np.minimum(chord, 1.0))), axis=-1)

    def open_loops(self, q: Array, what: str, expected: str = "closed loops") -> LoopClosureError:
        """Return the error that names the widest gap of postures, shape (..., n), called `what`.

        Of several postures it counts them from 0.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            errors = self.loop_errors(q)
        widest = np.unravel_index(int(errors.max(axis=-1).argmax()), errors.shape[:-1])
        *at, limb = (int(k) for k in widest)
        distance, angle = errors[widest].tolist()
        which = "".join(f"[{k}]" for k in at)
        return LoopClosureError(f"{what}{which}", limb + 1, distance, angle, expected)

    def close(self, actuated: ArrayLike, near: ArrayLike) -> LoopClosure:
        """Find all joints for positions of the drives (m,), in the assembly mode of a posture near.

        The drives go from where they are to the given positions on a straight way, in steps of
        which each is proved to meet no singularity, up to rounding; in front of one they end. The
        posture ``near`` (n,) has closed loops or nearly (rad or m).
        """
        target = checked_drives("actuated", actuated, self.dof)
        return self.loops.close(target, checked_drives("near", near, self.n))

    def rates(self, q: ArrayLike, actuated_rates: ArrayLike) -> tuple[Array, Array]:
        """Compute the rates of all joints, and the twist of the platform, for rates of the drives.

        All joints are (..., n), rates of the drives (..., m), rad/s or m/s. Returns rates (..., n)
        and the twist (..., 6), [angular velocity; velocity of the platform's origin] in the base
        (rad/s, m/s). Raises BadValueError for other numbers of joints and drives, or a posture in
        which the drives do not determine the motion.
        """
        given = as_finite("actuated_rates", actuated_rates, (self.dof,))
        qd, twist = self.loops.rates(self._all_joints("q", q), given[..., None])
        return qd[..., 0], twist[..., 0]

    def complement(self, q: ArrayLike) -> Array:
        """Compute the complement N (..., n, m) of the loops: ``qd = N qd_actuated``.

        References
        ----------
        Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 12.2.
        """
        return self.loops.rates(self._all_joints("q", q), np.eye(self.dof))[0]

    def twist_matrix(self, q: ArrayLike) -> Array:
        """Compute the map (..., 6, m) from drive rates to the platform's twist in the base."""
        return self.loops.rates(self._all_joints("q", q), np.eye(self.dof))[1]

    def accelerations(
        self, q: ArrayLike, qd: ArrayLike, actuated_accelerations: ArrayLike
    ) -> tuple[Array, Array]:
        """Compute accelerations of all joints and the platform, for those of the drives (..., m).

        All joints and their rates (..., n) are those of closed loops, from :meth:`rates`. Returns
        accelerations (..., n), rad/s^2 or m/s^2, and (..., 6), [angular acceleration; acceleration
        of the platform's origin] in the base.
        """
        joints, speeds = self._all_joints("q", q), self._all_joints("qd", qd)
        given = as_finite("actuated_accelerations", actuated_accelerations, (self.dof,))
        return self.loops.accelerations(joints, speeds, given)

    def _all_joints(self, what: str, q: ArrayLike) -> Array:
        return as_finite(what, q, (self.n,))
