"""Somebody who listens to tf, and somebody else who publishes frames, by Pinocchio."""

import threading

import numpy as np
import pinocchio
from geometry_msgs.msg import TransformStamped
from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.time import Time
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.spatial import matrix_from_quaternion

TIMEOUT = 30.0
ALL_LATCHED = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# What the other one's frames are lifted by (m), so that one can see whose they are.
LIFT = 1e-3
# An arm of one joint with two fingers, of which one follows, and a pad that follows that.
GRIPPER = """<robot name="gripper"><link name="base"/><link name="arm"/><link name="left"/>
  <link name="right"/><link name="pad"/><link name="tool0"/>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
    <origin xyz="0 0 0.2" rpy="0.1 0.2 0.3"/><axis xyz="0 0.6 0.8"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
  <joint name="tool" type="fixed"><parent link="arm"/><child link="tool0"/>
    <origin xyz="0 0 0.3"/></joint>
  <joint name="grip" type="prismatic"><parent link="tool0"/><child link="left"/>
    <axis xyz="0 1 0"/><limit lower="0.01" upper="0.04" velocity="1" effort="1"/></joint>
  <joint name="grip_2" type="prismatic"><parent link="tool0"/><child link="right"/>
    <axis xyz="0 -1 0"/><limit lower="0" upper="0.04" velocity="1" effort="1"/>
    <mimic joint="grip" multiplier="0.9" offset="0.001"/></joint>
  <joint name="pad_joint" type="revolute"><parent link="right"/><child link="pad"/>
    <axis xyz="1 0 0"/><limit lower="-3" upper="3" velocity="1" effort="1"/>
    <mimic joint="grip_2" multiplier="-20"/></joint>
</robot>"""


class PinocchioRobot:
    """A URDF as Pinocchio reads it."""

    def __init__(self, urdf):
        self.model = pinocchio.buildModelFromXML(urdf)
        self._data = self.model.createData()
        bodies = {f.name for f in self.model.frames if f.type == pinocchio.FrameType.BODY}
        self.links = bodies - {"universe"}

    def poses(self, positions):
        """Return the pose of every link in the root, at positions of all joints that move."""
        q = pinocchio.neutral(self.model)
        for name, position in positions.items():
            joint = self.model.joints[self.model.getJointId(name)]
            turning = joint.nq == 2
            q[joint.idx_q : joint.idx_q + joint.nq] = (
                [np.cos(position), np.sin(position)] if turning else position
            )
        pinocchio.framesForwardKinematics(self.model, self._data, q)
        return {
            frame.name: self._data.oMf[k].homogeneous.copy()
            for k, frame in enumerate(self.model.frames)
            if frame.name in self.links
        }


class StatePublisher(Node):
    """Substitute for robot_state_publisher: the description, and the frames of each joint state.

    Parameters
    ----------
    urdf : str
    edges : mapping
        Child to parent, of the links whose frames it publishes.
    moving : set of str
        Those of them that go to /tf, the others to /tf_static.
    """

    def __init__(self, urdf, edges, moving, describe=True, **options):
        super().__init__("robot_state_publisher", **options)
        self._robot, self._edges, self._moving = PinocchioRobot(urdf), edges, moving
        if describe:
            self.create_publisher(String, "robot_description", LATCHED).publish(String(data=urdf))
        self._publisher = self.create_publisher(TFMessage, "/tf", 100)
        fixed = self.create_publisher(TFMessage, "/tf_static", LATCHED)
        at_rest = dict.fromkeys((n for n in self._robot.model.names if n != "universe"), 0.0)
        stamp = self.get_clock().now().to_msg()
        fixed.publish(self._message(at_rest, [c for c in edges if c not in moving], stamp))
        self.create_subscription(JointState, "joint_states", self._take, 10)

    def _take(self, state):
        positions = dict(zip(state.name, state.position, strict=True))
        # As robot_state_publisher has it: with the stamp of the joint state.
        self._publisher.publish(self._message(positions, [*self._moving], state.header.stamp))

    def _message(self, positions, children, stamp):
        poses, message = self._robot.poses(positions), TFMessage()
        for child in children:
            step = np.linalg.inv(poses[self._edges[child]]) @ poses[child]
            entry = TransformStamped(child_frame_id=child)
            entry.header.frame_id, entry.header.stamp = self._edges[child], stamp
            place, turn = entry.transform.translation, entry.transform.rotation
            place.x, place.y, place.z = step[:3, 3] + [0.0, 0.0, LIFT]
            turn.x, turn.y, turn.z, turn.w = pinocchio.Quaternion(step[:3, :3]).coeffs().tolist()
            message.transforms.append(entry)
        return message


class Listener:
    """Keeps what tf says and what nodes log."""

    def __init__(self, client):
        self._news, self._clock = threading.Condition(), client.get_clock()
        self.moving, self.fixed, self.logs, self.states = [], [], [], []
        for kind, topic, into, qos in (
            (TFMessage, "/tf", self.moving, 100),
            (TFMessage, "/tf_static", self.fixed, ALL_LATCHED),
            (Log, "/rosout", self.logs, ALL_LATCHED),
        ):
            client.create_subscription(kind, topic, self._taker(into), qos)

    def _taker(self, into):
        def take(message):
            with self._news:
                into.append(message)
                self._news.notify_all()

        return take

    def until(self, condition):
        """Wait until something is so, looking whenever there is news."""
        with self._news:
            assert self._news.wait_for(condition, TIMEOUT), [log.msg for log in self.logs]

    def until_said(self, text):
        """Wait until a node has logged this, after what was waited for before."""

        def said():
            for k, log in enumerate(self.logs):
                if text in log.msg:
                    del self.logs[: k + 1]
                    return True
            return False

        self.until(said)

    def frames(self, messages=30):
        """Collect frames of later instants than now: child to all transforms, but fixed ones."""
        now, first = self._clock.now(), len(self.moving)

        def later():
            heard = (
                [entry for entry in m.transforms if instant(entry) > now]
                for m in self.moving[first:]
            )
            return [entries for entries in heard if entries]

        self.until(lambda: len(later()) >= messages)
        found = {}
        for entries in later():
            for entry in entries:
                found.setdefault(entry.child_frame_id, []).append(entry)
        return found

    def latest(self):
        """Return the last transform of every frame, moving or fixed."""
        with self._news:
            messages = [*self.fixed, *self.moving]
        return {entry.child_frame_id: entry for m in messages for entry in m.transforms}


def instant(entry):
    return Time.from_msg(entry.header.stamp)


def pose_of(entry):
    """Read a transform."""
    place, turn = entry.transform.translation, entry.transform.rotation
    pose = np.eye(4)
    pose[:3, 3] = place.x, place.y, place.z
    pose[:3, :3] = matrix_from_quaternion([turn.x, turn.y, turn.z, turn.w])
    return pose


def poses_in_root(frames, prefix=""):
    """Chain transforms: the pose of every frame in the root of its tree, by link."""

    def pose(name):
        if name not in frames:
            return np.eye(4)
        return pose(frames[name].header.frame_id) @ pose_of(frames[name])

    names = {*frames, *(entry.header.frame_id for entry in frames.values())}
    assert all(name.startswith(prefix) for name in names)
    return {name.removeprefix(prefix): pose(name) for name in names}
