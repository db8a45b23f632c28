"""Motions of chains, all of whose joints trajectories hold."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from sensor_msgs.msg import JointState

from robomech_ros.cartesian import CartesianPlan, plan_along
from robomech_ros.cartesian.arms import load_inverse_kinematics
from robomech_ros.kinematics import forward_kinematics, tip_poses
from robomech_ros.nodes.common.joints.joint_positions import JointPositions
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory import Limits, PosePath, SampledPlan
from robomech_ros.trajectory.plans.fitting_plan import fitting_plan
from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class Planned:
    """A motion of the joints of trajectories."""

    sampled: SampledPlan
    #: Gives the poses (m, 4, 4) of the tip in the base at its samples; it may take long.
    poses: Callable[[], Array]


class ChainMotions:
    """Plans motions of a chain of n joints, all of which trajectories hold.

    `PlatformMotions` has the same methods.
    """

    def __init__(self, chain: SerialChain, joints: JointPositions) -> None:
        self.way, self.limits, self._joints = chain, Limits.of(chain), joints

    def commanded(self, q: Array) -> Array:
        """Return all joints."""
        return q

    def read_goal(self, state: JointState) -> tuple[Array, Array | None]:
        """Read the goal, shape (n,)."""
        return self._joints.read(self.way, state, "goal"), None

    def check_start(self, q: Array) -> None:
        """Accept every start: a chain can come to it."""

    def tip_pose(self, q: Array) -> Array:
        """Pose of the tip in the base (4, 4)."""
        return forward_kinematics(self.way, q)

    def through(
        self, points: Array, start: Array, goal: Array | None, options: dict[str, Any]
    ) -> Planned:
        """Plan through points (k, n)."""
        sampled = fitting_plan(self.limits, points, **options)
        return Planned(sampled, partial(tip_poses, self.way, sampled.waypoints.positions))

    def along(
        self, path: PosePath, start: Array, kept: float, options: dict[str, Any]
    ) -> CartesianPlan:
        """Plan along a path of the tip within a part of the limits of rates."""
        limits = self.limits.scaled(velocity=kept, acceleration=kept, jerk=kept)
        return plan_along(self.way, path, start, limits=limits, **options)

    def poses_along(self, plan: CartesianPlan) -> Array:
        """Find the poses (k, 4, 4) of the tip at the samples of a plan."""
        assert plan.samples is not None
        return tip_poses(self.way, plan.samples.positions)

    def warm_up(self) -> None:
        """Load inverse kinematics."""
        load_inverse_kinematics()
