"""The task of the demonstration with obstacles: carry a part around a wall, and prove it."""

from functools import partial
from typing import Any, NamedTuple

import numpy as np
from moveit_msgs.action import ExecuteTrajectory
from moveit_msgs.msg import (
    AttachedCollisionObject,
    CollisionObject,
    Constraints,
    MotionPlanRequest,
    MoveItErrorCodes,
    PlanningScene as SceneMessage,
)
from moveit_msgs.srv import ApplyPlanningScene, GetMotionPlan, GetPlanningScene
from shape_msgs.msg import SolidPrimitive

from robomech_interfaces.srv import PlanJoint
from robomech_ros.collision import Box, Clearance, PlanningScene
from robomech_ros.execution.received_trajectory import read_waypoints
from robomech_ros.kinematics import inverse_kinematics
from robomech_ros.nodes.common.messages.joint_messages import received_trajectory
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, pose_from_matrix
from robomech_ros.nodes.demonstration.client import PLAN_JOINT, DemoClient
from robomech_ros.nodes.demonstration.obstacle_cell import PART, ObstacleCell, add_cell
from robomech_ros.nodes.demonstration.report import Reporter, listed_numbers
from robomech_ros.nodes.demonstration.suite import DemoFailedError
from robomech_ros.nodes.middleware.queue_depth import ask_action
from robomech_ros.nodes.moveit.goal_constraints import joint_goal, pose_goal
from robomech_ros.spatial import inverse_pose, pose_error
from robomech_ros.trajectory import Waypoints

SERVICES: dict[str, Any] = {
    "get_planning_scene": GetPlanningScene,
    "apply_planning_scene": ApplyPlanningScene,
    "plan_kinematic_path": GetMotionPlan,
    PLAN_JOINT: PlanJoint,
}
# Least distance that the planner keeps (m); the pads below the part are higher.
CLEARANCE = 1e-3
# Tolerances of goals (rad or m), and of the final pose of the part (m, rad).
_TOLERANCE, _PLACED = 1e-3, 2e-3
_PLANNING_SECONDS, _GRACE_SECONDS = 15.0, 15.0


class Leg(NamedTuple):
    """One motion for the summary: its name, duration (s), states, and least distance."""

    name: str
    duration: float
    states: int
    nearest: Clearance


class CarryAround:
    """Adds the objects, plans, executes, and checks the published joint states.

    - ``scene``: scene of the robot alone, which gets the same objects as the node's scene.
    """

    def __init__(
        self, client: DemoClient, scene: PlanningScene, cell: ObstacleCell, reporter: Reporter
    ) -> None:
        self._client, self._scene, self._cell, self._reporter = client, scene, cell, reporter
        self._home = client.present
        self._execute = self._spinning(
            partial(ask_action, client.node, ExecuteTrajectory, "execute_trajectory")
        )
        self.legs: list[Leg] = []
        self.marks: list[tuple[float, str]] = []

    def run(self) -> None:
        """Run the task."""
        chain, cell = self._scene.chain, self._cell
        tip = chain.tip, _TOLERANCE, chain.base
        self._add_objects()
        self._move("to the part", pose_goal(cell.pick, *tip))
        part = AttachedCollisionObject(link_name=chain.tip, touch_links=list(cell.touch_links))
        part.object.id, part.object.operation = PART, CollisionObject.ADD
        self._apply(f"attach '{PART}'", attached=part)
        self._scene.attach(PART, chain.tip, cell.touch_links, q=self._client.present)
        touching = ", ".join(f"'{link}'" for link in cell.touch_links)
        self._reporter.say(f"'{chain.tip}' carries '{PART}', which {touching} may touch")
        self._show_direct_motion()
        self._move("around the wall", pose_goal(cell.place, *tip))
        part.object.operation = CollisionObject.REMOVE
        self._apply(f"detach '{PART}'", attached=part)
        self._scene.detach(PART, q=self._client.present)
        self._check_part()
        self._move("home", joint_goal(chain.joint_names, self._home, _TOLERANCE))

    def _add_objects(self) -> None:
        # This request is repeated if it is lost; after an answer, discovery is complete.
        bodies = self._client.ask("get_planning_scene", GetPlanningScene.Request()).scene
        names = bodies.allowed_collision_matrix.entry_names
        self._reporter.say(f"move_group checks {len(names)} links: {', '.join(names)}")
        objects = []
        for name, (box, pose) in self._cell.standing.items():
            shape = SolidPrimitive(type=SolidPrimitive.BOX, dimensions=[box.x, box.y, box.z])
            one = CollisionObject(id=name, primitives=[shape], pose=pose_from_matrix(pose))
            one.header.frame_id = self._scene.chain.base
            objects.append(one)
            self._reporter.say(f"'{name}', {_size(box)}, at {listed_numbers(pose[:3, 3])} m")
        self._apply("add the objects", objects=objects)
        add_cell(self._scene, self._cell)

    def _apply(self, what: str, objects: Any = (), attached: Any = None) -> None:
        scene = SceneMessage(is_diff=True)
        scene.robot_state.is_diff = True
        scene.world.collision_objects = list(objects)
        scene.robot_state.attached_collision_objects = [attached] if attached else []
        request = ApplyPlanningScene.Request(scene=scene)
        if not self._client.ask("apply_planning_scene", request).success:
            raise DemoFailedError(f"move_group refused to {what}; its log says why")

    def _move(self, name: str, goal: Constraints) -> None:
        """Plan a motion, prove it, execute it, and check the joint states published meanwhile."""
        self._reporter.heading(name)
        request = MotionPlanRequest(
            goal_constraints=[goal], allowed_planning_time=_PLANNING_SECONDS
        )
        request.start_state.joint_state = self._client.state
        request.start_state.is_diff = True
        answer = self._client.ask(
            "plan_kinematic_path", GetMotionPlan.Request(motion_plan_request=request)
        ).motion_plan_response
        self._check_code("the plan", answer.error_code)
        trajectory = answer.trajectory.joint_trajectory
        points = _waypoints(trajectory)
        check = self._scene.check_motion(points, clearance=CLEARANCE)
        proof = f"no two bodies come nearer than {CLEARANCE * 1e3:g} mm, between the points too"
        if not check.certified:
            proof = f"not proved at {check.parameter:.3f} s for {' and '.join(check.bodies)}"
        remark = (
            f"; the answer adds: {answer.error_code.message}" if answer.error_code.message else ""
        )
        self._reporter.check(
            check.certified,
            f"planned in {answer.planning_time * 1e3:.0f} ms: {points.times[-1]:.2f} s, "
            f"{len(points.times)} points; certified {check.certified}: {proof}{remark}",
        )
        self.marks.append((self._client.now(), name))
        begun = self._client.now()
        self._run(ExecuteTrajectory.Goal(trajectory=answer.trajectory), points)
        self._prove(name, begun, float(points.times[-1]))

    def _run(self, goal: Any, points: Waypoints) -> None:
        patience = float(points.times[-1]) + _GRACE_SECONDS
        handle = self._awaited(partial(self._execute.send_goal_async, goal))
        result = self._awaited(handle.get_result_async, patience).result
        self._check_code("the execution", result.error_code)
        self._client.wait_until_at(points.positions[-1], _TOLERANCE, _GRACE_SECONDS)

    def _prove(self, name: str, begun: float, duration: float) -> None:
        """Check all joint states that were published since a time (s) of the recording."""
        times, q, _ = self._client.recording()
        rows = q[times >= begun]
        longest = float(np.diff(times[times >= begun]).max())
        nearest = min(map(self._scene.clearance, rows), key=lambda one: one.distance)
        between = self._scene.check_motion(rows)
        first, second = nearest.bodies
        text = (
            f"{len(rows)} published joint states were recorded, at most {longest * 1e3:.0f} ms "
            f"apart; the least distance is {nearest.distance * 1e3:.2f} mm, of '{first}' and "
            f"'{second}'; "
        )
        free = nearest.distance > 0.0 and between.certified
        words = "none is in contact, nor is any posture between them" if free else "a contact"
        self._reporter.check(free, text + words)
        self.legs.append(Leg(name, duration, len(rows), nearest))

    def _show_direct_motion(self) -> None:
        """Plan without the wall, and print how deep that motion would hit."""
        chain, here = self._scene.chain, self._client.present
        goal = inverse_kinematics(chain, self._cell.place, seed=here).q[0]
        answer = self._client.plan_joint(
            goal, profile=PlanJoint.Request.RUCKIG, keep_turns=True, ignore_collisions=True
        )
        points = _waypoints(answer.trajectory)
        found = [self._scene.clearance(row) for row in points.positions]
        k = min(range(len(found)), key=lambda i: found[i].distance)
        first, second = found[k].bodies
        self._reporter.check(
            found[k].distance < 0.0,
            f"with ignore_collisions the motion takes {points.times[-1]:.2f} s, and would drive "
            f"'{first}' and '{second}' {-found[k].distance * 1e3:.1f} mm into each other after "
            f"{points.times[k]:.2f} s: it is not executed",
        )

    def _check_part(self) -> None:
        """Compare the pose of the part in move_group with its goal."""
        answer = self._client.ask("get_planning_scene", GetPlanningScene.Request())
        standing = {one.id: one for one in answer.scene.world.collision_objects}
        wanted = self._cell.place @ inverse_pose(self._cell.pick) @ self._cell.standing[PART][1]
        if PART not in standing:
            raise DemoFailedError(f"'{PART}' is missing in the scene of move_group")
        error = pose_error(wanted, matrix_from_pose(standing[PART].pose)).reshape(2, 3)
        turned, off = np.linalg.norm(error, axis=1).tolist()
        self._reporter.check(
            max(turned, off) < _PLACED,
            f"'{PART}' stands {off * 1e3:.2f} mm and {turned:.1e} rad from its goal",
        )

    def _check_code(self, what: str, code: Any) -> None:
        if code.val != MoveItErrorCodes.SUCCESS:
            raise DemoFailedError(f"{what} ended with {code.val}: {code.message}")

    def _awaited(self, work: Any, seconds: float = _GRACE_SECONDS) -> Any:
        """Return the result of the future that work in the spinning thread returns."""
        future = self._spinning(work)
        if not self._client.wait(future.done, seconds):
            raise DemoFailedError(f"execute_trajectory did not answer within {seconds:.0f} s")
        return future.result()

    def _spinning(self, work: Any) -> Any:
        """Do work in the spinning thread: rclpy's action clients are not thread-safe."""
        task = self._client.node.executor.create_task(work)
        self._client.wait(task.done, _GRACE_SECONDS)
        return task.result()


def _waypoints(trajectory: Any) -> Waypoints:
    names, most = trajectory.joint_names, len(trajectory.points)
    return read_waypoints(received_trajectory(trajectory), names, most, np.inf, to_rest=False)


def _size(box: Box) -> str:
    return f"{box.x * 1e3:.0f} x {box.y * 1e3:.0f} x {box.z * 1e3:.0f} mm"
