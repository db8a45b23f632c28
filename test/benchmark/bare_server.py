"""A bare rclpy service that answers every SolveIK request with one response read from a file.

Run by `drive_nodes.py` in a process of its own: what a round trip costs when nothing is solved.
"""

from __future__ import annotations

import sys
from pathlib import Path

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.serialization import deserialize_message

from robomech_interfaces.srv import SolveIK


def main(path: str) -> None:
    """Serve `bare/solve_ik` with the serialised response in the file at `path` until stopped."""
    canned = deserialize_message(Path(path).read_bytes(), SolveIK.Response)
    rclpy.init()
    node = rclpy.create_node("bare")
    node.create_service(SolveIK, "~/solve_ik", lambda _request, _response: canned)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv[1])
