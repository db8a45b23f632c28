"""Simulated parallel robots whose drives move them: they track, sag, stop, and tell."""

import re

import numpy as np
import pytest
import yaml
from action_msgs.msg import GoalStatus
from drivers import NAME, seconds
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from std_srvs.srv import Trigger

from robomech_interfaces.msg import ErrorCode
from robomech_ros.errors import MissingInertiaError
from robomech_ros.nodes.joint_trajectory_controller.dynamic_plant import DynamicPlant
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.joint_trajectory_controller.settings import ControllerSettings
from robomech_ros.parallel import ParallelDynamics, load_parallel
from robomech_ros.robots import Body
from robomech_ros.robots.robot_kinds import documents_of

CLOSED = 1e-10


def test_it_holds_itself_moves_and_publishes_efforts_with_all_loops_closed(platform, graph):
    robot = platform("hexapod", simulation="dynamic")
    mechanism = robot.mechanism
    drives, home = mechanism.drive_index, robot.position
    holding = ParallelDynamics(mechanism).gravity(mechanism.home())
    robot.until(lambda: len(robot.states) > 20)
    efforts = np.array(robot.states[-1].effort)
    np.testing.assert_allclose(efforts[drives], holding, rtol=1e-6)
    assert np.isnan(np.delete(efforts, drives)).all()
    change = 0.02 * np.linspace(0.5, 1.0, 6)
    status, result = robot.execute(robot.move((1.0, change)), path_position_tolerance=[2e-2] * 6)
    assert (status, result.error_msg) == (GoalStatus.STATUS_SUCCEEDED, "")
    robot.until(lambda: np.abs(robot.drives - home[drives] - change).max() < 1e-5)
    _, positions, velocities = robot.path()
    assert mechanism.loop_errors(positions).max() < CLOSED
    expected, _ = mechanism.rates(positions, velocities[:, drives])
    np.testing.assert_allclose(velocities, expected, atol=1e-9)
    assert graph.call(Trigger, f"{NAME}/reset", Trigger.Request()).success
    robot.until(lambda: np.abs(robot.position - home).max() < 1e-9 and not robot.velocity.any())


def test_a_payload_on_the_platform_is_held_where_the_observer_is_off(platform, graph):
    robot = platform("delta", simulation="dynamic", dynamic_observer=0.0)
    home = robot.drives
    value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=0.5)
    request = SetParameters.Request(parameters=[Parameter(name="payload_mass", value=value)])
    answer = graph.call(SetParameters, f"{NAME}/set_parameters", request)
    assert answer.results[0].successful, answer.results[0].reason
    robot.until(lambda: np.abs(robot.drives - home).max() > 1e-4)
    robot.until(lambda: np.abs(robot.velocity).max() < 1e-9)
    loaded = ParallelDynamics(robot.mechanism).with_payload(Body(0.5, [0, 0, 0], np.zeros((3, 3))))
    efforts = np.array(robot.states[-1].effort)[robot.mechanism.drive_index]
    # Friction of the drives holds a part.
    off = np.abs(efforts - loaded.gravity(robot.position))
    assert (off <= robot.mechanism.limbs[0].chain.drives[0].coulomb + 1e-6).all()
    assert robot.mechanism.loop_errors(robot.position).max() < CLOSED


def test_the_end_of_an_assembly_mode_stops_it(platform):
    # With all drives the way is regular; with the first one stuck a singular posture is in it.
    change = np.array([-1.0195, 1.6647, -0.4024])
    robot = platform("planar_3rrr", simulation="dynamic", fault_stuck_joints="leg1_base")
    mechanism, home = robot.mechanism, robot.position
    assert mechanism.close(robot.drives + change * [0.0, 1.0, 1.0], home).status
    _, result = robot.execute(robot.move((3.0, change)), goal_time_tolerance=seconds(20.0))
    assert result.error_code == ErrorCode.SINGULAR, result.error_msg
    assert "stopped before a singular posture" in result.error_msg
    _, positions, _ = robot.path()
    assert mechanism.loop_errors(positions).max() < CLOSED
    assert np.abs(positions[-1] - home).max() > 0.01
    assert np.ptp(positions[:, mechanism.drive_index[0]]) < 1e-9


def test_what_would_cross_a_singularity_is_refused(platform):
    robot = platform("planar_3rrr", simulation="dynamic")
    mechanism, home = robot.mechanism, robot.position
    change = np.array([0.0, 1.6647, -0.4024])
    assert mechanism.close(robot.drives + change, home).status
    _, result = robot.execute(robot.move((3.0, change)))
    assert result.error_code == ErrorCode.SINGULAR
    assert re.search(r"after points\[0\] of 1.*singular", result.error_msg)


def test_a_robot_without_bodies_is_refused(graph, tmp_path):
    document = yaml.safe_load(documents_of("parallel")["planar_3rrr"].read_text())
    del document["bodies"]
    path = tmp_path / "bare.yaml"
    path.write_text(yaml.safe_dump(document))
    given = {"robot_description": str(path), "simulation": "dynamic"}
    with pytest.raises(MissingInertiaError, match="no mass and inertia of links platform"):
        graph.start(JointTrajectoryControllerNode, **given)


def test_joints_are_put_where_the_drives_are_in_the_mode_that_is_assumed():
    robot = load_parallel("planar_3rrr").mechanism
    plant = DynamicPlant(
        ParallelDynamics(robot), ControllerSettings(simulation="dynamic"), robot.home()
    )
    drives = robot.home()[robot.drive_index]
    modes = robot.direct(drives).q
    assert len(modes) > 1
    for mode in modes:
        plant.assume(mode)
        effort = plant.put(drives).effort
        np.testing.assert_allclose(effort, ParallelDynamics(robot).gravity(mode), atol=1e-9)
