"""Jogging by buttons that are held: what pages say, and when a press ends."""

import threading

import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.rvs.model.jog import JogDirection, JogSwitch, read_hold

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


def test_directions_are_read():
    assert read_hold("joint 5 - 1712 1", 6) == (JogDirection("joint", 5, -1), 1712)
    assert read_hold("linear 2 + 7 12345", 6) == (PLUS, 7)
    assert read_hold("angular 0 + 0 0", 6)[0] == JogDirection("angular", 0, 1)


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
        read_hold(text, 6)


def test_a_press_lasts_as_long_as_it_is_said_again(switch, clock):
    assert switch.held() is None
    for _ in range(5):
        switch.hold(PLUS, 1)
        clock.now += 0.3
        assert switch.held() == PLUS
    clock.now += 0.2
    assert switch.held() is None


def test_a_press_that_was_silent_does_not_go_on(switch, clock):
    switch.hold(PLUS, 1)
    clock.now += 0.5
    switch.hold(PLUS, 1)
    assert switch.held() is None
    switch.hold(PLUS, 2)
    assert switch.held() == PLUS


def test_what_comes_after_the_release_is_late(switch):
    switch.hold(PLUS, 1)
    switch.release()
    switch.hold(PLUS, 1)
    assert switch.held() is None


def test_another_button_takes_over(switch):
    minus = JogDirection("linear", 2, -1)
    switch.hold(PLUS, 1)
    switch.hold(minus, 2)
    assert switch.held() == minus
    switch.hold(PLUS, 1)
    assert switch.held() == minus


def test_who_waits_is_woken_by_a_press_and_by_the_end(switch):
    woken = []

    def wait():
        while switch.wait():
            woken.append(switch.held())
            switch.release()

    waiting = threading.Thread(target=wait, daemon=True)
    waiting.start()
    switch.hold(PLUS, 1)
    for _ in range(3000):
        if woken:
            break
        waiting.join(0.01)
    switch.close()
    waiting.join(30.0)
    assert woken[0] == PLUS and not waiting.is_alive()
    switch.hold(PLUS, 9)
    assert not switch.wait()
