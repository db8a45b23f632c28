"""Nodes that are killed without warning, and what the next process makes of it."""

import signal

import numpy as np
import pytest
from drivers import ROBOT, Driver, Suite
from rclpy.time import Time
from servo_operator import START, Operator

from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode

MOVE = np.full(6, 0.4)
TIMEOUT = 30.0


def kill(process):
    process.kill()
    process.wait(TIMEOUT)


def limits_kept(arm):
    """Whether no joint went farther from one state to the next than its speed allows."""
    times, positions, _ = arm.path()
    way = np.abs(np.diff(positions, axis=0))
    return bool((way <= arm.chain.velocity * np.diff(times)[:, None] + 1e-6).all())


def states_since(arm, instant):
    """Wait for states with later stamps than this, of who lives on; gives them, at least some."""

    def found():
        return [s for s in arm.states if Time.from_msg(s.header.stamp) > instant]

    arm.until(lambda: len(found()) > 20)
    return found()


@pytest.mark.slow
@pytest.mark.parametrize("given", [{}, {"initial_positions": START}])
def test_a_killed_controller_begins_anew(drive_process, process, graph, given):
    arm, controller = drive_process
    home = arm.position
    arm.publish(arm.trajectory((2.0, MOVE)))
    arm.until(lambda: arm.position[0] - home[0] > 0.1)
    kill(controller)
    killed = graph.client.get_clock().now()
    process(JointTrajectoryControllerNode, robot_description=ROBOT, **given)
    begin = given.get("initial_positions", home)
    first = states_since(arm, killed)[0]
    np.testing.assert_allclose(first.position, begin, atol=1e-12)
    assert not any(first.velocity)
    arm.publish(arm.trajectory((0.5, -MOVE)))
    arm.until_at(begin - MOVE)


@pytest.mark.slow
def test_a_motion_outlives_its_killed_publisher(graph, process):
    arm = Suite(graph, start=process)
    arm.start_execute(arm.trajectory(0.0, MOVE, duration=2.0))
    arm.until_moving()
    kill(arm.node)
    process(TrajectoryPublisherNode)
    arm.until_at(arm.home + MOVE)
    arm.condition()
    assert arm.execute(arm.trajectory(MOVE, MOVE + 0.05)).error_code == 0


@pytest.mark.slow
def test_a_motion_from_home_while_the_controller_starts_again_there(graph, process):
    """Joint states of the previous process do not count: it was elsewhere."""
    arm = Suite(graph, with_controller=False, controller_timeout=TIMEOUT)
    controller = process(JointTrajectoryControllerNode, robot_description=ROBOT)
    assert arm.execute(arm.trajectory(0.0, MOVE, duration=1.0)).error_code == 0
    controller.send_signal(signal.SIGTERM)
    assert controller.wait(TIMEOUT) == 0
    waiting = arm.start_execute(arm.trajectory(0.0, 0.5 * MOVE, duration=1.0))
    process(JointTrajectoryControllerNode, robot_description=ROBOT)
    answer = graph.wait_for(waiting)
    assert (answer.error_code, answer.error_msg) == (0, "")
    arm.until_at(arm.home + 0.5 * MOVE)


@pytest.mark.slow
@pytest.mark.parametrize("speed", [0.5, 1.5])
def test_a_servo_that_was_killed_in_full_motion(graph, process, speed):
    """The robot brakes by the plan in the last message, within its limits."""
    children = []

    def start(node, **parameters):
        children.append(process(node, **parameters))

    arm = Driver(graph, graph.start, initial_positions=START)
    hand = Operator(arm, graph, start=start)
    hand.repeat(hand.speeds(["waist"], [speed]), lambda: arm.velocity[0] > 0.95 * speed)
    kill(children[0])
    killed = len(arm.states)
    arm.until(lambda: not arm.velocity.any())
    times, position, velocity = arm.path(killed)
    limit = arm.chain.acceleration[0]
    rates = np.diff(velocity[:, 0]) / np.diff(times)
    assert np.abs(rates).max() <= limit * (1.0 + 1e-6)
    assert limits_kept(arm)
    # It ends where the plan in the last message does, and no later.
    last = hand.streamed[-1][1].points[-1]
    np.testing.assert_allclose(arm.position, last.positions, atol=1e-6)
    took, lasts = times[-1], last.time_from_start.nanosec * 1e-9
    assert took < lasts + 1.0
    assert position[-1, 0] - position[0, 0] < speed * took
