"""Robot models for the path planner, and serial chains as such models."""

from collections.abc import Sequence
from functools import cached_property
from typing import Protocol

import numpy as np

from robomech_ros.cartesian.arms import serial_arm
from robomech_ros.cartesian.singularity_names import ever_faster, singular_part
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import tip_poses
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import SerialChain
from robomech_ros.spatial.arrays import held_rows
from robomech_ros.trajectory import JointPath, Limits, SerialArm
from robomech_ros.trajectory.paths.arms import Tracked
from robomech_ros.trajectory.paths.partial_poses import partial_rank
from robomech_ros.typing import Array


class PathModel(Protocol):
    """A robot of n joints whose tip follows pose paths."""

    @property
    def limits(self) -> Limits:
        """Limits of all joints (rad or m)."""

    @property
    def timed(self) -> Sequence[int]:
        """Numbers of the joints whose motion over time is planned; the others follow from it."""

    @property
    def arm(self) -> Tracked:
        """Kinematic model with which `track_path` follows paths."""

    def tip_poses(self, q: Array, start: Array) -> Array:
        """Poses ``T_base_tip`` (m, 4, 4) of timed joints (m, t) on a way from a posture (n,)."""

    def singular_values(self, q: Array) -> Array:
        """Those of the Jacobian, lengths over the robot's size, largest first, of rows (m, n)."""

    def singular_part(self, joints: JointPath) -> str:
        """Say what is singular, or nearly, at the end of a joint path; empty if nothing is."""


class ChainPathModel:
    """A serial chain as what follows paths, with the task mask of `follow_path`."""

    def __init__(self, chain: SerialChain, task_mask: Sequence[bool] | None = None) -> None:
        self.chain, self._mask = chain, task_mask
        self.timed = tuple(range(chain.n))

    @cached_property
    def limits(self) -> Limits:
        """Limits of all joints (rad or m)."""
        return Limits.of(self.chain)

    @cached_property
    def arm(self) -> SerialArm:
        """Kinematic model with which `track_path` follows paths."""
        return serial_arm(self.chain, self._mask)

    def tip_poses(self, q: Array, start: Array) -> Array:
        """Poses ``T_base_tip`` (m, 4, 4) of joint values (m, n)."""
        return tip_poses(self.chain, q)

    def singular_values(self, q: Array) -> Array:
        """Those of the Jacobian, lengths over the arm's size, largest first, of rows (m, n).

        With a task mask, of those rows that are held, in axes of the tip.
        """
        J, held = jacobian(self.chain, q), self.arm.held
        scale = np.repeat([1.0, 1.0 / arm_size(self.chain)], 3)[:, None]
        if held is not None:
            back = np.swapaxes(tip_poses(self.chain, q)[:, :3, :3], 1, 2)
            J = np.concatenate([back @ J[:, :3], back @ J[:, 3:]], axis=1)[:, held]
            scale = scale[held]
        rank = 6 if held is None else partial_rank(self.arm, self.chain.n)
        return np.asarray(np.linalg.svd(scale * J, compute_uv=False)[:, :rank])

    def singular_part(self, joints: JointPath) -> str:
        """Say what is singular, or nearly, at the end of a joint path; empty if nothing is."""
        if self.arm.held is None:
            return singular_part(self.chain, joints)
        return ever_faster(self.chain.joint_names, self.chain.units, joints)


def as_path_model(
    chain: SerialChain | PathModel, task_mask: Sequence[bool] | None = None
) -> PathModel:
    """Return a chain, or another robot that can, as what follows paths."""
    if isinstance(chain, SerialChain):
        return ChainPathModel(chain, task_mask)
    if hasattr(chain, "singular_part") and not isinstance(chain, type):
        if task_mask is not None and len(held_rows("task_mask", task_mask)) not in (0, 6):
            expected = "all True or all False: only serial arms can leave components free"
            raise BadValueError("task_mask", list(task_mask), expected)
        return chain
    raise BadValueError("chain", chain, "a SerialChain, or a follower of a parallel robot")
