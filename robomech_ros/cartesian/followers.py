"""What a robot is to the planner of paths, and serial chains as such robots."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robomech_ros.cartesian.arms import serial_arm
from robomech_ros.cartesian.singular_parts import singular_part
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import tip_poses
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory import JointPath, Limits
from robomech_ros.trajectory.paths.arms import Tracked

__all__ = ["ChainFollower", "Follower", "as_follower"]

Array = NDArray[np.float64]


class Follower(Protocol):
    """A robot of n joints whose tip follows pose paths."""

    @property
    def limits(self) -> Limits:
        """Of all its joints, rad or m."""

    @property
    def timed(self) -> Sequence[int]:
        """Numbers of the joints whose motion over time is planned; the others follow from it."""

    @property
    def arm(self) -> Tracked:
        """What `track_path` follows paths with."""

    def tip_poses(self, q: Array, start: Array) -> Array:
        """Poses ``T_base_tip`` (m, 4, 4) of timed joints (m, t) on a way from a posture (n,)."""

    def singular_values(self, q: Array) -> Array:
        """Those of the Jacobian, lengths over the robot's size, largest first, of rows (m, n)."""

    def singular_part(self, joints: JointPath) -> str:
        """Say what is singular, or nearly, at the end of a joint path; empty if nothing is."""


class ChainFollower:
    """A serial chain as what follows paths.

    Parameters
    ----------
    chain : SerialChain
        Of n joints.
    """

    def __init__(self, chain: SerialChain) -> None:
        self.chain = chain
        self.timed = tuple(range(chain.n))

    @cached_property
    def limits(self) -> Limits:
        """Of all its joints, rad or m."""
        return Limits.of(self.chain)

    @cached_property
    def arm(self) -> Tracked:
        """What `track_path` follows paths with."""
        return serial_arm(self.chain)

    def tip_poses(self, q: Array, start: Array) -> Array:
        """Poses ``T_base_tip`` (m, 4, 4) of joint values (m, n)."""
        return tip_poses(self.chain, q)

    def singular_values(self, q: Array) -> Array:
        """Those of the Jacobian, lengths over the arm's size, largest first, of rows (m, n)."""
        scale = np.repeat([1.0, 1.0 / arm_size(self.chain)], 3)[:, None]
        return np.asarray(np.linalg.svd(scale * jacobian(self.chain, q), compute_uv=False))

    def singular_part(self, joints: JointPath) -> str:
        """Say what is singular, or nearly, at the end of a joint path; empty if nothing is."""
        return singular_part(self.chain, joints)


def as_follower(chain: SerialChain | Follower) -> Follower:
    """Give a chain, or another robot that can, as what follows paths.

    Raises
    ------
    BadValueError
        It is neither.
    """
    if isinstance(chain, SerialChain):
        return ChainFollower(chain)
    if hasattr(chain, "singular_part") and not isinstance(chain, type):
        return chain
    raise BadValueError("chain", chain, "a SerialChain, or a follower of a parallel robot")
