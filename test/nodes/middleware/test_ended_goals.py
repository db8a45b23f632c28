"""A goal that is over leaves nothing at its client."""

import pytest
from action_msgs.msg import GoalStatus
from rclpy.action import ActionServer

from robomech_interfaces.action import ExecuteTrajectory
from robomech_ros.nodes.middleware.queue_depth import ask_action

PATIENCE = 30.0


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


def test_a_goal_leaves_nothing_at_its_client(graph, server):
    """rclpy 9.1 kept a future for each goal that was ever sent."""
    client = ask_action(graph.client, ExecuteTrajectory, "server/execute")
    assert client.wait_for_server(PATIENCE)
    goal = ExecuteTrajectory.Goal(goal_position_tolerance=[1.0])
    for _ in range(5):
        handle = graph.wait_for(client.send_goal_async(goal))
        assert graph.wait_for(handle.get_result_async()).status == GoalStatus.STATUS_SUCCEEDED
    assert not any(not future.done() for future in client._futures)
