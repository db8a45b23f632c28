"""Jogging by buttons that are held: what pages say, and when a press ends."""

import threading

import numpy as np
import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.rvs.model.running.jog import HoldHeartbeat, JogDirection, JogSwitch, read_beat

PLUS = JogDirection("linear", 2, 1)


class Clock:
    """Time that tests set (s)."""

    now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def switch(clock):
    return JogSwitch(0.4, clock)


def test_beats_are_read():
    assert read_beat("joint 5 - 1712 1", 6) == HoldHeartbeat(
        JogDirection("joint", 5, -1), 1712, 0.001
    )
    assert read_beat("linear 2 + 7 12345", 6) == HoldHeartbeat(PLUS, 7, 12.345)
    assert read_beat("angular 0 + 0 0", 6) == HoldHeartbeat(JogDirection("angular", 0, 1), 0, 0.0)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "joint 6 + 1 1",
        "linear 3 + 1 1",
        "linear 1 +",
        "linear -1 + 1 1",
        "linear 1 * 1 1",
        "linear 1 + 1 1 1",
        "LINEAR 1 + 1 1",
        "joint 1e3 + 1 1",
        "joint ٣ + 1 1",
        "linear 1 + 1 1\n",
        "x" * 4000,
    ],
)
def test_other_texts_are_refused(text):
    with pytest.raises(BadValueError, match="jog is"):
        read_beat(text, 6)


def test_a_press_lasts_as_long_as_it_is_said_again(switch, clock):
    assert switch.held() is None
    for k in range(5):
        switch.hold(PLUS, 1, 0.3 * k)
        clock.now += 0.3
        assert switch.held() == PLUS
    clock.now += 0.2
    assert switch.held() is None


def test_a_press_that_was_silent_does_not_go_on(switch, clock):
    switch.hold(PLUS, 1, 0.0)
    clock.now += 0.5
    switch.hold(PLUS, 1, 0.5)
    assert switch.held() is None
    switch.hold(PLUS, 2, 0.0)
    assert switch.held() == PLUS


def test_what_comes_after_the_release_is_late(switch):
    switch.hold(PLUS, 1, 0.0)
    switch.release()
    switch.hold(PLUS, 1, 0.0)
    assert switch.held() is None


def test_a_press_ends_when_its_words_come_later_and_later(switch, clock):
    # Each takes 0.06 s longer than the one before: at most 0.16 s of silence, but 0.6 s of delay.
    delays = []
    for k in range(11):
        switch.hold(PLUS, 1, 0.1 * k)
        if switch.held() is None:
            break
        delays.append(0.06 * k)
        clock.now += 0.16
    assert delays[-1] == pytest.approx(0.36)
    switch.hold(PLUS, 1, 2.0)
    assert switch.held() is None
    switch.hold(PLUS, 2, 0.0)
    assert switch.held() == PLUS


def test_a_delay_that_stays_or_shrinks_ends_no_press(switch, clock):
    clock.now += 5.0
    for k in range(50):
        switch.hold(PLUS, 1, 0.1 * k)
        assert switch.held() == PLUS
        clock.now += 0.09 if k < 20 else 0.1


def test_whatever_the_delays_a_press_ends_soon_after_the_button_is_let_go(clock):
    """At most two silences, and what the first word took; nobody says that it was let go."""
    rng = np.random.default_rng(7)
    for _ in range(200):
        switch, begun = JogSwitch(0.4, clock), clock.now
        let_go = rng.uniform(0.05, 3.0)
        ages = np.arange(0.0, let_go, 0.1)
        delays = rng.uniform(0.0, 2.0) + rng.uniform(0.0, 1.5) * rng.random(len(ages))
        # In the order in which they were said.
        arrivals = np.maximum.accumulate(begun + ages + delays)
        latest = arrivals[0] + let_go + 2 * 0.4
        for age, arrival in zip(ages, arrivals, strict=True):
            clock.now = arrival
            switch.hold(PLUS, 1, age)
            assert switch.held() is None or arrival <= latest
        clock.now = max(clock.now, latest + 1e-6)
        assert switch.held() is None


def test_ages_that_no_page_would_say_end_their_own_press(switch, clock):
    switch.hold(PLUS, 1, 0.0)
    switch.hold(PLUS, 1, 999_999.999)
    switch.hold(PLUS, 1, 0.1)
    assert switch.held() is None
    switch.hold(PLUS, 2, 0.0)
    assert switch.held() == PLUS


def test_another_button_takes_over(switch):
    minus = JogDirection("linear", 2, -1)
    switch.hold(PLUS, 1, 0.0)
    switch.hold(minus, 2, 0.0)
    assert switch.held() == minus
    switch.hold(PLUS, 1, 0.0)
    assert switch.held() == minus


def test_who_waits_is_woken_by_a_press_and_by_the_end(switch):
    woken = []

    def wait():
        while switch.wait():
            woken.append(switch.held())
            switch.release()

    waiting = threading.Thread(target=wait, daemon=True)
    waiting.start()
    switch.hold(PLUS, 1, 0.0)
    for _ in range(3000):
        if woken:
            break
        waiting.join(0.01)
    switch.close()
    waiting.join(30.0)
    assert woken[0] == PLUS and not waiting.is_alive()
    switch.hold(PLUS, 9, 0.0)
    assert not switch.wait()
