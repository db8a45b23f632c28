"""Publishes joint_states, without making anything new for each message."""

import numpy as np
from numpy.typing import NDArray
from rclpy.node import Node
from sensor_msgs.msg import JointState

from robomech_ros.execution.joints import State
from robomech_ros.nodes.common.message_fields import floats
from robomech_ros.nodes.common.robot_description import RobotModel

__all__ = ["StatePublisher"]

# Reliable; what is older than the last ten states is of no interest to anybody.
_DEPTH = 10


class StatePublisher:
    """Publishes the positions and velocities of all joints of a robot, in the order of its URDF.

    Joints that do not belong to the chain stand still at 0, or at the limit nearest to it; their
    efforts are not known, NaN.

    Parameters
    ----------
    node : Node
        Owner of the publisher.
    model : RobotModel
        The robot and its chain.
    with_effort : bool
        Whether there are efforts to be published.
    """

    def __init__(self, node: Node, model: RobotModel, with_effort: bool) -> None:
        joints = [joint for joint in model.description.joints if joint.moves and not joint.mimic]
        rest = np.array([min(max(0.0, joint.lower), joint.upper) for joint in joints])
        names = [joint.name for joint in joints]
        self._places = np.array([names.index(name) for name in model.chain.joint_names])
        self._message = JointState(
            name=names, position=floats(rest), velocity=floats(np.zeros(len(names)))
        )
        # The message's arrays, written in place.
        if with_effort:
            self._message.effort = floats(np.full(len(names), np.nan))
        self._effort = np.frombuffer(self._message.effort) if with_effort else None
        self._position = np.frombuffer(self._message.position)
        self._velocity = np.frombuffer(self._message.velocity)
        self._publisher = node.create_publisher(JointState, "joint_states", _DEPTH)

    @property
    def positions(self) -> dict[str, float]:
        """Position (rad or m) of every joint, as published last."""
        return dict(zip(self._message.name, self._message.position, strict=True))

    def publish(
        self, state: State, effort: NDArray[np.float64] | None, stamp: tuple[int, int]
    ) -> None:
        """Publish a state, what the drives exert (N m or N), and their ROS time (s and ns)."""
        self._put(self._position, state.position)
        self._put(self._velocity, state.velocity)
        if self._effort is not None and effort is not None:
            self._put(self._effort, effort)
        when = self._message.header.stamp
        when.sec, when.nanosec = stamp
        self._publisher.publish(self._message)

    def _put(self, place: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        place[self._places] = values
