"""The node that answers kinematic questions: poses, joint positions, Jacobians, singularities."""

from collections.abc import Sequence
from dataclasses import dataclass
from threading import Lock
from time import perf_counter
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from sensor_msgs.msg import JointState, PointCloud2
from visualization_msgs.msg import MarkerArray

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import (
    AnalyzeSingularity,
    GetJacobian,
    QueryWorkspace,
    SolveFK,
    SolveIK,
    SolveIKBatch,
)
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import point_jacobian, singularity_report
from robomech_ros.nodes.common.error_codes import answer, guarded
from robomech_ros.nodes.common.joint_positions import JointPositions, StateSettings
from robomech_ros.nodes.common.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.message_fields import floats
from robomech_ros.nodes.common.parameters import NodeParameters, parameter
from robomech_ros.nodes.common.pauses import Turns, beside
from robomech_ros.nodes.common.pose_messages import (
    linear_rows_first,
    matrices_from_pose_rows,
    matrix_from_pose,
    point_vector,
    stamped_pose,
)
from robomech_ros.nodes.common.reference_axes import reference_axes
from robomech_ros.nodes.common.robot_description import LATCHED, RobotModel, when_robot_known
from robomech_ros.nodes.kinematics.ik_batch import solve_in_turns
from robomech_ros.nodes.kinematics.ik_messages import (
    SolutionPoints,
    encode_result,
    inverse_options,
    is_nearest,
)
from robomech_ros.nodes.kinematics.markers import (
    boundary_markers,
    marker_array,
    posture_markers,
)
from robomech_ros.nodes.kinematics.singularity_messages import encode_report
from robomech_ros.nodes.kinematics.workspace_messages import (
    Judgement,
    ReachOfRobot,
    poses_in_base,
    reach_of,
    workspace_cloud,
)
from robomech_ros.nodes.moveit import add_moveit_services
from robomech_ros.nodes.process.run import run_node
from robomech_ros.robots import SerialChain


@dataclass(frozen=True)
class KinematicsSettings(StateSettings):
    """Parameters of the node."""

    largest_batch: int = parameter(
        10_000,
        "Largest number of poses in one request of SolveIKBatch or QueryWorkspace, and in one "
        "answer of SolveFK",
        1,
        10_000_000,
        "poses",
        read_only=False,
    )
    batch_timeout: float = parameter(
        60.0,
        "How long one request of SolveIKBatch or QueryWorkspace may take; others are served "
        "meanwhile, and poses that are left then get the code TIMED_OUT",
        0.001,
        3600.0,
        "s",
        read_only=False,
    )
    publish_markers: bool = parameter(
        True,
        "Whether ~/markers shows the posture analysed last, and the boundary of the workspace, "
        "which is found as soon as somebody listens or calls query_workspace",
        read_only=False,
    )


class KinematicsNode(Node):
    """Forward and inverse kinematics, Jacobian and singularities of one robot, as services."""

    SETTINGS = KinematicsSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("kinematics", **options)
        self._table = NodeParameters(self, KinematicsSettings)
        self._monitor = JointStateMonitor(self)
        self._points = SolutionPoints()
        self._measured: set[SerialChain] = set()
        self._reach: ReachOfRobot | None = None
        self._reach_lock = Lock()
        when_robot_known(self, self._table.settings, self._serve)

    def _serve(self, model: RobotModel) -> None:
        self._model = model
        self._joints = JointPositions(model, self._monitor)
        chain = model.chain
        # The kernels are compiled or loaded on import; this decides the solver family, too.
        family = inverse_kinematics(chain, forward_kinematics(chain, chain.midrange())).family
        self.create_service(SolveIK, "~/solve_ik", self._solve_ik)
        # While one of these waits, for a joint state or for its turn, others are served.
        for kind, name, callback in (
            (SolveFK, "~/solve_fk", self._solve_fk),
            (SolveIKBatch, "~/solve_ik_batch", self._solve_ik_batch),
            (GetJacobian, "~/get_jacobian", self._get_jacobian),
            (AnalyzeSingularity, "~/analyze_singularity", self._analyze_singularity),
            (QueryWorkspace, "~/query_workspace", self._query_workspace),
        ):
            self.create_service(kind, name, callback, callback_group=ReentrantCallbackGroup())
        self._boundary: list[Any] = []
        self._posture: list[Any] = []
        self._markers = self.create_publisher(
            MarkerArray,
            "~/markers",
            LATCHED,
            callback_group=ReentrantCallbackGroup(),
            event_callbacks=PublisherEventCallbacks(matched=self._watched),
        )
        self._cloud = self.create_publisher(PointCloud2, "~/workspace", LATCHED)
        moveit = add_moveit_services(
            self,
            model,
            self._monitor,
            lambda: self._table.settings.state_timeout,
            self._check_size,
        )
        self.get_logger().info(
            f"ready: {chain.name}, {chain.base} to {chain.tip}, {chain.n} joints, "
            f"inverse kinematics: {family}{', compute_ik and compute_fk' if moveit else ''}"
        )

    @guarded
    async def _solve_fk(self, request: Any, response: Any) -> Any:
        chains = [self._model.chain_to(link) for link in request.links or [""]]
        self._check_size("states times links", max(len(request.states), 1) * len(chains))
        patience = self._table.settings.state_timeout
        rows = await self._joints.rows(chains, request.states, patience)
        poses = [forward_kinematics(chain, q) for chain, q in zip(chains, rows, strict=True)]
        base, turns = self._model.chain.base, Turns(self)
        for of_state in zip(*poses, strict=True):
            for T in of_state:
                response.poses.append(stamped_pose(T, base))
                await turns.end_if_over()
        return answer(response)

    @guarded
    def _solve_ik(self, request: Any, response: Any) -> Any:
        chain = self._moving_chain(request.tip_link)
        frame = self._model.frame_in_base(request.target.header.frame_id)
        T = matrix_from_pose(request.target.pose, "target")
        options = inverse_options(request)
        seed = self._joints.seed(chain, request.seed)
        start = perf_counter()
        target = T if frame is None else frame @ T
        result = inverse_kinematics(chain, target, seed=seed, **options)
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
        lists, done = await solve_in_turns(chain, T, allowed, Turns(self), **options)
        lists.fill(response)
        if done < len(T):
            text = f"{len(T) - done} of {len(T)} poses were left after {allowed:g} s"
            return answer(response, ErrorCode.TIMED_OUT, f"{text}, the parameter batch_timeout")
        return answer(response)

    def _check_size(self, what: str, poses: int) -> None:
        largest = self._table.settings.largest_batch
        if poses > largest:
            expected = f"at most {largest} poses, the parameter largest_batch"
            raise WrongSizeError(what, poses, expected)

    @guarded
    async def _get_jacobian(self, request: Any, response: Any) -> Any:
        chain = self._moving_chain(request.tip_link)
        patience = self._table.settings.state_timeout
        q = await self._joints.given_or_present(chain, request.state, "state", patience)
        point = point_vector(request.tool_point, "tool_point")
        axes = reference_axes(self._model, request.reference_frame, chain, q)
        response.jacobian = floats(linear_rows_first(point_jacobian(chain, q, point, axes)))
        response.joint_names = list(chain.joint_names)
        return answer(response)

    @guarded
    async def _analyze_singularity(self, request: Any, response: Any) -> Any:
        chain = self._moving_chain(request.tip_link)
        patience = self._table.settings.state_timeout
        q = await self._joints.given_or_present(chain, request.state, "state", patience)
        point = point_vector(request.tool_point, "tool_point")
        axes = reference_axes(self._model, request.reference_frame, chain, q)
        if chain not in self._measured:
            # The first report finds the characteristic length, which takes a second or two.
            await beside(self, lambda: singularity_report(chain, q))
            self._measured.add(chain)
        report = singularity_report(chain, q, point=point)
        encode_report(report, axes, request.reference_frame or chain.base, response)
        if self._table.settings.publish_markers:
            T = forward_kinematics(chain, q)
            J = point_jacobian(chain, q, point)
            at = T[:3, :3] @ point + T[:3, 3]
            self._posture = posture_markers(chain.base, at, J, report)
            self._show()
        return answer(response)

    @guarded
    async def _query_workspace(self, request: Any, response: Any) -> Any:
        chain, allowed = self._moving_chain(""), self._table.settings.batch_timeout
        self._check_size("poses", len(request.poses))
        T = poses_in_base(self._model, request.poses)
        reach = await self._known_reach()
        judged = Judgement(chain, T, tuple(bool(entry) for entry in request.task_mask), reach)
        done = await judged.work(self, allowed)
        judged.fill(response)
        if len(T):
            self._cloud.publish(workspace_cloud(chain.base, T, judged.count, judged.distance))
        if done < len(T):
            text = f"{len(T) - done} of {len(T)} poses were left after {allowed:g} s"
            return answer(response, ErrorCode.TIMED_OUT, f"{text}, the parameter batch_timeout")
        return answer(response)

    def _show(self) -> None:
        """Publish all markers there are."""
        self._markers.publish(marker_array([*self._posture, *self._boundary]))

    async def _watched(self, matched: Any) -> None:
        """Find and show the boundary for the first who listens to the markers."""
        settings = self._table.settings
        if matched.current_count and settings.publish_markers and self._model.chain.n:
            await self._known_reach()

    async def _known_reach(self) -> ReachOfRobot:
        """Give what is the same for all poses, and show the boundary if that is not done."""
        if self._reach is None:
            await beside(self, self._find_reach)
        reach = self._reach or self._find_reach()
        if reach.space is not None and not self._boundary and self._table.settings.publish_markers:
            self._boundary = boundary_markers(self._model.chain.base, reach.space)
            self._show()
        return reach

    def _find_reach(self) -> ReachOfRobot:
        with self._reach_lock:
            self._reach = self._reach or reach_of(self._model.chain)
            return self._reach

    def _moving_chain(self, link: str) -> SerialChain:
        """Give the chain to a link, "" being the configured tip, that joints move."""
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
