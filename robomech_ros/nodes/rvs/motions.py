"""Requests of planning, execution and stops, as by any client."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.client import Client
from rclpy.node import Node
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.srv import Execute, PlanJoint
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.message_fields import seconds_from_duration
from robomech_ros.nodes.middleware.queue_depth import ask
from robomech_ros.nodes.rvs.requests import Requests
from robomech_ros.nodes.rvs.settings import RvsSettings
from robomech_ros.nodes.rvs.stop_client import StopClient
from robomech_ros.outcomes import name_of
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.rvs.layers.live import LiveLayer

_AUTOMATIC = "auto_execute"
# Longest time for answers (s): about parameters, of the planner, and of the executing node.
_PARAMETER_TIMEOUT, _PLANNING_TIMEOUT, _MOTION_TIMEOUT = 5.0, 120.0, float("inf")


class Motions:
    """Calls the services of planner, publisher and controller; answers go to the view.

    - ``names``: names of the joints that move.
    - ``settings``: the parameters, which name the nodes to call.
    - ``show_plan``: shows a planned trajectory.
    """

    def __init__(
        self,
        node: Node,
        names: Sequence[str],
        settings: RvsSettings,
        view: LiveLayer,
        show_plan: Callable[[JointTrajectory], None],
    ) -> None:
        self._view, self._show_plan = view, show_plan
        self._names = tuple(names)
        planner, publisher, controller = settings.planner, settings.publisher, settings.controller
        self._planner = ask(node, PlanJoint, f"{planner}/plan_joint")
        self._executor = ask(node, Execute, f"{publisher}/execute")
        cancel = ask(node, Trigger, f"{publisher}/cancel")
        hold = ask(node, Trigger, f"{controller}/hold")
        self._reader = ask(node, GetParameters, f"{publisher}/get_parameters")
        self._writer = ask(node, SetParameters, f"{publisher}/set_parameters")
        self._requests = Requests(node)
        self._stopping = StopClient(self._requests, cancel, hold, view)
        # Held while something is decided and sent, so that nothing is sent after a stop.
        self._lock = threading.RLock()
        # Number of the latest request; whether the parameter is being asked for.
        self._number, self._looking = 0, False

    def plan(self, q: Array) -> None:
        """Plan from the robot's state to a posture (n,) (rad or m), and show the plan."""

        def planned(number: int, answer: Any, seconds: float) -> None:
            self._view.show_result(f"Planned: the motion takes {seconds:.2f} s.")

        self._plan(q, "No plan", planned)

    def execute(self, q: Array) -> None:
        """Plan such a motion, and execute it."""

        def planned(number: int, answer: Any, seconds: float) -> None:
            self._view.show_result(f"Executing a motion of {seconds:.2f} s ...")
            asked = Execute.Request(trajectory=answer.trajectory)
            self._call(number, self._executor, asked, executed, _MOTION_TIMEOUT)

        def executed(answer: Any) -> None:
            if not self._said_no("The motion ended early", answer):
                seconds = seconds_from_duration(answer.duration, "duration")
                self._view.show_result(f"Executed: the robot arrived after {seconds:.2f} s.")

        self._plan(q, "Not executed, no plan", planned)

    def _plan(self, q: Array, refusal: str, take: Callable[[int, Any, float], None]) -> None:
        """Ask for a plan that nobody else receives, so that the robot stays."""
        request = PlanJoint.Request(goal=joint_state(self._names, q), answer_only=True)
        with self._lock:
            number = self._begin("Planning ...")

            def planned(answer: Any) -> None:
                if not self._said_no(refusal, answer):
                    seconds = seconds_from_duration(answer.duration, "duration")
                    self._show_plan(answer.trajectory)
                    take(number, answer, seconds)

            self._call(number, self._planner, request, planned, _PLANNING_TIMEOUT)

    def stop(self) -> None:
        """Stop whatever moves the robot."""
        with self._lock:
            self._number += 1
            self._stopping.stop()

    def let_plans_wait(self, waiting: bool) -> None:
        """Set whether plans are executed on request only, or at once."""
        value = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=not waiting)
        request = SetParameters.Request(parameters=[Parameter(name=_AUTOMATIC, value=value)])

        def done(answer: Any) -> None:
            result = answer.results[0]
            if result.successful:
                text = "Plans wait for Execute." if waiting else "Plans are executed at once."
                self._view.show_result(text)
            else:
                self._view.show_result(f"Not set: {result.reason}.", failed=True)
            self._look_whether_automatic()

        with self._lock:
            self._call(self._begin("Setting ..."), self._writer, request, done, _PARAMETER_TIMEOUT)

    def look(self) -> None:
        """Check for waiting plans, and that the asked node is still there."""
        self._requests.look()
        self._stopping.look()
        self._look_whether_automatic()

    def _look_whether_automatic(self) -> None:
        if self._looking or not self._reader.service_is_ready():
            return
        self._looking = True

        def take(answer: Any) -> None:
            self._looking = False
            automatic = _automatic(answer)
            if automatic is not None:
                self._view.show_waiting(not automatic)

        def give_up(_: str) -> None:
            self._looking = False

        request = GetParameters.Request(names=[_AUTOMATIC])
        self._requests.send(self._reader, request, take, give_up, _PARAMETER_TIMEOUT)

    def _begin(self, text: str) -> int:
        self._number += 1
        self._stopping.hide()
        self._view.show_result(text)
        return self._number

    def _call(
        self,
        number: int,
        client: Client,
        request: Any,
        take: Callable[[Any], None],
        patience: float,
    ) -> None:
        """Call a service, and take its answer unless another request has come meanwhile."""
        name = self._requests.name(client)
        if not client.service_is_ready():
            self._view.show_result(f"Nobody serves {name}.", failed=True)
            return

        def answered(answer: Any) -> None:
            with self._lock:
                if number == self._number:
                    try:
                        take(answer)
                    except (RobomechError, LookupError) as error:
                        text = f"The answer of {name} cannot be read: {error}"
                        self._view.show_result(text, failed=True)

        def give_up(why: str) -> None:
            with self._lock:
                if number == self._number:
                    self._number += 1
                    self._view.show_result(f"No answer: {why}.", failed=True)

        self._requests.send(client, request, answered, give_up, patience)

    def _said_no(self, what: str, answer: Any) -> bool:
        if answer.error_code:
            why = f"{answer.error_msg} ({name_of(answer.error_code)})"
            self._view.show_result(f"{what}: {why}", failed=True)
        return bool(answer.error_code)


def _automatic(answer: Any) -> bool | None:
    """Read whether each plan is executed; None where the answer does not tell."""
    try:
        value = answer.values[0]
    except (RobomechError, LookupError):
        return None
    return bool(value.bool_value) if value.type == ParameterType.PARAMETER_BOOL else None
