"""Requests whose first answer is lost: sent again where that does no harm, and only there."""

import time

import pytest
from control_msgs.srv import QueryTrajectoryState
from moveit_msgs.srv import GetPositionIK, ServoCommandType
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger

from robomech_interfaces import srv
from robomech_interfaces.srv import PlanJoint, SolveFK
from robomech_ros.nodes.commands.service_client import call_service
from robomech_ros.nodes.demonstration.client import DemoClient
from robomech_ros.nodes.middleware import retrying_client
from robomech_ros.nodes.middleware.queue_depth import ask
from robomech_ros.nodes.middleware.retrying_client import RetriedRequest, changes_nothing
from robomech_ros.robots import load_robot

PATIENCE = 30.0
SERVICES = (SolveFK, "forgetful/solve_fk"), (PlanJoint, "forgetful/plan_joint")
# Of ours, those that do not only answer: they publish, move, or keep something.
CHANGING = {
    "AddSamples",
    "Execute",
    "PlanCartesian",
    "PlanJoint",
    "RemoveSample",
    "SaveCalibration",
    "SetPayload",
    "SetSpeed",
    "SolveCalibration",
    "TakeSample",
}


class Forgetful(Node):
    """Never answers the first request to a service, as if the answer had been lost."""

    def __init__(self, **options):
        super().__init__("forgetful", **options)
        self.came = []
        for kind, name in ((SolveFK, "~/solve_fk"), (PlanJoint, "~/plan_joint")):
            self.create_service(kind, name, self._answer, callback_group=ReentrantCallbackGroup())

    async def _answer(self, request, response):
        self.came.append(type(request))
        if self.came.count(type(request)) == 1:
            await Future()
        response.error_msg = f"request {self.came.count(type(request))}"
        return response


class Alive:
    """A suite of which no node ends."""

    def check(self):
        """Find nothing."""


def test_every_service_of_ours_is_known_to_change_something_or_nothing():
    ours = {name: kind for name, kind in vars(srv).items() if hasattr(kind, "Request")}
    asking = {name for name, kind in ours.items() if changes_nothing(kind)}
    assert asking | CHANGING == set(ours)
    assert not asking & CHANGING


def test_services_of_others():
    for kind in (QueryTrajectoryState, GetParameters, GetPositionIK):
        assert changes_nothing(kind)
    for kind in (SetParameters, Trigger, ServoCommandType):
        assert not changes_nothing(kind)


@pytest.fixture
def soon(monkeypatch):
    """Have requests repeated soon."""
    monkeypatch.setattr(retrying_client, "_AGAIN", 0.05)


def test_call_asks_again_where_the_first_answer_is_lost(graph, soon):
    """It ended without an answer about once in six calls."""
    server = graph.start(Forgetful)
    answer = call_service("forgetful/solve_fk", "", {}, PATIENCE)
    assert answer.error_msg.startswith("request ")
    assert len(server.came) >= 2


def test_only_what_changes_nothing_is_repeated_and_late_answers_are_dropped(graph, soon):
    server = graph.start(Forgetful)
    clients = {kind: ask(graph.client, kind, name) for kind, name in SERVICES}
    assert all(client.wait_for_service(PATIENCE) for client in clients.values())
    harmless, changing = (
        RetriedRequest(clients[kind], kind, kind.Request()) for kind in (SolveFK, PlanJoint)
    )
    deadline = time.monotonic() + PATIENCE
    while not harmless.answered.done():
        assert time.monotonic() < deadline, "no answer"
        harmless.repeat_if_due()
        changing.repeat_if_due()
        time.sleep(0.01)
    assert harmless.answer().error_msg.startswith("request ")
    assert not clients[SolveFK]._pending_requests
    changing.give_up()
    assert not clients[PlanJoint]._pending_requests
    assert server.came.count(SolveFK.Request) >= 2
    assert server.came.count(PlanJoint.Request) <= 1


def test_the_demonstration_asks_again_by_the_same_rule(graph, soon):
    server = graph.start(Forgetful)
    chain = load_robot("puma560")
    client = DemoClient(Alive(), chain.joint_names, chain.units)
    try:
        client._rows.append((0.0, None, None))
        client.wait_until_up({"forgetful/solve_fk": SolveFK})
        assert client.ask("forgetful/solve_fk", SolveFK.Request()).error_msg.startswith("request ")
    finally:
        client.close()
    assert len(server.came) >= 2
