"""Kinematics of chains for the services of the node."""

import math
from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from sensor_msgs.msg import JointState
from visualization_msgs.msg import Marker

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics, inverse_kinematics_batch
from robomech_ros.kinematics.inverse.families.selection import family_of
from robomech_ros.kinematics.inverse.first_solution import first_solution
from robomech_ros.kinematics.inverse.result.contacts import without_contacts
from robomech_ros.kinetostatics import point_jacobian
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.joints.joint_positions import JointPositions
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.kinematics.kinematic_results import PostureReport, distances_between
from robomech_ros.nodes.kinematics.markers import boundary_markers
from robomech_ros.nodes.kinematics.messages import inverse_options, wants_first
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array, BoolArray, IntArray

if TYPE_CHECKING:
    from robomech_ros.kinetostatics import SingularityReport, Workspace


class _ReachableSpace(NamedTuple):
    """Workspace of a chain, the same for all poses."""

    reach: tuple[float, float]  #: Least and greatest distance of the tip from the first joint (m).
    length: float  #: Characteristic length (m); NaN for an arm that has none.
    boundary: "Workspace | None"  #: None for an arm without a positioning part.
    centre: Array  #: The point that this part places, in the frame of the tip (m), shape (3,).
    markers: list[Marker]  #: Drawing of the boundary.


class ChainManipulator:
    """Kinematics of an arm."""

    def __init__(self, model: RobotModel, joints: JointPositions, worker: Worker) -> None:
        self._model, self._joints, self._worker = model, joints, worker
        self._chain = chain = model.chain
        self._measured: set[SerialChain] = set()
        # The kernels are compiled or loaded on import; this decides the solver family, too.
        family = inverse_kinematics(chain, forward_kinematics(chain, chain.midrange())).family
        self.closed_form = family_of(chain).closed_form
        self.introduction = (
            f"{chain.name}, {chain.base} to {chain.tip}, {counted(chain.n, 'joint')}, "
            f"inverse kinematics: {family}"
        )

    def linkage_to(self, link: str) -> SerialChain:
        """Return the chain to a link that joints move."""
        chain = self._model.chain_to(link)
        if not chain.n:
            expected = f"a link that joints move: nothing moves between it and '{chain.base}'"
            raise BadValueError("tip_link", link, expected)
        return chain

    def carrier(self, link: str) -> tuple[SerialChain, SerialChain]:
        """Return the chain to a link that joints move, as the carrier and as the linkage."""
        return self.linkage_to(link), self.linkage_to(link)

    async def rows(
        self, ways: Sequence[SerialChain], states: Sequence[JointState], patience: float
    ) -> tuple[list[Array], str]:
        """Read the positions (m, n) for each chain in all states.

        Without states, they are the present positions.  The text is a remark on them.
        """
        rows = []
        for way in ways:
            if states:
                read = self._joints.read
                q = [read(way, state, f"states[{i}]") for i, state in enumerate(states)]
            else:
                q = [await self._joints.read_or_present(way, JointState(), "states", patience)]
            rows.append(np.array(q))
        return rows, ""

    def solver(self, way: SerialChain, request: Any, scene: Any = None) -> Callable[..., Any]:
        """Return inverse kinematics, or one attempt from the seed, outside contact in a scene."""
        options = inverse_options(request)
        if not wants_first(request.mode):
            return partial(inverse_kinematics, way, scene=scene, **options)
        if scene is None:
            return partial(first_solution, way, **options)

        def first_free(T: Array, seed: Array) -> Any:
            return without_contacts(first_solution(way, T, seed=seed, **options), scene, None)

        return first_free

    def task_mask(self, mask: Sequence[bool]) -> tuple[bool, ...] | None:
        """Return the task mask of a request; None for the full pose."""
        return tuple(map(bool, mask)) if any(mask) and not all(mask) else None

    def solve_many(
        self, T: Array, *, task_mask: tuple[bool, ...] | None = None, **options: Any
    ) -> tuple[IntArray, IntArray, Array]:
        """Solve many poses (m, 4, 4) at once, or one after another for a part of the task.

        Return the number of solutions of each and its code, (m,), and all solutions, (k, n).
        """
        if task_mask is None:
            q, count, status = inverse_kinematics_batch(self._chain, T, **options)
            return count, status, q[np.arange(q.shape[1]) < count[:, None]]
        found = [inverse_kinematics(self._chain, pose, task_mask=task_mask) for pose in T]
        count = np.array([len(result) for result in found])
        status = np.array([int(result.status) for result in found])
        return count, status, np.concatenate([result.q for result in found])

    def pose_errors(self, T: Array, q: Array) -> tuple[Array, Array]:
        """Return the errors of position (m) and angle (rad) of postures (k, n)."""
        return distances_between(T, forward_kinematics(self._chain, q))

    def jacobian(
        self, carrier: SerialChain, q: Array, point: Array, axes: Array
    ) -> tuple[Array, Sequence[str]]:
        """Return the Jacobian (6, n) of a point, and all joints."""
        return point_jacobian(carrier, q, point, axes), carrier.joint_names

    async def singularity(self, way: SerialChain, q: Array, point: Array) -> PostureReport:
        """Judge a posture, and the motions of a point (3,) of the tip link (m)."""
        # Compiled code for reports is loaded with the first one.
        from robomech_ros.kinetostatics.singularities.report import posture_report

        if way not in self._measured:
            # The first report finds the characteristic length, which takes a second or two.
            await self._worker.do(partial(posture_report, way, q))
            self._measured.add(way)
        report = posture_report(way, q, point=point)
        T = forward_kinematics(way, q)
        return PostureReport(
            T[:3, :3] @ point + T[:3, 3],
            point_jacobian(way, q, point),
            report.singular_values,
            report.rank,
            report.manipulability,
            report.condition_number,
            report.length,
            report.normalised_condition_number,
            report.lost_directions,
            report.kinds,
            _summary(report),
        )

    async def prepare(self) -> None:
        """Find the workspace once."""
        await self._worker.do(lambda: self._known)

    @cached_property
    def _known(self) -> _ReachableSpace:
        return _reachable_space(self._chain)

    def condition_numbers(self, q: Array) -> Array:
        """Return the normalised condition numbers (k,) of postures (k, n), else infinity."""
        from robomech_ros.kinetostatics import condition_number

        length = self._known.length
        if math.isnan(length) or not len(q):
            return np.full(len(q), np.inf)
        return np.asarray(condition_number(self._chain, q, length=length))

    async def boundary_distances(self, T: Array, reachable: BoolArray, until: float) -> Array:
        """Return distances (m,) of the poses of the positioning part from its boundary (m).

        They are positive inside, and NaN where unknown.
        """
        boundary = self._known.boundary
        if boundary is None or not len(T):
            return np.full(len(T), np.nan)
        centres = T[:, :3, :3] @ self._known.centre + T[:, :3, 3]
        return await self._worker.do(partial(boundary.distance, centres))

    async def reach(self) -> tuple[float, float]:
        """Return the least and the greatest distance of the tip from the first joint (m)."""
        return self._known.reach

    async def boundary_markers(self, T: Array | None) -> list[Marker]:
        """Draw the boundary, which is the same for all poses."""
        if not self._chain.n:
            return []
        await self.prepare()
        return self._known.markers


def _reachable_space(chain: SerialChain) -> _ReachableSpace:
    """Find the workspace, which is the same for all poses; this takes some seconds."""
    from robomech_ros.kinetostatics import characteristic_length, reach_limits
    from robomech_ros.kinetostatics.workspace.boundary import positioning_boundary
    from robomech_ros.kinetostatics.workspace.positioning_part import positioning_part

    try:
        length = float(characteristic_length(chain))
    except RobomechError:
        length = math.nan
    boundary, centre, markers = None, np.zeros(3), list[Marker]()
    try:
        boundary, centre = positioning_boundary(chain), positioning_part(chain).in_tip
        boundary.distance(np.zeros(3))  # what is the same for all points is found now
        markers = boundary_markers(boundary)
    except RobomechError:
        boundary = None
    return _ReachableSpace(reach_limits(chain), length, boundary, centre, markers)


def _summary(report: "SingularityReport") -> str:
    if not report.singular:
        # More joints than freedoms leave singular values of zero, which say nothing of the posture.
        largest, least = report.singular_values[0], report.singular_values[report.rank - 1]
        return (
            f"regular: rank {report.rank}, least singular value {least:.3g} "
            f"and condition number {largest / least:.4g} with lengths over {report.length:.4g} m"
        )
    lost = len(report.lost_directions)
    directions = f"{counted(lost, 'direction')} of motion lost"
    return f"singular ({', '.join(report.kinds)}): rank {report.rank}, {directions}"
