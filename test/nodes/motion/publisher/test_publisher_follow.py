"""The publisher drives a controller by control_msgs' action, as it would one of ros2_control."""

import sys

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from control_msgs.action import FollowJointTrajectory
from drivers import ROBOT, Suite, asked, ended
from rclpy.action import ActionClient, ActionServer, GoalResponse
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.msg import ErrorCode
from robomech_ros.errors import RobomechError
from robomech_ros.nodes.common.messages.execute_goals import AskedTolerances
from robomech_ros.nodes.common.messages.follow_goals import FollowGoals
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode

FOLLOW = "follow_joint_trajectory"
NAME = f"/joint_trajectory_controller/{FOLLOW}"
MOVE = np.array([0.15, -0.05, 0.1, 0.05, 0.1, -0.05])
CODES = FollowJointTrajectory.Result
SUCCEEDED, ABORTED, CANCELED = (
    GoalStatus.STATUS_SUCCEEDED,
    GoalStatus.STATUS_ABORTED,
    GoalStatus.STATUS_CANCELED,
)
# Status, code and text of the controller, whether the robot has moved; our code and text.
MEANINGS = [
    (SUCCEEDED, CODES.SUCCESSFUL, "Goal successfully reached!", True, 0, ""),
    (SUCCEEDED, CODES.SUCCESSFUL, "defaults hold", True, 0, "defaults hold"),
    (CANCELED, CODES.SUCCESSFUL, "", True, 222, "the goal was cancelled"),
    (ABORTED, CODES.INVALID_GOAL, "limit", False, 221, "INVALID_GOAL: limit"),
    (ABORTED, CODES.INVALID_GOAL, "preempted", True, 222, "INVALID_GOAL: preempted"),
    (ABORTED, CODES.SUCCESSFUL, "", True, 222, "SUCCESSFUL, without a reason"),
    (ABORTED, CODES.SUCCESSFUL, "", False, 221, "SUCCESSFUL, without a reason"),
    (ABORTED, CODES.INVALID_JOINTS, "thumb", False, 102, "INVALID_JOINTS: thumb"),
    (ABORTED, CODES.OLD_HEADER_TIMESTAMP, "old", False, 221, "OLD_HEADER_TIMESTAMP: old"),
    (ABORTED, CODES.PATH_TOLERANCE_VIOLATED, "a", True, 223, "PATH_TOLERANCE_VIOLATED: a"),
    (ABORTED, CODES.GOAL_TOLERANCE_VIOLATED, "b", True, 224, "GOAL_TOLERANCE_VIOLATED: b"),
    (ABORTED, -77, "odd", True, 221, "error code -77: odd"),
    (SUCCEEDED, CODES.INVALID_GOAL, "odd", False, 221, "INVALID_GOAL: odd"),
]


@pytest.mark.parametrize(("status", "given", "said", "began", "code", "text"), MEANINGS)
def test_what_results_mean(status, given, said, began, code, text):
    result = CODES(error_code=given, error_string=said)
    assert FollowGoals().verdict(status, result, began) == (code, text)


def test_goals_name_tolerances_where_they_are_asked_for():
    trajectory = JointTrajectory(joint_names=["a", "b"])
    goal = FollowGoals().goal(trajectory, AskedTolerances(0.1, -1.0, 2.5))
    assert [(t.name, t.position) for t in goal.path_tolerance] == [("a", 0.1), ("b", 0.1)]
    assert [(t.name, t.position) for t in goal.goal_tolerance] == [("a", -1.0), ("b", -1.0)]
    assert (goal.goal_time_tolerance.sec, goal.goal_time_tolerance.nanosec) == (2, 500_000_000)
    goal = FollowGoals().goal(trajectory, AskedTolerances())
    assert not goal.path_tolerance and not goal.goal_tolerance


@pytest.fixture
def following(graph):
    """Start a publisher that uses the action, and a controller with its own parameters."""

    def start(controller=None, **parameters):
        arm = Suite(graph, with_controller=False, transport=FOLLOW, **parameters)
        arm.start_controller(**(controller or {}))
        arm.until(lambda: arm.states)
        return arm

    return start


def test_plans_and_requests_go_by_the_action(following):
    arm = following()
    arm.plan(0.0, MOVE)
    arm.until_at(arm.home + MOVE)
    answer = arm.execute(arm.trajectory(MOVE, 0.0))
    assert (answer.error_code, answer.error_msg) == (ErrorCode.NONE, "")
    arm.until_at(arm.home)
    assert arm.value("arrived", lambda status: status.message == "idle") == "2"


def test_under_the_name_that_a_controller_has(graph):
    arm = Suite(graph, with_controller=False, transport=FOLLOW, controller="left/arm_controller")
    arguments = ["--ros-args", "-r", "__node:=arm_controller", "-r", "__ns:=/left"]
    graph.start(
        lambda **options: JointTrajectoryControllerNode(
            cli_args=[*arguments, "-r", "joint_states:=/joint_states"], **options
        ),
        robot_description=ROBOT,
    )
    answer = arm.execute(arm.trajectory(0.0, MOVE))
    assert (answer.error_code, answer.error_msg) == (ErrorCode.NONE, "")


def test_what_the_controller_refuses(following):
    arm = following()
    answer = arm.execute(arm.trajectory(0.0, MOVE, duration=0.01))
    assert answer.error_code == ErrorCode.REJECTED
    assert answer.error_msg.startswith("INVALID_GOAL: at t = ")
    assert "the velocity of joint '" in answer.error_msg
    five = arm.trajectory(0.0, MOVE)
    five.joint_names = five.joint_names[:5]
    for point in five.points:
        point.positions, point.velocities, point.accelerations = point.positions[:5], [], []
    answer = arm.execute(five)
    assert answer.error_code == ErrorCode.UNKNOWN_JOINT
    assert answer.error_msg.startswith("INVALID_JOINTS: joint_names has size 5")
    assert arm.execute(arm.trajectory(0.0, MOVE)).error_code == ErrorCode.NONE


@pytest.mark.parametrize("transport", [FOLLOW, "action"])
def test_the_tolerances_that_are_asked_for(graph, transport):
    arm = Suite(graph, with_controller=False, transport=transport, controller_path_tolerance=0.01)
    arm.start_controller(tracking_lag=0.3)
    answer = arm.execute(arm.trajectory(0.0, MOVE, duration=0.5))
    assert answer.error_code == ErrorCode.PATH_TOLERANCE
    assert "off its path, the tolerance is 0.01 rad" in answer.error_msg
    assert answer.error_msg.startswith("PATH") == (transport == FOLLOW)


@pytest.mark.parametrize("transport", [FOLLOW, "action"])
def test_the_goal_tolerance_and_time_that_are_asked_for(graph, transport):
    asked = {"controller_goal_tolerance": 0.001, "controller_goal_time": 0.2}
    arm = Suite(graph, with_controller=False, transport=transport, **asked)
    arm.start_controller(tracking_lag=0.3, goal_time=100.0)
    answer = arm.execute(arm.trajectory(0.0, MOVE, duration=0.5))
    assert answer.error_code == ErrorCode.GOAL_TOLERANCE
    assert "off its goal, the tolerance is 0.001 rad" in answer.error_msg


def test_another_client_takes_over(graph, following):
    arm = following()
    waiting = arm.start_execute(arm.trajectory(0.0, MOVE, duration=8.0))
    arm.until(lambda: np.abs(arm.position - arm.home).max() > 2e-3)
    client = ActionClient(graph.client, FollowJointTrajectory, NAME)
    assert client.wait_for_server(30.0)
    plan = arm.trajectory(0.0, 0.0, duration=0.5)
    del plan.points[0]
    goal = FollowJointTrajectory.Goal(trajectory=plan)
    handle = ended(asked(graph.client, lambda: client.send_goal_async(goal)))
    answer = ended(waiting)
    assert answer.error_code == ErrorCode.PREEMPTED
    assert answer.error_msg == "INVALID_GOAL: preempted by a newer goal of the action"
    assert ended(asked(graph.client, handle.get_result_async)).status == SUCCEEDED


def test_hold_and_cancel(graph, following):
    arm = following()
    waiting = arm.start_execute(arm.trajectory(0.0, MOVE, duration=8.0))
    arm.until(lambda: np.abs(arm.position - arm.home).max() > 2e-3)
    graph.call(Trigger, "joint_trajectory_controller/hold", Trigger.Request())
    answer = ended(waiting)
    assert answer.error_code == ErrorCode.PREEMPTED
    assert answer.error_msg == "INVALID_GOAL: stopped by the service hold"
    waiting = arm.start_execute(arm.trajectory(arm.position - arm.home, MOVE, duration=20.0))
    arm.until_moving()
    assert graph.call(Trigger, "trajectory_publisher/cancel", Trigger.Request()).success
    answer = ended(waiting)
    assert answer.error_code == ErrorCode.PREEMPTED
    assert "cancelled by the" in answer.error_msg
    arm.until(lambda: not arm.velocity.any())


def stranger(graph, arm, execute, **options):
    """Serve the action as another controller would, whose robot stands at home."""
    states = graph.client.create_publisher(JointState, "joint_states", 10)
    message = JointState(name=list(arm.chain.joint_names), position=arm.home.tolist())
    message.velocity = [0.0] * len(message.name)
    graph.client.create_timer(0.02, lambda: states.publish(message))
    return ActionServer(graph.client, FollowJointTrajectory, NAME, execute, **options)


def aborted(handle):
    handle.abort()
    return CODES(error_code=CODES.INVALID_GOAL)


def test_a_controller_that_rejects(graph):
    arm = Suite(graph, with_controller=False, transport=FOLLOW)
    rejecting = {"goal_callback": lambda goal: GoalResponse.REJECT}
    server = stranger(graph, arm, aborted, **rejecting)
    answer = arm.execute(arm.trajectory(0.0, MOVE))
    assert answer.error_code == ErrorCode.REJECTED
    assert answer.error_msg == f"action '{NAME}' rejected the goal without a reason"
    server.destroy()


def test_a_controller_that_forgets(graph):
    arm = Suite(graph, with_controller=False, transport=FOLLOW)
    # Often the goal is forgotten before its result is asked for.
    server = stranger(graph, arm, aborted, result_timeout=0)
    for _ in range(5):
        answer = arm.execute(arm.trajectory(0.0, MOVE))
        assert answer.error_code == ErrorCode.REJECTED
        forgotten = f"action '{NAME}' does not know the goal; how the motion ended is not known"
        assert answer.error_msg in (forgotten, "INVALID_GOAL, without a reason")
    server.destroy()


def test_without_the_package(graph, monkeypatch):
    for module in ("control_msgs", "control_msgs.action"):
        monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.delitem(sys.modules, FollowGoals.__module__)
    expected = "'transport' is 'follow_joint_trajectory'; allowed is 'topic' or 'action', since "
    with pytest.raises(RobomechError, match=expected + "control_msgs cannot be used"):
        graph.start(TrajectoryPublisherNode, transport=FOLLOW)


@pytest.mark.parametrize("what", ["path", "goal"])
def test_tolerances_that_mean_nothing(graph, what):
    name = f"controller_{what}_tolerance"
    with pytest.raises(RobomechError, match=f"'{name}' is -0.5; allowed is -1 .any distance., 0"):
        graph.start(TrajectoryPublisherNode, **{name: -0.5})
