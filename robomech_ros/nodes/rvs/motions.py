"""Has motions planned, executed and stopped, as any client would."""

import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.client import Client
from rclpy.node import Node
from std_srvs.srv import Trigger

from robomech_interfaces.srv import Execute, PlanJoint
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.joint_messages import joint_state
from robomech_ros.nodes.common.message_fields import seconds_from_duration
from robomech_ros.nodes.middleware.deep_queues import ask
from robomech_ros.nodes.rvs.requests import Requests
from robomech_ros.nodes.rvs.settings import RvsSettings
from robomech_ros.nodes.rvs.stopping import Stopping
from robomech_ros.outcomes import name_of
from robomech_ros.rvs.model.live_robot import LiveView

__all__ = ["Motions"]

Array = NDArray[np.float64]

_AUTOMATIC = "auto_execute"
_WOULD_MOVE = (
    "Not planned: '{publisher}' executes every plan at once (its parameter auto_execute), so a "
    "plan would move the robot. Execute does both; with 'plans wait', under ROS, plans are "
    "only shown."
)
_UNKNOWN = (
    "Not planned: '{publisher}' does not say whether it executes every plan at once (its parameter "
    "auto_execute), and plans are read by {readers}, so a plan might move the robot."
)
# How long answers may take (s): about parameters, of the planner, and of who executes a motion.
_BRIEFLY, _PLANNING, _MOVING = 5.0, 120.0, float("inf")


class Motions:
    """Calls the services of planner, publisher and controller; answers go to the view.

    Parameters
    ----------
    node : Node
        Owner of the clients.
    names : sequence of str
        The joints that move.
    settings : RvsSettings
        Whom to call.
    view : LiveView
    """

    def __init__(
        self, node: Node, names: Sequence[str], settings: RvsSettings, view: LiveView
    ) -> None:
        self._node, self._view, self._publisher = node, view, settings.publisher
        self._plans = f"{settings.planner}/planned_trajectory"
        self._names = tuple(names)
        planner, publisher, controller = settings.planner, settings.publisher, settings.controller
        self._planner = ask(node, PlanJoint, f"{planner}/plan_joint")
        self._executor = ask(node, Execute, f"{publisher}/execute")
        cancel = ask(node, Trigger, f"{publisher}/cancel")
        hold = ask(node, Trigger, f"{controller}/hold")
        self._reader = ask(node, GetParameters, f"{publisher}/get_parameters")
        self._writer = ask(node, SetParameters, f"{publisher}/set_parameters")
        self._requests = Requests(node)
        self._stopping = Stopping(self._requests, cancel, hold, view)
        # Held while something is decided and sent, so that nothing is sent after a stop.
        self._lock = threading.RLock()
        # Which request is the latest, which was the latest to stop; whether a look is under way.
        self._number, self._stopped_from, self._looking = 0, 0, False

    def plan(self, q: Array) -> None:
        """Plan from where the robot is to a posture (n,) (rad or m), unless that would move it."""
        with self._lock:
            number = self._begin("Planning ...")

            def planned(answer: Any) -> None:
                if self._said_no("No plan", answer):
                    return
                seconds = seconds_from_duration(answer.duration, "duration")
                self._view.show_result(f"Planned: the motion takes {seconds:.2f} s.")

            def allowed(automatic: bool) -> None:
                if automatic:
                    text = _WOULD_MOVE.format(publisher=self._publisher)
                    self._view.show_result(text, failed=True)
                    return
                self._call(number, self._planner, self._request(q), planned, _PLANNING)

            self._ask_whether_automatic(number, allowed)

    def execute(self, q: Array) -> None:
        """Plan such a motion, and execute it."""
        with self._lock:
            number = self._begin("Planning ...")

            def planned(answer: Any, automatic: bool) -> None:
                if self._said_no("Not executed, no plan", answer):
                    return
                seconds = seconds_from_duration(answer.duration, "duration")
                self._view.show_result(f"Executing a motion of {seconds:.2f} s ...")
                # Without a trajectory it is the latest plan, which may be under way already.
                asked = Execute.Request()
                if not automatic:
                    asked.trajectory = answer.trajectory
                self._call(number, self._executor, asked, executed, _MOVING)

            def executed(answer: Any) -> None:
                if self._said_no("The motion ended early", answer):
                    return
                seconds = seconds_from_duration(answer.duration, "duration")
                self._view.show_result(f"Executed: the robot arrived after {seconds:.2f} s.")

            def allowed(automatic: bool) -> None:
                request = self._request(q)
                self._call(
                    number, self._planner, request, lambda plan: planned(plan, automatic), _PLANNING
                )

            self._ask_whether_automatic(number, allowed)

    def stop(self) -> None:
        """Stop whatever moves the robot."""
        with self._lock:
            self._number += 1
            self._stopped_from = self._number
            self._stopping.stop()

    def let_plans_wait(self, waiting: bool) -> None:
        """Have plans executed on request only, or each as it is made."""
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
            self._call(self._begin("Setting ..."), self._writer, request, done, _BRIEFLY)

    def look(self) -> None:
        """Look whether plans wait, and whether who is to answer is still there."""
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
        self._requests.send(self._reader, request, take, give_up, _BRIEFLY)

    def _ask_whether_automatic(self, number: int, go_on: Callable[[bool], None]) -> None:
        """Go on with whether each plan is executed; refuse where nobody tells and one may be."""

        def decide(automatic: bool | None) -> None:
            readers = self._readers_of_plans() if automatic is None else []
            if readers:
                text = _UNKNOWN.format(publisher=self._publisher, readers=" and ".join(readers))
                self._view.show_result(text, failed=True)
                return
            go_on(bool(automatic))

        def silent(_: str) -> None:
            if number == self._number:
                decide(None)

        if not self._reader.service_is_ready():
            decide(None)
            return
        request = GetParameters.Request(names=[_AUTOMATIC])
        self._call(
            number,
            self._reader,
            request,
            lambda answer: decide(_automatic(answer)),
            _BRIEFLY,
            silent,
        )

    def _readers_of_plans(self) -> list[str]:
        """Name the other nodes that read what the planner plans, quoted."""
        own = (self._node.get_namespace(), self._node.get_name())
        topic = self._node.resolve_topic_name(self._plans)
        readers = {
            (one.node_namespace, one.node_name)
            for one in self._node.get_subscriptions_info_by_topic(topic)
        }
        return sorted(f"'{space.rstrip('/')}/{name}'" for space, name in readers - {own})

    def _request(self, q: Array) -> PlanJoint.Request:
        return PlanJoint.Request(goal=joint_state(self._names, q))

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
        silent: Callable[[str], None] | None = None,
    ) -> None:
        """Call a service, and take its answer unless another request has come meanwhile."""
        name = self._requests.name(client)
        if not client.service_is_ready():
            self._view.show_result(f"Nobody serves {name}.", failed=True)
            return

        def answered(answer: Any) -> None:
            with self._lock:
                if number < self._stopped_from:
                    # What was planned before the stop must not begin after it.
                    if client is self._planner:
                        self._stopping.stop()
                elif number == self._number:
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

        def ended(why: str) -> None:
            with self._lock:
                (silent or give_up)(why)

        self._requests.send(client, request, answered, ended, patience)

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
