"""Execution of trajectories by the controller, for MoveIt's clients."""

import math
import time
from collections.abc import Awaitable, Callable
from contextlib import suppress
from typing import Any

from action_msgs.msg import GoalStatus
from moveit_msgs.msg import MoveItErrorCodes
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String

from robomech_ros.errors import RobomechError
from robomech_ros.execution.received_trajectory import read_waypoints
from robomech_ros.nodes.common.cooperative_wait import pause
from robomech_ros.nodes.common.messages.execute_goals import AskedTolerances
from robomech_ros.nodes.common.messages.follow_goals import FollowGoals
from robomech_ros.nodes.common.messages.joint_messages import received_trajectory
from robomech_ros.nodes.middleware.queue_depth import ask_action
from robomech_ros.nodes.move_group.motion_watch import MotionWatch
from robomech_ros.nodes.move_group.scenes import Scenes
from robomech_ros.nodes.move_group.settings import MoveGroupSettings
from robomech_ros.nodes.moveit.serving import RejectedError
from robomech_ros.nodes.moveit.whole_robot import WholeRobot
from robomech_ros.outcomes import Code

_CONTROL_FAILED = MoveItErrorCodes.CONTROL_FAILED
_INVALIDATED = MoveItErrorCodes.MOTION_PLAN_INVALIDATED_BY_ENVIRONMENT_CHANGE
# Codes of the controller with a MoveIt code of their own, instead of CONTROL_FAILED.
_CODES: dict[int, int] = {
    Code.NONE: MoveItErrorCodes.SUCCESS,
    Code.PREEMPTED: MoveItErrorCodes.PREEMPTED,
}


class Execution:
    """Sends trajectories to the controller, and stops them."""

    def __init__(
        self,
        node: Node,
        robot: WholeRobot,
        scenes: Scenes,
        settings: Callable[[], MoveGroupSettings],
    ) -> None:
        self._node, self._robot, self._settings = node, robot, settings
        self._scenes = scenes
        self._goals = FollowGoals()
        self._controller = settings().controller
        self._client = ask_action(node, FollowGoals.kind, f"{self._controller}/{FollowGoals.name}")
        self._stops = 0
        node.create_subscription(String, "trajectory_execution_event", self._take_event, 10)

    @property
    def unchecked(self) -> str:
        """Unchecked links, with the reasons; "" if all links are checked."""
        return self._scenes.unchecked

    async def run(self, trajectory: Any, cancelled: Callable[[], bool]) -> tuple[int, str]:
        """Execute a JointTrajectory to its end.

        - ``trajectory``: JointTrajectory.
        - ``cancelled``: whether the client has cancelled its goal.

        Returns one of MoveItErrorCodes, and why.

        Raises RejectedError: the controller is missing, the robot is not at the start, or something
        is in the way.
        """
        if not trajectory.points:
            return MoveItErrorCodes.SUCCESS, "the trajectory is empty"
        self._check_start(trajectory)
        await self._while_there(self._client.server_is_ready)
        watch = self._watch(trajectory)
        if reason := await self._obstruction(watch):
            raise RejectedError(_INVALIDATED, reason)
        stops, asked, obstruction = self._stops, False, ""
        handle = await self._awaited(
            self._client.send_goal_async(self._goals.goal(trajectory, AskedTolerances()))
        )
        if not handle.accepted:
            raise RejectedError(_CONTROL_FAILED, "the controller rejected the trajectory")

        async def stop_if_necessary() -> None:
            nonlocal asked, obstruction
            if asked:
                return
            obstruction = await self._obstruction(watch)
            if obstruction or cancelled() or self._stops != stops:
                asked = True
                handle.cancel_goal_async()

        ended = await self._awaited(handle.get_result_async(), stop_if_necessary)
        if ended.status == GoalStatus.STATUS_UNKNOWN:
            raise RejectedError(_CONTROL_FAILED, "the controller does not know the goal any more")
        code, text = self._goals.verdict(ended.status, ended.result, True)
        if obstruction and code == Code.PREEMPTED:
            return _INVALIDATED, f"the robot has stopped on its path: {obstruction}"
        if asked and code == Code.PREEMPTED:
            by = "the client" if cancelled() else "trajectory_execution_event"
            text = f"stopped by {by}; the robot stands on its path"
        return _CODES.get(code, _CONTROL_FAILED), text

    def _watch(self, trajectory: Any) -> MotionWatch | None:
        """Return the collision watch of a trajectory; None if the controller will refuse it."""
        names, model = list(trajectory.joint_names), self._robot.model
        with suppress(RobomechError):
            most = len(trajectory.points), math.inf
            waypoints = read_waypoints(received_trajectory(trajectory), names, *most, to_rest=False)
            return MotionWatch(model, self._robot.known, names, waypoints)
        return None

    async def _obstruction(self, watch: MotionWatch | None) -> str:
        """Name what the rest of a motion would touch in a changed world; "" for nothing."""
        if watch is None or not watch.is_due(self._scenes.world):
            return ""
        positions = self._robot.with_defaults(self._robot.known())
        return watch.obstruction(await self._scenes.of(watch.chain, positions))

    async def _awaited(
        self, future: Future, look: Callable[[], Awaitable[None]] | None = None
    ) -> Any:
        """Return the controller's answer; looks around while it is waited for."""
        await self._while_there(future.done, look)
        return future.result()

    async def _while_there(
        self, done: Callable[[], bool], look: Callable[[], Awaitable[None]] | None = None
    ) -> None:
        """Wait until something is done; give up if the controller is missing for too long."""
        patience, seen = self._settings().controller_timeout, time.monotonic()
        while not done():
            now = time.monotonic()
            if self._client.server_is_ready():
                seen = now
            elif now - seen > patience:
                reason = f"the controller '{self._controller}' does not serve {FollowGoals.name}"
                raise RejectedError(_CONTROL_FAILED, f"{reason}; start it, or set controller")
            if look is not None:
                await look()
            await pause(self._node)

    def _check_start(self, trajectory: Any) -> None:
        """Refuse a trajectory that begins somewhere else than the robot is."""
        first, most = trajectory.points[0], self._settings().start_tolerance
        if first.time_from_start.sec or first.time_from_start.nanosec:
            return
        known, turning = self._robot.known(), self._robot.continuous
        for name, wanted in zip(trajectory.joint_names, first.positions, strict=False):
            if name not in known:
                continue
            apart = known[name] - wanted
            if name in turning:
                apart = math.remainder(apart, math.tau)
            if not abs(apart) <= most:
                unit = self._robot.model.units[name]
                raise RejectedError(
                    MoveItErrorCodes.INVALID_MOTION_PLAN,
                    f"the trajectory starts with '{name}' at {wanted:.6g} {unit}, {abs(apart):.3g} "
                    f"{unit} from where it is; up to {most:g} is allowed by start_tolerance",
                )

    def _take_event(self, message: Any) -> None:
        if message.data == "stop":
            self._stops += 1
