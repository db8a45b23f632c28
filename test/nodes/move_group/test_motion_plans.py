"""Plans of move_group around obstacles: goals, refusals, cancellation."""

import math
import time

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Vector3
from move_group_client import HERE, THERE, UR5E, box, joint_goal, pose_goal, request, state
from moveit_msgs.action import ExecuteTrajectory, MoveGroup
from moveit_msgs.msg import (
    Constraints,
    DisplayTrajectory,
    JointConstraint,
    MoveItErrorCodes as Codes,
    OrientationConstraint,
    PositionIKRequest,
    RobotState,
    VisibilityConstraint,
)
from moveit_msgs.srv import (
    GetCartesianPath,
    GetMotionPlan,
    GetPlannerParams,
    GetPositionIK,
    QueryPlannerInterfaces,
    SetPlannerParams,
)
from shaped_arm import shaped_ur5e
from trajectories import waypoints as points_of

from robomech_ros.collision import Box, PlanningScene
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix, stamped_pose
from robomech_ros.robots import load_description
from robomech_ros.trajectory import verify

WALL = ((0.6, 0.02, 0.8), (0.55, 0.0, 0.4))


def plan(client, *goals, **fields):
    asked = {"motion_plan_request": request(*goals, **fields)}
    return client.graph.ask(GetMotionPlan, "plan_kinematic_path", **asked).motion_plan_response


def checked(answer, start=HERE):
    """Check what every plan promises; return its last point."""
    assert answer.error_code.val == Codes.SUCCESS, answer.error_code.message
    message = answer.trajectory.joint_trajectory
    assert list(message.joint_names) == list(UR5E.joint_names)
    points = points_of(message)
    report = verify(points, UR5E, start=start, start_tolerance=1e-9)
    assert report.ok, report.violation
    return points


def free_of_wall(points):
    """Check by a scene of the test's own that no point of the curve touches the wall."""
    scene = PlanningScene(load_description(shaped_ur5e()).chain())
    wall = np.eye(4)
    wall[:3, 3] = WALL[1]
    scene.add("wall", Box(*WALL[0]), wall)
    dense = points.curve.sample(np.linspace(0.0, points.times[-1], 2000)).position
    return bool(np.all(scene.is_free(dense)))


def test_a_joint_goal_behind_a_wall_is_reached_around_it(client):
    assert client.apply(box("wall", *WALL))
    points = checked(plan(client, joint_goal(THERE), allowed_planning_time=20.0))
    np.testing.assert_allclose(points.positions[-1], THERE, atol=1e-9)
    assert free_of_wall(points)
    assert not free_of_wall(checked(plan_without_wall(client)))


def plan_without_wall(client):
    gone = box("wall")
    gone.operation = gone.REMOVE
    assert client.apply(gone)
    return plan(client, joint_goal(THERE))


def test_a_pose_goal_behind_a_wall_is_reached_by_one_of_its_postures(client):
    assert client.apply(box("wall", *WALL))
    goal = forward_kinematics(UR5E, THERE)
    points = checked(plan(client, pose_goal(goal, frame="base_link"), allowed_planning_time=20.0))
    np.testing.assert_allclose(forward_kinematics(UR5E, points.positions[-1]), goal, atol=1e-6)
    assert free_of_wall(points)


def test_the_nearer_of_two_goals_is_reached(client):
    points = checked(plan(client, joint_goal(THERE), joint_goal(HERE + 0.1)))
    np.testing.assert_allclose(points.positions[-1], HERE + 0.1, atol=1e-9)


def test_a_position_alone_and_a_turn_alone(client):
    goal = forward_kinematics(UR5E, THERE)
    position = pose_goal(goal)
    position.orientation_constraints = []
    reached = forward_kinematics(UR5E, checked(plan(client, position)).positions[-1])
    np.testing.assert_allclose(reached[:3, 3], goal[:3, 3], atol=1e-3)
    free = pose_goal(goal)
    free.orientation_constraints[0].absolute_z_axis_tolerance = math.tau
    reached = forward_kinematics(UR5E, checked(plan(client, free)).positions[-1])
    np.testing.assert_allclose(reached[:3, 2], goal[:3, 2], atol=1e-3)


def test_a_point_beside_the_link_is_brought_to_the_region(client):
    goal = forward_kinematics(UR5E, THERE)
    beside = pose_goal(goal)
    beside.position_constraints[0].target_point_offset = Vector3(x=0.0, y=0.0, z=0.1)
    reached = forward_kinematics(UR5E, checked(plan(client, beside)).positions[-1])
    np.testing.assert_allclose(reached @ [0.0, 0.0, 0.1, 1.0], [*goal[:3, 3], 1.0], atol=1e-6)


def test_parts_of_the_limits_and_the_speed_of_a_link(client):
    whole = checked(plan(client, joint_goal(THERE)))
    half = checked(plan(client, joint_goal(THERE), max_velocity_scaling_factor=0.2))
    assert half.times[-1] > 1.5 * whole.times[-1]
    slow = checked(
        plan(
            client,
            joint_goal(THERE),
            cartesian_speed_limited_link="tool0",
            max_cartesian_speed=0.05,
        )
    )
    dense = np.linspace(0.0, slow.times[-1], 3000)
    tips = forward_kinematics(UR5E, slow.curve.sample(dense).position)[:, :3, 3]
    speeds = np.linalg.norm(np.diff(tips, axis=0), axis=1) / np.diff(dense)
    assert 0.045 < speeds.max() < 0.0501


def test_the_same_request_has_the_same_answer(client):
    assert client.apply(box("wall", *WALL))
    goal = joint_goal(THERE)
    one, other = (plan(client, goal, allowed_planning_time=20.0).trajectory for _ in range(2))
    assert one == other


def test_start_and_goal_in_contact_are_named(client):
    tip = forward_kinematics(UR5E, THERE)[:3, 3]
    assert client.apply(box("block", (0.1, 0.1, 0.1), tip))
    answer = plan(client, joint_goal(THERE))
    assert answer.error_code.val == Codes.GOAL_IN_COLLISION
    assert "'block'" in answer.error_code.message and "m deep" in answer.error_code.message
    assert client.apply(box("block", (0.1, 0.1, 0.1), forward_kinematics(UR5E, HERE)[:3, 3]))
    answer = plan(client, joint_goal(THERE))
    # It is left while the distance grows, or it is said that it cannot be.
    assert answer.error_code.val in (Codes.SUCCESS, Codes.START_STATE_IN_COLLISION)
    assert "'block'" in answer.error_code.message


def cage(half):
    """Make four walls around the tool at the goal (m)."""
    tip, along = forward_kinematics(UR5E, THERE)[:3, 3], np.eye(3)
    return [
        box(
            f"side {axis}{sign}",
            np.where(along[axis], 0.01, 2.0 * half),
            tip + sign * half * along[axis],
        )
        for axis in range(2)
        for sign in (-1, 1)
    ]


def test_no_path_in_time_is_said(client):
    assert client.apply(*cage(0.17))
    answer = plan(client, joint_goal(THERE), allowed_planning_time=0.3)
    assert answer.error_code.val in (Codes.TIMED_OUT, Codes.GOAL_IN_COLLISION)
    assert answer.error_code.message


def path_constraint():
    return Constraints(orientation_constraints=[OrientationConstraint(link_name="tool0")])


FAR = np.eye(4)
FAR[0, 3] = 5.0
SEEING = Constraints(visibility_constraints=[VisibilityConstraint()])
FOREIGN = Constraints(joint_constraints=[JointConstraint(joint_name="lid")])
OUTSIDE = joint_goal(np.full(6, 9.0))
REFUSALS = {
    "group": ({"group_name": "legs"}, Codes.INVALID_GROUP_NAME, "legs"),
    "path constraint": (
        {"path_constraints": path_constraint()},
        Codes.INVALID_GOAL_CONSTRAINTS,
        "path_constraints.orientation_constraints has length 1",
    ),
    "visibility": ({"goal_constraints": [SEEING]}, Codes.INVALID_GOAL_CONSTRAINTS, "visibility"),
    "no goal": ({"goal_constraints": []}, Codes.INVALID_GOAL_CONSTRAINTS, "goal_constraints"),
    "empty goal": (
        {"goal_constraints": [Constraints()]},
        Codes.INVALID_GOAL_CONSTRAINTS,
        "no constraints",
    ),
    "joint": ({"goal_constraints": [FOREIGN]}, Codes.INVALID_GOAL_CONSTRAINTS, "lid"),
    "outside": (
        {"goal_constraints": [OUTSIDE]},
        Codes.INVALID_GOAL_CONSTRAINTS,
        "is to go to 9 rad",
    ),
    "out of reach": ({"goal_constraints": [pose_goal(FAR)]}, Codes.NO_IK_SOLUTION, "reach"),
    "link": ({"goal_constraints": [pose_goal(FAR, link="nose")]}, Codes.INVALID_LINK_NAME, "nose"),
    "frame": (
        {"goal_constraints": [pose_goal(FAR, frame="moon")]},
        Codes.FRAME_TRANSFORM_FAILURE,
        "moon",
    ),
    "planner": ({"planner_id": "TRRT"}, Codes.FAILURE, "RRTConnect"),
    "pipeline": ({"pipeline_id": "pilz"}, Codes.FAILURE, "'ompl'"),
    "scale": ({"max_velocity_scaling_factor": 1.5}, Codes.FAILURE, "max_velocity_scaling_factor"),
    "time": ({"allowed_planning_time": -1.0}, Codes.FAILURE, "allowed_planning_time"),
    "not a number": (
        {"goal_constraints": [joint_goal([math.nan] * 6)]},
        Codes.INVALID_GOAL_CONSTRAINTS,
        "nan",
    ),
    "no state": ({"start_state": RobotState()}, Codes.ROBOT_STATE_STALE, "joint_states"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_what_is_not_served_is_refused_by_name(client, name):
    fields, code, words = REFUSALS[name]
    asked = request(joint_goal(THERE))
    for field, value in fields.items():
        setattr(asked, field, value)
    answer = client.graph.ask(GetMotionPlan, "plan_kinematic_path", motion_plan_request=asked)
    outcome = answer.motion_plan_response.error_code
    assert outcome.val == code, outcome
    assert words in outcome.message, outcome.message
    assert not answer.motion_plan_response.trajectory.joint_trajectory.points


def test_a_goal_that_is_only_planned(client):
    goal = MoveGroup.Goal(request=request(joint_goal(THERE)))
    goal.planning_options.plan_only = True
    shown = []
    client.graph.client.create_subscription(
        DisplayTrajectory, "display_planned_path", shown.append, 10
    )
    _, ended = client.send(MoveGroup, "move_action", goal)
    result = client.graph.wait_for(ended)
    assert result.status == GoalStatus.STATUS_SUCCEEDED
    assert result.result.error_code.val == Codes.SUCCESS
    last = result.result.planned_trajectory.joint_trajectory.points[-1].positions
    np.testing.assert_allclose(last, THERE, atol=1e-9)
    assert not result.result.executed_trajectory.joint_trajectory.points
    assert shown and shown[0].trajectory[0] == result.result.planned_trajectory


@pytest.mark.parametrize("option", ["replan", "look_around"])
def test_options_that_there_are_not_are_refused(client, option):
    goal = MoveGroup.Goal(request=request(joint_goal(THERE)))
    setattr(goal.planning_options, option, True)
    _, ended = client.send(MoveGroup, "move_action", goal)
    result = client.graph.wait_for(ended)
    assert result.status == GoalStatus.STATUS_ABORTED
    assert f"planning_options.{option} is set" in result.result.error_code.message


def test_a_cancelled_goal_ends_and_others_are_answered_meanwhile(client):
    assert client.apply(*cage(0.17))
    goal = MoveGroup.Goal(request=request(joint_goal(THERE), allowed_planning_time=60.0))
    handle, ended = client.send(MoveGroup, "move_action", goal)
    begun = time.monotonic()
    assert client.scene().world.collision_objects
    client.graph.wait_for(handle.cancel_goal_async())
    result = client.graph.wait_for(ended)
    assert time.monotonic() - begun < 20.0
    assert result.status in (GoalStatus.STATUS_CANCELED, GoalStatus.STATUS_ABORTED)


def test_without_a_controller_nothing_is_executed(client):
    planned = plan(client, joint_goal(THERE)).trajectory
    goal = ExecuteTrajectory.Goal(trajectory=planned)
    _, ended = client.send(ExecuteTrajectory, "execute_trajectory", goal)
    result = client.graph.wait_for(ended)
    assert result.status == GoalStatus.STATUS_ABORTED
    assert result.result.error_code.val == Codes.CONTROL_FAILED
    assert "joint_trajectory_controller" in result.result.error_code.message


def test_inverse_kinematics_leaves_out_postures_in_contact(client):
    goal = forward_kinematics(UR5E, HERE)
    asked = PositionIKRequest(robot_state=state(), pose_stamped=stamped_pose(goal, ""))
    asked.avoid_collisions = True

    def solve():
        answer = client.graph.ask(GetPositionIK, "compute_ik", ik_request=asked)
        return answer.error_code, np.array(answer.solution.joint_state.position)

    outcome, first = solve()
    assert outcome.val == Codes.SUCCESS
    np.testing.assert_allclose(first, HERE, atol=1e-7)
    elbow = load_description("ur5e").link_poses(dict(zip(UR5E.joint_names, HERE, strict=True)))
    assert client.apply(box("block", (0.05, 0.05, 0.05), elbow["forearm_link"][:3, 3]))
    outcome, other = solve()
    assert outcome.val == Codes.SUCCESS, outcome.message
    assert np.abs(other - HERE).max() > 0.1
    np.testing.assert_allclose(forward_kinematics(UR5E, other), goal, atol=1e-7)
    assert client.apply(box("block", (0.05, 0.05, 0.05), goal[:3, 3]))
    outcome, _ = solve()
    assert outcome.val == Codes.NO_IK_SOLUTION
    assert "'block'" in outcome.message and "m deep" in outcome.message
    asked.avoid_collisions = False
    assert solve()[0].val == Codes.SUCCESS


def test_a_straight_line_ends_before_a_wall(client):
    goal = forward_kinematics(UR5E, HERE)
    goal[1, 3] = -0.3
    asked = {
        "start_state": state(),
        "waypoints": [pose_from_matrix(goal)],
        "max_step": 0.01,
        "avoid_collisions": True,
    }
    answer = client.graph.ask(GetCartesianPath, "compute_cartesian_path", **asked)
    assert answer.fraction == 1.0, answer.error_code
    assert client.apply(box("wall", *WALL))
    answer = client.graph.ask(GetCartesianPath, "compute_cartesian_path", **asked)
    assert 0.1 < answer.fraction < 0.6
    assert "'wall'" in answer.error_code.message
    assert free_of_wall(points_of(answer.solution.joint_trajectory))
    asked["avoid_collisions"] = False
    assert client.graph.ask(GetCartesianPath, "compute_cartesian_path", **asked).fraction == 1.0


def test_planners_and_their_parameters(client):
    ask = client.graph.ask
    (interface,) = ask(QueryPlannerInterfaces, "query_planner_interface").planner_interfaces
    assert interface.pipeline_id == "ompl" and "RRTConnect" in interface.planner_ids
    kind, name = GetPlannerParams, "get_planner_params"
    params = ask(kind, name).params
    values = dict(zip(params.keys, params.values, strict=True))
    assert values == {
        "planner": "RRTConnect",
        "planning_time": "5.0",
        "clearance": "0.0",
        "seed": "0",
    }
    assert all(params.descriptions)
    params.keys, params.values = ["seed", "clearance", "nonsense"], ["7", "0.01", "1"]
    ask(SetPlannerParams, "set_planner_params", params=params)
    params = ask(kind, name).params
    values = dict(zip(params.keys, params.values, strict=True))
    assert (values["seed"], values["clearance"]) == ("7", "0.01")
