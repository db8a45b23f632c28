"""A mechanism as what follows pose paths: all its limbs together."""

from __future__ import annotations

from functools import cached_property, partial
from typing import Any

import numpy as np

from robomech_ros.cartesian.singularity_names import ever_faster
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.motion.drive_paths import follow_drives
from robomech_ros.parallel.motion.singularity_check import named_singularity, singular_values
from robomech_ros.trajectory import JoinedArms, JointLimits, JointPath, Limits, SerialArm
from robomech_ros.typing import Array

# A limb whose Jacobian, lengths over the size, is conditioned worse than this is singular.
_SINGULAR_LIMB = 1e3
# A mechanism conditioned worse than this is nearly singular.
_NEARLY = 20.0


class MechanismPathModel:
    """A parallel robot as what `follow_path` and `plan_along` move along paths of its platform.

    Joint paths hold all joints.  Motions over time hold the drives, and the passive joints that
    have limits of velocity or acceleration.

    Parameters
    ----------
    mechanism : Mechanism
        Mechanism of n joints.
    limits : JointLimits, optional
        Limits of all n joints; default those of the mechanism.

    Attributes
    ----------
    limits : Limits
        Limits of all its joints, rad or m.
    timed : tuple of int
        Numbers of the joints whose motion over time is planned.
    """

    def __init__(self, mechanism: Mechanism, limits: JointLimits | Any = None) -> None:
        if not isinstance(mechanism, Mechanism):
            raise BadValueError("mechanism", mechanism, "a Mechanism")
        self.mechanism = mechanism
        self.limits = Limits.of(mechanism if limits is None else limits)
        if len(self.limits.joint_names) != mechanism.n:
            raise WrongSizeError("joints of limits", len(self.limits.joint_names), mechanism.n)
        limited = np.isfinite(self.limits.velocity) | np.isfinite(self.limits.acceleration)
        limited[mechanism.drive_index] = True
        self.timed = tuple(np.flatnonzero(limited).tolist())

    @cached_property
    def arm(self) -> JoinedArms:
        """The limbs as arms that hold one platform."""
        chains = [limb.chain for limb in self.mechanism.limbs]
        return JoinedArms(
            tuple(
                # If a limb is lost all limbs are asked together.
                SerialArm(
                    partial(forward_kinematics, chain), lambda *_: None, partial(jacobian, chain)
                )
                for chain in chains
            ),
            tuple(chain.n for chain in chains),
            self._nearest,
        )

    def _nearest(self, T: Array, near: Array) -> Array | None:
        try:
            found = self.mechanism.postures(T, seed=near).q
        except BadValueError:  # a pose that no platform of this kind can have
            return None
        return found[0] if len(found) else None

    def tip_poses(self, q: Array, start: Array) -> Array:
        """Poses ``T_base_platform`` (m, 4, 4) of timed joints (m, t) on a way from a posture."""
        index = self.mechanism.drive_index
        columns = np.searchsorted(self.timed, index)
        found = follow_drives(self.mechanism, q[:, columns], start)
        if found.stop is not None:
            raise BadValueError("way of the drives", found.reason, "one in one assembly mode")
        return self.mechanism.pose(found.q)

    def singular_values(self, q: Array) -> Array:
        """Those of the twists that the drives give, lengths over the size, of rows (m, n)."""
        return singular_values(self.mechanism, q)

    def singular_part(self, joints: JointPath) -> str:
        """Say what is singular, or nearly, at the end of a joint path; empty if nothing is."""
        start, q = joints.derivatives(np.array([0.0, joints.length]))[0]
        limb = self._singular_limb(q)
        if limb is not None:
            drives = ", ".join(self.mechanism.limbs[limb].actuated)
            return f"limb {limb + 1} (of drive {drives}) is singular"
        values = singular_values(self.mechanism, q[None])[0]
        if values[0] > _NEARLY * values[-1]:
            return named_singularity(self.mechanism, start, q)
        return ever_faster(self.limits.joint_names, self.limits.units, joints)

    def _singular_limb(self, q: Array) -> int | None:
        worst, found = _SINGULAR_LIMB, None
        scale = np.repeat([1.0, 1.0 / self.mechanism.size], 3)[:, None]
        for k, limb in enumerate(self.mechanism.limbs):
            slides = np.array(limb.chain.units) == "m"
            J = scale * jacobian(limb.chain, q[self.mechanism.loops.joints_of(k)])
            values = np.linalg.svd(J * np.where(slides, self.mechanism.size, 1.0), compute_uv=False)
            condition = values[0] / values[-1] if values[-1] > 0.0 else np.inf
            if condition > worst:
                worst, found = float(condition), k
        return found
