"""The node that answers kinematic questions: poses, joint positions, Jacobians, singularities."""

from contextlib import suppress
from functools import partial
from time import perf_counter
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.event_handler import PublisherEventCallbacks
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
from robomech_ros.errors import RobomechError, WrongSizeError
from robomech_ros.errors.formatting import counted
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.cooperative_wait import TimeSlices, Worker
from robomech_ros.nodes.common.joints.joint_positions import JointPositions, Linkage
from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.common.messages.error_codes import answer
from robomech_ros.nodes.common.messages.joint_messages import TrajectoryPoints
from robomech_ros.nodes.common.messages.message_fields import floats
from robomech_ros.nodes.common.messages.pose_messages import (
    linear_rows_first,
    matrices_from_pose_rows,
    matrix_from_pose,
    point_vector,
    stamped_pose,
)
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.robot.floating_base import FloatingRobot
from robomech_ros.nodes.common.robot.robot_description import LATCHED, RobotModel
from robomech_ros.nodes.common.robot.robot_source import when_robot_known
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.frames.robot_frames import RobotFrames
from robomech_ros.nodes.kinematics.chain_manipulator import ChainManipulator
from robomech_ros.nodes.kinematics.markers import MarkerPublisher, posture_markers
from robomech_ros.nodes.kinematics.messages import (
    answer_in_time,
    encode_report,
    encode_result,
    inverse_options,
    is_nearest,
    poses_in_base,
    workspace_cloud,
)
from robomech_ros.nodes.kinematics.pose_batches import Manipulator, WorkspaceQuery, solve_in_turns
from robomech_ros.nodes.kinematics.settings import KinematicsSettings
from robomech_ros.nodes.move_group.monitored_scene import MonitoredScene
from robomech_ros.nodes.process.run import run_node
from robomech_ros.outcomes import Code
from robomech_ros.typing import Array


class KinematicsNode(Node):
    """Forward and inverse kinematics, Jacobian and singularities of one robot, as services."""

    SETTINGS = KinematicsSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("kinematics", **options)
        # Facts that are computed once for a robot take seconds.
        self._worker = Worker(self)
        self._table = NodeParameters(self, KinematicsSettings)
        self._monitor = JointStateMonitor(self)
        self._points = TrajectoryPoints()
        when_robot_known(self, self._table.settings, self._serve, parallel=True)

    def stop(self) -> None:
        """Answer all requests that wait for long work."""
        self._worker.give_up(f"the node {self.get_name()} shuts down")

    def destroy_node(self) -> None:
        """Destroy the node, and end its thread for long work."""
        self._worker.close()
        super().destroy_node()

    def _serve(self, model: RobotModel) -> None:
        self._model = model
        self._joints = JointPositions(model, self._monitor)
        self._frames = RobotFrames(self, model, self._monitor, lambda: self._table.settings)
        self._floating = FloatingRobot(model, self._table.settings)
        self._robot = self._manipulator()
        self._scene = MonitoredScene(self, model, self._monitor, self._worker)
        # While one of these waits, for a joint state, a frame or its turn, others are served.
        for kind, name, callback in (
            (SolveIK, "~/solve_ik", self._solve_ik),
            (SolveFK, "~/solve_fk", self._solve_fk),
            (SolveIKBatch, "~/solve_ik_batch", self._solve_ik_batch),
            (GetJacobian, "~/get_jacobian", self._get_jacobian),
            (AnalyzeSingularity, "~/analyze_singularity", self._analyze_singularity),
            (QueryWorkspace, "~/query_workspace", self._query_workspace),
        ):
            serve(self, kind, name, callback, callback_group=ReentrantCallbackGroup())
        self._markers = MarkerPublisher(self, model.base_frame, self._show_first_boundary)
        # Subscribers of another type or quality of service report that themselves.
        silent = PublisherEventCallbacks(use_default_callbacks=False)
        self._cloud = self.create_publisher(
            PointCloud2, "~/workspace", LATCHED, event_callbacks=silent
        )
        self.get_logger().info(f"ready: {self._robot.introduction}")

    def _manipulator(self) -> Manipulator:
        """Make the kinematics of the robot; what is compiled for its kind is loaded only then."""
        if self._model.mechanism is None:
            return ChainManipulator(self._model, self._joints, self._worker)
        from robomech_ros.nodes.kinematics.platform_manipulator import PlatformManipulator

        return PlatformManipulator(self._model, self._joints, self._worker)

    async def _solve_fk(self, request: Any, response: Any) -> Any:
        ways = [self._model.chain_to(link) for link in request.links or [""]]
        self._check_size("states times links", max(len(request.states), 1) * len(ways))
        patience = self._table.settings.state_timeout
        rows, text = await self._robot.rows(ways, request.states, patience)
        poses = [forward_kinematics(way, q) for way, q in zip(ways, rows, strict=True)]
        base, turns = self._model.base_frame, TimeSlices(self)
        for of_state in zip(*poses, strict=True):
            for T in of_state:
                response.poses.append(stamped_pose(T, base))
                await turns.end_if_over()
        return answer(response, Code.NONE, text)

    async def _solve_ik(self, request: Any, response: Any) -> Any:
        way: Any = self._robot.linkage_to(request.tip_link)
        T = matrix_from_pose(request.target.pose, "target")
        header, patience = request.target.header, self._table.settings.state_timeout
        # Most requests are in the base.
        if header.frame_id:
            T = await self._frames.in_base(header.frame_id, patience, header.stamp) @ T
        seed = self._joints.seed(way, request.seed)
        scene = await self._scene.of(way, request.ignore_collisions)
        start = perf_counter()
        if self._floating.floats and self._frames.is_apart(header.frame_id):
            # Compiled code is loaded only for such a robot.
            from robomech_ros.nodes.kinematics.inertial_solution import solve_inertial

            robot, options = self._floating.carrying(way), inverse_options(request)
            solve = partial(solve_inertial, robot, T, seed, scene, options)
            result = await self._worker.do(solve)
        else:
            result = self._robot.solver(way, request, scene)(T, seed=seed)
        seconds = perf_counter() - start
        encode_result(result, way.joint_names, self._points, seconds, response)
        return self._scene.add_note(scene, response)

    async def _solve_ik_batch(self, request: Any, response: Any) -> Any:
        way, allowed = self._robot.linkage_to(""), self._table.settings.batch_timeout
        T = matrices_from_pose_rows(request.poses)
        self._check_size("poses", len(T))
        options = {
            "seed": self._joints.seed(way, JointState(position=request.seed)),
            "respect_limits": not request.ignore_limits,
            "max_solutions": 1 if is_nearest(request.mode) else None,
        }
        lists = await solve_in_turns(self._robot, T, allowed, TimeSlices(self), **options)
        done = len(lists)
        lists.fill(response, len(T))
        response.joint_names = list(way.joint_names)
        return answer_in_time(response, done, len(T), allowed)

    def _check_size(self, what: str, poses: int) -> None:
        largest = self._table.settings.max_batch_size
        if poses > largest:
            expected = f"at most {counted(largest, 'pose')}, the parameter max_batch_size"
            raise WrongSizeError(what, poses, expected)

    async def _get_jacobian(self, request: Any, response: Any) -> Any:
        carrier, way = self._robot.carrier(request.tip_link)
        asked = await self._posture_asked(way, request)
        J, names = self._robot.jacobian(carrier, *asked)
        response.jacobian = floats(linear_rows_first(J))
        response.joint_names = list(names)
        return answer(response)

    async def _analyze_singularity(self, request: Any, response: Any) -> Any:
        way: Any = self._robot.linkage_to(request.tip_link)
        q, point, axes = await self._posture_asked(way, request)
        report = await self._robot.singularity(way, q, point)
        encode_report(report, axes, self._model.full_frame(request.reference_frame), response)
        if self._table.settings.publish_markers:
            self._markers.show_posture(posture_markers(report))
        return answer(response)

    async def _query_workspace(self, request: Any, response: Any) -> Any:
        settings, robot = self._table.settings, self._robot
        robot.linkage_to("")
        self._check_size("poses", len(request.poses))
        mask = robot.task_mask([bool(entry) for entry in request.task_mask])
        T = await poses_in_base(self._frames, request.poses, settings.state_timeout)
        await robot.prepare()
        query = WorkspaceQuery(robot, T, mask)
        done = await query.work(self, settings.batch_timeout)
        query.fill(response)
        response.least_reach, response.greatest_reach = await robot.reach()
        if len(T):
            cloud = workspace_cloud(self._model.base_frame, T, query.count, query.distance)
            self._cloud.publish(cloud)
        await self._show_boundary(T[0] if len(T) else None)
        return answer_in_time(response, done, len(T), settings.batch_timeout)

    async def _posture_asked(self, way: Linkage, request: Any) -> tuple[Array, Array, Array]:
        """Read the posture (n,), the point (3,) and the axes of a request about a Jacobian.

        The axes are ``R_base_axes``, shape (3, 3).
        """
        patience = self._table.settings.state_timeout
        q = await self._joints.read_or_present(way, request.state, "state", patience)
        point = point_vector(request.tool_point, "tool_point")
        at = dict(zip(way.joint_names, q.tolist(), strict=True))
        frame = await self._frames.in_base(request.reference_frame, patience, at=at)
        return q, point, frame[:3, :3]

    async def _show_first_boundary(self) -> None:
        """Find and show the boundary when the first subscriber of the markers comes."""
        with suppress(RobomechError):  # a request for it gets the error
            await self._show_boundary(None)

    async def _show_boundary(self, T: Array | None) -> None:
        """Show the boundary, of a platform in the orientation of a pose."""
        if self._table.settings.publish_markers:
            self._markers.show_boundary(await self._robot.boundary_markers(T))


main = partial(run_node, KinematicsNode)

if __name__ == "__main__":
    raise SystemExit(main())
