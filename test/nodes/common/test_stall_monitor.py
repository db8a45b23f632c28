"""Commands without a stamp are as old as the process was held up."""

import pytest

from robomech_ros.nodes.common.joints.stall_monitor import HELD_UP, StallMonitor


def test_who_looks_often_was_not_held_up():
    watch = StallMonitor()
    # The first look has none before it.
    for now in (1000.0, 1000.0 + HELD_UP, 1000.3 + HELD_UP):
        assert not watch.look(now) and watch.age(now) == 0.0


def test_after_a_hold_up_commands_are_as_old_as_it_for_a_moment():
    watch = StallMonitor()
    watch.look(10.0)
    assert watch.look(13.0)
    assert watch.age(13.0) == pytest.approx(3.0)
    assert not watch.look(13.1)
    assert watch.age(13.1) == pytest.approx(3.1)
    assert not watch.look(13.3)
    assert watch.age(13.3) == 0.0


def test_the_longest_time_between_looks_may_be_given():
    watch = StallMonitor()
    watch.look(0.0)
    assert not watch.look(2.0, most=3.0)
    assert watch.look(5.1, most=3.0)


def test_a_clock_that_is_set_back_makes_nothing_older():
    watch = StallMonitor()
    watch.look(10.0)
    watch.look(13.0)
    assert not watch.look(2.0) and watch.age(2.0) == 0.0
