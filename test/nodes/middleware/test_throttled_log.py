"""Lines that are repeated do not fill a log."""

import pytest
from rclpy.logging import get_logger

from robomech_ros.nodes.middleware.throttled_log import MOST, PERIOD, ThrottledLog


class Recorder:
    def __init__(self):
        self.lines = []
        self.now = 0.0

    def __getattr__(self, severity):
        return lambda text: self.lines.append(f"{severity} {text}")


@pytest.fixture
def recorder():
    return Recorder()


@pytest.fixture
def log(recorder):
    return ThrottledLog(recorder, lambda: recorder.now)


@pytest.mark.parametrize("severity", ["error", "warning", "info"])
def test_a_flood_is_one_line_a_second_with_the_count_of_the_others(recorder, log, severity):
    # Powers of two: no rounding.
    for step in range(1280):
        recorder.now = step / 128
        getattr(log, severity)(f"late by {0.1 * step:.3g} s, 1e-{step} m")
    assert len(recorder.lines) == 10 / PERIOD
    expected = f"{severity} late by 12.8 s, 1e-128 m (127 more lines left out)"
    assert recorder.lines[1] == expected


def test_another_kind_of_line_comes_at_once(recorder, log):
    for _ in range(3):
        log.error("bad 1")
        log.warning("odd")
    assert recorder.lines == ["error bad 1", "warning odd"]


def test_a_flood_does_not_hide_what_comes_later(recorder, log):
    for step in range(1000):
        recorder.now = step / 100
        log.info("replaced")
    log.error("bad")
    assert recorder.lines[-1].startswith("error bad")


def test_kinds_that_senders_make_up_are_bounded(recorder, log):
    letters = "abcdefghij"
    for step in range(1000):
        recorder.now = step / 100
        name = "".join(letters[int(digit)] for digit in str(step))
        log.error(f"no joint '{name}'")
    assert len(recorder.lines) <= 10 / PERIOD + MOST


def test_all_severities_go_to_one_logger_of_rclpy(capfd):
    log = ThrottledLog(get_logger("sparing"))
    log.error("bad")
    log.warning("odd")
    log.info("new")
    logged = capfd.readouterr().err
    assert "bad" in logged and "odd" in logged and "new" in logged
