"""The node that answers kinematic questions: poses, joint positions, Jacobians, singularities."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from time import perf_counter
from typing import Any, NamedTuple

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from sensor_msgs.msg import JointState, PointCloud2

from robomech_interfaces.srv import (
    AnalyzeSingularity,
    GetJacobian,
    QueryWorkspace,
    SolveFK,
    SolveIK,
    SolveIKBatch,
)
from robomech_ros.errors import BadValueError, RobomechError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinematics.inverse.first_solution import first_solution
from robomech_ros.kinetostatics import point_jacobian
from robomech_ros.kinetostatics.singularities.report import posture_report
from robomech_ros.nodes.common.cooperative_wait import TimeSlices, Worker
from robomech_ros.nodes.common.error_codes import ShutdownError, answer, guarded
from robomech_ros.nodes.common.joint_positions import JointPositions
from robomech_ros.nodes.common.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.message_fields import floats
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.pose_messages import (
    linear_rows_first,
    matrices_from_pose_rows,
    matrix_from_pose,
    point_vector,
    stamped_pose,
)
from robomech_ros.nodes.common.robot_description import LATCHED, RobotModel
from robomech_ros.nodes.common.robot_source import when_robot_known
from robomech_ros.nodes.frames.robot_frames import RobotFrames
from robomech_ros.nodes.kinematics.ik_batch import solve_in_turns
from robomech_ros.nodes.kinematics.marker_publisher import MarkerPublisher
from robomech_ros.nodes.kinematics.messages import (
    SolutionPoints,
    answer_in_time,
    encode_report,
    encode_result,
    inverse_options,
    is_nearest,
    poses_in_base,
    wants_first,
    workspace_cloud,
)
from robomech_ros.nodes.kinematics.settings import KinematicsSettings
from robomech_ros.nodes.kinematics.workspace_cache import ReachableSpace, SpaceFinder
from robomech_ros.nodes.kinematics.workspace_query import WorkspaceQuery
from robomech_ros.nodes.middleware.queue_depth import serve
from robomech_ros.nodes.moveit.add_services import add_moveit_services
from robomech_ros.nodes.process.run import run_node
from robomech_ros.robots import SerialChain
from robomech_ros.typing import Array

_SERVICES = (
    "~/solve_ik",
    "~/solve_fk",
    "~/solve_ik_batch",
    "~/get_jacobian",
    "~/analyze_singularity",
    "~/query_workspace",
)


class _Posture(NamedTuple):
    """Posture and point of a request about a Jacobian.

    Attributes
    ----------
    chain : SerialChain
        To the link asked about, of n joints.
    q : ndarray, shape (n,)
        rad or m.
    point : ndarray, shape (3,)
        Of the link, in its frame (m).
    axes : ndarray, shape (3, 3), or None
        ``R_base_axes`` of the axes of the answer; None for the base.
    """

    chain: SerialChain
    q: Array
    point: Array
    axes: Array | None


class KinematicsNode(Node):
    """Forward and inverse kinematics, Jacobian and singularities of one robot, as services."""

    SETTINGS = KinematicsSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("kinematics", **options)
        # What is found once for a robot takes seconds.
        self._worker = Worker(self)
        self._table = NodeParameters(self, KinematicsSettings)
        self._monitor = JointStateMonitor(self)
        self._points = SolutionPoints()
        self._measured: set[SerialChain] = set()
        when_robot_known(self, self._table.settings, self._serve, parallel=True)

    def stop(self) -> None:
        """Answer those who wait for what takes long."""
        self._worker.give_up(ShutdownError(self.get_name()))

    def destroy_node(self) -> None:
        """Take leave of ROS, and of the thread for long work."""
        self._worker.close()
        super().destroy_node()

    def _serve(self, model: RobotModel) -> None:
        self._model = model
        self._joints = JointPositions(model, self._monitor)
        self._frames = RobotFrames(self, model, self._monitor, lambda: self._table.settings)
        if model.mechanism is not None:
            self._serve_platform(model)
            return
        chain = model.chain
        # The kernels are compiled or loaded on import; this decides the solver family, too.
        family = inverse_kinematics(chain, forward_kinematics(chain, chain.midrange())).family
        self._offer(
            (
                self._solve_ik,
                self._solve_fk,
                self._solve_ik_batch,
                self._get_jacobian,
                self._analyze_singularity,
                self._query_workspace,
            )
        )
        self._space = SpaceFinder(self._worker, chain)
        self._markers = MarkerPublisher(self, model.base_frame, self._show_boundary)
        self._cloud = self.create_publisher(PointCloud2, "~/workspace", LATCHED)
        moveit = add_moveit_services(
            self,
            model,
            self._monitor,
            self._frames,
            lambda: self._table.settings.state_timeout,
            self._check_size,
        )
        self.get_logger().info(
            f"ready: {chain.name}, {chain.base} to {chain.tip}, {chain.n} joints, "
            f"inverse kinematics: {family}{', compute_ik and compute_fk' if moveit else ''}"
        )

    def _offer(self, callbacks: Sequence[Callable[..., Any]]) -> None:
        """Serve; while one waits, for a joint state, a frame or its turn, others are served."""
        kinds = SolveIK, SolveFK, SolveIKBatch, GetJacobian, AnalyzeSingularity, QueryWorkspace
        for kind, name, callback in zip(kinds, _SERVICES, callbacks, strict=True):
            serve(self, kind, name, callback, callback_group=ReentrantCallbackGroup())

    def _serve_platform(self, model: RobotModel) -> None:
        """Serve a parallel robot; what is compiled for those is loaded where it is needed."""
        from robomech_ros.nodes.kinematics.platform_services import PlatformServices

        services = PlatformServices(
            self,
            model,
            self._joints,
            self._frames,
            self._worker,
            lambda: self._table.settings,
            self._check_size,
        )
        self._offer(
            (
                services.solve_ik,
                services.solve_fk,
                services.solve_ik_batch,
                services.get_jacobian,
                services.analyze_singularity,
                services.query_workspace,
            )
        )
        mechanism = services.mechanism
        self.get_logger().info(
            f"ready: {mechanism.name}, {mechanism.base_link} to {mechanism.platform_link}, "
            f"{mechanism.n} joints, {mechanism.dof} drives"
        )

    @guarded
    async def _solve_fk(self, request: Any, response: Any) -> Any:
        ways = [self._model.chain_to(link) for link in request.links or [""]]
        self._check_size("states times links", max(len(request.states), 1) * len(ways))
        patience = self._table.settings.state_timeout
        rows = await self._joints.rows(ways, request.states, patience)
        poses = [forward_kinematics(way, q) for way, q in zip(ways, rows, strict=True)]
        base, turns = self._model.base_frame, TimeSlices(self)
        for of_state in zip(*poses, strict=True):
            for T in of_state:
                response.poses.append(stamped_pose(T, base))
                await turns.end_if_over()
        return answer(response)

    @guarded
    async def _solve_ik(self, request: Any, response: Any) -> Any:
        chain = self._moving_chain(request.tip_link)
        T = matrix_from_pose(request.target.pose, "target")
        options = inverse_options(request)
        header, patience = request.target.header, self._table.settings.state_timeout
        frame = await self._frames.in_base(header.frame_id, patience, header.stamp)
        seed = self._joints.seed(chain, request.seed)
        start = perf_counter()
        target = T if frame is None else frame @ T
        solve = first_solution if wants_first(request.mode) else inverse_kinematics
        result = solve(chain, target, seed=seed, **options)
        seconds = perf_counter() - start
        return encode_result(result, chain.joint_names, self._points, seconds, response)

    @guarded
    async def _solve_ik_batch(self, request: Any, response: Any) -> Any:
        chain, allowed = self._model.chain, self._table.settings.batch_timeout
        T = matrices_from_pose_rows(request.poses)
        self._check_size("poses", len(T))
        options = {
            "seed": self._joints.seed(chain, JointState(position=request.seed)),
            "respect_limits": not request.ignore_limits,
            "max_solutions": 1 if is_nearest(request.mode) else None,
        }
        lists, done = await solve_in_turns(chain, T, allowed, TimeSlices(self), **options)
        lists.fill(response)
        return answer_in_time(response, done, len(T), allowed)

    def _check_size(self, what: str, poses: int) -> None:
        largest = self._table.settings.max_batch_size
        if poses > largest:
            expected = f"at most {largest} poses, the parameter max_batch_size"
            raise WrongSizeError(what, poses, expected)

    @guarded
    async def _get_jacobian(self, request: Any, response: Any) -> Any:
        asked = await self._posture_asked(request)
        J = point_jacobian(asked.chain, asked.q, asked.point, asked.axes)
        response.jacobian = floats(linear_rows_first(J))
        response.joint_names = list(asked.chain.joint_names)
        return answer(response)

    @guarded
    async def _analyze_singularity(self, request: Any, response: Any) -> Any:
        asked = await self._posture_asked(request)
        chain, q, point = asked.chain, asked.q, asked.point
        if chain not in self._measured:
            # The first report finds the characteristic length, which takes a second or two.
            await self._worker.do(partial(posture_report, chain, q))
            self._measured.add(chain)
        report = posture_report(chain, q, point=point)
        frame = self._model.full_frame(request.reference_frame)
        encode_report(report, asked.axes, frame, response)
        if self._table.settings.publish_markers:
            self._markers.show_posture(chain, q, point, report)
        return answer(response)

    @guarded
    async def _query_workspace(self, request: Any, response: Any) -> Any:
        chain, allowed = self._moving_chain(""), self._table.settings.batch_timeout
        self._check_size("poses", len(request.poses))
        patience = self._table.settings.state_timeout
        T = await poses_in_base(self._frames, request.poses, patience)
        mask = tuple(bool(entry) for entry in request.task_mask)
        query = WorkspaceQuery(chain, T, mask, await self._known_space())
        done = await query.work(self, self._worker, allowed)
        query.fill(response)
        if len(T):
            cloud = workspace_cloud(self._model.base_frame, T, query.count, query.distance)
            self._cloud.publish(cloud)
        return answer_in_time(response, done, len(T), allowed)

    async def _posture_asked(self, request: Any) -> _Posture:
        """Read the posture, the point and the axes of a request about a Jacobian."""
        chain = self._moving_chain(request.tip_link)
        patience = self._table.settings.state_timeout
        q = await self._joints.read_or_present(chain, request.state, "state", patience)
        point = point_vector(request.tool_point, "tool_point")
        at = dict(zip(chain.joint_names, q.tolist(), strict=True))
        frame = await self._frames.in_base(request.reference_frame, patience, at=at)
        return _Posture(chain, q, point, None if frame is None else frame[:3, :3])

    async def _known_space(self) -> ReachableSpace:
        """Return what is the same for all poses, and show the boundary if that is not done."""
        space = await self._space.get()
        if space.boundary is not None and self._table.settings.publish_markers:
            self._markers.show_boundary(space.boundary)
        return space

    async def _show_boundary(self) -> None:
        """Find and show the boundary when the first subscriber of the markers comes."""
        if self._table.settings.publish_markers and self._model.chain.n:
            with suppress(RobomechError):  # who asks for it by a request gets the error
                await self._known_space()

    def _moving_chain(self, link: str) -> SerialChain:
        """Return the chain to a link, "" being the configured tip, that joints move."""
        chain = self._model.chain_to(link)
        if not chain.n:
            expected = f"a link that joints move: nothing moves between it and '{chain.base}'"
            raise BadValueError("tip_link", link, expected)
        return chain


def main(args: Sequence[str] | None = None) -> int:
    """Run the node; returns the exit code."""
    return run_node(KinematicsNode, args)


if __name__ == "__main__":
    raise SystemExit(main())
