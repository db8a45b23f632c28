"""Execution by move_group: the simulated robot goes where it is told, and stops when it is told."""

import threading
import time

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from move_group_client import HERE, THERE, UR5E, Client, box, joint_goal, request
from moveit_msgs.action import ExecuteTrajectory, MoveGroup
from moveit_msgs.msg import MoveItErrorCodes as Codes, RobotState
from moveit_msgs.srv import GetMotionPlan, GetStateValidity
from shaped_arm import shaped_ur5e
from std_msgs.msg import String

from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.move_group.node import MoveGroupNode

HALF = {"max_velocity_scaling_factor": 0.3, "start_state": RobotState(is_diff=True)}


class Robot(Client):
    """A simulated UR5e and its move_group."""

    def __init__(self, graph):
        super().__init__(graph)
        robot = {"robot_description": shaped_ur5e()}
        start = {"initial_positions": HERE.tolist()}
        self.controller = graph.start(JointTrajectoryControllerNode, **robot, **start)
        graph.start(MoveGroupNode, assume_limits=True, state_timeout=20.0, **robot)

    @property
    def position(self):
        found = self.scene().robot_state.joint_state
        at = dict(zip(found.name, found.position, strict=True))
        return np.array([at[name] for name in UR5E.joint_names])

    def wait_until_it_moves(self):
        while np.abs(self.position - HERE).max() < 0.05:
            time.sleep(0.01)


@pytest.fixture
def robot(graph):
    return Robot(graph)


def test_a_goal_is_planned_and_reached(robot):
    goal = MoveGroup.Goal(request=request(joint_goal(THERE), **HALF))
    _, result = robot.send(MoveGroup, "move_action", goal)
    ended = robot.graph.wait_for(result)
    assert ended.result.error_code.val == Codes.SUCCESS, ended.result.error_code
    assert ended.status == GoalStatus.STATUS_SUCCEEDED
    assert ended.result.executed_trajectory == ended.result.planned_trajectory
    np.testing.assert_allclose(robot.position, THERE, atol=1e-4)


def test_a_plan_is_executed_and_an_old_one_is_not(robot):
    asked = {"motion_plan_request": request(joint_goal(THERE), **HALF)}
    answer = robot.graph.ask(GetMotionPlan, "plan_kinematic_path", **asked).motion_plan_response
    assert answer.error_code.val == Codes.SUCCESS, answer.error_code
    goal = ExecuteTrajectory.Goal(trajectory=answer.trajectory)
    _, result = robot.send(ExecuteTrajectory, "execute_trajectory", goal)
    assert robot.graph.wait_for(result).result.error_code.val == Codes.SUCCESS
    np.testing.assert_allclose(robot.position, THERE, atol=1e-4)
    _, result = robot.send(ExecuteTrajectory, "execute_trajectory", goal)
    outcome = robot.graph.wait_for(result).result.error_code
    assert outcome.val == Codes.INVALID_MOTION_PLAN
    assert "shoulder_pan_joint" in outcome.message and "start_tolerance" in outcome.message


@pytest.mark.parametrize("how", ["cancel", "event"])
def test_a_motion_is_stopped(robot, how):
    slow = {**HALF, "max_velocity_scaling_factor": 0.05}
    goal = MoveGroup.Goal(request=request(joint_goal(THERE), **slow))
    handle, result = robot.send(MoveGroup, "move_action", goal)
    robot.wait_until_it_moves()
    if how == "cancel":
        robot.graph.wait_for(handle.cancel_goal_async())
    else:
        publisher = robot.graph.client.create_publisher(String, "trajectory_execution_event", 10)
        ended = threading.Event()
        result.add_done_callback(lambda _: ended.set())
        while not ended.wait(0.1):
            publisher.publish(String(data="stop"))
    ended = robot.graph.wait_for(result)
    assert ended.result.error_code.val == Codes.PREEMPTED, ended.result.error_code
    expected = GoalStatus.STATUS_CANCELED if how == "cancel" else GoalStatus.STATUS_ABORTED
    assert ended.status == expected
    assert np.abs(robot.position - THERE).max() > 0.05


def test_the_robot_stops_before_what_comes_into_its_way(robot):
    slow = {**HALF, "max_velocity_scaling_factor": 0.05}
    goal = MoveGroup.Goal(request=request(joint_goal(THERE), **slow))
    _, result = robot.send(MoveGroup, "move_action", goal)
    robot.wait_until_it_moves()
    assert robot.apply(box("wall", (0.6, 0.02, 0.8), (0.55, 0.0, 0.4)))
    outcome = robot.graph.wait_for(result).result.error_code
    assert outcome.val == Codes.MOTION_PLAN_INVALIDATED_BY_ENVIRONMENT_CHANGE, outcome
    assert "'wall'" in outcome.message and "stopped on its path" in outcome.message
    answer = robot.graph.ask(GetStateValidity, "check_state_validity")
    assert answer.valid
    # A plan of before is not executed any more either.
    assert robot.apply(box("wall", (0.6, 0.02, 0.8), (5.0, 0.0, 0.4)))
    start = {**HALF, "start_state": RobotState(is_diff=True)}
    asked = {"motion_plan_request": request(joint_goal(THERE), **start)}
    planned = robot.graph.ask(GetMotionPlan, "plan_kinematic_path", **asked).motion_plan_response
    assert planned.error_code.val == Codes.SUCCESS, planned.error_code
    assert robot.apply(box("wall", (0.6, 0.02, 0.8), (0.55, 0.0, 0.4)))
    goal = ExecuteTrajectory.Goal(trajectory=planned.trajectory)
    _, result = robot.send(ExecuteTrajectory, "execute_trajectory", goal)
    outcome = robot.graph.wait_for(result).result.error_code
    assert outcome.val == Codes.MOTION_PLAN_INVALIDATED_BY_ENVIRONMENT_CHANGE, outcome
