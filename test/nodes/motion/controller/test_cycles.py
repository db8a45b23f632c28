"""The regular cycle of the controller: its grid, failures, ends, and what it does not wait for."""

import itertools
import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest
from drivers import ended
from rclpy.node import Node

from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.joint_trajectory_controller import control_cycle
from robomech_ros.nodes.joint_trajectory_controller.control_cycle import Cycles

RATE = 50.0
MOVE = np.array([0.2, -0.1, 0.15, 0.0, 0.1, -0.1])


class Ticks:
    """Counts cycles, and notes when they were."""

    def __init__(self, node, work=lambda cycles, count: None, rate=RATE):
        self.times = []
        self._work = work
        self._news = threading.Condition()
        # Cycles begin before their constructor has returned.
        self._made = threading.Event()
        self.cycles = Cycles(node, MotionClock(node), rate, self._tick)
        self._made.set()

    def _tick(self):
        assert self._made.wait(30.0)
        with self._news:
            self.times.append(time.monotonic())
            self._news.notify_all()
        self._work(self.cycles, len(self.times))

    def until(self, count):
        with self._news:
            assert self._news.wait_for(lambda: len(self.times) >= count, 30.0)


@pytest.fixture
def node(graph):
    """A node that nobody spins."""
    result = Node("cycling", context=graph.context)
    yield result
    result.destroy_node()


class Moments:
    """A time of its own (ns), in which waiting and a late wake-up are all that takes any."""

    def __init__(self, monkeypatch):
        self.now, self.late = 0, 0
        outer = self

        class Event(threading.Event):
            def wait(self, timeout):
                outer.now += max(round(timeout * 1e9), 0) + outer.late
                return self.is_set()

        monkeypatch.setattr(control_cycle, "time", SimpleNamespace(monotonic_ns=lambda: self.now))
        known = SimpleNamespace(**{**vars(threading), "Event": Event})
        monkeypatch.setattr(control_cycle, "threading", known)


def test_cycles_need_no_executor_and_keep_to_their_grid(node, monkeypatch):
    moments, seen = Moments(monkeypatch), []
    period = round(1e9 / RATE)

    def work(cycles, count):
        seen.append(moments.now)
        # The fifth takes two cycles more than its own, and the thread wakes late now and then.
        moments.now += round(2.4 * period) if count == 5 else 1000
        moments.late = period // 4 if count % 3 == 0 else 0
        if count == 30:
            cycles.stop()

    ticks = Ticks(node, work)
    ticks.until(30)
    ticks.cycles.stop()
    late = np.array(seen) % period
    assert set(late) == {0, period // 4}
    # They are left out, not made up for.
    steps = np.diff(np.array(seen) // period)
    np.testing.assert_array_equal(steps, [3 if k == 4 else 1 for k in range(29)])


def test_a_cycle_that_fails_is_told_and_the_next_one_comes(node, capfd):
    def fail(_, count):
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
    ticks = Ticks(node, lambda cycles, count: cycles.stop() if count == 3 else None)
    ticks.until(3)
    ticks.cycles.stop()
    assert len(ticks.times) == 3


def test_the_robot_moves_on_while_a_callback_takes_long(arm):
    """A blocked executor, such as by reading a long trajectory, does not stop the robot."""
    node = next(n for n in arm.graph._nodes if n.get_name() == "joint_trajectory_controller")
    arm.send(arm.trajectory((20.0, 5 * MOVE)))
    arm.until_moving()
    blocked, free = [], threading.Event()

    def block():
        node.destroy_timer(timer)
        blocked.append(len(arm.states))
        arm.until(lambda: len(arm.states) > blocked[0] + 25)
        blocked.append(len(arm.states))
        free.set()

    timer = node.create_timer(0.01, block)
    assert free.wait(60.0)
    _, positions, _ = arm.path()
    assert (np.diff(positions[blocked[0] : blocked[1], 0]) > 0.0).all()


def test_a_goal_ends_though_nothing_else_wakes_the_executor(drive):
    """The result of an action is told when the cycle finds the goal reached."""
    arm = drive(action_monitor_rate=0.1, publish_frames="never")
    node = next(n for n in arm.graph._nodes if n.get_name() == "joint_trajectory_controller")
    for timer in node.timers:
        timer.cancel()
    for _ in range(3):
        handle = arm.send(arm.trajectory((0.2, 0.1 * MOVE)))
        assert arm.result(handle)[0] == 4


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
    times, positions, _ = arm.path()
    along = (positions - start) @ MOVE / (MOVE @ MOVE)
    # At a constant speed of one MOVE per second.
    moving = (along > 0.001) & (along < 0.999)
    assert moving.sum() > 10
    assert np.ptp(times[moving] - along[moving]) < 1e-3
