"""Has motions planned, executed and stopped, as any client would."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.client import Client
from rclpy.node import Node
from std_srvs.srv import Trigger

from robomech_interfaces.srv import Execute, PlanJoint
from robomech_ros.nodes.common.joint_messages import joint_state
from robomech_ros.nodes.common.message_fields import seconds_from_duration
from robomech_ros.nodes.middleware.deep_queues import ask
from robomech_ros.nodes.rvs.settings import RvsSettings
from robomech_ros.outcomes import name_of
from robomech_ros.robots import SerialChain
from robomech_ros.rvs.model.live_robot import LiveView

__all__ = ["Motions"]

Array = NDArray[np.float64]

_AUTOMATIC = "auto_execute"
_WOULD_MOVE = (
    "Not planned: '{publisher}' executes every plan at once (its parameter auto_execute), so a "
    "plan would move the robot. Execute does both; with 'plans wait', under ROS, plans are "
    "only shown."
)


class Motions:
    """Calls the services of planner, publisher and controller; answers go to the view.

    Parameters
    ----------
    node : Node
        Owner of the clients.
    chain : SerialChain
        What moves.
    settings : RvsSettings
        Whom to call.
    view : LiveView
    """

    def __init__(
        self, node: Node, chain: SerialChain, settings: RvsSettings, view: LiveView
    ) -> None:
        self._node, self._view, self._publisher = node, view, settings.publisher
        self._names = chain.joint_names
        planner, publisher, controller = settings.planner, settings.publisher, settings.controller
        self._planner = ask(node, PlanJoint, f"{planner}/plan_joint")
        self._executor = ask(node, Execute, f"{publisher}/execute")
        self._stoppers = [
            ask(node, Trigger, f"{publisher}/cancel"),
            ask(node, Trigger, f"{controller}/hold"),
        ]
        self._reader = ask(node, GetParameters, f"{publisher}/get_parameters")
        self._writer = ask(node, SetParameters, f"{publisher}/set_parameters")
        # Which request is the latest, whether it was to stop, and whose answer is awaited.
        self._number, self._stopped_from = 0, 0
        self._awaited: Client | None = None

    def plan(self, q: Array) -> None:
        """Plan from where the robot is to a posture (n,) (rad or m), unless that would move it."""
        number = self._begin("Planning ...")

        def planned(answer: Any) -> None:
            if self._said_no("No plan", answer):
                return
            seconds = seconds_from_duration(answer.duration, "duration")
            self._view.show_result(f"Planned: the motion takes {seconds:.2f} s.")

        def allowed(answer: Any) -> None:
            if _is_automatic(answer):
                text = _WOULD_MOVE.format(publisher=self._publisher)
                self._view.show_result(text, failed=True)
                return
            self._call(number, self._planner, self._request(q), planned)

        if self._reader.service_is_ready():
            self._call(number, self._reader, GetParameters.Request(names=[_AUTOMATIC]), allowed)
        else:
            self._call(number, self._planner, self._request(q), planned)

    def execute(self, q: Array) -> None:
        """Plan such a motion, and execute it."""
        number = self._begin("Planning ...")

        def planned(answer: Any) -> None:
            if self._said_no("Not executed, no plan", answer):
                return
            seconds = seconds_from_duration(answer.duration, "duration")
            self._view.show_result(f"Executing a motion of {seconds:.2f} s ...")
            # Without a trajectory it is the latest plan, which may be under way already.
            self._call(number, self._executor, Execute.Request(), executed)

        def executed(answer: Any) -> None:
            if self._said_no("The motion ended early", answer):
                return
            seconds = seconds_from_duration(answer.duration, "duration")
            self._view.show_result(f"Executed: the robot arrived after {seconds:.2f} s.")

        self._call(number, self._planner, self._request(q), planned)

    def stop(self) -> None:
        """Stop whatever moves the robot."""
        self._number += 1
        self._stopped_from = self._number
        self._awaited = None
        self._stop()

    def _stop(self) -> None:
        there = [client for client in self._stoppers if client.service_is_ready()]
        for client in there:
            client.call_async(Trigger.Request())
        if there:
            self._view.show_result("Stopped.")
            return
        names = " and ".join(self._name(client) for client in self._stoppers)
        self._view.show_result(f"Nobody serves {names}: only the jog is stopped.", failed=True)

    def let_plans_wait(self, waiting: bool) -> None:
        """Have plans executed on request only, or each as it is made."""
        value = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=not waiting)
        request = SetParameters.Request(parameters=[Parameter(name=_AUTOMATIC, value=value)])
        number = self._begin("Setting ...")

        def done(answer: Any) -> None:
            result = answer.results[0]
            text = "Plans wait for Execute." if waiting else "Plans are executed at once."
            self._view.show_result(text if result.successful else f"Not set: {result.reason}.")
            self.look()

        self._call(number, self._writer, request, done)

    def look(self) -> None:
        """Look whether plans wait, and whether who is to answer is still there."""
        awaited = self._awaited
        if awaited is not None and not awaited.service_is_ready():
            self._awaited = None
            self._number += 1
            self._view.show_result(f"No answer: {self._name(awaited)} is gone.", failed=True)
        if self._reader.service_is_ready():
            future = self._reader.call_async(GetParameters.Request(names=[_AUTOMATIC]))
            future.add_done_callback(
                lambda done: self._view.show_waiting(not _is_automatic(done.result()))
            )

    def _request(self, q: Array) -> PlanJoint.Request:
        return PlanJoint.Request(goal=joint_state(self._names, q))

    def _begin(self, text: str) -> int:
        self._number += 1
        self._view.show_result(text)
        return self._number

    def _call(self, number: int, client: Client, request: Any, take: Callable[[Any], None]) -> None:
        """Call a service, and take its answer unless another request has come meanwhile."""
        if not client.service_is_ready():
            self._view.show_result(f"Nobody serves {self._name(client)}.", failed=True)
            return
        self._awaited = client

        def answered(future: Any) -> None:
            if number < self._stopped_from:
                # What was planned before the stop must not begin after it.
                if client is self._planner:
                    self._stop()
                return
            if number == self._number:
                self._awaited = None
                take(future.result())

        client.call_async(request).add_done_callback(answered)

    def _name(self, client: Client) -> str:
        return f"'{self._node.resolve_service_name(client.srv_name)}'"

    def _said_no(self, what: str, answer: Any) -> bool:
        if answer.error_code:
            why = f"{answer.error_msg} ({name_of(answer.error_code)})"
            self._view.show_result(f"{what}: {why}", failed=True)
        return bool(answer.error_code)


def _is_automatic(answer: Any) -> bool:
    return bool(answer is not None and answer.values and answer.values[0].bool_value)
