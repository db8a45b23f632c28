"""The regular cycle of the controller: its grid, failures, ends, and what it does not wait for."""

import itertools
import threading
import time

import numpy as np
import pytest
from drivers import ended
from rclpy.node import Node
from sensor_msgs.msg import JointState

from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.joint_trajectory_controller.cycles import Cycles

RATE = 50.0
MOVE = np.array([0.2, -0.1, 0.15, 0.0, 0.1, -0.1])


class Ticks:
    """Counts cycles, and notes when they were."""

    def __init__(self, node, work=lambda count: None, rate=RATE):
        self.times = []
        self._work = work
        self._news = threading.Condition()
        self.cycles = Cycles(node, MotionClock(node), rate, self._tick)

    def _tick(self):
        with self._news:
            self.times.append(time.monotonic())
            self._news.notify_all()
        self._work(len(self.times))

    def until(self, count):
        with self._news:
            assert self._news.wait_for(lambda: len(self.times) >= count, 30.0)


@pytest.fixture
def node(graph):
    """A node that nobody spins."""
    result = Node("cycling", context=graph.context)
    yield result
    result.destroy_node()


def test_cycles_need_no_executor_and_keep_to_their_grid(node):
    ticks = Ticks(node, lambda count: time.sleep(2.4 / RATE if count == 5 else 0.0))
    ticks.until(30)
    ticks.cycles.stop()
    count = len(ticks.times)
    phase = (np.array(ticks.times) - ticks.times[0]) * RATE % 1.0
    # All within a part of a cycle, but those that a busy machine delays.
    assert np.median(np.minimum(phase, 1.0 - phase)) < 0.25
    # The fifth took two cycles more than its own: they are left out, not made up for.
    assert ticks.times[5] - ticks.times[4] > 2.0 / RATE
    time.sleep(3.0 / RATE)
    assert len(ticks.times) == count


def test_a_cycle_that_fails_is_told_and_the_next_one_comes(node, capfd):
    def fail(count):
        if count == 3:
            raise ValueError("the third")

    ticks = Ticks(node, fail)
    ticks.until(6)
    ticks.cycles.stop()
    said = capfd.readouterr().err
    assert "a cycle failed, please report this" in said
    assert "the third" in said


def test_cycles_end_with_their_context(graph, node):
    ticks = Ticks(node)
    ticks.until(3)
    graph.context.try_shutdown()
    (thread,) = [each for each in threading.enumerate() if each.name == "cycles"]
    thread.join(10.0)
    assert not thread.is_alive()


def test_a_cycle_can_stop_its_own_cycles(node):
    ticks = Ticks(node, lambda count: ticks.cycles.stop() if count == 3 else None)
    ticks.until(3)
    ticks.cycles.stop()
    assert len(ticks.times) == 3


def test_the_robot_moves_on_while_a_callback_takes_long(arm):
    """What blocks the executor, such as reading a long trajectory, does not stop the robot."""
    node = next(n for n in arm.graph._nodes if n.get_name() == "joint_trajectory_controller")
    handle = arm.send(arm.trajectory((1.5, MOVE)))
    arm.until_moving()
    blocked = []

    def block():
        blocked.append(len(arm.states))
        time.sleep(0.5)
        blocked.append(len(arm.states))
        node.destroy_timer(timer)

    timer = node.create_timer(0.01, block)
    assert arm.result(handle)[0] == 4
    first, last = blocked[:2]
    assert last - first > 25
    positions = np.array([state.position for state in arm.states[first:last]])
    assert (np.diff(positions[:, 0]) > 0.0).mean() > 0.9


def test_a_goal_ends_though_nothing_else_wakes_the_executor(drive):
    """The result of an action is told when the cycle finds the goal reached, not later."""
    arm = drive(action_monitor_rate=0.1)
    for _ in range(3):
        handle = arm.send(arm.trajectory((0.2, 0.1 * MOVE)))
        began = time.monotonic()
        assert arm.result(handle)[0] == 4
        assert time.monotonic() - began < 0.2 + 0.5
        arm.graph.receive(JointState, "joint_states", 10, lambda message: True)


def test_the_node_leaves_no_thread_behind(drive):
    arm = drive()
    node = arm.graph._nodes[-1]
    ended(node.executor.create_task(node.stop))
    node.destroy_node()
    assert "cycles" not in {each.name for each in threading.enumerate()}


def test_a_state_has_the_time_for_which_it_was_computed(arm):
    """However long it then takes until it is published."""
    node = next(n for n in arm.graph._nodes if n.get_name() == "joint_trajectory_controller")
    publish, delays = node._control_cycle.states.publish, itertools.cycle((0.0, 0.02, 0.005))

    def publish_late(*what):
        time.sleep(next(delays))
        publish(*what)

    node._control_cycle.states.publish = publish_late
    start = arm.position
    assert arm.execute(arm.trajectory((1.0, MOVE), velocities=False))[0] == 4
    stamps = [state.header.stamp for state in arm.states]
    times = np.array([stamp.sec + 1e-9 * stamp.nanosec for stamp in stamps])
    along = (np.array([state.position for state in arm.states]) - start) @ MOVE / (MOVE @ MOVE)
    # At a constant speed of one MOVE per second.
    moving = (along > 0.001) & (along < 0.999)
    assert moving.sum() > 10
    assert np.ptp(times[moving] - along[moving]) < 1e-3
