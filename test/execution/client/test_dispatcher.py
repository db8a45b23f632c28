import math

import numpy as np
import pytest
from execution_cases import to_rest

from robomech_ros.execution.client.comparison import apart
from robomech_ros.execution.client.delivery import Delivery, Stage, Transport
from robomech_ros.execution.client.delivery_queue import QueueFullError
from robomech_ros.execution.client.dispatch_settings import DispatchSettings
from robomech_ros.execution.client.dispatcher import Dispatcher
from robomech_ros.execution.refusals import TrajectoryRefusedError
from robomech_ros.trajectory import Waypoints

NAMES = ("shoulder", "elbow", "roll")
HOME = (0.0, 0.0, 0.0)


class Robot:
    """A gateway to a robot that follows at once or not at all."""

    def __init__(self):
        self.at = np.zeros(3)
        self.lacking = ""
        self.known = self.talks = True
        self.said = 0
        self.sent = []
        self.cancelled = []
        self.old_goal_runs = False

    def missing(self, transport):
        return self.lacking

    def send(self, delivery):
        self.sent.append(delivery)

    def cancel(self, delivery):
        self.cancelled.append(delivery)

    def positions(self, names):
        return self.at.copy() if self.known else None

    def heard(self, names):
        self.said += self.talks
        return self.said

    def continuous(self, names):
        return np.array([False, False, True])

    def acceleration(self, names):
        return np.full(3, 10.0)

    def runs_before(self, delivery):
        return self.old_goal_runs


@pytest.fixture
def robot():
    return Robot()


@pytest.fixture
def dispatcher(robot):
    settings = DispatchSettings(
        capacity=3, controller_timeout=2.0, arrival_timeout=1.0, standstill_timeout=0.5
    )
    return Dispatcher(robot, settings)


def delivery(goal=(0.5, 0.2, 0.1), start=HOME, transport=Transport.TOPIC):
    return Delivery(None, NAMES, to_rest(goal, 1.0, start), transport)


def test_sends_and_sees_the_robot_arrive(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    assert robot.sent == [one]
    dispatcher.step(0.5)
    robot.at = one.goal.copy()
    dispatcher.step(1.0)
    assert one.stage is Stage.SENT
    dispatcher.step(1.05)
    assert (one.report.code, one.report.text) == (0, "")
    assert one.report.duration == pytest.approx(1.05)
    assert not dispatcher.busy


def test_a_robot_that_still_moves_has_not_arrived(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    robot.at = one.goal - 0.008
    dispatcher.step(1.0)
    robot.at = one.goal - 0.002
    dispatcher.step(1.05)
    assert one.report is None
    dispatcher.step(1.1)
    assert one.report.code == 0


def test_names_joint_and_amount_when_it_does_not_arrive(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    for time in np.arange(0.0, 2.2, 0.05):
        # It moves all the time, but not there.
        robot.at = np.array([0.5, 0.05, 0.1 - 0.04 * time])
        dispatcher.step(time)
    assert one.report.code == 224
    assert "joint 'elbow' is at 0.05, 0.15 off its goal 0.2, allowed is 0.01" in one.report.text
    assert dispatcher.tally.failed == 1


def test_says_that_the_robot_has_not_moved(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    dispatcher.step(2.1)
    assert "has not moved" in one.report.text


def follow(robot, dispatcher, one, begin, end):
    """Let the robot follow a delivery sent at 0 that lasts 1 s."""
    for time in np.arange(begin, end, 0.05):
        robot.at = one.waypoints.curve.sample(time).position
        dispatcher.step(time)


def test_a_robot_that_was_stopped_on_its_way_is_noticed_at_once(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.32)
    for time in np.arange(0.35, 1.05, 0.05):
        dispatcher.step(time)
    assert one.report.code == 222
    assert one.report.duration < 1.0
    assert "the robot stands for 0.6 s" in one.report.text or "for 0.5 s" in one.report.text
    assert "it was stopped" in one.report.text
    assert "joint 'shoulder' is at" in one.report.text and "off its goal 0.5" in one.report.text


def test_a_robot_that_never_moves_is_noticed_before_the_trajectory_is_over(robot, dispatcher):
    one = Delivery(None, NAMES, to_rest((0.5, 0.2, 0.1), 20.0), Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    for time in np.arange(0.0, 5.0, 0.05):
        dispatcher.step(time)
    assert one.report.code == 221
    assert "the robot does not move for" in one.report.text
    assert "the controller's log may say why" in one.report.text


def test_a_trajectory_that_rests_on_its_way_is_not_taken_for_a_stop(robot, dispatcher):
    times = np.array([0.0, 1.0, 4.0, 5.0])
    places = np.array([HOME, (0.5, 0.2, 0.1), (0.5, 0.2, 0.1), (0.9, 0.2, 0.1)])
    still = np.zeros_like(places)
    one = Delivery(None, NAMES, Waypoints(times, places, still, still), Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 5.2)
    assert one.report.code == 0


def test_a_trajectory_that_begins_later_is_not_taken_for_a_stop(robot, dispatcher):
    one = Delivery(None, NAMES, to_rest((0.5, 0.2, 0.1), 1.0), Transport.TOPIC, delay=3.0)
    dispatcher.offer(one, 0.0)
    for time in np.arange(0.0, 4.3, 0.05):
        robot.at = one.waypoints.curve.sample(max(time - 3.0, 0.0)).position
        dispatcher.step(time)
    assert one.report.code == 0


def test_a_single_point_is_watched_from_where_the_robot_is(robot, dispatcher):
    robot.at = np.full(3, 0.3)
    waypoints = Waypoints(np.array([10.0]), np.zeros((1, 3)))
    one = Delivery(None, NAMES, waypoints, Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    for time in np.arange(0.0, 1.5, 0.05):
        dispatcher.step(time)
    assert one.report.code == 221


def test_of_a_silent_robot_nobody_says_that_it_stands(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.32)
    robot.talks = False
    for time in np.arange(0.35, 1.9, 0.05):
        dispatcher.step(time)
    assert one.report is None
    robot.talks, robot.at = True, one.goal.copy()
    dispatcher.step(1.9)
    dispatcher.step(1.95)
    assert one.report.code == 0


@pytest.mark.parametrize("transport", Transport)
def test_a_robot_that_falls_silent_is_gone(robot, dispatcher, transport):
    one = Delivery(None, NAMES, to_rest((0.5, 0.2, 0.1), 20.0), transport)
    dispatcher.offer(one, 0.0)
    robot.at = np.array([0.1, 0.0, 0.0])
    dispatcher.step(3.0)
    robot.talks = False
    dispatcher.step(4.9)
    assert one.report is None
    dispatcher.step(5.1)
    assert one.report.code == 221
    assert one.report.text.startswith("the controller is gone: no joint states of shoulder, elbow")
    assert "for 2.1 s; how the motion ended is not known; at last joint 'sh" in one.report.text


def test_a_robot_that_falls_silent_at_the_end_is_gone(robot, dispatcher):
    one = delivery()
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.92)
    robot.talks = False
    dispatcher.step(1.95)
    assert one.report is None
    dispatcher.step(2.05)
    assert one.report.code == 221
    assert "the controller is gone: no joint states" in one.report.text


def test_a_subscriber_that_disappears(robot, dispatcher):
    one = Delivery(None, NAMES, to_rest((0.5, 0.2, 0.1), 20.0), Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    follow(robot, dispatcher, one, 0.0, 0.5)
    robot.lacking = "subscriber of '/arm/joint_trajectory'"
    follow(robot, dispatcher, one, 0.5, 2.7)
    assert one.report.code == 221
    assert "the controller is gone: subscriber of '/arm/joint_trajectory' dis" in one.report.text


def test_one_after_the_other_in_order(robot, dispatcher):
    goals = [(0.1, 0.0, 0.0), (0.1, 0.1, 0.0), (0.0, 0.1, 0.0)]
    starts = [HOME, *goals[:-1]]
    many = [delivery(goal, start) for goal, start in zip(goals, starts, strict=True)]
    for one in many:
        dispatcher.offer(one, 0.0)
    assert robot.sent == many[:1]
    time = 0.0
    for count, one in enumerate(many, 1):
        assert robot.sent == many[:count]
        robot.at = one.goal.copy()
        dispatcher.step(time + 1.1)
        dispatcher.step(time + 1.2)
        time += 1.2
    assert [one.report.code for one in many] == [0, 0, 0]


def test_a_start_elsewhere_is_refused_and_the_next_one_sent(robot, dispatcher):
    far, near = delivery(start=(0.0, 0.3, 0.0)), delivery()
    robot.lacking = "controller"
    dispatcher.offer(far, 0.0)
    dispatcher.offer(near, 0.0)
    robot.lacking = ""
    dispatcher.step(0.1)
    assert far.report.code == 221
    assert "starts with joint 'elbow' at 0.3, but the joint is at 0: 0.3 apart" in far.report.text
    assert robot.sent == [near]


def test_whole_turns(robot, dispatcher):
    robot.at = np.array([0.0, 0.0, math.tau])
    one = delivery()
    dispatcher.offer(one, 0.0)
    assert robot.sent == [one]
    np.testing.assert_allclose(
        apart(np.array([math.tau, 0.1]), np.zeros(2), np.array([True, False])), [0.0, 0.1]
    )


def test_a_first_point_later_than_zero_starts_anywhere(robot, dispatcher):
    robot.at = np.array([1.0, 1.0, 1.0])
    waypoints = Waypoints(np.array([1.0]), np.zeros((1, 3)))
    one = Delivery(None, NAMES, waypoints, Transport.TOPIC)
    dispatcher.offer(one, 0.0)
    assert robot.sent == [one]


def test_a_full_queue(robot, dispatcher):
    robot.lacking = "controller"
    for _ in range(3):
        dispatcher.offer(delivery(), 0.0)
    with pytest.raises(QueueFullError, match="3 trajectories are waiting already"):
        dispatcher.offer(delivery(), 0.0)


def test_without_controller_topics_wait_and_callers_are_told(robot):
    stalls, told = [], []
    dispatcher = Dispatcher(robot, DispatchSettings(controller_timeout=2.0), on_stall=stalls.append)
    robot.lacking = "action '/arm/execute'"
    waits, asks = delivery(), delivery(transport=Transport.ACTION)
    waits.listen(told.append)
    dispatcher.offer(waits, 0.0)
    dispatcher.offer(asks, 0.0)
    dispatcher.step(1.9)
    assert not told
    dispatcher.step(2.0)
    assert stalls == ["action '/arm/execute' not there after 2.0 s"]
    assert (asks.report.code, asks.report.text) == (221, stalls[0])
    assert told[0].code == 221
    assert "stays queued" in told[0].text
    robot.lacking = ""
    dispatcher.step(100.0)
    assert robot.sent == [waits]
    assert len(stalls) == 1


def test_without_joint_states_the_first_gives_way(robot, dispatcher):
    robot.known = False
    strange, one = delivery(), delivery(transport=Transport.ACTION)
    dispatcher.offer(strange, 0.0)
    dispatcher.offer(one, 0.0)
    dispatcher.step(2.0)
    assert strange.report.code == 107
    assert "no joint states of shoulder, elbow, roll within 2.0 s" in strange.report.text
    assert one.report is None
    robot.known = True
    dispatcher.step(2.1)
    assert robot.sent == [one]


def test_joint_states_have_their_time_from_when_the_controller_is_there(robot, dispatcher):
    robot.lacking, robot.known = "the controller", False
    one = delivery()
    dispatcher.offer(one, 0.0)
    dispatcher.step(50.0)
    robot.lacking = ""
    dispatcher.step(51.0)
    dispatcher.step(52.9)
    assert one.report is None
    robot.known = True
    dispatcher.step(52.95)
    assert robot.sent == [one]


def test_the_result_of_an_action(robot, dispatcher):
    one = delivery(transport=Transport.ACTION)
    dispatcher.offer(one, 0.0)
    dispatcher.step(1.2)
    robot.at = one.goal.copy()
    dispatcher.conclude(one, 0, "", 1.21)
    assert (one.report.code, one.report.text) == (0, "")
    two = delivery(start=one.goal, transport=Transport.ACTION)
    dispatcher.offer(two, 2.0)
    dispatcher.conclude(two, 223, "joint 'elbow' left its path", 2.1)
    assert (two.report.code, two.report.text) == (223, "joint 'elbow' left its path")
    dispatcher.conclude(two, 0, "late", 2.2)
    assert two.report.code == 223


def test_success_that_the_joint_states_do_not_confirm(robot, dispatcher):
    one = delivery(transport=Transport.ACTION)
    dispatcher.offer(one, 0.0)
    dispatcher.conclude(one, 0, "", 1.0)
    assert one.report is None
    dispatcher.step(2.1)
    assert one.report.code == 0
    assert "reports success, but joint 'shoulder'" in one.report.text


def test_a_controller_that_disappears(robot, dispatcher):
    one = delivery(transport=Transport.ACTION)
    dispatcher.offer(one, 0.0)
    robot.lacking = "action '/arm/execute'"
    dispatcher.step(0.5)
    dispatcher.step(2.6)
    assert one.report.code == 221
    assert "action '/arm/execute' disappeared" in one.report.text


def test_a_controller_that_never_answers(robot, dispatcher):
    one = delivery(transport=Transport.ACTION)
    dispatcher.offer(one, 0.0)
    for time in (1.0, 2.0, 3.0, 3.9):
        dispatcher.step(time)
    assert one.report is None
    dispatcher.step(4.1)
    assert one.report.code == 205
    assert robot.cancelled == [one]


def test_close_tells_everybody(robot, dispatcher):
    told = []
    one, two = delivery(), delivery()
    for each in (one, two):
        each.listen(told.append)
        dispatcher.offer(each, 0.0)
    dispatcher.close("the publisher shuts down")
    assert len(told) == 2
    assert not dispatcher.busy


def test_late_listeners_are_told_at_once(robot, dispatcher):
    one = delivery(start=(1.0, 1.0, 1.0))
    dispatcher.offer(one, 0.0)
    told = []
    one.listen(told.append)
    assert told == [one.report]


def move_along(robot, dispatcher, path, begin, end):
    """Let the robot be where a function of time has it, and look every 50 ms."""
    for now in np.arange(begin, end, 0.05):
        robot.at = path(now)
        dispatcher.step(now)


@pytest.mark.parametrize("transport", list(Transport))
def test_a_pause_that_comes_too_late_is_sent_again(robot, dispatcher, transport):
    one = Delivery(None, NAMES, to_rest((0.5, 0.2, 0.1), 3.0), transport)
    planned = one.waypoints.curve
    dispatcher.offer(one, 0.0)
    dispatcher.pause(0.2)
    assert len(robot.sent) == 2
    first, now = one.goal.copy(), 0.4
    robot.old_goal_runs = True
    if transport is Transport.ACTION:
        dispatcher.conclude(one, 221, "it should be over by now", now)
    while len(robot.sent) < 3:
        now += 0.05
        move_along(robot, dispatcher, lambda time: planned.sample(time).position, now, now + 0.04)
    assert now < 1.0
    assert one.report is None
    # From where the robot is now, since it has moved on.
    assert one.goal[0] > first[0]
    assert one.delay == pytest.approx(0.4)


def test_a_pause_too_late_for_the_end_lets_the_robot_arrive(robot, dispatcher):
    one = delivery()
    planned, goal = one.waypoints.curve, one.goal.copy()
    dispatcher.offer(one, 0.0)
    dispatcher.pause(0.4)
    assert len(robot.sent) == 2
    move_along(robot, dispatcher, lambda now: planned.sample(now).position, 0.45, 2.0)
    np.testing.assert_array_equal(one.goal, goal)
    assert one.report.code == 0
    assert len(robot.sent) == 2
    assert dispatcher.paused


def test_a_pause_that_is_refused_again_and_again_is_given_up(robot, dispatcher):
    one = delivery(transport=Transport.ACTION)
    dispatcher.offer(one, 0.0)
    dispatcher.pause(0.01)
    robot.old_goal_runs = True
    now = 0.01
    while one.report is None:
        now += 0.01
        dispatcher.conclude(one, 221, "no", now)
    assert 2 <= len(robot.sent) <= 5
    assert robot.cancelled == [one]
    assert (one.report.code, one.report.text) == (221, "no")


def test_what_was_paused_goes_on_to_its_end(robot, dispatcher):
    one = delivery()
    planned = one.waypoints.curve
    dispatcher.offer(one, 0.0)
    dispatcher.pause(0.2)
    stop = one.waypoints.curve
    begin = one.sent_at + one.delay
    move_along(robot, dispatcher, lambda now: planned.sample(now).position, 0.2, begin)
    place = one.goal.copy()
    assert 0.0 < place[0] < 0.5
    move_along(robot, dispatcher, lambda now: stop.sample(now - begin).position, begin + 0.05, 3.0)
    assert one.report is None
    assert len(robot.sent) == 2
    dispatcher.resume(3.0)
    np.testing.assert_allclose(one.waypoints.positions[0], place, atol=1e-12)
    rest = one.waypoints.curve
    move_along(robot, dispatcher, lambda now: rest.sample(now - 3.0).position, 3.0, 6.0)
    assert one.report.code == 0
    assert len(robot.sent) == 3


def test_a_speed_at_which_a_trajectory_would_last_too_long_changes_nothing(robot):
    dispatcher = Dispatcher(robot, DispatchSettings(max_duration=100.0))
    one, two = delivery(), delivery()
    planned = one.waypoints.curve
    dispatcher.offer(one, 0.0)
    with pytest.raises(TrajectoryRefusedError, match=r"at speed 0\.001 .* last .* at most 100 s"):
        dispatcher.set_speed(1e-3, 0.2)
    assert (dispatcher.speed, len(robot.sent)) == (1.0, 1)
    move_along(robot, dispatcher, lambda now: planned.sample(min(now, 1.0)).position, 0.2, 2.0)
    assert one.report.code == 0
    robot.at = np.zeros(3)
    dispatcher.set_speed(1e-3, 3.0)
    dispatcher.offer(two, 3.0)
    assert (two.report.code, len(robot.sent)) == (221, 1)
    assert "at speed 0.001 the trajectory would last 1000 s, at most 100 s" in two.report.text


def test_cancel_ends_when_the_robot_stands(robot, dispatcher):
    one, two = delivery(), delivery(start=(0.5, 0.2, 0.1), goal=HOME)
    dispatcher.offer(one, 0.0)
    dispatcher.offer(two, 0.0)
    assert dispatcher.cancel("enough", 0.3) == 2
    assert (two.report.code, two.report.text) == (222, "not sent: enough")
    assert one.report is None
    stop, begin = one.waypoints.curve, one.sent_at + one.delay
    move_along(robot, dispatcher, lambda now: stop.sample(now - begin).position, 0.35, 2.0)
    assert (one.report.code, one.report.text) == (222, "enough")
    assert not dispatcher.busy


def stamped(delay, goal=(0.5, 0.2, 0.1)):
    return Delivery(None, NAMES, to_rest(goal, 1.0), Transport.TOPIC, delay=delay)


@pytest.mark.parametrize("jump", [-100.0, -5.0, 2.0])
def test_what_waits_for_its_stamp_is_watched_by_the_clock_that_jumped(robot, dispatcher, jump):
    one = stamped(3.0)
    dispatcher.offer(one, 0.0)
    dispatcher.step(0.5)
    dispatcher.clock_jumped(jump, 0.5)
    begin = 3.0 - jump
    for time in np.arange(0.55, begin + 1.2, 0.05):
        assert one.report is None or time > begin + 0.95
        robot.at = one.waypoints.curve.sample(max(time - begin, 0.0)).position
        dispatcher.step(time)
    assert (one.report.code, one.report.text) == (0, "")
    assert one.report.duration == pytest.approx(begin + 1.05, abs=0.1)
    assert robot.sent == [one]


def test_the_speed_can_be_set_when_what_waited_over_a_jump_has_begun(robot, dispatcher):
    one = stamped(3.0)
    dispatcher.offer(one, 0.0)
    dispatcher.clock_jumped(-10.0, 0.5)
    with pytest.raises(TrajectoryRefusedError, match="only begins in 9 s"):
        dispatcher.set_speed(0.5, 4.0)
    for time in np.arange(4.0, 13.3, 0.05):
        robot.at = one.waypoints.curve.sample(max(time - 13.0, 0.0)).position
        dispatcher.step(time)
    dispatcher.set_speed(0.5, 13.3)
    assert len(robot.sent) == 2


def test_a_jump_does_not_touch_what_is_under_way(robot, dispatcher):
    one = stamped(0.2)
    dispatcher.offer(one, 0.0)
    for time in np.arange(0.0, 0.5, 0.05):
        robot.at = one.waypoints.curve.sample(max(time - 0.2, 0.0)).position
        dispatcher.step(time)
    dispatcher.clock_jumped(-100.0, 0.5)
    robot.at = one.goal.copy()
    for time in (0.55, 1.2, 1.25, 1.3):
        dispatcher.step(time)
    assert one.report.code == 0


def test_the_stamp_of_what_has_queued_counts_when_it_is_sent(robot, dispatcher):
    one, two = delivery(), stamped(3.0, (0.7, 0.2, 0.1))
    two.waypoints = to_rest((0.7, 0.2, 0.1), 1.0, one.goal)
    dispatcher.offer(one, 0.0)
    dispatcher.offer(two, 0.0)
    dispatcher.clock_jumped(-4.0, 0.2)
    robot.at = one.goal.copy()
    for time in (1.0, 1.05):
        dispatcher.step(time)
    assert robot.sent == [one, two]
    assert two.delay == pytest.approx(7.0 - 1.05)
