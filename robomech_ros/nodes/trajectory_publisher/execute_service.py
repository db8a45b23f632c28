"""The service execute: a trajectory, or the latest plan, and how its motion has ended."""

from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.task import Future
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.srv import Execute
from robomech_ros.errors import RobomechError
from robomech_ros.execution.client.execution_request import ExecutionRequest
from robomech_ros.execution.client.position_check import off_goal, off_start
from robomech_ros.nodes.common.messages.error_codes import NoStateError, answer
from robomech_ros.nodes.common.messages.message_fields import duration_from_seconds
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.trajectory_publisher.controller_client import ControllerClient
from robomech_ros.nodes.trajectory_publisher.received_plans import ReceivedPlans
from robomech_ros.nodes.trajectory_publisher.settings import PublisherSettings, answering_transport
from robomech_ros.nodes.trajectory_publisher.speed_services import CANCELLED
from robomech_ros.outcomes import Code

_DONE_BEFORE = "executed before this request; the robot stands at its end"


class NoPlanError(NoStateError):
    """The latest plan is asked for, and there is none."""

    def __init__(self, topics: str) -> None:
        RobomechError.__init__(self, f"no trajectory was planned yet, nothing came on {topics}")


class ExecuteService:
    """Executes what a request asks for, and answers when the motion has ended.

    - ``settings``: parameters, with the tolerances of start and goal.
    - ``plans``: the latest plan, the reader of requests, and the loop that executes them.
    - ``link``: knows the positions of the joints.
    """

    def __init__(
        self, node: Node, settings: PublisherSettings, plans: ReceivedPlans, link: ControllerClient
    ) -> None:
        self._settings, self._plans, self._link = settings, plans, link
        self._transport = answering_transport(settings)
        serve(node, Execute, "~/execute", self._execute, callback_group=ReentrantCallbackGroup())

    async def _execute(self, request: Any, response: Any) -> Any:
        if _asks_for_latest(request.trajectory) and not await self._plans.wait_for_plan():
            return answer(response, Code.PREEMPTED, f"not sent: {CANCELLED}")
        execution = self._execution(request.trajectory, bool(request.ignore_collisions))
        before = execution.report is not None and execution is self._plans.latest
        ended: Future = Future()
        execution.listen(lambda report: ended.done() or ended.set_result(report))
        report = await ended
        response.duration = duration_from_seconds(report.duration)
        done_before = before and not report.code
        return answer(response, report.code, _DONE_BEFORE if done_before else report.text)

    def _execution(self, trajectory: JointTrajectory, ignoring: bool) -> ExecutionRequest:
        """Find the execution request that a request means: a new one, or the latest plan's.

        A client that gives the latest plan, which is executed anyway, means that one.
        """
        if not (_asks_for_latest(trajectory) or self._plans.executes(trajectory)):
            execution = self._plans.asked = self._read(trajectory, ignoring)
            self._plans.loop.offer(execution)
            return execution
        latest = self._plans.latest
        if latest is None:
            raise NoPlanError(self._plans.topics)
        dispatcher = self._plans.loop.dispatcher
        in_hand = latest is dispatcher.current or latest in dispatcher.queue
        if in_hand or self._stands_at_the_end_of(latest):
            return latest
        self._plans.latest = self._read(latest.trajectory, ignoring)
        self._plans.loop.offer(self._plans.latest)
        return self._plans.latest

    def _read(self, trajectory: JointTrajectory, ignoring: bool) -> ExecutionRequest:
        reader, transport = self._plans.reader, self._transport
        return reader.read(trajectory, transport, ignore_collisions=ignoring)

    def _stands_at_the_end_of(self, execution: ExecutionRequest) -> bool:
        """Return whether it was executed and the robot is still at its end, not at its start."""
        if execution.report is None or execution.report.code:
            return False
        names, settings = execution.names, self._settings
        positions = self._link.positions(names)
        if positions is None:
            return False
        given = execution, positions, self._link.kinds(names)
        there = not off_goal(*given, settings.goal_tolerance)
        return there and bool(off_start(*given, settings.start_tolerance))


def _asks_for_latest(trajectory: JointTrajectory) -> bool:
    return not (trajectory.points or trajectory.joint_names)
