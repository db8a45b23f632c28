"""The attack of `make fuzz` notices every answer that does not come."""

import sys
import time
from pathlib import Path

import numpy as np
import pytest
from rclpy.action import ActionServer
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Trigger
from waiting import until

from robomech_interfaces.action import ExecuteTrajectory
from robomech_interfaces.srv import SolveFK

sys.path.insert(0, str(Path(__file__).parents[2] / "fuzz"))

import attack
import probes
from known_robot import known_robot
from messages import MessageMaker

COUNT, TIMEOUT = 10, 60.0
ACTION, SERVICE, RESET = "/server/execute", "/server/solve_fk", "/server/reset"


def ends_at_once(handle):
    """End a goal."""
    handle.succeed()
    return ExecuteTrajectory.Result()


async def never_ends(handle):
    """Execute a goal without end."""
    await Future()


@pytest.fixture
def attack_on(graph):
    """Make an attack by things of one kind on a server that spins or rests."""
    attacker, resting = [Node(name, context=graph.context) for name in ("attacker", "resting")]
    servers = []

    def make(kind, execute, *, spins, answer=lambda request, response: response, reset=False):
        server = graph.client if spins else resting
        servers.append(ActionServer(server, ExecuteTrajectory, ACTION, execute))
        server.create_service(*((Trigger, RESET) if reset else (SolveFK, SERVICE)), answer)
        wait_for_viewer(attacker, RESET if reset else SERVICE)
        rng = np.random.default_rng(0)
        maker = MessageMaker(rng, known_robot("puma560"), (0.0,))
        return attack.Attack(attacker, [server.get_name()], maker, rng, lambda: True, {kind: 1.0})

    yield make
    for waitable in (*servers, *attacker.waitables):
        waitable.destroy()
    attacker.destroy_node()
    resting.destroy_node()


@pytest.fixture
def impatient(monkeypatch):
    """Make attacks wait for a short time, in which they probe all nodes again and again."""

    def shorten():
        monkeypatch.setattr(attack, "PATIENCE", 0.3)
        monkeypatch.setattr(probes, "_BETWEEN", 0.05)

    return shorten


def wait_for_viewer(node, service):
    """Wait until a node knows the services of the server."""
    names = {service, f"{ACTION}/_action/send_goal"}
    until(lambda: names <= dict(node.get_service_names_and_types()).keys())


@pytest.mark.parametrize(("kind", "missing"), [("request", SERVICE), ("goal", f"{ACTION}: goal")])
def test_a_server_that_says_nothing_is_noticed(attack_on, impatient, kind, missing):
    """Goals that were neither accepted nor refused did not count."""
    attacking = attack_on(kind, ends_at_once, spins=False)
    impatient()
    attacking.run(COUNT)
    assert attacking.outcome.unanswered == {missing: COUNT}
    assert attacking.outcome.answered == 0
    assert attacking.outcome.faults == ["answers are missing; resting ignored a probe, too"]


def test_goals_that_never_end_are_noticed(attack_on, impatient):
    attacking = attack_on("goal", never_ends, spins=True)
    deadline = time.monotonic() + TIMEOUT
    for _ in range(COUNT):
        attacking._goal()
    while {name for name, _ in attacking._waiting.values()} != {f"{ACTION}: result"}:
        assert time.monotonic() < deadline, attacking._waiting
        attacking.spin_once(0.1)
    impatient()
    attacking.settle()
    assert attacking.outcome.unanswered == {f"{ACTION}: result": COUNT}
    assert attacking.outcome.faults == ["answers are missing; no node ignored a probe, too"]


@pytest.mark.parametrize("kind", ["request", "goal"])
def test_nothing_is_missing_of_a_server_that_answers(attack_on, kind):
    attacking = attack_on(kind, ends_at_once, spins=True)
    attacking.run(COUNT)
    assert not attacking.outcome.unanswered
    assert attacking.outcome.answered == COUNT
    assert not attacking.outcome.faults


def test_an_attacker_that_starves_waits_for_the_answers(attack_on, impatient):
    """A minute without an answer was too long, even where the attacker got to none."""

    def answer_late(request, response):
        time.sleep(0.9)
        return response

    attacking = attack_on("request", ends_at_once, spins=True, answer=answer_late)
    impatient()
    # It gets to its answers once in 50 ms, of which 10 ms count.
    attacking._node.create_timer(0.001, lambda: time.sleep(0.05))
    attacking.run(2)
    assert attacking.outcome.answered == 2
    assert not attacking.outcome.unanswered and not attacking.outcome.faults


@pytest.mark.parametrize("kind", ["request", "bytes"])
def test_resets_are_noted_from_request_to_answer(attack_on, kind):
    times = []

    def note(request, response):
        times.append(time.time())
        return response

    attacking = attack_on(kind, ends_at_once, spins=True, answer=note, reset=True)
    before = time.time()
    attacking.run(COUNT)
    after = time.time()
    assert times and attacking.outcome.answered
    assert all(attacking.resets.earliest(now, now) == now for now in times)
    assert attacking.resets.earliest(after + 0.1, after + 0.2) == np.inf
    assert attacking.resets.earliest(0.0, before - 0.1) == np.inf
