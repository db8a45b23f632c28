"""Parallel robots as nodes get them: by parameter, by topic, or refused."""

import argparse

import numpy as np
import pytest
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import Trigger

from robomech_interfaces.srv import SolveFK
from robomech_ros.cli.kind_options import OptionRefusedError
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.nodes.commands import bringup
from robomech_ros.nodes.common.joints.closed_loop_positions import ClosedLoopPositions
from robomech_ros.nodes.common.messages.error_codes import OutcomeError, code_of
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.common.robot.robot_description import LATCHED, RobotModel, RobotSettings
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.servo.node import ServoNode
from robomech_ros.outcomes import Code
from robomech_ros.parallel import load_parallel, load_tree_description


@pytest.fixture(scope="module")
def delta():
    return load_parallel("delta").mechanism


def model_of(name, **settings):
    robot = load_tree_description(name)
    return RobotModel(robot.description, RobotSettings(**settings), robot=robot.robot)


def test_model_of_a_parallel_robot(delta):
    model = model_of("delta")
    assert model.mechanism.joint_names == model.joint_names == delta.joint_names
    assert (model.chain.base, model.chain.tip) == ("base_link", "platform")
    assert model.commanded.joint_names == delta.actuated
    assert np.isfinite(model.commanded.velocity).all()
    assert model.chain_to("leg2_arm").joint_names == ("leg2_base",)


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"base_link": "base_link", "tip_link": "leg1_arm"}, "'platform' or empty"),
        ({"base_link": "leg1_arm"}, "'base_link' or empty"),
        ({"group": "arm"}, "all limbs of 'delta' move"),
    ],
)
def test_ends_that_are_not_those_of_all_limbs(settings, text):
    with pytest.raises(BadValueError, match=text):
        model_of("delta", **settings)


def test_postures_are_read_whole_or_completed_from_the_drives(delta):
    reader, home = ClosedLoopPositions(delta), delta.home()
    drives = home[delta.drive_index]
    np.testing.assert_array_equal(reader.read(JointState(name=["home"]), "seed"), home)
    for state in (joint_state(delta.actuated, drives), JointState(position=drives.tolist())):
        assert reader.gives_drives(state)
        np.testing.assert_allclose(reader.read(state, "seed", home), home, atol=1e-9)
        np.testing.assert_allclose(reader.read(state, "seed"), home, atol=1e-9)
    whole = joint_state(delta.joint_names[::-1], home[::-1])
    assert not reader.gives_drives(whole)
    np.testing.assert_array_equal(reader.read(whole, "seed"), home)
    # Six digits are enough: the loops are closed to rounding.
    q = reader.read(joint_state(delta.joint_names, home.round(6)), "seed")
    assert delta.loop_errors(q).max() < 1e-12


def test_postures_that_cannot_be_read(delta):
    reader, home = ClosedLoopPositions(delta), delta.home()
    with pytest.raises(WrongSizeError, match="3, of the drives, or 15, of all joints"):
        reader.read(JointState(position=[0.0] * 4), "seed")
    with pytest.raises(NonFiniteError, match="leg2_base"):
        reader.read(JointState(position=[0.0, float("nan"), 0.0]), "seed")
    with pytest.raises(WrongSizeError, match="missing: leg3_base"):
        reader.read(joint_state(delta.actuated[:2], home[:2]), "seed")
    broken = home.copy()
    broken[-1] += 0.1
    with pytest.raises(BadValueError, match="limb 3 ends"):
        reader.read(joint_state(delta.joint_names, broken), "seed")


def test_drives_that_hold_the_platform_nowhere_are_an_outcome():
    mechanism = load_parallel("planar_3rpr").mechanism
    with pytest.raises(OutcomeError) as caught:
        ClosedLoopPositions(mechanism).read(JointState(position=[0.01, 0.01, 5.0]), "seed")
    assert code_of(caught.value) == Code.OUT_OF_REACH


def test_a_node_gets_the_loops_by_the_topic(graph, delta):
    graph.start(KinematicsNode)
    publisher = graph.client.create_publisher(String, "robot_description", LATCHED)
    publisher.publish(String(data=load_tree_description("delta").description.document))
    drives = delta.home()[delta.drive_index]
    request = SolveFK.Request(states=[joint_state(delta.actuated, drives)])
    response = graph.call(SolveFK, "kinematics/solve_fk", request)
    assert response.error_code == 0, response.error_msg
    assert len(response.poses) == 2
    first = matrix_from_pose(response.poses[0].pose)
    np.testing.assert_allclose(first, delta.pose(delta.home()), atol=1e-9)


def test_the_servo_refuses_parallel_robots_by_parameter_and_by_topic(graph):
    with pytest.raises(BadValueError, match="'servo' serves no parallel robots"):
        graph.start(ServoNode, robot_description="hexapod")
    graph.start(ServoNode)
    publisher = graph.client.create_publisher(String, "robot_description", LATCHED)
    publisher.publish(String(data=load_tree_description("hexapod").description.document))
    part = "'servo' serves no parallel robots"
    request = Trigger.Request()
    answer = graph.call_until(Trigger, "servo/ready", request, lambda said: part in said.message)
    assert not answer.success


@pytest.mark.parametrize(
    ("option", "value"),
    [("--group", "arm"), ("--srdf", "delta.srdf"), ("--joint-limits", "limits.yaml")],
)
def test_bringup_refuses_options_of_chains(option, value):
    parser = argparse.ArgumentParser()
    bringup.add_arguments(parser)
    args = parser.parse_args(["--robot", "delta", option, value])
    with pytest.raises(OptionRefusedError, match=f"{option} does not apply to 'delta', a parallel"):
        bringup.run(args)
