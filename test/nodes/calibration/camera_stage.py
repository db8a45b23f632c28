"""A robot's hand and a camera on tf or on topics, and the calibration node between them."""

from __future__ import annotations

import threading
import time

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseArray, PoseStamped
from tf2_msgs.msg import TFMessage

from robomech_interfaces.srv import (
    AddSamples,
    ListSamples,
    RemoveSample,
    SaveCalibration,
    SolveCalibration,
    TakeSample,
)
from robomech_ros.nodes.calibration.node import CalibrationNode
from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix, stamped_transform
from robomech_ros.spatial import pose_exponential

__all__ = ["FRAMES", "NANO", "Stage"]

NANO = 1_000_000_000
FRAMES = {
    "robot_base_frame": "base",
    "robot_effector_frame": "hand",
    "tracking_base_frame": "camera",
    "tracking_marker_frame": "marker",
}
_PERIOD = 0.02
# Long, since a machine may be busy; nothing waits longer than it has to.
TIMEOUT = 60.0
_KINDS = {
    "add_samples": AddSamples,
    "list_samples": ListSamples,
    "remove_sample": RemoveSample,
    "save": SaveCalibration,
    "solve": SolveCalibration,
    "take_sample": TakeSample,
}


class Stage:
    """Publishes poses fifty times a second until the test ends.

    Attributes
    ----------
    hand, marker : ndarray, shape (4, 4), or None
        What is published; None is nothing.
    drift : ndarray, shape (6,)
        By how much the hand turns (rad) and moves (m) on at each message.
    late : int
        How old the marker's stamps are (ns).
    """

    def __init__(self, graph, **parameters):
        self.graph, client = graph, graph.client
        self.node = graph.start(CalibrationNode, **{**FRAMES, **parameters})
        self.hand, self.marker = np.eye(4), np.eye(4)
        self.drift, self.late = np.zeros(6), 0
        self._lock = threading.Lock()
        self._tf = client.create_publisher(TFMessage, "/tf", 10)
        self._topics = {
            name: client.create_publisher(PoseStamped, parameters[f"{name}_topic"], 10)
            for name in ("robot", "tracking")
            if parameters.get(f"{name}_topic")
        }
        client.create_timer(_PERIOD, self._publish)

    def put(self, hand, marker):
        """Show these poses from now on."""
        with self._lock:
            self.hand, self.marker = hand, marker

    def _publish(self):
        now = self.graph.client.get_clock().now().nanoseconds
        with self._lock:
            if self.hand is not None:
                self.hand = self.hand @ pose_exponential(self.drift)
            poses = {"robot": (self.hand, "base", "hand", now)}
            poses["tracking"] = (self.marker, "camera", "marker", now - self.late)
        for name, (T, parent, child, stamp) in poses.items():
            if T is None:
                continue
            instant = Time(sec=stamp // NANO, nanosec=stamp % NANO)
            if name in self._topics:
                message = PoseStamped(pose=pose_from_matrix(T))
                message.header.frame_id, message.header.stamp = parent, instant
                self._topics[name].publish(message)
            else:
                transform = stamped_transform(T, parent, child)
                transform.header.stamp = instant
                self._tf.publish(TFMessage(transforms=[transform]))

    def ask(self, service, **fields):
        """Call a service of the node, whatever it answers."""
        kind = _KINDS[service]
        return self.graph.ask(kind, f"calibration/{service}", **fields)

    def do(self, service, **fields):
        """Call a service that must succeed."""
        response = self.ask(service, **fields)
        assert response.error_code == 0, response.error_msg
        return response

    def until(self, words, service="take_sample", **fields):
        """Call a service again and again until its message has these words; gives the answer."""
        deadline = time.monotonic() + TIMEOUT
        while words not in (answer := self.ask(service, **fields)).error_msg:
            assert time.monotonic() < deadline, answer.error_msg
        return answer

    def add(self, robot, tracking):
        """Return samples, whatever is answered."""
        return self.ask("add_samples", robot=array_of(robot), tracking=array_of(tracking))


def array_of(poses, frame=""):
    """Return matrices as a PoseArray."""
    message = PoseArray(poses=[pose_from_matrix(T) for T in poses])
    message.header.frame_id = frame
    return message
