"""Kinematics of parallel robots for the services of the node."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np
from sensor_msgs.msg import JointState
from visualization_msgs.msg import Marker

from robomech_ros.errors import BadValueError, RobomechError, SingularPostureError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinetostatics import point_jacobian
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.joints.joint_positions import JointPositions
from robomech_ros.nodes.common.messages.error_codes import OutcomeError, code_of
from robomech_ros.nodes.common.messages.joint_messages import positions_by_name
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.kinematics.kinematic_results import PostureReport
from robomech_ros.nodes.kinematics.markers import surface_markers
from robomech_ros.nodes.kinematics.messages import inverse_options
from robomech_ros.nodes.kinematics.platform_postures import (
    conditions,
    limb_errors,
    platform_solutions,
)
from robomech_ros.nodes.kinematics.platform_space import PlatformSpace
from robomech_ros.parallel import Mechanism, loop_singularity, platform_length
from robomech_ros.robots import SerialChain
from robomech_ros.spatial import transfer_twist
from robomech_ros.typing import Array, BoolArray, IntArray


class PlatformManipulator:
    """Kinematics of a parallel robot of n joints and m drives."""

    closed_form = False

    def __init__(self, model: RobotModel, joints: JointPositions, worker: Worker) -> None:
        assert model.mechanism is not None and model.robot is not None
        assert joints.loops is not None
        self._model, self._joints, self._worker = model, joints, worker
        self._robot, self._mechanism, self._loops = model.robot, model.mechanism, joints.loops
        self._space = PlatformSpace(self._robot)
        mechanism = model.mechanism
        self.introduction = (
            f"{mechanism.name}, {mechanism.base_link} to {mechanism.platform_link}, "
            f"{counted(mechanism.n, 'joint')}, {counted(mechanism.dof, 'drive')}"
        )

    def linkage_to(self, link: str) -> Mechanism:
        """Return all limbs, which carry the platform; refuse other links."""
        platform = self._mechanism.platform_link
        if self._model.chain_to(link).tip != platform:
            expected = f"'{platform}' or empty, which all limbs carry"
            raise BadValueError("tip_link", link, expected)
        return self._mechanism

    def carrier(self, link: str) -> tuple[SerialChain, Mechanism]:
        """Return the chain to a link that a limb carries, and all limbs."""
        chain = self._model.chain_to(link)
        if not chain.n:
            raise BadValueError("tip_link", link, "a link of a limb, which joints move")
        return chain, self._mechanism

    async def rows(
        self, ways: Sequence[SerialChain], states: Sequence[JointState], patience: float
    ) -> tuple[list[Array], str]:
        """Read the positions (m, n) for each chain: of one state of drives in all assembly modes.

        Without states, they are the present positions.  The text is a remark on them.
        """
        text, loops = "", self._loops
        if not states:
            whole = self._mechanism
            q = [await self._joints.read_or_present(whole, JointState(), "states", patience)]
        elif len(states) == 1 and loops.gives_drives(states[0]):
            q, text = self._modes(states[0], "states[0]")
        else:
            q = [
                self._modes(state, f"states[{i}]")[0][0]
                if loops.gives_drives(state)
                else loops.read(state, f"states[{i}]")
                for i, state in enumerate(states)
            ]
        return [np.array(q)[:, self._places(way)] for way in ways], text

    def _places(self, way: SerialChain) -> list[int]:
        """Return where the joints of a chain are among all."""
        return [self._mechanism.joint_names.index(name) for name in way.joint_names]

    def _modes(self, state: JointState, what: str) -> tuple[list[Array], str]:
        """Return all joints (n,) in all assembly modes, nearest to the present one first."""
        mechanism, present = self._mechanism, self._joints.present_posture()
        drives = positions_by_name(state, mechanism.actuated, what)
        near = mechanism.home() if present is None else present
        found = mechanism.direct(drives, seed=near)
        if not len(found):
            raise OutcomeError(found.status, f"{what}: {found.reason}")
        known = "these are all" if found.complete else "there may be more"
        count = counted(len(found), "assembly mode")
        text = f"{count} ({found.family}), {known}"
        if found.reason:
            text += f"; {found.reason}"
        return list(found.q), text + _beyond_limits(mechanism, found.q)

    def solver(self, way: Mechanism, request: Any, scene: Any = None) -> Callable[..., Any]:
        """Return the solver of all limbs; its solutions meet any tolerance, in any time."""
        options = inverse_options(request)
        self.task_mask(options.get("task_mask", ()))
        if options["include_windings"]:
            expected = "false for a parallel robot, whose passive joints have no limits"
            raise BadValueError("include_windings", True, expected)
        kept = ("respect_limits", "metric", "max_solutions")
        return partial(platform_solutions, way, **{k: options[k] for k in kept if k in options})

    def task_mask(self, mask: Sequence[bool]) -> None:
        """Refuse a part of the task."""
        if any(mask) and not all(mask):
            expected = "all false or all true for a parallel robot: the pose of the platform"
            raise BadValueError("task_mask", [bool(entry) for entry in mask], expected)

    def solve_many(
        self, T: Array, *, seed: Array | None = None, task_mask: object = None, **options: Any
    ) -> tuple[IntArray, IntArray, Array]:
        """Solve many poses (m, 4, 4); a pose that no such platform can have gets a code.

        Return the number of solutions of each and its code, (m,), and all solutions, (k, n).
        """
        near = self._mechanism.home() if seed is None else seed
        count, status = np.zeros(len(T), np.int64), np.zeros(len(T), np.int64)
        rows = [np.empty((0, self._mechanism.n))]
        for k, pose in enumerate(T):
            try:
                found = platform_solutions(self._mechanism, pose, near, **options)
            except RobomechError as error:
                status[k] = code_of(error)
            else:
                count[k], status[k] = len(found.q), found.status
                rows.append(found.q)
        return count, status, np.concatenate(rows)

    def pose_errors(self, T: Array, q: Array) -> tuple[Array, Array]:
        """Return the errors of position (m) and angle (rad) of postures (k, n)."""
        return limb_errors(self._mechanism, q, T)

    def jacobian(
        self, carrier: SerialChain, q: Array, point: Array, axes: Array
    ) -> tuple[Array, Sequence[str]]:
        """Return the Jacobian (6, m) of a point of a link of a limb, and the drives."""
        index = self._places(carrier)
        J = point_jacobian(carrier, q[index], point, axes) @ self._mechanism.complement(q)[index]
        return J, self._mechanism.actuated

    async def singularity(self, way: Mechanism, q: Array, point: Array) -> PostureReport:
        """Report the lost motions of the platform, and those with locked drives."""
        # The first report finds the characteristic length.
        return await self._worker.do(partial(self._report, q, point))

    def _report(self, q: Array, point: Array) -> PostureReport:
        mechanism = self._mechanism
        T = mechanism.pose(q)
        origin, at = np.zeros(3), T[:3, :3] @ point
        own = q if isinstance(self._robot, Mechanism) else q[mechanism.drive_index]
        found = loop_singularity(self._robot, T, own)
        lost, free = (
            transfer_twist(twists, origin, at) if len(twists) else twists
            for twists in (found.lost_directions, found.free_directions)
        )
        text = found.summary
        if not found.singular:
            text += (
                f": {found.distances[1]:.3g} from type 2 and {found.distances[0]:.3g} from type 1, "
                f"lengths over {found.length:.4g} m"
            )
        J, values = None, np.full(1, np.inf)
        with suppress(SingularPostureError):
            twists = mechanism.twist_matrix(q)
            J = transfer_twist(twists.T, origin, at).T
            values = np.linalg.svd(twists, compute_uv=False)
        return PostureReport(
            at + T[:3, 3],
            J,
            found.singular_values,
            len(found.singular_values) - len(found.free_directions),
            float(np.prod(values)),
            float(values[0] / values[-1]) if 0.0 < values[-1] < np.inf else float("inf"),
            found.length,
            found.condition_number,
            lost,
            found.kinds,
            text,
            free,
        )

    async def prepare(self) -> None:
        """Find the characteristic length, which is kept."""
        self._length = await self._worker.do(partial(platform_length, self._robot))

    def condition_numbers(self, q: Array) -> Array:
        """Return the condition numbers (k,) of the twists of the drives over the length."""
        return conditions(self._mechanism, q, self._length)

    async def boundary_distances(self, T: Array, reachable: BoolArray, until: float) -> Array:
        """Return distances (m,) of poses from the boundary for their orientations (m).

        They are positive inside, NaN where unknown; ``until`` is a time of the monotonic clock.
        """
        return await self._space.distances(self._worker, T, reachable, until)

    async def reach(self) -> tuple[float, float]:
        """Return the least and the greatest distance of the platform from the base (m)."""
        return await self._worker.do(self._space.reach)

    async def boundary_markers(self, T: Array | None) -> list[Marker]:
        """Draw the boundary for the orientation of a pose, by default that of home."""
        surface = await self._worker.do(partial(self._space.surface, T))
        return [] if surface is None else surface_markers(surface)


def _beyond_limits(mechanism: Mechanism, q: Array) -> str:
    """Say which of some postures (k, n) are beyond limits, and by how much; empty for none."""
    excess = mechanism.limit_excess(q)
    rows = np.flatnonzero((excess > 0.0).any(axis=1))
    if not rows.size:
        return ""
    joint = int(np.argmax(excess[rows[0]]))
    by = f"{excess[rows[0], joint]:.3g} {mechanism.units[joint]}"
    first = f"number {rows[0] + 1} with {mechanism.joint_names[joint]} by {by}"
    return f"; beyond limits: {rows.size} of {len(q)}, {first}"
