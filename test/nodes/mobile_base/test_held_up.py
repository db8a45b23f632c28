"""A base whose process was held up does not move by what came meanwhile."""

import signal
import subprocess
import sys
import threading
import time

import pytest
from nav_msgs.msg import Odometry
from twist_driver import Driver

from robomech_ros.nodes.mobile_base import node


@pytest.fixture
def base():
    """A base in a process of its own."""
    command = [sys.executable, "-m", node.__name__, "--ros-args"]
    command += ["-p", "robot_description:=omni", "-p", "cmd_vel_timeout:=0.3"]
    with subprocess.Popen(command) as process:
        yield process
        process.kill()


@pytest.mark.slow
def test_commands_without_a_stamp_from_that_time_move_nothing(graph, base):
    """The sender of such commands may have let go since."""
    said, news = [], threading.Event()

    def hear(message):
        said.append(message)
        news.set()

    graph.client.create_subscription(Odometry, "mobile_base/odom", hear, 100)
    driver = Driver(graph, "mobile_base/cmd_vel_unstamped", stamped=False)
    driver.command(0.3)

    def wait_for(what):
        while not (said and what(said[-1].twist.twist.linear.x)):
            news.clear()
            assert news.wait(60.0)

    wait_for(lambda speed: speed > 0.29)
    driver.silent()
    wait_for(lambda speed: speed == 0.0)
    base.send_signal(signal.SIGSTOP)
    driver.command(0.3)
    time.sleep(1.0)
    driver.silent()
    known = len(said)
    base.send_signal(signal.SIGCONT)
    wait_for(lambda speed: len(said) > known + 50)
    assert {message.twist.twist.linear.x for message in said[known:]} == {0.0}
    driver.command(0.3)
    wait_for(lambda speed: speed > 0.29)
