"""A controller in another process is stopped while the servo drives it: no joint exceeds a limit.

Before, joints accelerated at 6 to 48 times their limits when it went on.
"""

import signal
import time

import numpy as np
import pytest
from drivers import Driver
from servo_operator import START, Operator

# Stamps are exact to the nanosecond, and cycles last 2 ms.
ROUNDING = 1e-3


@pytest.fixture
def hand(graph, process):
    """A robot of its own process at 500 Hz, its servo, and the process."""
    started = []

    def start(node, namespace="", **parameters):
        started.append(process(node, namespace, publish_rate=500.0, **parameters))

    arm = Driver(graph, start, initial_positions=START)
    operator = Operator(arm, graph, publish_rate=100.0)
    operator.process = started[0]
    return operator


def stop_for(hand, seconds):
    hand.process.send_signal(signal.SIGSTOP)
    time.sleep(seconds)
    hand.process.send_signal(signal.SIGCONT)


def assert_within(arm):
    times, positions, velocities = arm.path()
    spans = np.diff(times)[:, None]
    assert spans.min() > 0.0
    speeds = np.abs(np.diff(positions, axis=0)) / spans
    changes = np.abs(np.diff(velocities, axis=0)) / spans
    assert (speeds <= arm.chain.velocity * (1.0 + ROUNDING)).all()
    worst = (changes / arm.chain.acceleration).max()
    assert worst <= 1.0 + ROUNDING, f"accelerations are up to {worst} of their limits"
    # Velocities are those of the positions, also across the stop.
    mean = 0.5 * (velocities[1:] + velocities[:-1])
    short = spans[:, 0] < 0.01
    off = np.abs(np.diff(positions, axis=0) / spans - mean)[short]
    assert (off <= 0.5 * arm.chain.acceleration * spans[short] + ROUNDING).all()
    return spans.max()


@pytest.mark.parametrize("seconds", [0.1, 0.3])
def test_a_controller_that_is_stopped_catches_up_within_limits(hand, seconds):
    arm = hand.arm
    send = hand.speeds(["waist", "elbow"], [1.0, -0.6])
    first = arm.position
    hand.repeat(send, lambda: arm.position[0] > first[0] + 0.2)
    stop_for(hand, seconds)
    seen = arm.position[0]
    hand.repeat(send, lambda: arm.position[0] > seen + 0.3)
    hand.until_still()
    assert assert_within(arm) > 0.8 * seconds
    # Messages that come too late, as on a busy machine, are refused: the one before them counts.
    ends = np.array([message.points[-1].positions for _, message in hand.streamed])
    assert np.abs(ends - arm.position).max(axis=1).min() < 1e-6


def test_the_servo_says_once_that_points_come_late(hand, capfd):
    arm = hand.arm
    send = hand.speeds(["waist"], [0.6])
    hand.repeat(send, lambda: arm.position[0] > START[0] + 0.1)
    # The node itself is held up, with all that it computes.
    for _ in range(3):
        hand.node._driver.stream.lead.sent(hand.node._motion_clock.now(), 0.05)
        seen = arm.position[0]
        hand.repeat(send, lambda seen=seen: arm.position[0] > seen + 0.05)
    hand.until_still()
    said = [line for line in capfd.readouterr().err.splitlines() if "ms late" in line]
    assert len(said) == 1
    assert "the lead rises to at most 10 (max_lead)" in said[0]
    # More of each message is known beforehand.
    assert max(len(message.points) for _, message in hand.streamed) > 7
    assert_within(arm)
