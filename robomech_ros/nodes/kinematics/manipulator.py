"""What the services of kinematics need of a robot, be it a chain or a parallel robot."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

import numpy as np
from sensor_msgs.msg import JointState
from visualization_msgs.msg import Marker

from robomech_ros.nodes.common.joint_positions import Way
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array, BoolArray, IntArray


class PoseSolutions(NamedTuple):
    """Solutions of inverse kinematics for m poses of a robot with n joints.

    Attributes
    ----------
    counts, statuses : ndarray of int, shape (m,)
        Number of solutions of each pose, and its code.
    q : ndarray, shape (k, n)
        All solutions, in the order of the poses (rad or m).
    """

    counts: IntArray
    statuses: IntArray
    q: Array


@dataclass(frozen=True, eq=False)
class PostureReport:
    """Singularity report on a posture, with the fields of an AnalyzeSingularity response.

    Attributes
    ----------
    position : ndarray, shape (3,)
        Of the point, in the base (m).
    jacobian : ndarray, shape (6, m), or None
        Of the point in the axes of the base, angular rows first; None where the drives of a
        parallel robot do not determine its motion.
    lost_directions, free_directions : ndarray, shape (r, 6)
        Twists of the point that are lost, and those it can have with locked drives, angular first,
        in the base.
    """

    position: Array
    jacobian: Array | None
    singular_values: Array
    rank: int
    manipulability: float
    condition_number: float
    characteristic_length: float
    normalised_condition_number: float
    lost_directions: Array
    singularity_types: Sequence[str]
    summary: str
    free_directions: Array = field(default_factory=lambda: np.empty((0, 6)))


class Manipulator(Protocol):
    """Kinematics of one robot, whose posture has n joints (rad or m).

    Attributes
    ----------
    introduction : str
        Name, ends and joints, for the log.
    closed_form : bool
        Whether many poses at once are solved in closed form.
    """

    introduction: str
    closed_form: bool

    def way_to(self, link: str) -> Way:
        """Return the joints that move a link, "" being the tip; refuse a link without any."""

    def carrier(self, link: str) -> tuple[SerialChain, Way]:
        """Return the chain that carries a link, and the joints of which its postures consist."""

    async def rows(
        self, ways: Sequence[SerialChain], states: Sequence[JointState], patience: float
    ) -> tuple[list[Array], str]:
        """Read the positions (m, n) for each way in all states, and a remark on them.

        Without states, they are the present positions.
        """

    def solver(self, way: Any, request: Any) -> Callable[..., Any]:
        """Return the solver for a SolveIK request, of a pose (4, 4) and the keyword ``seed``."""

    def task_mask(self, mask: Sequence[bool]) -> tuple[bool, ...] | None:
        """Return the task mask of a request; None for the full pose."""

    def solve_many(self, T: Array, **options: Any) -> PoseSolutions:
        """Solve many poses (m, 4, 4); options are those of `inverse_kinematics`."""

    def pose_errors(self, T: Array, q: Array) -> tuple[Array, Array]:
        """Return the errors of position (m) and angle (rad) of postures (k, n), (k,) each."""

    def jacobian(
        self, carrier: SerialChain, q: Array, point: Array, axes: Array | None
    ) -> tuple[Array, Sequence[str]]:
        """Return the Jacobian (6, m) of a point of any link, and the joints of its columns."""

    async def singularity(self, way: Any, q: Array, point: Array) -> PostureReport:
        """Judge a posture, and the motions of a point (3,) of the tip (m)."""

    async def prepare(self) -> None:
        """Compute what all queries of the workspace need; the first call takes seconds."""

    def condition_numbers(self, q: Array) -> Array:
        """Return the normalised condition numbers (k,) of postures (k, n)."""

    async def boundary_distances(self, T: Array, reachable: BoolArray, until: float) -> Array:
        """Return distances (m,) of poses from the boundary (m), NaN where unknown.

        They are positive inside.  ``until`` is a time of the monotonic clock (s).
        """

    async def reach(self) -> tuple[float, float]:
        """Return the least and the greatest reach (m)."""

    async def boundary_markers(self, T: Array | None) -> list[Marker]:
        """Draw the boundary, of a platform in the orientation of a pose (4, 4), None for home."""


def distances_between(T: Array, reached: Array) -> tuple[Array, Array]:
    """Return the distances (m) and angles (rad) between poses, shape (..., 4, 4)."""
    apart = T - reached
    turned = _lengths(apart[..., :3, :3].reshape(*apart.shape[:-2], 9))
    # The matrices of two rotations that differ by an angle differ by 2 sqrt(2) sin(angle / 2).
    chord = np.minimum(turned / math.sqrt(8.0), 1.0)
    return _lengths(apart[..., :3, 3]), 2.0 * np.arcsin(chord)


def _lengths(rows: Array) -> Array:
    """Lengths along the last axis, without the copies that a norm makes."""
    lengths: Array = np.sqrt(np.einsum("...i,...i->...", rows, rows))
    return lengths
