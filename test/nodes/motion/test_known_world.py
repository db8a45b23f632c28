"""The servo and the trajectory publisher know what stands around the robot."""

import numpy as np
import pytest
from move_group_client import HERE, THERE, UR5E, Client, box
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from servo_operator import Operator
from shaped_arm import shaped_ur5e

from robomech_interfaces.msg import ServoStatus
from robomech_interfaces.srv import Execute
from robomech_ros.collision import Box, PlanningScene
from robomech_ros.nodes.common.messages.joint_messages import joint_trajectory
from robomech_ros.nodes.move_group.node import MoveGroupNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode
from robomech_ros.outcomes import Code

ROBOT = {"robot_description": shaped_ur5e()}
SIZES, PLACE = (0.6, 0.02, 0.8), (0.55, 0.0, 0.4)
PAN = ["shoulder_pan_joint"]


@pytest.fixture
def world(graph):
    graph.start(MoveGroupNode, assume_limits=True, state_timeout=20.0, **ROBOT)
    return Client(graph)


@pytest.fixture
def robot(drive):
    return drive(initial_positions=HERE.tolist(), **ROBOT)


@pytest.fixture
def scene():
    """The same wall as the library has it."""
    scene, pose = PlanningScene(UR5E), np.eye(4)
    pose[:3, 3] = PLACE
    scene.add("wall", Box(*SIZES), pose)
    return scene


def slowly(start, goal, seconds):
    """Return a trajectory of a few points, between which the controller interpolates."""
    times = np.linspace(0.0, seconds, 5)
    turn, way = np.pi * times[:, None] / seconds, np.asarray(goal) - start
    rows = 0.5 - 0.5 * np.cos(turn), 0.5 * np.sin(turn), 0.5 * np.cos(turn)
    rates = [(np.pi / seconds) ** k * row * way for k, row in enumerate(rows)]
    return joint_trajectory(list(UR5E.joint_names), times, start + rates[0], *rates[1:])


def test_the_servo_stops_before_a_wall_and_leaves_it(world, robot, scene, graph):
    hand = Operator(robot, graph, characteristic_length=0.264, **ROBOT)
    assert world.apply(box("wall", SIZES, PLACE))
    halt = ServoStatus.HALT_FOR_COLLISION
    hand.repeat(hand.speeds(PAN, [-0.8]), lambda: hand.has_code(halt, "'wall', 0.00"))
    hand.until_still()
    found = scene.clearance(robot.position)
    assert 0.0009 < found.distance < 0.005 and "wall" in found.bodies
    here = robot.position[0]
    hand.repeat(hand.speeds(PAN, [0.8]), lambda: robot.position[0] > here + 0.2)
    # A request that ignores the scene is executed.
    value = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=False)
    change = Parameter(name="check_collisions", value=value)
    request = SetParameters.Request(parameters=[change])
    assert graph.call(SetParameters, "servo/set_parameters", request).results[0].successful
    hand.repeat(hand.speeds(PAN, [-0.8]), lambda: not scene.is_free(robot.position))


def test_what_is_executed_ends_before_a_wall_that_comes_into_the_way(world, robot, scene, graph):
    graph.start(TrajectoryPublisherNode, **ROBOT)

    def execute(trajectory, **fields):
        request = Execute.Request(trajectory=trajectory, **fields)
        return graph.call(Execute, "trajectory_publisher/execute", request)

    client = graph.client.create_client(Execute, "trajectory_publisher/execute")
    assert client.wait_for_service(30.0)
    sent = client.call_async(Execute.Request(trajectory=slowly(HERE, THERE, 12.0)))
    robot.until(lambda: robot.position[0] < HERE[0] - 0.05)
    assert world.apply(box("wall", SIZES, PLACE))
    answer = graph.wait_for(sent)
    assert answer.error_code == Code.COLLISION, answer
    assert "stopped on its path" in answer.error_msg and "'wall'" in answer.error_msg
    robot.until(lambda: not robot.velocity.any())
    here = robot.position
    assert scene.is_free(here)
    # The rest is not sent any more, unless the world is to be ignored.
    through = slowly(here, THERE, 2.0)
    answer = execute(through)
    assert answer.error_code == Code.COLLISION and "not sent" in answer.error_msg
    assert "'wall'" in answer.error_msg and "m deep" in answer.error_msg
    assert not answer.duration.nanosec and np.array_equal(robot.position, here)
    # A contact may be left, and not deepened.
    turned = np.repeat(here[None], 100, axis=0)
    turned[:, 0] -= np.linspace(0.0, 1.0, 100)
    touching = turned[int(np.argmin(scene.is_free(turned)))]
    answer = execute(slowly(here, touching, 1.0), ignore_collisions=True)
    assert answer.error_code == Code.NONE, answer
    answer = execute(slowly(robot.position, THERE, 1.0))
    assert answer.error_code == Code.COLLISION and "not sent" in answer.error_msg
    answer = execute(slowly(robot.position, HERE, 1.0))
    assert answer.error_code == Code.NONE, answer
