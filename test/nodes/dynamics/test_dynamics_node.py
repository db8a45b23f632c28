"""The dynamics node against closed forms of a swinging rod, and what it refuses."""

import math

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Inertia, InertiaStamped, Vector3, WrenchStamped
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
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
from robomech_ros.nodes.dynamics.node import DynamicsNode

G, MASS, LENGTH, MOMENT = 9.81, 2.0, 0.6, 0.1
INERTIA = MOMENT + MASS * (LENGTH / 2.0) ** 2

# A rod that turns about y, hanging down at q = pi / 2, its length along x.
ROD = f"""<robot name="rod">
  <link name="base_link"/>
  <link name="rod">
    <inertial>
      <origin xyz="{LENGTH / 2.0} 0 0"/>
      <mass value="{MASS}"/>
      <inertia ixx="{MOMENT / 10.0}" ixy="0" ixz="0" iyy="{MOMENT}" iyz="0" izz="{MOMENT}"/>
    </inertial>
  </link>
  <link name="tool0"/>
  <joint name="hinge" type="revolute">
    <parent link="base_link"/><child link="rod"/>
    <axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" velocity="2" effort="7"/>
  </joint>
  <joint name="flange" type="fixed">
    <parent link="rod"/><child link="tool0"/><origin xyz="{LENGTH} 0 0"/>
  </joint>
</robot>"""


def weight(q, mass=MASS, arm=LENGTH / 2.0):
    """Torque about y that holds a mass on an arm against gravity."""
    return -mass * G * arm * math.cos(q)


@pytest.fixture
def rod(graph):
    graph.start(DynamicsNode, robot_description=ROD, state_timeout=0.1)
    return graph


def inverse(graph, points, **fields):
    return graph.ask(InverseDynamics, "dynamics/inverse_dynamics", points=points, **fields)


def point(q, qd=None, qdd=None, t=0.0):
    message = JointTrajectoryPoint(positions=[q])
    message.velocities = [] if qd is None else [qd]
    message.accelerations = [] if qdd is None else [qdd]
    message.time_from_start = Duration(sec=int(t), nanosec=round(t % 1.0 * 1e9))
    return message


def test_efforts_and_their_shares(rod):
    answer = inverse(rod, [point(0.3), point(-0.8, 1.5, 2.0)])
    assert answer.error_code == ErrorCode.NONE, answer.error_msg
    gravity = [weight(0.3), weight(-0.8)]
    np.testing.assert_allclose(answer.gravity, gravity, rtol=1e-12)
    np.testing.assert_allclose(answer.inertial, [0.0, 2.0 * INERTIA], rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(answer.coriolis, [0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(answer.effort, np.add(gravity, answer.inertial), rtol=1e-12)


def test_another_gravity_and_a_wrench_on_the_tip(rod):
    sideways = inverse(rod, [point(0.3)], gravity=Vector3(x=-G))
    np.testing.assert_allclose(sideways.gravity, [-MASS * G * 0.3 * math.sin(0.3)], rtol=1e-12)
    # Surroundings that carry half the weight's moment, by a force at the tip along the base's z.
    wrench = WrenchStamped()
    wrench.wrench.force.z = MASS * G / 4.0
    answer = inverse(rod, [point(0.3)], tip_wrench=wrench)
    np.testing.assert_allclose(answer.effort, [weight(0.3) / 2.0], rtol=1e-12)
    # The same force in the axes of the tip.
    wrench.header.frame_id = "tool0"
    wrench.wrench.force.x = -MASS * G / 4.0 * math.sin(0.3)
    wrench.wrench.force.z = MASS * G / 4.0 * math.cos(0.3)
    answer = inverse(rod, [point(0.3)], tip_wrench=wrench)
    np.testing.assert_allclose(answer.effort, [weight(0.3) / 2.0], rtol=1e-12)


def test_accelerations_and_inertia(rod):
    state = JointState(name=["hinge"], position=[0.3], velocity=[1.0], effort=[4.0])
    answer = rod.ask(ForwardDynamics, "dynamics/forward_dynamics", state=state)
    assert (answer.error_code, answer.joint_names) == (0, ["hinge"])
    np.testing.assert_allclose(answer.acceleration, [(4.0 - weight(0.3)) / INERTIA], rtol=1e-12)
    answer = rod.ask(MassMatrix, "dynamics/mass_matrix", state=state)
    np.testing.assert_allclose(answer.mass_matrix, [INERTIA], rtol=1e-12)
    late = rod.ask(MassMatrix, "dynamics/mass_matrix")
    assert late.error_code == ErrorCode.NO_STATE
    assert "hinge" in late.error_msg


def test_efforts_with_names_act_on_the_present_posture(rod):
    sender = rod.client.create_publisher(JointState, "joint_states", 10)
    push = JointState(name=["hinge"], effort=[4.0])
    request = ForwardDynamics.Request(state=push)

    def known(answer):
        sender.publish(JointState(name=["hinge"], position=[0.3]))
        return answer.error_code != ErrorCode.NO_STATE

    answer = rod.call_until(ForwardDynamics, "dynamics/forward_dynamics", request, known)
    assert answer.error_code == ErrorCode.NONE, answer.error_msg
    np.testing.assert_allclose(answer.acceleration, [(4.0 - weight(0.3)) / INERTIA], rtol=1e-12)
    present = rod.ask(MassMatrix, "dynamics/mass_matrix")
    np.testing.assert_allclose(present.mass_matrix, [INERTIA], rtol=1e-12)


def test_names_without_any_numbers_are_refused(rod):
    """They were passed over, and the present state taken instead."""
    for kind, service in ((MassMatrix, "mass_matrix"), (ForwardDynamics, "forward_dynamics")):
        answer = rod.ask(kind, f"dynamics/{service}", state=JointState(name=["hinge"]))
        assert answer.error_code == ErrorCode.WRONG_SIZE
        assert "state.position has size 0, expected 1, one for every name" in answer.error_msg


def test_a_gravity_of_another_size_is_refused_when_it_is_set(rod):
    value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE_ARRAY, double_array_value=[0.0, 9.0])
    request = SetParameters.Request(parameters=[Parameter(name="gravity", value=value)])
    result = rod.call(SetParameters, "dynamics/set_parameters", request).results[0]
    assert not result.successful
    assert "'gravity' is [0.0, 9.0]; allowed is a list of 3 numbers" in result.reason
    assert inverse(rod, [point(0.3)]).gravity[0] == pytest.approx(weight(0.3))


def payload(graph, frame="", **inertia):
    load = InertiaStamped(inertia=Inertia(**inertia))
    load.header.frame_id = frame
    return graph.ask(SetPayload, "dynamics/set_payload", payload=load)


def test_a_payload_is_put_on_and_taken_off(rod):
    assert payload(rod, m=1.0, ixx=0.01, iyy=0.01, izz=0.01).error_code == ErrorCode.NONE
    loaded = inverse(rod, [point(0.3)]).effort[0]
    assert loaded == pytest.approx(weight(0.3) + weight(0.3, 1.0, LENGTH), rel=1e-12)
    assert payload(rod, "rod", m=1.0, com=Vector3(x=0.2)).error_code == ErrorCode.NONE
    moved = inverse(rod, [point(0.3)]).effort[0]
    assert moved == pytest.approx(weight(0.3) + weight(0.3, 1.0, 0.2), rel=1e-12)
    assert payload(rod).error_code == ErrorCode.NONE
    assert inverse(rod, [point(0.3)]).effort[0] == pytest.approx(weight(0.3), rel=1e-12)


def test_a_summary_tells_peaks_energy_and_saturation(rod):
    # Lifted from hanging to level in 1 s, from rest to rest: the energy is the height's.
    points = [point(math.pi / 2.0, 0.0, 0.0), point(0.0, 0.0, 0.0, 1.0)]
    trajectory = JointTrajectory(joint_names=["hinge"], points=points)
    answer = rod.ask(SummarizeTorques, "dynamics/summarize_torques", trajectory=trajectory)
    assert answer.error_code == ErrorCode.NONE, answer.error_msg
    net = answer.energy_out[0] - answer.energy_back[0]
    assert net == pytest.approx(MASS * G * LENGTH / 2.0, rel=1e-5)
    assert answer.effort_limit[0] == 7.0
    assert answer.saturation[0] == pytest.approx(answer.peak_effort[0] / 7.0)
    # It is slowed down at the top, where the weight has its longest arm.
    when = answer.peak_effort_time[0].sec + answer.peak_effort_time[0].nanosec * 1e-9
    assert when == 1.0
    assert (answer.saturated_joints == ["hinge"]) == (answer.saturation[0] > 1.0)
    assert "'hinge'" in answer.summary
    limp = SummarizeTorques.Request(trajectory=trajectory, gravity=Vector3(z=-1e-3))
    easy = rod.call(SummarizeTorques, "dynamics/summarize_torques", limp)
    assert (easy.saturated_joints, easy.error_code) == ([], 0)
    assert "within all effort limits" in easy.summary
    held = [point(0.0, 0.0, 0.0), point(0.0, 0.0, 0.0, 1.0)]
    for part, named in ((0.9, []), (1.1, ["hinge"])):
        gravity = Vector3(z=-G * part * 7.0 / abs(weight(0.0)))
        still = JointTrajectory(joint_names=["hinge"], points=held)
        request = SummarizeTorques.Request(trajectory=still, gravity=gravity)
        found = rod.call(SummarizeTorques, "dynamics/summarize_torques", request)
        assert found.saturation[0] == pytest.approx(part) and found.saturated_joints == named


REFUSALS = {
    "not a number": ({"points": [point(math.nan)]}, ErrorCode.NON_FINITE, "points[0].positions"),
    "too many numbers": (
        {"points": [JointTrajectoryPoint(positions=[0.0, 1.0])]},
        ErrorCode.WRONG_SIZE,
        "points[0].positions has size 2",
    ),
    "no positions": (
        {"points": [JointTrajectoryPoint(velocities=[1.0])]},
        ErrorCode.WRONG_SIZE,
        "points[0].positions",
    ),
    "unknown joint": (
        {"points": [point(0.0)], "joint_names": ["elbow"]},
        ErrorCode.UNKNOWN_JOINT,
        "unknown joint 'elbow'",
    ),
    "infinite gravity": (
        {"points": [point(0.0)], "gravity": Vector3(z=-math.inf)},
        ErrorCode.NON_FINITE,
        "gravity",
    ),
    "huge gravity": (
        {"points": [point(0.0)], "gravity": Vector3(z=-1e308)},
        ErrorCode.BAD_VALUE,
        "gravity is [0.0, 0.0, -1e+308], expected magnitudes of at most",
    ),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_refusals_of_inverse_dynamics(rod, case):
    fields, code, words = REFUSALS[case]
    answer = inverse(rod, fields.pop("points"), **fields)
    assert answer.error_code == code, answer.error_msg
    assert words in answer.error_msg
    assert inverse(rod, [point(0.0)]).error_code == ErrorCode.NONE


def test_refusals_of_payloads_and_wrenches(rod):
    wrench = WrenchStamped()
    wrench.header.frame_id = "camera"
    answer = inverse(rod, [point(0.0)], tip_wrench=wrench)
    assert (answer.error_code, "camera" in answer.error_msg) == (ErrorCode.FRAME_UNAVAILABLE, True)
    answer = payload(rod, m=-1.0)
    assert (answer.error_code, "payload.inertia.m is -1.0" in answer.error_msg) == (109, True)
    for load in ({"m": math.nan}, {"m": 1.0, "ixx": math.inf}):
        answer = payload(rod, **load)
        assert (answer.error_code, "payload.inertia" in answer.error_msg) == (104, True)
    answer = payload(rod, "base_link", m=1.0)
    assert (answer.error_code, "one of rod, tool0" in answer.error_msg) == (109, True)
    answer = payload(rod, "camera", m=1.0)
    assert answer.error_code == ErrorCode.UNKNOWN_LINK
    answer = payload(rod, m=1.0, ixx=5.0, iyy=1.0, izz=1.0)
    assert (answer.error_code, "at most the sum of the others" in answer.error_msg) == (109, True)
    # Nothing of that was put on.
    assert inverse(rod, [point(0.3)]).effort[0] == pytest.approx(weight(0.3), rel=1e-12)


def test_a_robot_without_masses_is_told(graph):
    bare = "".join(part.split("</inertial>")[-1] for part in ROD.split("<inertial>"))
    graph.start(DynamicsNode, robot_description=bare)
    for response in (inverse(graph, [point(0.0)]), payload(graph, m=1.0)):
        assert response.error_code == ErrorCode.MISSING_INERTIA
        assert "hinge" in response.error_msg


def test_impossible_numbers_are_refused_where_they_are_used(graph):
    heavy = ROD.replace(f'iyy="{MOMENT}"', 'iyy="3.0"')
    graph.start(DynamicsNode, robot_description=heavy)
    answer = inverse(graph, [point(0.0)])
    assert answer.error_code == ErrorCode.BAD_VALUE
    assert "body of rod and tool0" in answer.error_msg
    assert "at most the sum of the others" in answer.error_msg


@pytest.mark.parametrize("names", [[], ["hinge"]])
def test_a_request_without_points_is_about_the_present_state_at_rest(rod, names):
    late = inverse(rod, [], joint_names=names)
    assert late.error_code == ErrorCode.NO_STATE
    publisher = rod.client.create_publisher(JointState, "joint_states", 10)
    there = JointState(name=["hinge"], position=[0.3], velocity=[1.0])

    def answered(answer):
        publisher.publish(there)
        return answer.error_code == 0

    request = InverseDynamics.Request(joint_names=names)
    answer = rod.call_until(InverseDynamics, "dynamics/inverse_dynamics", request, answered)
    np.testing.assert_allclose(answer.effort, [weight(0.3)], rtol=1e-12)
    np.testing.assert_allclose(answer.coriolis, [0.0], atol=1e-12)
    wrong = inverse(rod, [], joint_names=["knee"])
    assert wrong.error_code == ErrorCode.UNKNOWN_JOINT, wrong.error_msg
