"""Joint motions of a robot for the planner: the joints of trajectories, and their planning."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from sensor_msgs.msg import JointState

from robomech_ros.cartesian import CartesianPlan
from robomech_ros.nodes.common.joint_positions import Way
from robomech_ros.trajectory import Limits, PosePath, SampledPlan
from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class Planned:
    """A motion of the joints of trajectories.

    Attributes
    ----------
    sampled : SampledPlan
    poses : callable
        Gives the poses (m, 4, 4) of the tip in the base at its samples; it may take long.
    """

    sampled: SampledPlan
    poses: Callable[[], Array]


class JointMotions(Protocol):
    """Plans motions of one robot.

    Attributes
    ----------
    limits : Limits
        Of the m joints that trajectories hold.
    """

    limits: Limits

    @property
    def way(self) -> Way:
        """The chain or mechanism whose posture, of n joints, a motion starts from."""

    def commanded(self, q: Array) -> Array:
        """Pick the joints of trajectories, shape (m,), of a posture, shape (n,)."""

    def read_goal(self, state: JointState) -> tuple[Array, Array | None]:
        """Read the goal of the joints of trajectories (m,); the posture (n,) if all are given."""

    def check_start(self, q: Array) -> None:
        """Refuse a start (n,) that the robot can never come to from its present posture."""

    def tip_pose(self, q: Array) -> Array:
        """Pose of the tip in the base (4, 4) in a posture (n,)."""

    def through(
        self, points: Array, start: Array, goal: Array | None, options: dict[str, Any]
    ) -> Planned:
        """Plan through points (k, m), from a posture to another (n,), where that is given."""

    def along(
        self, path: PosePath, start: Array, kept: float, options: dict[str, Any]
    ) -> CartesianPlan:
        """Plan along a path within a part of the limits of rates; samples hold the m joints."""

    def poses_along(self, plan: CartesianPlan) -> Array:
        """Find the poses (k, 4, 4) of the tip at the samples of a plan."""

    def warm_up(self) -> None:
        """Load what the first paths wait for otherwise."""
