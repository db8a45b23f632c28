"""Nodes of an arm on a floating base, against Pinocchio's free flyer."""

import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from trajectories import waypoints
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import (
    ForwardDynamics,
    InverseDynamics,
    MassMatrix,
    PlanCartesian,
    SolveIK,
)
from robomech_ros.dynamics import FloatingChain
from robomech_ros.errors import RobomechError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, stamped_pose
from robomech_ros.nodes.common.robot.floating_base import FloatingRobot, FloatingSettings
from robomech_ros.nodes.common.robot.robot_description import RobotModel
from robomech_ros.nodes.dynamics.node import DynamicsNode
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.robots import Body, load_description, load_robot
from robomech_ros.rvs.model.floating_tree import CAPTURED, CRAFT, floating_tree, free_joints
from robomech_ros.spatial import pose_error, pose_exponential, quaternion_from_matrix

sys.path.insert(0, str(Path(__file__).parents[2] / "dynamics"))
from arms_with_bodies import pinocchio_of

ARM = load_robot("canadarm2")
BASE = load_description("canadarm2").floating_base
HOME = ARM.home()
TIP = forward_kinematics(ARM, HOME)
LINEAR_FIRST = [3, 4, 5, 0, 1, 2]


@pytest.fixture(scope="module")
def flyer():
    """Return the model of Pinocchio, and the places of our numbers in its vectors."""
    model = pinocchio_of(ARM, gravity=(0, 0, 0), root=pinocchio.JointModelFreeFlyer())
    inertia = pinocchio.Inertia(BASE.mass, np.array(BASE.com), np.array(BASE.inertia))
    model.appendBodyToJoint(1, inertia, pinocchio.SE3.Identity())
    return model, [*LINEAR_FIRST, *range(6, 6 + ARM.n)]


def momentum(flyer, T, twist, q, qd):
    """Return angular momentum about the mass centre, then linear, in the inertial axes."""
    model, order = flyer
    data = model.createData()
    at = np.concatenate((T[:3, 3], quaternion_from_matrix(T[:3, :3]), q))
    pinocchio.ccrba(model, data, at, np.concatenate((twist, qd))[order])
    return data.hg.vector[LINEAR_FIRST]


class Recording:
    """Collects the messages of odom and joint_states by their stamps."""

    def __init__(self, node):
        self.base, self.joints = {}, {}
        node.create_subscription(Odometry, "odom", self._base, 1000)
        node.create_subscription(JointState, "joint_states", self._joint, 1000)

    def _base(self, message):
        w, v = message.twist.twist.angular, message.twist.twist.linear
        twist = np.array([w.x, w.y, w.z, v.x, v.y, v.z])
        self.base[self._stamp(message)] = matrix_from_pose(message.pose.pose), twist

    def _joint(self, message):
        self.joints[self._stamp(message)] = np.array(message.position), np.array(message.velocity)

    @staticmethod
    def _stamp(message):
        return message.header.stamp.sec, message.header.stamp.nanosec

    def states(self):
        """Return base pose, twist, joint values and rates, in the order of their stamps."""
        common = sorted(self.base.keys() & self.joints.keys())
        return [(*self.base[one], *self.joints[one]) for one in common]

    def wait(self, condition, seconds=60.0):
        deadline = time.monotonic() + seconds
        while not (self.base and self.joints and condition(self)):
            assert time.monotonic() < deadline
            time.sleep(0.02)


def target(x=0.15, frame="odom"):
    T = TIP.copy()
    T[:3, 3] += [x, -0.5 * x, 0.2]
    return stamped_pose(T, frame)


def test_the_tip_arrives_in_inertial_space_and_captures_a_body(graph, flyer):
    graph.start(JointTrajectoryControllerNode, robot_description="canadarm2")
    graph.start(TrajectoryPlannerNode, robot_description="canadarm2")
    graph.start(KinematicsNode, robot_description="canadarm2")
    record = Recording(graph.client)
    record.wait(lambda one: len(one.base) > 2)
    solved = graph.ask(SolveIK, "kinematics/solve_ik", target=target())
    assert solved.error_code == ErrorCode.NONE, solved.error_msg
    assert (solved.family, len(solved.solutions), solved.complete) == ("floating", 1, False)
    assert max(*solved.position_errors, *solved.orientation_errors) < 1e-9
    assert "the base moves by 0.0" in solved.error_msg
    planned = graph.ask(
        PlanCartesian,
        "trajectory_planner/plan_cartesian",
        waypoints=[target()],
        profile=PlanCartesian.Request.TIME_OPTIMAL,
    )
    assert (planned.error_code, planned.fraction) == (ErrorCode.NONE, 1.0), planned.error_msg
    goal = waypoints(planned.trajectory).positions[-1]
    np.testing.assert_allclose(solved.solutions[0].positions, goal, atol=1e-8)
    topic = "joint_trajectory_controller/joint_trajectory"
    graph.client.create_publisher(JointTrajectory, topic, 10).publish(planned.trajectory)
    record.wait(
        lambda one: (
            np.abs(list(one.joints.values())[-1][0] - goal).max() < 1e-9
            and not np.any(list(one.joints.values())[-1][1])
        )
    )
    states = record.states()
    T, _, q, _ = states[-1]
    wanted = matrix_from_pose(target().pose)
    assert np.abs(pose_error(wanted, T @ forward_kinematics(ARM, q))).max() < 1e-6
    # The same joints on a fixed base would miss by centimetres.
    assert np.abs(pose_error(wanted, forward_kinematics(ARM, q))[3:]).max() > 0.02
    moved = [one for one in states if np.abs(one[3]).max() > 1e-3]
    assert len(moved) > 20
    for T, twist, q, qd in moved[::20]:
        found, alone = (momentum(flyer, T, one, q, qd) for one in (twist, 0.0 * twist))
        assert np.abs(found).max() < 1e-10 * np.abs(alone).max()
    # Twists are the rates of the poses.
    stamps = sorted(record.base)
    for before, after in list(zip(stamps, stamps[2:], strict=False))[::25]:
        (A, first), (B, second) = record.base[before], record.base[after]
        seconds = after[0] - before[0] + 1e-9 * (after[1] - before[1])
        change = pose_error(B, A).reshape(2, 3) @ A[:3, :3]
        np.testing.assert_allclose(
            change.ravel(), 0.5 * seconds * (first + second), atol=1e-2 * seconds * 0.05
        )
    capture(graph, record)


def capture(graph, record):
    """A body of 500 kg at 0.1 m/s is fixed to the tip."""
    values = {
        "payload_mass": 500.0,
        "payload_com": [0.0, 0.0, 0.5],
        "payload_velocity": [0.0, 0.1, 0.0],
    }
    parameters = [Parameter(name, value=one).to_parameter_msg() for name, one in values.items()]
    service = "joint_trajectory_controller/set_parameters_atomically"
    T, _, q, _ = record.states()[-1]
    known = set(record.base)
    assert graph.ask(SetParametersAtomically, service, parameters=parameters).result.successful
    record.wait(lambda one: len(one.base.keys() - known) > 20)
    after, twist, _, _ = record.states()[-1]
    # The whole drifts as one body, with the momentum of the captured one.
    links = sum(body.mass for body in ARM.bodies)
    tip = T @ forward_kinematics(ARM, q)
    own = tip[:3, 3] + 0.5 * tip[:3, 2]
    chain = FloatingChain(ARM, BASE)
    centre = T[:3, :3] @ chain.center_of_mass(q) + T[:3, 3]
    whole = BASE.mass + links + 500.0
    middle = ((whole - 500.0) * centre + 500.0 * own) / whole
    w, v = (after[:3, :3] @ part for part in (twist[:3], twist[3:]))
    drift = v + np.cross(w, middle - after[:3, 3])
    np.testing.assert_allclose(drift, [0.0, 50.0 / whole, 0.0], atol=2e-5)


def test_efforts_are_those_of_the_free_flyer(graph, flyer):
    graph.start(
        DynamicsNode, robot_description="canadarm2", momentum=[50.0, 20.0, -30.0, 4.0, 5.0, 6.0]
    )
    rng = np.random.default_rng(2)
    q, (qd, tau) = HOME + rng.uniform(-0.3, 0.3, 7), rng.uniform(-0.05, 0.05, (2, 7))
    tau = 1e3 * tau
    state = JointState(position=q.tolist(), velocity=qd.tolist(), effort=tau.tolist())
    found = graph.ask(ForwardDynamics, "dynamics/forward_dynamics", state=state)
    assert found.error_code == ErrorCode.NONE, found.error_msg
    model, _ = flyer
    data = model.createData()
    at = np.concatenate((np.zeros(6), [1.0], q))
    pinocchio.computeCentroidalMap(model, data, at)
    A = data.Ag[LINEAR_FIRST]
    given = np.array([50.0, 20.0, -30.0, 4.0, 5.0, 6.0])
    v = np.concatenate((np.linalg.solve(A[:, :6], given - A[:, 6:] @ qd), qd))
    expected = pinocchio.aba(model, data, at, v, np.concatenate((np.zeros(6), tau)))
    np.testing.assert_allclose(found.acceleration, expected[6:], atol=1e-12)
    point = JointTrajectoryPoint(
        positions=q.tolist(), velocities=qd.tolist(), accelerations=list(found.acceleration)
    )
    back = graph.ask(InverseDynamics, "dynamics/inverse_dynamics", points=[point])
    np.testing.assert_allclose(back.effort, tau, atol=1e-9)
    np.testing.assert_allclose(back.gravity, np.zeros(7), atol=1e-9)
    np.testing.assert_allclose(np.add(back.coriolis, back.inertial), tau, atol=1e-9)
    M = graph.ask(MassMatrix, "dynamics/mass_matrix", state=JointState(position=q.tolist()))
    inverse = np.linalg.inv(pinocchio.computeMinverse(model, data, at)[6:, 6:])
    full = np.triu(inverse) + np.triu(inverse, 1).T
    np.testing.assert_allclose(np.reshape(M.mass_matrix, (7, 7)), full, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize(
    ("node", "parameters", "text"),
    [
        (DynamicsNode, {"momentum": [np.nan] * 6}, "momentum"),
        (DynamicsNode, {"momentum": [1.0]}, "6 numbers"),
        (JointTrajectoryControllerNode, {"momentum": [np.inf] * 6}, "momentum"),
        (JointTrajectoryControllerNode, {"simulation": "dynamic"}, "floats"),
        (
            JointTrajectoryControllerNode,
            {"payload_velocity": [0.1, 0.0, 0.0], "floating_base": "never"},
            "does not float",
        ),
        (
            JointTrajectoryControllerNode,
            {"robot_description": "general6r", "floating_base": "always"},
            "no link fixed to it has a mass",
        ),
    ],
)
def test_wrong_parameters_are_refused_by_name(graph, node, parameters, text):
    with pytest.raises(RobomechError, match=text):
        graph.start(node, **({"robot_description": "canadarm2"} | parameters))


def test_requests_that_cannot_be_served_get_code_and_text(graph):
    graph.start(JointTrajectoryControllerNode, robot_description="canadarm2")
    graph.start(KinematicsNode, robot_description="canadarm2")
    graph.start(TrajectoryPlannerNode, robot_description="canadarm2")
    graph.start(DynamicsNode, robot_description="general6r", floating_base="always")
    for x, code, text in (
        (60.0, ErrorCode.NOT_CONVERGED, "the generalised Jacobian is singular|limit"),
        (np.nan, ErrorCode.NON_FINITE, "target"),
    ):
        far = graph.ask(SolveIK, "kinematics/solve_ik", target=target(x))
        assert (far.error_code, len(far.solutions)) == (code, 0)
        assert any(part in far.error_msg for part in text.split("|")), far.error_msg
    # In a frame of the robot a target moves with the base, and all solutions are found.
    fixed = graph.ask(SolveIK, "kinematics/solve_ik", target=target(frame=""))
    assert (fixed.family, fixed.error_code) == ("redundant", ErrorCode.NONE)
    partly = graph.ask(
        SolveIK, "kinematics/solve_ik", target=target(), task_mask=[True] * 3 + [False] * 3
    )
    assert partly.error_code == ErrorCode.BAD_VALUE
    assert "task_mask" in partly.error_msg
    two = [target(), PoseStamped(pose=target().pose)]
    mixed = graph.ask(PlanCartesian, "trajectory_planner/plan_cartesian", waypoints=two)
    assert mixed.error_code == ErrorCode.BAD_VALUE
    assert "its base floats" in mixed.error_msg
    empty = graph.ask(MassMatrix, "dynamics/mass_matrix", state=JointState(position=[0.1] * 6))
    assert empty.error_code == ErrorCode.MISSING_INERTIA
    assert "no link fixed to it has a mass" in empty.error_msg


def test_the_base_of_a_urdf_can_float():
    settings = FloatingSettings(floating_base="always")
    body = Body(30.0, np.zeros(3), np.eye(3))
    known = load_description("ur5e")
    description = replace(known, bodies={**known.bodies, known.root: body})
    floating = FloatingRobot(RobotModel(description, settings), settings)
    base = floating.carrying(load_robot("ur5e")).base
    assert base.mass == 30.0
    assert not FloatingRobot(RobotModel(description), FloatingSettings()).floats


def test_a_captured_body_and_the_craft_are_drawn_where_they_are():
    box = Body(600.0, np.zeros(3), 100.0 * np.eye(3))
    tree = floating_tree(load_description("canadarm2"), BASE, box)
    poses = pose_exponential([[0.1, 0.2, -0.3, 1.0, 2.0, 3.0], [0.2, 0.4, -0.6, 0.0, 1.0, 0.0]])
    for name, link in ((CRAFT, "base_link"), (CAPTURED, "captured_body")):
        for k, pose in enumerate(poses):
            at = {joint: values[k] for joint, values in free_joints(name, poses).items()}
            np.testing.assert_allclose(tree.link_poses(at)[link], pose, atol=1e-12)
