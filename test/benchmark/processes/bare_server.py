"""A bare rclpy service that answers every request with one response read from a file.

Run by `drive_nodes.py` in a process of its own: what a round trip costs when nothing is computed.
"""

from __future__ import annotations

import sys
from pathlib import Path

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.serialization import deserialize_message

from robomech_interfaces import srv


def main(kind: str, path: str) -> None:
    """Serve `bare/<kind>` with the serialised response in the file at `path` until stopped."""
    service = getattr(srv, kind)
    canned = deserialize_message(Path(path).read_bytes(), service.Response)
    rclpy.init()
    node = rclpy.create_node("bare")
    node.create_service(service, f"~/{kind}", lambda _request, _response: canned)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main(*sys.argv[1:])
