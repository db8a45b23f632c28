"""Robots as RViz would see them: descriptions and frames of two robots in two namespaces."""

from __future__ import annotations

import threading

import numpy as np
import pinocchio
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from robomech_interfaces.srv import SolveFK, SolveIK
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.robots import load_description, load_robot
from robomech_ros.spatial import matrix_from_quaternion

PATIENCE = 60.0
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SIDES = {"left": "ur5e", "right": "puma560"}


class Viewer:
    """Sees what RViz sees: descriptions and tf; and the joint states."""

    def __init__(self, node):
        self.news = threading.Condition()
        self.descriptions, self.states = {}, {side: {} for side in SIDES}
        self.frames = {}
        for side in SIDES:
            self._watch(node, String, f"{side}/robot_description", LATCHED, side, self._describe)
            self._watch(node, JointState, f"{side}/joint_states", 100, side, self._place)
        for topic, qos in (("/tf", 100), ("/tf_static", LATCHED)):
            self._watch(node, TFMessage, topic, qos, "", self._put)

    def _watch(self, node, kind, topic, qos, side, take):
        def receive(message):
            with self.news:
                take(side, message)
                self.news.notify_all()

        node.create_subscription(kind, topic, receive, qos)

    def _describe(self, side, message):
        self.descriptions.setdefault(side, []).append(message.data)

    def _place(self, side, message):
        stamp = (message.header.stamp.sec, message.header.stamp.nanosec)
        self.states[side][stamp] = dict(zip(message.name, message.position, strict=True))

    def _put(self, side, message):
        for entry in message.transforms:
            self.frames[entry.child_frame_id] = entry

    def until(self, condition):
        with self.news:
            assert self.news.wait_for(condition, PATIENCE), sorted(self.frames)

    def positions(self, frame):
        """Return the joint positions at the instant of a moving frame; None without a message."""
        stamp = self.frames[frame].header.stamp
        return self.states[frame.split("/")[0]].get((stamp.sec, stamp.nanosec))

    def pose(self, frame):
        """Chain the frames from the root of the tree."""
        if frame not in self.frames:
            return np.eye(4)
        entry = self.frames[frame].transform
        place, turn = entry.translation, entry.rotation
        step = np.eye(4)
        step[:3, :3] = matrix_from_quaternion([turn.x, turn.y, turn.z, turn.w])
        step[:3, 3] = place.x, place.y, place.z
        return self.pose(self.frames[frame].header.frame_id) @ step


def test_two_robots_are_described_and_placed_in_two_trees(bringup, outsider):
    viewer = Viewer(outsider.node)
    options = {
        side: ("--robot", name, "--namespace", side, "--in-one-process", "--no-servo")
        for side, name in SIDES.items()
    }
    with bringup(*options["left"]), bringup(*options["right"]):
        viewer.until(lambda: viewer.descriptions.keys() == SIDES.keys())
        for side, name in SIDES.items():
            (urdf,) = viewer.descriptions[side]
            model = pinocchio.buildModelFromXML(urdf)
            described = load_description(urdf)
            others = [joint.child for joint in described.joints]
            moving = f"{side}/{next(j.child for j in described.joints if j.moves)}"
            wanted = {f"{side}/{link}" for link in others}
            viewer.until(lambda w=wanted: w <= viewer.frames.keys())
            viewer.until(lambda m=moving: viewer.positions(m))
            with viewer.news:
                positions = viewer.positions(moving)
                found = {link: viewer.pose(f"{side}/{link}") for link in others}
            data, q = model.createData(), pinocchio.neutral(model)
            for joint, position in positions.items():
                q[model.joints[model.getJointId(joint)].idx_q] = position
            pinocchio.framesForwardKinematics(model, data, q)
            for link in others:
                expected = data.oMf[model.getFrameId(link)].homogeneous
                np.testing.assert_allclose(found[link], expected, atol=1e-12)
            answers_in_its_frames(outsider, side, name, described.root)
        assert {name.split("/")[0] for name in viewer.frames} == set(SIDES)


def answers_in_its_frames(outsider, side, name, base):
    """Ask for a pose and its solutions, in frames with and without the prefix."""
    chain, service = load_robot(name), f"{side}/kinematics"
    state = joint_state(chain.joint_names, chain.home())
    request = SolveFK.Request(states=[state])
    pose = outsider.call(SolveFK, f"{service}/solve_fk", request).poses[0]
    assert pose.header.frame_id == f"{side}/{base}"
    for frame in (f"{side}/{base}", base):
        pose.header.frame_id = frame
        request = SolveIK.Request(target=pose, seed=state)
        answer = outsider.call(SolveIK, f"{service}/solve_ik", request)
        assert answer.error_code == 0, answer.error_msg
        np.testing.assert_allclose(answer.solutions[0].positions, chain.home(), atol=1e-8)
