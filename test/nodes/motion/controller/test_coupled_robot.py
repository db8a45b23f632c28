"""A palletizer, on which two joints follow: every node works in its four drives."""

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from trajectory_msgs.msg import JointTrajectoryPoint

from robomech_interfaces.srv import (
    AnalyzeSingularity,
    GetJacobian,
    InverseDynamics,
    PlanCartesian,
    PlanJoint,
    QueryWorkspace,
    SolveFK,
    SolveIK,
    SolveIKBatch,
)
from robomech_ros.dynamics import inverse_dynamics
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose
from robomech_ros.nodes.dynamics.node import DynamicsNode
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.robots import load_robot
from test.coupled_robots import palletizer_with_bodies

DRIVES = ["turn", "rear", "fore", "spin"]
FOLLOWERS = ["rear_back", "level"]
START, GOAL = [0.2, 0.4, 0.5, 0.3], [-0.3, 0.9, 0.8, -0.6]


@pytest.fixture
def text():
    return palletizer_with_bodies()


def test_kinematics_and_dynamics_in_drives(graph, text):
    chain = load_robot(text)
    graph.start(KinematicsNode, robot_description=text)
    graph.start(DynamicsNode, robot_description=text)

    def ask(kind, name, **fields):
        answer = graph.call(kind, name, kind.Request(**fields))
        assert answer.error_code == 0, answer.error_msg
        return answer

    state = joint_state(DRIVES, np.array(START))
    poses = ask(SolveFK, "kinematics/solve_fk", states=[state], links=["tool0", "hand"]).poses
    solved = ask(SolveIK, "kinematics/solve_ik", target=poses[0], seed=state)
    assert (solved.joint_names, solved.family, solved.complete) == (DRIVES, "coupled", True)
    np.testing.assert_allclose(solved.solutions[0].positions, START, atol=1e-9)
    pose = poses[0].pose
    row = [pose.position.x, pose.position.y, pose.position.z]
    row += [getattr(pose.orientation, axis) for axis in "xyzw"]
    many = ask(SolveIKBatch, "kinematics/solve_ik_batch", poses=row, seed=START)
    np.testing.assert_allclose(many.solutions[:4], START, atol=1e-9)
    found = ask(GetJacobian, "kinematics/get_jacobian", state=state)
    assert list(found.joint_names) == DRIVES
    J = np.roll(jacobian(chain, START), 3, axis=0)
    np.testing.assert_allclose(np.reshape(found.jacobian, (6, 4)), J, atol=1e-12)
    report = ask(AnalyzeSingularity, "kinematics/analyze_singularity", state=state)
    assert report.rank == 4
    space = ask(QueryWorkspace, "kinematics/query_workspace", poses=poses[:1])
    assert list(space.reachable) == [True]
    assert 0.1 < space.least_reach < space.greatest_reach < 0.35
    motion = np.array([START, [0.1, -0.2, 0.3, 0.4], [1.0, 0.5, -0.6, 0.2]])
    point = JointTrajectoryPoint(positions=motion[0], velocities=motion[1], accelerations=motion[2])
    effort = ask(InverseDynamics, "dynamics/inverse_dynamics", points=[point]).effort
    np.testing.assert_allclose(effort, inverse_dynamics(chain, *motion), atol=1e-12)


def test_plans_are_executed_and_followers_shown(drive, text, tmp_path):
    limits = tmp_path / "joint_limits.yaml"
    rows = "".join(
        f"  {name}: {{has_acceleration_limits: true, max_acceleration: 8.0, "
        "has_jerk_limits: true, max_jerk: 80.0}\n"
        for name in DRIVES
    )
    limits.write_text(f"joint_limits:\n{rows}", encoding="utf-8")
    robot = drive(robot_description=text, initial_positions=START)
    graph = robot.graph
    graph.start(TrajectoryPlannerNode, robot_description=text, joint_limits=str(limits))
    goal = joint_state(DRIVES, np.array(GOAL))
    request = PlanJoint.Request(goal=goal, profile=PlanJoint.Request.RUCKIG)
    plan = graph.call(PlanJoint, "trajectory_planner/plan_joint", request)
    assert plan.error_code == 0, plan.error_msg
    assert plan.trajectory.joint_names == DRIVES
    assert robot.execute(plan.trajectory)[0] == GoalStatus.STATUS_SUCCEEDED
    _, rear, fore, _ = GOAL
    robot.until_at(np.array([*GOAL, -rear, -fore]))
    assert robot.states[-1].name == [*DRIVES, *FOLLOWERS]
    chain = load_robot(text)
    there = forward_kinematics(chain, GOAL)
    there[:3, 3] += [0.01, 0.02, 0.01]
    motion = PlanCartesian.Request(start=goal, waypoints=[stamped_pose(there, "base_link")])
    straight = graph.call(PlanCartesian, "trajectory_planner/plan_cartesian", motion)
    assert (straight.error_code, straight.fraction) == (0, 1.0), straight.error_msg
    assert straight.trajectory.joint_names == DRIVES
    end = forward_kinematics(chain, straight.trajectory.points[-1].positions)
    np.testing.assert_allclose(end, there, atol=1e-6)
