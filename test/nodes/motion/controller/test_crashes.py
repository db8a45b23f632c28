"""Nodes that are killed without warning, and what the next process makes of it."""

import signal
import threading

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from drivers import NAME, ROBOT, Driver, Suite
from rclpy.time import Time
from servo_operator import START, Operator
from std_srvs.srv import Trigger

from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.trajectory_publisher.node import TrajectoryPublisherNode

MOVE = np.full(6, 0.4)
TIMEOUT = 30.0


def kill(process):
    process.kill()
    process.wait(TIMEOUT)


def said_by(process):
    """Collect the lines that a process writes to stderr."""
    lines = []
    threading.Thread(target=lambda: lines.extend(process.stderr), daemon=True).start()
    return lines


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
def test_a_controller_that_was_killed_comes_back_where_it_was(drive_process, process, graph):
    arm, controller = drive_process
    home = arm.position
    arm.publish(arm.trajectory((2.0, MOVE)))
    arm.until(lambda: arm.position[0] - home[0] > 0.1)
    kill(controller)
    killed = graph.client.get_clock().now()
    again = process(JointTrajectoryControllerNode, robot_description=ROBOT)
    lines = said_by(again)
    after = states_since(arm, killed)
    before = [s for s in arm.states if Time.from_msg(s.header.stamp) <= killed][-1]
    assert limits_kept(arm)
    # The last state of all may not have got out.
    np.testing.assert_allclose(after[0].position, before.position, atol=0.02)
    assert not any(any(state.velocity) for state in after)
    assert any("process was killed" in line and "joints stand where" in line for line in lines)
    there = arm.position
    arm.publish(arm.trajectory((0.5, -MOVE)))
    arm.until_at(there - MOVE)
    assert limits_kept(arm)
    assert graph.call(Trigger, f"{NAME}/reset", Trigger.Request()).success
    arm.until_at(home)
    # After a clean end it begins at home.
    arm.publish(arm.trajectory((0.5, MOVE)))
    arm.until_at(home + MOVE)
    again.send_signal(signal.SIGINT)
    assert again.wait(TIMEOUT) == 0
    ended = graph.client.get_clock().now()
    process(JointTrajectoryControllerNode, robot_description=ROBOT)
    np.testing.assert_array_equal(states_since(arm, ended)[0].position, home)


@pytest.mark.slow
@pytest.mark.parametrize("given", [{"initial_positions": START}, {"resume_within": 0.0}])
def test_a_robot_that_is_told_where_to_begin_does(drive_process, process, graph, given):
    arm, controller = drive_process
    home = arm.position
    arm.publish(arm.trajectory((1.0, MOVE)))
    arm.until_at(home + MOVE)
    kill(controller)
    killed = graph.client.get_clock().now()
    process(JointTrajectoryControllerNode, robot_description=ROBOT, **given)
    expected = given.get("initial_positions", home)
    np.testing.assert_allclose(states_since(arm, killed)[0].position, expected, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("held", [False, True])
def test_a_publisher_that_was_killed_tells_what_became_of_the_motion(graph, process, held):
    arm = Suite(graph, start=process)
    arm.start_execute(arm.trajectory(0.0, MOVE, duration=2.0))
    arm.until_moving()
    kill(arm.node)
    if held:
        assert graph.call(Trigger, f"{NAME}/hold", Trigger.Request()).success
    again = process(TrajectoryPublisherNode)
    lines = said_by(again)
    report = reported(graph, "off its goal" if held else "reached its goal")
    assert "process was killed" in report and "it had a motion under way" in report
    if not held:
        arm.until_at(arm.home + MOVE)
    assert any("it is watched to its end" in line for line in lines)
    # The next motion is executed as ever.
    goal = arm.position + 0.05 - arm.home
    there = arm.position - arm.home
    assert arm.execute(arm.trajectory(there, goal)).error_code == 0


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


def reported(graph, text):
    """Wait until the publisher tells of the time before its start, with a text in it."""

    def told(array):
        values = {entry.key: entry.value for entry in array.status[0].values}
        return values.get("before the restart", "")

    array = graph.receive(DiagnosticArray, "/diagnostics", 10, lambda array: text in told(array))
    return told(array)


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
