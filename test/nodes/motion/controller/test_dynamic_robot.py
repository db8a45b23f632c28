"""The simulated robot whose drives move it: it tracks, sags, saturates, stands, and tells."""

import re

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from drivers import NAME
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import Trigger

from robomech_interfaces.msg import ErrorCode
from robomech_ros.dynamics import gravity_torque, mass_matrix, with_payload
from robomech_ros.dynamics.simulation.controlled_arm import CONTROLS
from robomech_ros.errors import RobomechError
from robomech_ros.execution.controller.follower import Phase, TrajectoryFollower
from robomech_ros.execution.controller.simulated_joints import Faults, SimulatedJoints
from robomech_ros.execution.controller.trajectory_goal import End
from robomech_ros.execution.joints import Joints, at_rest
from robomech_ros.execution.motion_tolerances import Tolerances
from robomech_ros.nodes.common.parameters import table_rows
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.joint_trajectory_controller.dynamic_plant import (
    DynamicPlant,
    MotionRanAwayError,
)
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.joint_trajectory_controller.settings import ControllerSettings
from robomech_ros.outcomes import Code
from robomech_ros.robots import Body, load_robot
from robomech_ros.trajectory.waypoints import Waypoints

PUMA = load_robot("puma560")
HOME = PUMA.home()
MOVE = np.array([0.3, -0.2, 0.3, 0.2, -0.3, 0.3])
MASS, ARM, EFFORT, MOMENT = 2.0, 0.3, 7.0, 0.1
INERTIA = MOMENT + MASS * ARM**2


def rod(moment=MOMENT, effort=EFFORT):
    """Describe a rod that turns about y, level at 0, without friction."""
    return f"""<robot name="rod">
      <link name="base_link"/>
      <link name="rod">
        <inertial>
          <origin xyz="{ARM} 0 0"/><mass value="{MASS}"/>
          <inertia ixx="0.01" ixy="0" ixz="0" iyy="{moment}" iyz="0" izz="{MOMENT}"/>
        </inertial>
      </link>
      <link name="tool0"/>
      <joint name="hinge" type="revolute">
        <parent link="base_link"/><child link="rod"/><axis xyz="0 1 0"/>
        <limit lower="-3" upper="3" velocity="9" effort="{effort}"/>
      </joint>
      <joint name="flange" type="fixed">
        <parent link="rod"/><child link="tool0"/><origin xyz="0.6 0 0"/>
      </joint>
    </robot>"""


def set_payload(arm, mass):
    value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=mass)
    request = SetParameters.Request(parameters=[Parameter(name="payload_mass", value=value)])
    return arm.graph.call(SetParameters, f"{NAME}/set_parameters", request).results[0]


def until_still(arm):
    arm.until(lambda: np.abs(arm.velocity).max() < 1e-6)


def follower(chain=PUMA, position=HOME, **parameters):
    settings = ControllerSettings(simulation="dynamic", **parameters)
    plant = DynamicPlant(chain, settings, position)
    return TrajectoryFollower(Joints.of(chain), SimulatedJoints(position, plant=plant))


def start(robot, change, duration, ends):
    """Begin a quintic from rest to rest, at time 0, held to no path."""
    place = robot.desired.position
    still = np.zeros((2, len(place)))
    waypoints = Waypoints(
        np.array([0.0, duration]), np.array([place, place + change]), still, still
    )
    any_amount = np.full(len(place), np.inf)
    close = np.full(len(place), 0.01)
    robot.start(waypoints, Tolerances(any_amount, close, close, 1.0), 0.0, on_end=ends.append)


def cycles(robot, begin, end, period=0.01):
    """Let it move; gives errors of positions, and the positions, after each cycle."""
    errors, positions = [], []
    for time in np.arange(begin + period, end + 0.5 * period, period):
        robot.advance(time)
        positions.append(robot.actual.position)
        errors.append(robot.desired.position - robot.actual.position)
    return np.abs(errors), np.array(positions)


def test_it_holds_itself_and_its_efforts_are_published(drive):
    arm = drive(simulation="dynamic")
    arm.until(lambda: len(arm.states) > 20)
    np.testing.assert_allclose(arm.position, HOME, atol=1e-9)
    np.testing.assert_allclose(arm.states[-1].effort, gravity_torque(PUMA, HOME), atol=1e-6)
    # A busy machine may miss cycles, between which commands are interpolated.
    status, result = arm.execute(arm.trajectory((0.6, MOVE)), path_position_tolerance=[2e-2] * 6)
    assert (status, result.error_msg) == (GoalStatus.STATUS_SUCCEEDED, "")
    arm.until(lambda: np.abs(arm.position - HOME - MOVE).max() < 1e-3)
    until_still(arm)
    np.testing.assert_allclose(arm.position, HOME + MOVE, atol=1e-3)
    assert arm.graph.call(Trigger, f"{NAME}/reset", Trigger.Request()).success
    arm.until(lambda: np.abs(arm.position - HOME).max() < 1e-9 and not arm.velocity.any())


def test_no_efforts_without_forces(drive):
    arm = drive()
    assert len(arm.states[-1].effort) == 0
    answer = set_payload(arm, 2.0)
    assert not answer.successful
    assert answer.reason.endswith("'payload_mass' is 2.0; allowed is 0 with simulation: kinematic")


def test_a_payload_that_is_put_on_makes_it_sag(drive):
    arm = drive(
        robot_description=rod(), simulation="dynamic", initial_positions=[0.0], dynamic_observer=0.0
    )
    assert set_payload(arm, 0.1).successful
    arm.until(lambda: arm.position[0] > 1e-4)
    until_still(arm)
    # By the moment of the payload over the gain of the position: 0.6 m away, 0.1 kg.
    torque = 0.1 * 9.81 * 0.6 * np.cos(arm.position[0])
    assert arm.position[0] == pytest.approx(torque / (INERTIA * 50.0**2), rel=1e-4)
    weight = MASS * 9.81 * ARM * np.cos(arm.position[0])
    assert arm.states[-1].effort[0] == pytest.approx(-weight - torque, rel=1e-5)
    assert set_payload(arm, 0.0).successful
    arm.until(lambda: abs(arm.position[0]) < 1e-6)


def test_a_payload_is_observed_and_made_up_for(drive):
    arm = drive(robot_description=rod(), simulation="dynamic", initial_positions=[0.0])
    assert set_payload(arm, 0.1).successful
    carried = -(MASS * ARM + 0.1 * 0.6) * 9.81
    arm.until(lambda: abs(arm.states[-1].effort[0] - carried) < 1e-3)
    until_still(arm)
    assert abs(arm.position[0]) < 1e-6


@pytest.mark.slow
def test_saturation_is_told(drive):
    arm = drive(robot_description=rod(), simulation="dynamic", initial_positions=[0.0])
    # It weighs 5.9 N m there; its drive has 7 N m, and is asked for 9 and more.
    status, result = arm.execute(arm.trajectory((0.5, [-0.6])), path_position_tolerance=[1.0])
    assert status == GoalStatus.STATUS_SUCCEEDED, result.error_msg
    assert result.error_msg.startswith("joint 'hinge' was at its effort limit for 0.")
    said = arm.diagnosis(lambda status: "effort limit" in status.message)
    assert said.level == said.WARN
    values = {entry.key: entry.value for entry in said.values}
    assert values["at effort limits"].startswith("joint 'hinge' was at its effort limit for 0.")
    assert max(abs(state.effort[0]) for state in arm.states) == pytest.approx(EFFORT)
    status, result = arm.execute(arm.trajectory((0.5, [-0.9])), path_position_tolerance=[0.02])
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.PATH_TOLERANCE)
    told = (
        r"joint 'hinge' is 0\.\d+ rad off its path, .*; joint 'hinge' was at its effort limit for"
    )
    assert re.match(told, result.error_msg)
    until_still(arm)
    assert arm.execute(arm.trajectory((1.0, [0.1])))[1].error_msg == ""
    arm.diagnosis(lambda status: status.level == status.OK)


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("robot", ["puma560", "ur5e", "panda"])
def test_all_controllers_track_and_come_to_rest(robot, control):
    chain = load_robot(robot)
    moving, ends = follower(chain, chain.midrange(), dynamic_control=control), []
    start(moving, np.resize([0.3, -0.2, 0.3], chain.n), 1.0, ends)
    errors, _ = cycles(moving, 0.0, 3.0)
    assert (ends[0].end, ends[0].text) == (End.REACHED, "")
    assert errors.max() < {"computed-torque": 5e-5, "pd-gravity": 0.04}[control]
    # What friction holds back is the torque of an error that remains.
    assert errors[-1].max() < 1e-3
    assert np.abs(moving.actual.velocity).max() < 1e-4


@pytest.mark.parametrize(("observer", "least", "most"), [(0.0, 1e-4, 4e-3), (2000.0, 1e-6, 5e-4)])
def test_two_kilograms_cost_some_milliradians_whatever_the_rate(observer, least, most):
    for period in (0.001, 0.01, 0.037):
        load = {"payload_mass": 2.0, "payload_com": (0.0, 0.0, 0.1)}
        moving, ends = follower(dynamic_observer=observer, **load), []
        start(moving, 2.0 * MOVE, 1.0, ends)
        errors, _ = cycles(moving, 0.0, 1.5, period)
        assert ends[0].end is End.REACHED
        assert least < errors.max() < most


def test_damping_and_bandwidth():
    chain, ends = load_robot(rod(effort=0.0)), []
    for damping, overshoot in ((1.0, 0.0), (0.5, 0.163)):
        moving = follower(chain, np.zeros(1), dynamic_bandwidth=20.0, dynamic_damping=damping)
        moving.simulated_joints._plant.put(np.array([-0.1]))
        _, positions = cycles(moving, 0.0, 1.0)
        assert positions.max() / 0.1 == pytest.approx(overshoot, abs=0.02)
        assert abs(positions[-1, 0]) < 1e-4
    assert ends == []


def test_a_robot_that_is_halted_does_not_jump():
    moving, ends = follower(), []
    start(moving, MOVE, 1.0, ends)
    _, before = cycles(moving, 0.0, 0.5)
    moving.halt(Code.PREEMPTED, "enough")
    stood = moving.desired.position
    _, after = cycles(moving, 0.5, 1.0)
    assert (ends[0].text, moving.phase) == ("enough", Phase.HOLDING)
    np.testing.assert_array_equal(stood, before[-1])
    steps = np.abs(np.diff([*before, *after], axis=0)).max(axis=1)
    assert steps[49] > 0.5 * steps[48] > 1e-3
    # It overshoots and comes back, as far as friction lets it.
    assert np.abs(after[-1] - stood).max() < 5e-3
    assert np.abs(moving.actual.velocity).max() < 1e-6


def test_stuck_joints_and_commands_that_come_late():
    moving, ends = follower(), []
    stuck = np.arange(6) == 2
    moving.simulated_joints.inject(Faults(stuck=stuck, offset=np.zeros(6)))
    start(moving, MOVE, 0.5, ends)
    _, positions = cycles(moving, 0.0, 2.0)
    assert np.ptp(positions[:, 2]) == 0.0
    # The torques that should accelerate the elbow push the shoulder off.
    np.testing.assert_allclose(positions[-1], HOME + np.where(stuck, 0.0, MOVE), atol=0.1)
    assert "joint 'elbow' was at its effort limit for" in ends[0].text
    late, ends = follower(), []
    delayed = Faults(stuck=np.zeros(6, dtype=bool), offset=np.zeros(6), delay=0.1)
    late.simulated_joints.inject(delayed)
    start(late, MOVE, 1.0, ends)
    errors, _ = cycles(late, 0.0, 1.5)
    # A quintic's greatest speed is 15/8 of the mean one.
    assert errors.max() == pytest.approx(0.1 * 0.3 * 15.0 / 8.0, rel=0.05)
    assert ends[0].end is End.REACHED


def test_a_motion_that_runs_away_ends_where_it_was():
    # Without a limit of the velocity it is told to be wherever it is wanted.
    endless = rod(effort=0.0).replace("revolute", "continuous").replace('"9"', '"0"')
    chain = load_robot(endless)
    plant = DynamicPlant(chain, ControllerSettings(simulation="dynamic"), np.zeros(1))
    here, far = at_rest(np.zeros(1)), at_rest(np.full(1, 1e12))
    with pytest.raises(MotionRanAwayError, match=r"ran away .* stands where it was before"):
        plant.drive(far, far, 0.01, None)
    stands = plant.drive(here, here, 0.01, None).state
    np.testing.assert_allclose(stands.position, 0.0, atol=1e-9)


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("robot", ["puma560", "ur5e", "panda", "planar3r"])
def test_steps_between_the_limits_do_not_make_it_thrash(robot, control):
    chain = load_robot(robot)
    settings = ControllerSettings(simulation="dynamic", dynamic_control=control)
    low, high = np.maximum(chain.lower, -3.0), np.minimum(chain.upper, 3.0)
    random, home = np.random.default_rng(4), at_rest(chain.midrange())
    plant, command = DynamicPlant(chain, settings, home.position), home
    for _ in range(10):
        before, command = command, at_rest(random.uniform(low, high))
        done = plant.drive(before, command, 0.01, None)
        done = plant.drive(command, command, 0.2, random.random(chain.n) < 0.2)
        assert (done.state.position <= chain.upper + 1e-9).all()
        assert (done.state.position >= chain.lower - 1e-9).all()
        assert (np.abs(done.state.velocity) < 5.0 * chain.velocity).all()
    for _ in range(2):
        done = plant.drive(home, home, 4.0, None)
    np.testing.assert_allclose(done.state.position, home.position, atol=5e-3)


def test_after_a_pause_only_its_end_is_simulated():
    moving = follower()
    moving.advance(1e5)
    np.testing.assert_allclose(moving.actual.position, HOME, atol=1e-9)


def test_what_cannot_be_simulated_is_refused(graph):
    for robot, parameters, text in (
        ("irb120", {}, "no mass and inertia of links link_1, link_2, .* link_6"),
        (rod(moment=5.0), {}, "rod.* principal moments of inertia are"),
        ("puma560", {"tracking_lag": 0.1}, "'tracking_lag' is 0.1; allowed is 0 with simulation"),
        ("puma560", {"payload_com": [0.1]}, "'payload_com' is .* 3 numbers"),
        ("puma560", {"gravity": [0.1]}, "'gravity' is .* 3 numbers"),
        ("puma560", {"dynamic_control": "pid"}, "'dynamic_control' is 'pid'; allowed is one of"),
    ):
        given = {"simulation": "dynamic", "robot_description": robot, **parameters}
        with pytest.raises(RobomechError, match=text):
            graph.start(JointTrajectoryControllerNode, **given)


def test_a_robot_without_inertias_on_the_topic_is_not_taken(graph):
    graph.start(JointTrajectoryControllerNode, simulation="dynamic")
    sender = graph.client.create_publisher(String, "robot_description", LATCHED)
    bare = rod().replace("<inertial>", "<!--").replace("</inertial>", "-->")
    for text in (bare, rod()):
        sender.publish(String(data=text))
    state = graph.receive(JointState, "joint_states", 10, lambda state: True)
    assert list(state.name) == ["hinge"]


def test_the_table_names_the_controllers_that_there_are():
    rows = {row.name: row for row in table_rows(ControllerSettings)}
    assert rows["dynamic_control"].choices == CONTROLS


def test_the_payload_that_the_plant_carries_is_that_of_the_chain():
    load = Body(2.0, [0.0, 0.0, 0.1], np.zeros((3, 3)))
    loaded = with_payload(PUMA, load)
    settings = ControllerSettings(
        simulation="dynamic", payload_mass=2.0, payload_com=(0.0, 0.0, 0.1)
    )
    held = DynamicPlant(PUMA, settings, HOME).put(HOME)
    np.testing.assert_allclose(held.effort, gravity_torque(loaded, HOME), atol=1e-12)
    assert np.abs(mass_matrix(loaded, HOME) - mass_matrix(PUMA, HOME)).max() > 0.1
