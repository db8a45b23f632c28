"""The services of the node kinematics for a parallel robot."""

import time
from array import array
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np
from rclpy.node import Node
from sensor_msgs.msg import JointState, PointCloud2

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import point_jacobian
from robomech_ros.nodes.common.cooperative_wait import TimeSlices, Worker
from robomech_ros.nodes.common.error_codes import OutcomeError, answer, code_of, guarded
from robomech_ros.nodes.common.joint_messages import positions_by_name
from robomech_ros.nodes.common.joint_positions import JointPositions
from robomech_ros.nodes.common.message_fields import append_numbers, floats
from robomech_ros.nodes.common.pose_messages import (
    linear_rows_first,
    matrices_from_pose_rows,
    matrix_from_pose,
    point_vector,
    stamped_pose,
)
from robomech_ros.nodes.common.robot_description import LATCHED, RobotModel
from robomech_ros.nodes.frames.robot_frames import RobotFrames
from robomech_ros.nodes.kinematics.marker_publisher import MarkerPublisher
from robomech_ros.nodes.kinematics.messages import (
    SolutionPoints,
    answer_in_time,
    encode_result,
    inverse_options,
    is_nearest,
    poses_in_base,
    workspace_cloud,
)
from robomech_ros.nodes.kinematics.platform_postures import (
    PlatformSolutions,
    conditions,
    platform_solutions,
)
from robomech_ros.nodes.kinematics.platform_singularity import (
    encode_singularity,
    jacobian_at,
    singularity_at,
)
from robomech_ros.nodes.kinematics.platform_space import PlatformSpace
from robomech_ros.nodes.kinematics.settings import KinematicsSettings
from robomech_ros.outcomes import Code
from robomech_ros.parallel import Mechanism, platform_length
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array


class PlatformServices:
    """Services of the node for a parallel robot, matching those for an arm.

    Parameters
    ----------
    node : Node
    model : RobotModel
        Of a parallel robot of n joints and m drives.
    joints : JointPositions
    frames : RobotFrames
    worker : Worker
        For what takes long.
    settings : callable
        Gives the parameters of the node.
    check_size : callable
        Raises where there is more of something than the node handles at once.

    Attributes
    ----------
    mechanism : Mechanism
        All limbs.
    """

    def __init__(
        self,
        node: Node,
        model: RobotModel,
        joints: JointPositions,
        frames: RobotFrames,
        worker: Worker,
        settings: Callable[[], KinematicsSettings],
        check_size: Callable[[str, int], None],
    ) -> None:
        assert model.mechanism is not None and model.robot is not None
        assert joints.loops is not None
        self._node, self._model, self._joints, self._frames = node, model, joints, frames
        self._robot, self.mechanism, self._loops = model.robot, model.mechanism, joints.loops
        self._worker, self._settings, self._check_size = worker, settings, check_size
        self._points = SolutionPoints()
        self._space = PlatformSpace(self._robot)
        self._markers = MarkerPublisher(node, model.base_frame, self._show_boundary)
        self._cloud = node.create_publisher(PointCloud2, "~/workspace", LATCHED)
        self.get_logger = node.get_logger

    @guarded
    async def solve_fk(self, request: Any, response: Any) -> Any:
        """Return poses of links; of drives alone those of all assembly modes."""
        ways = [self._model.chain_to(link) for link in request.links or [""]]
        self._check_size("states times links", max(len(request.states), 1) * len(ways))
        patience = self._settings().state_timeout
        if not request.states:
            empty = JointState()
            rows = [await self._joints.read_or_present(self.mechanism, empty, "states", patience)]
            text = ""
        else:
            rows, text = self._rows(request.states)
        base, turns = self._model.base_frame, TimeSlices(self._node)
        for q in rows:
            at = dict(zip(self.mechanism.joint_names, q, strict=True))
            for way in ways:
                own = np.array([at[name] for name in way.joint_names])
                response.poses.append(stamped_pose(forward_kinematics(way, own), base))
            await turns.end_if_over()
        return answer(response, Code.NONE, text)

    def _rows(self, states: list[JointState]) -> tuple[list[Array], str]:
        """Return the postures (n,) of states, all modes of one state of drives, and what to say."""
        if len(states) == 1 and self._loops.gives_drives(states[0]):
            return self._modes(states[0])
        rows = []
        for i, state in enumerate(states):
            what = f"states[{i}]"
            if self._loops.gives_drives(state):
                rows.append(self._modes(state, what)[0][0])
            else:
                rows.append(self._loops.read(state, what))
        return rows, ""

    def _modes(self, state: JointState, what: str = "states[0]") -> tuple[list[Array], str]:
        """Return all joints (n,) in all assembly modes, nearest to the present one first."""
        mechanism, present = self.mechanism, self._joints.present_posture()
        drives = positions_by_name(state, mechanism.actuated, what)
        near = mechanism.home() if present is None else present
        found = mechanism.direct(drives, seed=near)
        if not len(found):
            raise OutcomeError(found.status, f"{what}: {found.reason}")
        known = "these are all" if found.complete else "there may be more"
        count = f"{len(found)} assembly mode{'s' if len(found) != 1 else ''}"
        text = f"{count} ({found.family}), {known}"
        if found.reason:
            text += f"; {found.reason}"
        return list(found.q), text + _beyond_limits(mechanism, found.q)

    @guarded
    async def solve_ik(self, request: Any, response: Any) -> Any:
        """Return all postures that hold the platform in a pose."""
        self._check_tip(request.tip_link)
        T = matrix_from_pose(request.target.pose, "target")
        options = _platform_options(inverse_options(request))
        header, patience = request.target.header, self._settings().state_timeout
        frame = await self._frames.in_base(header.frame_id, patience, header.stamp)
        seed = self._joints.seed(self.mechanism, request.seed)
        start = perf_counter()
        target = T if frame is None else frame @ T
        result = platform_solutions(self.mechanism, target, seed, **options)
        seconds = perf_counter() - start
        names = self.mechanism.joint_names
        return encode_result(result, names, self._points, seconds, response)

    @guarded
    async def solve_ik_batch(self, request: Any, response: Any) -> Any:
        """Return all postures for many poses."""
        T, allowed = matrices_from_pose_rows(request.poses), self._settings().batch_timeout
        self._check_size("poses", len(T))
        seed = self._joints.seed(self.mechanism, JointState(position=request.seed))
        most = 1 if is_nearest(request.mode) else None
        lists: dict[str, array[Any]] = {
            name: array(kind)
            for name, kind in (
                ("counts", "I"),
                ("codes", "H"),
                ("solutions", "d"),
                ("position_errors", "d"),
                ("orientation_errors", "d"),
            )
        }
        turns, began, done = TimeSlices(self._node), time.monotonic(), 0
        while done < len(T) and time.monotonic() - began < allowed:
            found = self._solutions_or_code(
                T[done], seed, respect_limits=not request.ignore_limits, max_solutions=most
            )
            _append(lists, found)
            done += 1
            await turns.end_if_over()
        append_numbers(lists["counts"], np.zeros(len(T) - done))
        append_numbers(lists["codes"], np.full(len(T) - done, Code.TIMED_OUT))
        response.joint_names = list(self.mechanism.joint_names)
        for name, numbers in lists.items():
            setattr(response, name, numbers)
        return answer_in_time(response, done, len(T), allowed)

    def _solutions_or_code(self, T: Array, seed: Array, **options: Any) -> PlatformSolutions | Code:
        """Solve for one pose of many; a pose that no such platform can have gets a code."""
        try:
            return platform_solutions(self.mechanism, T, seed, **options)
        except RobomechError as error:
            return code_of(error)

    @guarded
    async def get_jacobian(self, request: Any, response: Any) -> Any:
        """Return the twist of any link that a limb carries, for rates of the drives."""
        chain = self._model.chain_to(request.tip_link)
        if not chain.n:
            raise BadValueError("tip_link", request.tip_link, "a link of a limb, which joints move")
        q, point, axes = await self._asked(request)
        names = self.mechanism.joint_names
        index = [names.index(name) for name in chain.joint_names]
        J = point_jacobian(chain, q[index], point, axes) @ self.mechanism.complement(q)[index]
        response.jacobian = floats(linear_rows_first(J))
        response.joint_names = list(self.mechanism.actuated)
        return answer(response)

    @guarded
    async def analyze_singularity(self, request: Any, response: Any) -> Any:
        """Say what the platform cannot do, or does by itself."""
        self._check_tip(request.tip_link)
        q, point, axes = await self._asked(request)
        # The first report finds the characteristic length.
        found = await self._worker.do(lambda: singularity_at(self._robot, q, point))
        frame = self._model.full_frame(request.reference_frame)
        encode_singularity(self.mechanism, q, found, axes, frame, response)
        if self._settings().publish_markers:
            at = self.mechanism.pose(q)
            place = at[:3, :3] @ point + at[:3, 3]
            J = jacobian_at(self.mechanism, q, point)
            self._markers.show_platform(place, J, found.lost_directions, found.free_directions)
        return answer(response)

    @guarded
    async def query_workspace(self, request: Any, response: Any) -> Any:
        """Say which of many poses the platform can have within all limits."""
        allowed, patience = self._settings().batch_timeout, self._settings().state_timeout
        self._check_size("poses", len(request.poses))
        _check_mask([bool(entry) for entry in request.task_mask])
        T = await poses_in_base(self._frames, request.poses, patience)
        # It is found on the first request, and kept.
        length = await self._worker.do(lambda: platform_length(self._robot))
        count, reason = np.zeros(len(T), np.int64), np.full(len(T), Code.TIMED_OUT, np.int64)
        condition = np.full(len(T), np.inf)
        turns, began, done, seed = (
            TimeSlices(self._node),
            time.monotonic(),
            0,
            self.mechanism.home(),
        )
        while done < len(T) and time.monotonic() - began < allowed:
            found = self._solutions_or_code(T[done], seed)
            if isinstance(found, PlatformSolutions):
                count[done], reason[done] = len(found.q), found.status
                values = conditions(self.mechanism, found.q, length)
                condition[done] = values.min(initial=np.inf)
            else:
                reason[done] = found
            done += 1
            await turns.end_if_over()
        response.reachable = (count > 0).tolist()
        response.reason, response.solution_count = reason.tolist(), count.tolist()
        response.condition_numbers = condition.tolist()
        distance = await self._space.distances(self._worker, T, count > 0, began + allowed)
        response.boundary_distances = distance.tolist()
        response.least_reach, response.greatest_reach = await self._worker.do(self._space.reach)
        if len(T):
            cloud = workspace_cloud(self._model.base_frame, T, count, distance)
            self._cloud.publish(cloud)
            await self._show_boundary(T[0])
        return answer_in_time(response, done, len(T), allowed)

    async def _show_boundary(self, T: Array | None = None) -> None:
        """Show the boundary for the orientation of a pose, by default that of home."""
        if self._settings().publish_markers:
            surface = await self._worker.do(lambda: self._space.surface(T))
            if surface is not None:
                self._markers.show_surface(surface)

    async def _asked(self, request: Any) -> tuple[Array, Array, Array | None]:
        """Read all joints, the point and the axes of a request about a Jacobian."""
        patience = self._settings().state_timeout
        q = await self._joints.read_or_present(self.mechanism, request.state, "state", patience)
        point = point_vector(request.tool_point, "tool_point")
        at = dict(zip(self.mechanism.joint_names, q.tolist(), strict=True))
        frame = await self._frames.in_base(request.reference_frame, patience, at=at)
        return q, point, None if frame is None else frame[:3, :3]

    def _check_tip(self, link: str) -> None:
        """Refuse links other than the platform, which all limbs carry."""
        chain: SerialChain = self._model.chain_to(link)
        if chain.tip != self.mechanism.platform_link:
            expected = f"'{self.mechanism.platform_link}' or empty, which all limbs carry"
            raise BadValueError("tip_link", link, expected)


def _append(lists: dict[str, "array[Any]"], found: PlatformSolutions | Code) -> None:
    """Add what was found for one pose to the lists of a SolveIKBatch response."""
    if not isinstance(found, PlatformSolutions):
        lists["counts"].append(0)
        lists["codes"].append(int(found))
        return
    lists["counts"].append(len(found.q))
    lists["codes"].append(int(found.status))
    append_numbers(lists["solutions"], found.q)
    append_numbers(lists["position_errors"], found.position_error)
    append_numbers(lists["orientation_errors"], found.orientation_error)


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


def _platform_options(options: dict[str, Any]) -> dict[str, Any]:
    """Pick what holds for a parallel robot; the solutions meet any tolerance, in any time."""
    _check_mask(options.get("task_mask", ()))
    if options["include_windings"]:
        expected = "false for a parallel robot, whose passive joints have no limits"
        raise BadValueError("include_windings", True, expected)
    kept = ("respect_limits", "metric", "max_solutions")
    return {name: options[name] for name in kept if name in options}


def _check_mask(mask: Any) -> None:
    if any(mask) and not all(mask):
        expected = "all false or all true for a parallel robot: the pose of the platform"
        raise BadValueError("task_mask", list(mask), expected)
