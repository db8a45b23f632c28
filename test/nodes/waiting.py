"""Waiting for nodes, and machines on which a package is not installed."""

import sys
import time

import numpy as np
from sensor_msgs.msg import JointState

from robomech_interfaces.srv import SolveFK
from robomech_ros.nodes.common.messages.joint_messages import joint_state

# Long, since a machine may be busy; nothing waits longer than it has to.
PATIENCE = 60.0


def until(condition, what="what is waited for does not come"):
    """Wait until a condition holds."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, what
        time.sleep(0.01)


def publish_present(graph, q, names):
    """Publish a joint state until the node kinematics uses it as the present one."""
    publisher = graph.client.create_publisher(JointState, "joint_states", 10)
    message = joint_state(names, np.asarray(q, dtype=float))
    timer = graph.client.create_timer(0.01, lambda: publisher.publish(message))
    graph.call_until(
        SolveFK, "kinematics/solve_fk", SolveFK.Request(), lambda answer: not answer.error_code
    )
    timer.cancel()


class _NotInstalled:
    """Python's import on a machine without a package."""

    def __init__(self, package):
        self.package = package

    def find_spec(self, name, path=None, target=None):
        if name == self.package:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


def hide_package(monkeypatch, package, *users):
    """Make a package, and what starts with these names, as not imported and not installed."""
    for name in list(sys.modules):
        if name.partition(".")[0] == package or name.startswith(users):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "meta_path", [_NotInstalled(package), *sys.meta_path])
