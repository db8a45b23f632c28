"""Servers whose answers are larger than can be read; and a goal leaves nothing at its client."""

import pytest
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped
from rclpy.action import ActionServer

from robomech_interfaces.action import ExecuteTrajectory
from robomech_interfaces.srv import SolveFK
from robomech_ros.errors import WrongSizeError
from robomech_ros.nodes.middleware import bounded_requests
from robomech_ros.nodes.middleware.deep_queues import ask, ask_action

PATIENCE = 30.0
ALLOWED, SENT = 1000, 2000


@pytest.fixture
def few(monkeypatch):
    """So few entries are too many that a test sends them in a moment."""
    monkeypatch.setattr(bounded_requests, "MOST_OBJECTS", ALLOWED)


def test_an_answer_that_is_too_large_is_refused(graph, few):
    sizes = [SENT, 1]

    def answer(request, response):
        response.poses = [PoseStamped()] * sizes.pop(0)
        return response

    graph.client.create_service(SolveFK, "server/solve_fk", answer)
    client = ask(graph.client, SolveFK, "server/solve_fk")
    assert client.wait_for_service(PATIENCE)
    got = graph.wait_for(client.call_async(SolveFK.Request()))
    with pytest.raises(WrongSizeError, match="the answer"):
        print(got.error_code)
    assert len(graph.wait_for(client.call_async(SolveFK.Request())).poses) == 1


@pytest.fixture
def server(graph):
    """An action server whose results have as many names as the goal's trajectory has tolerances."""

    def execute(handle):
        handle.succeed()
        count = int(handle.request.goal_position_tolerance[0])
        return ExecuteTrajectory.Result(joint_names=["joint"] * count)

    server = ActionServer(graph.client, ExecuteTrajectory, "server/execute", execute)
    yield server
    server.destroy()


def test_a_result_that_is_too_large_is_that_of_an_unknown_goal(graph, server, few):
    client = ask_action(graph.client, ExecuteTrajectory, "server/execute")
    assert client.wait_for_server(PATIENCE)
    for count, status in ((SENT, GoalStatus.STATUS_UNKNOWN), (3, GoalStatus.STATUS_SUCCEEDED)):
        goal = ExecuteTrajectory.Goal(goal_position_tolerance=[float(count)])
        handle = graph.wait_for(client.send_goal_async(goal))
        got = graph.wait_for(handle.get_result_async())
        assert got.status == status
        assert len(got.result.joint_names) == (0 if count > ALLOWED else count)


def test_a_goal_leaves_nothing_at_its_client(graph, server):
    """rclpy 9.1 kept a future for each goal that was ever sent."""
    client = ask_action(graph.client, ExecuteTrajectory, "server/execute")
    assert client.wait_for_server(PATIENCE)
    goal = ExecuteTrajectory.Goal(goal_position_tolerance=[1.0])
    for _ in range(5):
        handle = graph.wait_for(client.send_goal_async(goal))
        assert graph.wait_for(handle.get_result_async()).status == GoalStatus.STATUS_SUCCEEDED
    assert not any(not future.done() for future in client._futures)
