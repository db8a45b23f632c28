"""A burst of calls is answered to the last one."""

from collections import Counter

import pytest
from action_msgs.srv import CancelGoal

from robomech_interfaces.action import ExecuteTrajectory
from robomech_interfaces.srv import SolveFK, SolveIK
from robomech_ros.nodes.common.deep_queues import ask, ask_action
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.kinematics.node import KinematicsNode

CLIENTS, CALLS = 4, 250


@pytest.mark.parametrize("kind", [SolveIK, SolveFK])
def test_a_thousand_calls_at_once_are_all_answered(graph, kind):
    graph.start(KinematicsNode, robot_description="puma560")
    name = {SolveIK: "solve_ik", SolveFK: "solve_fk"}[kind]
    clients = [ask(graph.client, kind, f"kinematics/{name}") for _ in range(CLIENTS)]
    assert all(client.wait_for_service(30.0) for client in clients)
    futures = [client.call_async(kind.Request()) for _ in range(CALLS) for client in clients]
    codes = Counter(graph.wait_for(future).error_code for future in futures)
    assert codes.total() == CLIENTS * CALLS
    assert len(codes) == 1


def test_a_thousand_goals_and_cancellations_at_once_are_all_answered(graph):
    graph.start(JointTrajectoryControllerNode, robot_description="puma560")
    name = "joint_trajectory_controller/execute_trajectory"
    client = ask_action(graph.client, ExecuteTrajectory, name)
    cancel = ask(graph.client, CancelGoal, f"{name}/_action/cancel_goal")
    assert client.wait_for_server(30.0) and cancel.wait_for_service(30.0)
    goals = [client.send_goal_async(ExecuteTrajectory.Goal()) for _ in range(CALLS)]
    handles = [graph.wait_for(goal) for goal in goals]
    results = [handle.get_result_async() for handle in handles]
    cancellations = [cancel.call_async(CancelGoal.Request()) for _ in range(CLIENTS * CALLS)]
    assert all(graph.wait_for(result).result.error_code for result in results)
    assert all(graph.wait_for(answer) is not None for answer in cancellations)
