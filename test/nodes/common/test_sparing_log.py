"""Complaints that are repeated do not fill a log."""

from rclpy.logging import get_logger

from robomech_ros.nodes.common.sparing_log import MOST, PERIOD, SparingLog


class Recorder:
    def __init__(self):
        self.lines = []
        self.now = 0.0

    def error(self, text):
        self.lines.append(text)

    def warning(self, text):
        self.lines.append(f"WARN {text}")

    def log(self):
        return SparingLog(self, lambda: self.now)


def test_the_same_complaint_comes_once_a_period_with_the_count_of_those_left_out():
    recorder = Recorder()
    log = recorder.log()
    for _ in range(1000):
        log.error("bad")
    assert recorder.lines == ["bad"]
    recorder.now = PERIOD
    log.error("bad")
    log.error("bad")
    assert recorder.lines == ["bad", "bad (999 such lines left out)"]


def test_warnings_are_as_sparing():
    recorder = Recorder()
    log = recorder.log()
    for _ in range(3):
        log.warning("odd")
    assert recorder.lines == ["WARN odd"]


def test_another_complaint_comes_at_once():
    recorder = Recorder()
    log = recorder.log()
    log.error("bad")
    log.error("worse")
    assert recorder.lines == ["bad", "worse"]


def test_complaints_that_all_differ_are_bounded_too():
    recorder = Recorder()
    log = recorder.log()
    for k in range(1000):
        log.error(f"bad {k}")
    assert len(recorder.lines) == MOST


def test_errors_and_warnings_go_to_one_logger_of_rclpy(capfd):
    log = SparingLog(get_logger("sparing"))
    log.error("bad")
    log.warning("odd")
    logged = capfd.readouterr().err
    assert "bad" in logged and "odd" in logged
