"""Measure the browser view of a running robot, with the Python that has ROS; print JSON.

`bench_view.py` starts this script in the environment of the suite.
"""

from __future__ import annotations

import json
import math
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState

from robomech_ros.robots import load_robot

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "rvs"))

import msgspec.msgpack
from raw_client import Client, camera

ROBOT, RATE = "panda", 60.0
SETTLE_SECONDS, SECONDS = 3.0, 15.0
ADDRESS = re.compile(r"/rvs: open (\S+)")


class Page:
    """The page at an address."""

    def __init__(self, url: str) -> None:
        self.url = url


@contextmanager
def running_view(options: Sequence[str]) -> Iterator[tuple[int, Page]]:
    """Run the node rvs with these ROS arguments; gives its process and its page."""
    command = [sys.executable, "-m", "robomech_ros.nodes.process.entry_points", "rvs", "--ros-args"]
    command += ["-p", f"robot_description:={ROBOT}", "-p", "port:=0", *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        found = None
        while found is None:
            assert process.stdout is not None
            line = process.stdout.readline()
            if not line:
                raise RuntimeError("the view does not come up")
            found = ADDRESS.match(line)
        yield process.pid, Page(found[1])
    finally:
        process.send_signal(signal.SIGINT)
        process.wait()


def processor_seconds(pid: int) -> float:
    """Return the processor time that a process has taken (s)."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def move_joints(node: Node, ended: threading.Event) -> None:
    """Publish the states of a robot whose joints all move, until told to end."""
    arm = load_robot(ROBOT)
    publisher = node.create_publisher(JointState, "joint_states", 10)
    middle, due = arm.home(), time.monotonic()
    while not ended.is_set():
        q = middle + 0.2 * math.sin(due)
        message = JointState(name=list(arm.joint_names), position=q.tolist())
        message.header.stamp = node.get_clock().now().to_msg()
        publisher.publish(message)
        due += 1.0 / RATE
        ended.wait(max(due - time.monotonic(), 0.0))


def measured(*options: str) -> dict[str, float]:
    """Return the share of a core that the node takes, and how often its page was told something."""
    rclpy.init(args=[])
    node, ended = Node("moving_joints"), threading.Event()
    mobile_robot = threading.Thread(target=move_joints, args=(node, ended))
    mobile_robot.start()
    told = 0
    try:
        with running_view(options) as (pid, page), Client(page).connect() as browser:
            browser.send(msgspec.msgpack.encode(camera()))
            deadline = time.monotonic() + SETTLE_SECONDS
            while (left := deadline - time.monotonic()) > 0.0:
                heard(browser, left)
            before, began = processor_seconds(pid), time.monotonic()
            while (left := began + SECONDS - time.monotonic()) > 0.0:
                told += heard(browser, left)
            lasted = time.monotonic() - began
            taken = processor_seconds(pid) - before
    finally:
        ended.set()
        mobile_robot.join()
        node.destroy_node()
        rclpy.try_shutdown()
    return {"core": taken / lasted, "rate": told / lasted, "seconds": lasted}


def heard(browser: object, patience: float) -> bool:
    """Take the next message of the page; says whether one came in time."""
    try:
        browser.recv(timeout=patience)  # type: ignore[attr-defined]
    except TimeoutError:
        return False
    return True


if __name__ == "__main__":
    print(json.dumps({"as set": measured(), "as told": measured("-p", f"rate:={RATE}")}))
