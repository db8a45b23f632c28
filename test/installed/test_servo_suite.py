"""The installed servo, driven from outside through the whole suite, over real DDS."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest
from geometry_msgs.msg import TwistStamped
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState

from robomech_interfaces.msg import ServoStatus
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import load_robot

# Long, since a machine may be busy; nothing waits longer than it has to.
PATIENCE = 60.0
SPEED = 0.1  # m/s
SECONDS = 2.0
PERIOD = 0.02
QOS = QoSProfile(depth=2000)
# From the middle of the ranges, which is singular, to where the arm can move every way.
REGULAR = [0.3, 0.6, -0.7, 0.4, 0.8, 0.2]


class Hand:
    """Publishes twists, and sees what the robot and the servo say."""

    def __init__(self, outsider):
        self.states, self.statuses = [], []
        self._news = threading.Condition()
        node = outsider.node
        self._twists = node.create_publisher(TwistStamped, "servo/delta_twist_cmds", 10)
        self._speeds = node.create_publisher(JointState, "servo/joint_velocity_cmds", 10)
        node.create_subscription(JointState, "joint_states", self._take(self.states), QOS)
        node.create_subscription(ServoStatus, "servo/status", self._take(self.statuses), QOS)

    def _take(self, into):
        def take(message):
            with self._news:
                into.append((time.monotonic(), message))
                self._news.notify_all()

        return take

    def wait_for(self, condition):
        with self._news:
            assert self._news.wait_for(condition, PATIENCE), "it never came"

    def ready(self):
        return self.states and self._twists.get_subscription_count()

    def repeat(self, send, until):
        """Command every period until something is so; gives when the last command was sent."""
        due = begun = time.monotonic()
        while not until(due - begun):
            assert due < begun + PATIENCE, f"it never came: {self.statuses[-1:]}"
            send()
            due += PERIOD
            with self._news:
                self._news.wait_for(lambda due=due: time.monotonic() >= due, due - time.monotonic())
        return due - PERIOD

    def twist(self, **linear):
        message = TwistStamped()
        for axis, value in linear.items():
            setattr(message.twist.linear, axis, value)
        self._twists.publish(message)

    def joints(self, names, speeds):
        self._speeds.publish(JointState(name=names, velocity=speeds))

    @property
    def position(self):
        return np.array(self.states[-1][1].position)

    @property
    def stands(self):
        return not any(self.states[-1][1].velocity)

    def path(self, since):
        """Times by the stamps (s), positions and velocities of the states from one on."""
        messages = [message for _, message in self.states[since:]]
        stamps = [m.header.stamp for m in messages]
        times = np.array([s.sec - stamps[0].sec + 1e-9 * s.nanosec for s in stamps])
        rows = [(m.position, m.velocity) for m in messages]
        return times, *(np.array(part) for part in zip(*rows, strict=True))


def to_a_regular_posture(hand, chain):
    """Jog the joints there, as the middle of the ranges is a singularity of the wrist."""
    goal = np.array(REGULAR)

    def send():
        speeds = np.clip(2.0 * (goal - hand.position), -0.8, 0.8)
        hand.joints(list(chain.joint_names), speeds.tolist())

    hand.repeat(send, lambda _: np.abs(hand.position - goal).max() < 0.02)
    hand.wait_for(lambda: hand.stands)


def test_twists_move_the_tip_of_an_arm_in_one_process(bringup, outsider):
    with bringup("--robot", "puma560", "--in-one-process"):
        check_twists_for_two_seconds(outsider)


def check_twists_for_two_seconds(outsider):
    """Move the tip by as much as is commanded; no limit is exceeded."""
    chain, hand = load_robot("puma560"), Hand(outsider)
    hand.wait_for(hand.ready)
    to_a_regular_posture(hand, chain)
    began, told = len(hand.states) - 1, len(hand.statuses)
    before = forward_kinematics(chain, hand.position)
    ended = hand.repeat(lambda: hand.twist(y=SPEED), lambda passed: passed >= SECONDS)
    hand.wait_for(lambda: hand.statuses[-1][1].code == ServoStatus.STALE_COMMAND)
    hand.wait_for(lambda: hand.stands)
    stood = hand.states[-1][0]
    after = forward_kinematics(chain, hand.position)
    times, positions, velocities = hand.path(began)
    way = after[:3, 3] - before[:3, 3]
    # The last command counts for 0.1 s; acceleration and braking take the same way as standing.  On
    # a busy machine commands come late, and the tip stops between them.
    assert 0.5 < way[1] / (SPEED * (SECONDS + 0.1)) < 1.1
    speeds = np.einsum("kij,kj->ki", jacobian(chain, positions), velocities)[:, 4]
    assert np.median(speeds[speeds > 0.5 * SPEED]) == pytest.approx(SPEED, rel=0.1)
    assert np.abs(way[[0, 2]]).max() < 0.02 * way[1]
    np.testing.assert_allclose(after[:3, :3], before[:3, :3], atol=0.01)
    codes = {message.code for _, message in hand.statuses[told:]}
    assert ServoStatus.NO_STATE not in codes and ServoStatus.INVALID not in codes
    # It stands well before it would if nobody looked for commands that do not come any more.
    assert stood - ended < 10.0
    assert_within(chain, times, positions, velocities)


def assert_within(chain, times, positions, velocities):
    """Limits, by the velocities published and by differences over some cycles."""
    assert (positions >= chain.lower).all() and (positions <= chain.upper).all()
    assert (np.abs(velocities) <= chain.velocity * (1 + 1e-6)).all()
    for k in (5, 10):
        spans = times[k:] - times[:-k]
        told = spans > 0.01
        speeds = (positions[k:] - positions[:-k])[told] / spans[told, None]
        # A stamp may be a millisecond or two beside the time of the state.
        assert (np.abs(speeds) <= 1.3 * chain.velocity).all()
        changes = (velocities[k:] - velocities[:-k])[told] / spans[told, None]
        assert (np.abs(changes) <= 1.3 * chain.acceleration).all()
