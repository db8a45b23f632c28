"""Plans go to the controller, in order, none lost."""

from itertools import pairwise

import numpy as np
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.msg import ErrorCode
from robomech_ros.nodes.common.parameters import table_rows
from robomech_ros.nodes.trajectory_publisher.settings import PublisherSettings

MOVE = np.array([0.05, -0.05, 0.05, 0.0, 0.05, -0.05])
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
DONE = (ErrorCode.NONE, "")


def idle(status):
    return status.message == "idle"


def planner(graph):
    topic = "trajectory_planner/planned_trajectory"
    return graph.client.create_publisher(JointTrajectory, topic, LATCHED)


@pytest.mark.parametrize("transport", ["topic", "action"])
def test_a_plan_is_executed(suite, transport):
    arm = suite(transport=transport)
    arm.plan(0.0, MOVE)
    arm.until_at(arm.home + MOVE)
    assert arm.value("arrived", idle) == "1"


def test_in_a_namespace(suite):
    arm = suite(namespace="left")
    arm.plan(0.0, MOVE)
    arm.until_at(arm.home + MOVE)
    answer = arm.execute(arm.trajectory(MOVE, 0.0))
    assert (answer.error_code, answer.error_msg) == DONE


@pytest.mark.slow
@pytest.mark.parametrize("transport", ["topic", "action"])
def test_ten_plans_at_once_none_lost(suite, transport):
    arm = suite(transport=transport)
    changes = [k * MOVE for k in range(11)]
    for start, goal in pairwise(changes):
        arm.plan(start, goal)
    arm.until_at(arm.home + changes[-1])
    # In order, and each of them to its end.
    seen = np.array([state.position for state in arm.states]) - arm.home
    arrivals = [int(np.argmax(np.abs(seen - goal).max(axis=1) < 1e-6)) for goal in changes]
    assert arrivals == sorted(arrivals)
    assert len(set(arrivals)) == len(changes)
    assert arm.value("arrived", idle) == "10"


@pytest.mark.slow
def test_ten_rounds_of_plan_and_execute(suite):
    arm = suite()
    changes = [(k % 2) * MOVE for k in range(11)]
    for start, goal in pairwise(changes):
        answer = arm.execute(arm.trajectory(start, goal))
        assert (answer.error_code, answer.error_msg) == DONE
        assert answer.duration.nanosec > 0
    arm.until_at(arm.home + changes[-1])


def test_a_plan_from_before_the_controller_waits_for_it(suite):
    arm = suite(with_controller=False, controller_timeout=0.2)
    arm.plan(0.0, MOVE)
    status = arm.condition(lambda status: "not there" in status.message)
    assert "subscriber of '/joint_trajectory_controller/joint_trajectory'" in status.message
    arm.start_controller()
    arm.until_at(arm.home + MOVE)
    arm.condition(idle)


def test_the_latched_topic_of_the_planner(graph, suite):
    plans = planner(graph)
    arm = suite()
    arm.until(plans.get_subscription_count)
    plans.publish(arm.trajectory(0.0, MOVE))
    arm.until_at(arm.home + MOVE)


def test_a_plan_from_before_this_node_is_ignored(graph, suite):
    plans = planner(graph)
    old = suite(auto_execute=False).trajectory(0.0, -MOVE)
    plans.publish(old)
    arm = suite(namespace="right", planner_topic="/trajectory_planner/planned_trajectory")
    arm.until(lambda: plans.get_subscription_count() == 2)
    # So long after its start the publisher has had time to do something about it.
    arm.until(lambda: len(arm.states) > 50)
    assert arm.value("sent") == "0"
    answer = arm.execute()
    assert answer.error_code == ErrorCode.NO_STATE
    assert "nothing came on '/right/planned_trajectory' or '/traj" in answer.error_msg


@pytest.mark.slow
def test_execute_joins_the_plan_that_is_being_executed(suite):
    arm = suite()
    arm.plan(0.0, MOVE, duration=2.0)
    arm.until_moving()
    answer = arm.execute()
    assert (answer.error_code, answer.error_msg) == DONE
    arm.until_at(arm.home + MOVE)
    again = arm.execute()
    assert again.error_code == ErrorCode.NONE
    assert "executed before this request" in again.error_msg
    assert arm.value("sent") == "1"


@pytest.mark.slow
def test_who_gives_the_plan_that_is_executed_anyway_joins_it(suite):
    arm = suite()
    there, back = (arm.trajectory(*ends, duration=0.5) for ends in ((0.0, MOVE), (MOVE, 0.0)))
    arm.send(there)
    arm.until_moving()
    answer = arm.execute(there)
    assert (answer.error_code, answer.error_msg) == DONE
    arm.until_at(arm.home + MOVE)
    assert "executed before this request" in arm.execute(there).error_msg
    # The request is the faster one.
    waiting = arm.start_execute(back)
    arm.until_moving()
    arm.send(back)
    arm.until(waiting.done)
    assert (waiting.result().error_code, waiting.result().error_msg) == DONE
    arm.until_at(arm.home)
    assert arm.value("sent", idle) == "2"
    # Another trajectory is another motion, wherever the robot is.
    assert arm.execute(there).error_code == ErrorCode.NONE
    assert arm.execute(back).error_code == ErrorCode.NONE
    assert arm.value("sent", idle) == "4"


def test_a_plan_moves_nothing_until_it_is_to_be_executed(suite):
    default = table_rows(PublisherSettings)
    arm = suite(auto_execute={row.name: row.default for row in default}["auto_execute"])
    arm.plan(0.0, MOVE)
    arm.until(lambda: len(arm.states) > 30)
    assert arm.value("sent") == "0" and not arm.velocity.any()
    assert arm.execute().error_code == ErrorCode.NONE
    assert arm.execute(arm.trajectory(MOVE, 0.0)).error_code == ErrorCode.NONE
    # The robot is at its start again: so it can be executed again.
    answer = arm.execute()
    assert (answer.error_code, answer.error_msg) == DONE
    arm.until_at(arm.home + MOVE)


def test_a_request_may_overtake_the_plan(suite):
    arm = suite()
    arm.plan(0.0, MOVE)
    assert arm.execute().error_code == ErrorCode.NONE
    places = [MOVE, 0.0]
    for _ in range(20):
        waiting = arm.start_execute()
        arm.plan(*places)
        arm.until(waiting.done)
        arm.until_at(arm.home + places[1])
        places.reverse()
        answer = waiting.result()
        if (answer.error_code, answer.error_msg) == DONE:
            return
        # On a busy machine the plan may have come too late to be meant.
        assert "executed before this request" in answer.error_msg
    pytest.fail("the plan is never waited for")
