"""The node that answers what a hand holds: closure, forces and postures of grasps."""

from functools import partial
from importlib.util import find_spec
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from robomech_interfaces.srv import AnalyzeGrasp, ContactForces, SolveGrasp
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError
from robomech_ros.errors.formatting import counted
from robomech_ros.hands import (
    ForceStatus,
    contact_forces,
    grasp_matrix,
    hand_postures,
    load_hand,
    tip_postures,
)
from robomech_ros.hands.conic_solver import ConicSolverUnavailableError
from robomech_ros.hands.contacts import span
from robomech_ros.hands.forces import SMALLEST
from robomech_ros.hands.postures import MOST_POSTURES
from robomech_ros.hands.quality import SHORTEST
from robomech_ros.nodes.common.cooperative_wait import Worker
from robomech_ros.nodes.common.joints.joint_positions import is_empty
from robomech_ros.nodes.common.messages.joint_messages import positions_by_name
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.common.parameters import NodeParameters
from robomech_ros.nodes.common.readiness import Readiness
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.grasping.answers import analysed, fill_efforts, fill_forces, fill_postures
from robomech_ros.nodes.grasping.requests import (
    GivenHand,
    load_wrench,
    read_contacts,
    read_origin,
    read_points,
)
from robomech_ros.nodes.grasping.settings import GraspingSettings, check_settings
from robomech_ros.nodes.process.run import run_node

_TOLERANCE = 1e-4
_POSTURES = 100


class GraspingNode(Node):
    """Closure, quality and forces of grasps, and postures of a hand, as services."""

    SETTINGS = GraspingSettings

    def __init__(self, **options: Any) -> None:
        super().__init__("grasping", **options)
        self._table = NodeParameters(self, GraspingSettings, check=check_settings)
        settings = self._table.settings
        check_settings(settings)
        described = settings.robot_description
        hand = load_hand(described) if described else None
        self._hand = GivenHand(hand, settings.frame_prefix)
        # A quality may take half a second; forces do not wait for it, nor it for them.
        self._analyses, self._forces = Worker(self), Worker(self)
        Readiness(self)
        group = ReentrantCallbackGroup()
        serve(self, AnalyzeGrasp, "~/analyze_grasp", self._analyze_grasp, callback_group=group)
        serve(self, ContactForces, "~/contact_forces", self._contact_forces, callback_group=group)
        serve(self, SolveGrasp, "~/solve_grasp", self._solve_grasp)
        if find_spec("clarabel") is None:
            self.get_logger().warning(f"no ~/contact_forces: {ConicSolverUnavailableError()}")
        name = "no hand" if hand is None else f"{hand.name}, {counted(len(hand.fingers), 'finger')}"
        self.get_logger().info(f"ready: {name}")

    def stop(self) -> None:
        """Answer the waiting requests."""
        for worker in (self._analyses, self._forces):
            worker.give_up(f"the node {self.get_name()} shuts down")

    def destroy_node(self) -> None:
        """Take leave of ROS, and of the threads for long work."""
        for worker in (self._analyses, self._forces):
            worker.close()
        super().destroy_node()

    async def _analyze_grasp(self, request: Any, response: Any) -> Any:
        contacts = read_contacts(request)
        origin = read_origin(request)
        matrix = grasp_matrix(contacts, origin)
        work = partial(
            analysed,
            contacts,
            matrix,
            self._hand.posture(request, len(contacts)),
            origin=origin,
            length=request.length or min(max(span(contacts, origin), SHORTEST), LARGEST_LENGTH),
            tolerance=request.tolerance or _TOLERANCE,
            max_wrenches=self._table.settings.max_wrenches,
        )
        found = await self._analyses.do(work, self._table.settings.max_queue_time)
        return found.fill(self._hand.frame(request.frame_id), response)

    async def _contact_forces(self, request: Any, response: Any) -> Any:
        contacts = read_contacts(request)
        if request.smallest >= len(SMALLEST):
            raise BadValueError("smallest", request.smallest, "LARGEST (0) or TOTAL (1)")
        load = load_wrench(request)
        origin = read_origin(request)
        made_by = self._hand.posture(request, len(contacts))
        smallest = SMALLEST[request.smallest]
        work = partial(contact_forces, contacts, load, origin=origin, smallest=smallest)
        found = await self._forces.do(work)
        if made_by is not None and found.status is ForceStatus.HELD:
            fill_efforts(made_by, contacts, found.components, response)
        return fill_forces(found, load, self._hand.frame(request.frame_id), response)

    def _solve_grasp(self, request: Any, response: Any) -> Any:
        hand = self._hand.required()
        self._hand.require_palm(request.object_pose.header.frame_id)
        T = matrix_from_pose(request.object_pose.pose, "object_pose")
        points = read_points(request.positions) @ T[:3, :3].T + T[:3, 3]
        numbers = self._hand.fingers(request.fingers, len(points), each_once=True)
        seed = None
        if not is_empty(request.seed):
            seed = positions_by_name(request.seed, hand.joint_names, "seed")
        respected, most = not request.ignore_limits, request.max_solutions or _POSTURES
        if most > MOST_POSTURES:
            raise BadValueError("max_solutions", most, f"0 to {MOST_POSTURES}")
        found = tip_postures(hand, points, fingers=numbers, seed=seed, respect_limits=respected)
        whole = hand_postures(hand, found, fingers=numbers, seed=seed, most=most)
        owners = range(len(points)) if numbers is None else numbers
        return fill_postures(hand, found, owners, whole, response)


main = partial(run_node, GraspingNode)

if __name__ == "__main__":
    raise SystemExit(main())
