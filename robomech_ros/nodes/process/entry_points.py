"""Starts a node of this package by name, and answers signals from the very first moment.

A node's module takes a second to import, in which Python would answer a signal with a traceback.
The executables of the nodes and ``robomech bringup`` start them through here; so this module must
itself import next to nothing.
"""

import gc
import os
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from importlib import import_module
from typing import NoReturn

from robomech_ros.stop_signals import leave_on_signals

# Node name to module, in the order in which they are started.
_NODES = (
    *("joint_trajectory_controller", "kinematics", "dynamics", "trajectory_planner"),
    *(
        "trajectory_publisher",
        "move_group",
        "servo",
        "calibration",
        "rvs",
        "mobile_base",
        "grasping",
        "walker",
    ),
)
NODE_MODULES = {node: f"robomech_ros.nodes.{node}.node" for node in _NODES}

EXIT_CANNOT_START = 2


def main(args: Sequence[str] | None = None) -> NoReturn:
    """Run the node named by the first argument, and end the process."""
    argv = list(sys.argv[1:] if args is None else args)
    _run(argv[0] if argv else "", argv)


def _run(node: str, argv: Sequence[str]) -> NoReturn:
    leave_on_signals()
    # The linear algebra of NumPy and SciPy would reserve 80 MB for each processor; our matrices
    # are small.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Numba would load it wherever it is installed.
    sys.modules.setdefault("coverage", None)  # type: ignore[arg-type]
    if node not in NODE_MODULES:
        names = ", ".join(NODE_MODULES)
        print(f"unknown node {node!r}; available: {names}", file=sys.stderr)
        raise SystemExit(EXIT_CANNOT_START)
    # Hundreds of thousands of objects are made, and all stay: there is no garbage to look for.
    gc.disable()
    module = import_module(NODE_MODULES[node])
    gc.enable()
    code = int(module.main(argv))
    for stream in (sys.stdout, sys.stderr):
        # The reader may have gone, or there is none.
        with suppress(OSError, AttributeError):
            stream.flush()
    # All is done and said.  To take the interpreter and its libraries apart would take longer than
    # the node's own end, and waits for threads of the middleware.
    os._exit(code)


def _entry(node: str) -> Callable[[], NoReturn]:
    """Make what runs a node by the arguments of the process, and ends the process."""
    return lambda: _run(node, sys.argv)


kinematics_node = _entry("kinematics")
dynamics_node = _entry("dynamics")
trajectory_planner_node = _entry("trajectory_planner")
trajectory_publisher_node = _entry("trajectory_publisher")
joint_state_simulator_node = _entry("joint_trajectory_controller")
move_group_node = _entry("move_group")
servo_node = _entry("servo")
calibration_node = _entry("calibration")
rvs_node = _entry("rvs")
mobile_base_node = _entry("mobile_base")
grasping_node = _entry("grasping")
walker_node = _entry("walker")

if __name__ == "__main__":
    main()
