"""Where the frame of a robot that moves is published."""

from typing import Any

from rclpy.node import Node

__all__ = ["odometry_frame"]

# As tf2_ros has it.
_DEPTH = 100


def odometry_frame(node: Node, topic: str) -> Any:
    """Make the publisher of tf2_msgs/TFMessage; None, with a warning, without these messages.

    Parameters
    ----------
    node : Node
        Its owner.
    topic : str
        Such as ``/tf``.
    """
    try:
        from tf2_msgs.msg import TFMessage
    except ImportError as error:
        node.get_logger().warning(f"no frames are published: {error}")
        return None
    return node.create_publisher(TFMessage, topic, _DEPTH)
