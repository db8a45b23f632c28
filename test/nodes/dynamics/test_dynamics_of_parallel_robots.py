"""The dynamics node of parallel robots: efforts over their drives, and what it refuses."""

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Inertia, InertiaStamped, Vector3, WrenchStamped
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import (
    ForwardDynamics,
    InverseDynamics,
    MassMatrix,
    SetPayload,
    SummarizeTorques,
)
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.dynamics.node import DynamicsNode
from robomech_ros.parallel import ParallelDynamics, load_parallel
from robomech_ros.robots import Body

DOWN = [0.0, 0.0, -9.81]


@pytest.fixture(params=["hexapod", "delta"])
def robot(request, graph):
    """The dynamics of a robot, of which a node answers questions."""
    graph.start(DynamicsNode, robot_description=request.param, state_timeout=0.1)
    return ParallelDynamics(load_parallel(request.param).mechanism)


def a_motion(robot):
    """Posture, rates and accelerations of the drives."""
    rng, mechanism = np.random.default_rng(4), robot.mechanism
    home, m = mechanism.home(), mechanism.dof
    q = mechanism.close(home[mechanism.drive_index] + 0.02 * rng.normal(size=m), home).q
    return q, *(0.5 * rng.normal(size=(2, m)))


def point(positions, velocities=(), accelerations=(), t=0.0):
    message = JointTrajectoryPoint(positions=list(positions))
    message.velocities, message.accelerations = list(velocities), list(accelerations)
    message.time_from_start = Duration(sec=int(t), nanosec=round(t % 1.0 * 1e9))
    return message


def inverse(graph, points, **fields):
    return graph.ask(InverseDynamics, "dynamics/inverse_dynamics", points=points, **fields)


def test_efforts_of_drives_named_or_not_and_of_all_joints(graph, robot):
    q, rates, gains = a_motion(robot)
    drives = q[robot.drives_at]
    expected = robot.inverse(q, rates, gains, gravity=DOWN)
    answer = inverse(graph, [point(drives, rates, gains)])
    assert answer.error_code == ErrorCode.NONE, answer.error_msg
    np.testing.assert_allclose(answer.effort, expected, rtol=1e-9)
    shares = np.add(np.add(answer.gravity, answer.coriolis), answer.inertial)
    np.testing.assert_allclose(shares, expected, rtol=1e-9)
    names = list(robot.drive_names)[::-1]
    turned = [point(row[::-1]) for row in (drives,)]
    turned[0].velocities, turned[0].accelerations = list(rates[::-1]), list(gains[::-1])
    answer = inverse(graph, turned, joint_names=names)
    np.testing.assert_allclose(answer.effort, expected[::-1], rtol=1e-9)
    # With all joints named, in any order, those without a drive have no effort.
    order = np.random.default_rng(1).permutation(len(q))
    qd = robot.joint_rates(q, rates)
    qdd = robot.mechanism.accelerations(q, qd, gains)[0]
    names = [robot.joint_names[i] for i in order]
    answer = inverse(graph, [point(q[order], qd[order], qdd[order])], joint_names=names)
    whole = np.zeros(len(q))
    whole[robot.drives_at] = expected
    np.testing.assert_allclose(answer.effort, whole[order], rtol=1e-9, atol=1e-9)


def test_a_wrench_in_the_axes_of_the_platform_and_another_gravity(graph, robot):
    q, rates, gains = a_motion(robot)
    wrench = WrenchStamped()
    wrench.header.frame_id = "platform"
    wrench.wrench.force = Vector3(x=10.0, y=-20.0, z=30.0)
    wrench.wrench.torque = Vector3(x=1.0, y=2.0, z=-3.0)
    R = robot.mechanism.pose(q)[:3, :3]
    in_base = np.concatenate((R @ [1.0, 2.0, -3.0], R @ [10.0, -20.0, 30.0]))
    up = [1.0, 2.0, 9.0]
    expected = robot.inverse(q, rates, gains, gravity=up, tip_wrench=in_base)
    states = [point(q[robot.drives_at], rates, gains)]
    answer = inverse(graph, states, tip_wrench=wrench, gravity=Vector3(x=1.0, y=2.0, z=9.0))
    assert answer.error_code == ErrorCode.NONE, answer.error_msg
    np.testing.assert_allclose(answer.effort, expected, rtol=1e-9)


def test_accelerations_inertia_and_payload(graph, robot):
    q, rates, gains = a_motion(robot)
    efforts = robot.inverse(q, rates, gains, gravity=DOWN)
    names = list(robot.drive_names)
    state = JointState(name=names, position=q[robot.drives_at].tolist())
    state.velocity, state.effort = rates.tolist(), efforts.tolist()
    answer = graph.ask(ForwardDynamics, "dynamics/forward_dynamics", state=state)
    assert answer.error_code == ErrorCode.NONE, answer.error_msg
    assert answer.joint_names == names
    np.testing.assert_allclose(answer.acceleration, gains, rtol=1e-7, atol=1e-7)
    answer = graph.ask(MassMatrix, "dynamics/mass_matrix", state=state)
    inertia = np.reshape(answer.mass_matrix, (len(names), -1))
    np.testing.assert_allclose(inertia, robot.mass_matrix(q), rtol=1e-9, atol=1e-12)
    load = Inertia(m=2.0, com=Vector3(z=0.1), ixx=0.01, iyy=0.02, izz=0.02)
    payload = InertiaStamped(inertia=load)
    payload.header.frame_id = "platform"
    request = SetPayload.Request(payload=payload)
    assert graph.call(SetPayload, "dynamics/set_payload", request).error_msg == ""
    loaded = robot.with_payload(Body(2.0, [0.0, 0.0, 0.1], np.diag([0.01, 0.02, 0.02])))
    answer = inverse(graph, [point(q[robot.drives_at])])
    expected = loaded.inverse(q, 0.0 * rates, 0.0 * rates, gravity=DOWN)
    np.testing.assert_allclose(answer.effort, expected, rtol=1e-9)
    payload.header.frame_id = robot.mechanism.base_link
    answer = graph.call(SetPayload, "dynamics/set_payload", request)
    assert answer.error_code == ErrorCode.BAD_VALUE
    assert "platform" in answer.error_msg


def test_a_summary_over_a_motion_of_the_drives(graph, robot):
    q, _, _ = a_motion(robot)
    start, end = robot.mechanism.home()[robot.drives_at], q[robot.drives_at]
    still = np.zeros(len(start))
    trajectory = JointTrajectory(joint_names=list(robot.drive_names))
    trajectory.points = [point(start, still, still), point(end, still, still, t=1.0)]
    answer = graph.ask(SummarizeTorques, "dynamics/summarize_torques", trajectory=trajectory)
    assert answer.error_code == ErrorCode.NONE, answer.error_msg
    assert answer.joint_names == list(robot.drive_names)
    first = np.abs(robot.inverse(robot.mechanism.home(), still, still, gravity=DOWN))
    assert (np.array(answer.peak_effort) >= 0.99 * first).all()
    np.testing.assert_array_equal(answer.effort_limit, robot.effort)
    assert "effort limits" in answer.summary or "saturates" in answer.summary


def test_what_is_refused_is_named(graph, robot):
    q, _, _ = a_motion(robot)
    away = q.copy()
    passive = next(i for i in range(len(q)) if i not in robot.drives_at)
    away[passive] += 0.2
    answer = inverse(graph, [point(q), point(away)], joint_names=list(robot.joint_names))
    assert answer.error_code == ErrorCode.BAD_VALUE
    assert "points[1]" in answer.error_msg
    assert "has open loops: limb" in answer.error_msg
    answer = inverse(graph, [point([0.0])], joint_names=["leg9_length"])
    assert answer.error_code == ErrorCode.UNKNOWN_JOINT
    assert robot.drive_names[0] in answer.error_msg
    name = robot.joint_names[passive]
    answer = inverse(graph, [point([0.0])], joint_names=[name])
    assert answer.error_code == ErrorCode.WRONG_SIZE
    assert f"or all {len(q)} joints; '{name}' is passive" in answer.error_msg
    answer = inverse(graph, [point(np.full(len(robot.drive_names), np.nan))])
    assert answer.error_code == ErrorCode.NON_FINITE
    answer = graph.ask(MassMatrix, "dynamics/mass_matrix")
    assert answer.error_code == ErrorCode.NO_STATE
    assert robot.drive_names[0] in answer.error_msg


def test_a_singular_posture_among_the_points_has_its_code(graph):
    """It was BAD_VALUE, with the positions of all joints in the text."""
    graph.start(DynamicsNode, robot_description="hexapod", state_timeout=0.1)
    mechanism = load_parallel("hexapod").mechanism
    home = mechanism.home()
    T = mechanism.pose(home)
    T[:3, :3] = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    singular = mechanism.postures(T, ignore_limits=True).q[0]
    names = list(mechanism.joint_names)
    answer = inverse(graph, [point(home), point(singular)], joint_names=names)
    assert answer.error_code == ErrorCode.SINGULAR
    expected = "expected one in which the drives hold the platform"
    assert answer.error_msg == f"posture[1] is singular, {expected}"
    state = joint_state(names, singular)
    answer = graph.ask(MassMatrix, "dynamics/mass_matrix", state=state)
    assert answer.error_code == ErrorCode.SINGULAR
    assert answer.error_msg == f"posture is singular, {expected}"
    answer = graph.ask(ForwardDynamics, "dynamics/forward_dynamics", state=state)
    assert answer.error_code == ErrorCode.SINGULAR


def test_names_without_positions_are_refused_where_there_is_nothing_else_to_name(graph, robot):
    names = list(robot.drive_names)
    request = MassMatrix.Request(state=JointState(name=names, effort=[0.0] * len(names)))
    answer = graph.call(MassMatrix, "dynamics/mass_matrix", request)
    assert answer.error_code == ErrorCode.WRONG_SIZE
    assert "state.position has size 0" in answer.error_msg
    state = JointState(name=["home"])
    answer = graph.ask(MassMatrix, "dynamics/mass_matrix", state=state)
    assert answer.error_code == ErrorCode.NONE, answer.error_msg
    expected = robot.mass_matrix(robot.mechanism.home())
    np.testing.assert_allclose(answer.mass_matrix, expected.ravel(), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "apart", "code"),
    [
        ("planar_3rpr", [-7.0, 1.0, -6.0], ErrorCode.SINGULAR),
        # Lengths that no leg has are what is wrong, not what is on the way there.
        ("hexapod", [3.0, -3.0] * 3, ErrorCode.LIMIT),
    ],
)
def test_points_between_which_the_mode_ends_are_refused(graph, name, apart, code):
    graph.start(DynamicsNode, robot_description=name, state_timeout=0.1)
    mechanism = load_parallel(name).mechanism
    drives = mechanism.home()[mechanism.drive_index]
    answer = inverse(graph, [point(drives), point(drives + apart)])
    assert answer.error_code == code
    assert "points[1]" in answer.error_msg
