"""Controllers that are killed, restarted and stopped, as those see it who send to them."""

import signal
import time

import pytest
from drivers import ROBOT, TIMEOUT

from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.middleware.liveliness import LivelinessMonitor
from robomech_ros.nodes.trajectory_publisher.action_transport import request_topic

CONTROLLER = "/joint_trajectory_controller"
ACTION = f"{CONTROLLER}/execute_trajectory"
TOPIC = f"{CONTROLLER}/joint_trajectory"


def until(condition):
    end = time.monotonic() + TIMEOUT
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.fixture
def life(graph):
    """Return the liveliness of the controller as its action client sees it."""
    return LivelinessMonitor(graph.client, ACTION, 0.5)


@pytest.fixture
def start(graph, process, life):
    """Start a controller and wait until its signs of life are seen."""

    def start():
        count = len(life._lives)
        child = process(JointTrajectoryControllerNode, robot_description=ROBOT)
        until(lambda: len(life._lives) > count)
        return child

    return start


def reads(life):
    return life.reads(TOPIC), life.reads(request_topic(ACTION), no_mangle=True)


@pytest.mark.slow
def test_what_is_sent_to_a_killed_controller_is_not_sent_to_its_successor(graph, life, start):
    """Its subscriptions stay in the graph for 20 s: they are not those of the one that lives."""
    assert not life.ended
    first = start()
    until(lambda: reads(life) == (True, True))
    first.kill()
    until(lambda: life.ended)
    assert graph.client.get_subscriptions_info_by_topic(TOPIC)
    assert reads(life) == (False, False)
    start()
    until(lambda: reads(life) == (True, True))
    assert not life.ended


@pytest.mark.slow
def test_a_successor_that_comes_before_the_death_is_noticed_lives(life, start):
    assert life.server is None
    first = start()
    until(lambda: life.server)
    server = life.server
    assert not life.has_successor(server)
    second = start()
    first.kill()
    until(lambda: life.has_successor(server))
    assert not life.has_successor(life.server)
    assert not life.ended
    until(lambda: reads(life) == (True, True))
    second.send_signal(signal.SIGSTOP)
    until(lambda: life.ended)
    second.send_signal(signal.SIGCONT)
    until(lambda: not life.ended)
    second.terminate()
    until(lambda: life.ended)


@pytest.mark.slow
def test_one_that_stood_still_comes_back_and_not_one_that_was_killed(life, start):
    """Both are in the graph, and the killed one for 20 s only."""
    first = start()
    first.kill()
    until(lambda: life.ended)
    second = start()
    second.send_signal(signal.SIGSTOP)
    until(lambda: life.ended)
    second.send_signal(signal.SIGCONT)
    until(lambda: list(life._lives.values()) == [False, True])
    until(lambda: reads(life) == (True, True))
    assert not life.ended
