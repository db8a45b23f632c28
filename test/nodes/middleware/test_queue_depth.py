"""A burst of calls is answered to the last one."""

from collections import Counter

import pytest
from action_msgs.srv import CancelGoal
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import JointState
from std_srvs.srv import Empty, Trigger

from robomech_interfaces.action import ExecuteTrajectory
from robomech_interfaces.srv import AnalyzeSingularity, QueryWorkspace, SolveFK, SolveIK
from robomech_ros.nodes.common.services import serve
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.middleware.queue_depth import ask, ask_action

CLIENTS, CALLS = 4, 250


# How many calls at once.  For the first request the last two find what takes seconds, once for all
# who wait; and the distance from the boundary of the workspace takes 50 ms a pose.
CALLED = {
    "solve_ik": (1000, SolveIK, {}),
    "solve_fk": (1000, SolveFK, {}),
    "analyze_singularity": (1000, AnalyzeSingularity, {"state": JointState(position=[0.1] * 6)}),
    "query_workspace": (100, QueryWorkspace, {"poses": [PoseStamped()]}),
}


@pytest.mark.parametrize("name", CALLED)
def test_calls_at_once_are_all_answered(graph, name):
    graph.start(KinematicsNode, robot_description="puma560")
    count, kind, fields = CALLED[name]
    clients = [ask(graph.client, kind, f"kinematics/{name}") for _ in range(CLIENTS)]
    assert all(client.wait_for_service(30.0) for client in clients)
    request = kind.Request(**fields)
    futures = [clients[k % CLIENTS].call_async(request) for k in range(count)]
    codes = Counter(graph.wait_for(future).error_code for future in futures)
    assert codes.total() == count
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


@pytest.mark.parametrize("waits", [False, True])
def test_a_request_whose_callback_fails_is_answered_with_a_reason(graph, waits):
    def fail(request, response):
        raise ValueError("no such thing")

    async def fail_later(request, response):
        fail(request, response)

    for kind, name in ((Trigger, "trigger"), (Empty, "empty")):
        serve(graph.client, kind, name, fail_later if waits else fail)
    answer = graph.ask(Trigger, "trigger")
    assert not answer.success
    assert answer.message == "internal error, please report it: ValueError: no such thing"
    assert graph.ask(Empty, "empty") == Empty.Response()
