"""Robots with fingers and with joints that mimic others, and where their links are."""

import re
from pathlib import Path

import numpy as np
import pinocchio

from robomech_ros.spatial import matrix_from_quaternion

ROOT = Path(__file__).resolve().parents[3]

# An arm as of a palletiser: a bar beside its upper arm, and a wrist that stays level.
PALLETISER = """
<robot name="palletiser">
  <link name="base_link"/><link name="upper"/><link name="bar"/><link name="fore"/>
  <link name="level"/><link name="tool0"/>
  <joint name="level_joint" type="revolute">
    <parent link="fore"/><child link="level"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-6" upper="6" effort="10" velocity="4"/>
    <mimic joint="bar_joint" multiplier="-0.5" offset="0.3"/>
  </joint>
  <joint name="bar_joint" type="revolute">
    <parent link="base_link"/><child link="bar"/><origin xyz="0.1 0 0.3"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="10" velocity="2"/><mimic joint="shoulder" offset="0.1"/>
  </joint>
  <joint name="shoulder" type="revolute">
    <parent link="base_link"/><child link="upper"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="10" velocity="2"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="fore"/><origin xyz="0.5 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="10" velocity="2"/>
  </joint>
  <joint name="tool" type="fixed">
    <parent link="fore"/><child link="tool0"/><origin xyz="0.4 0 0"/>
  </joint>
</robot>"""


def panda_with_hand():
    """The URDF that an example makes: the library's Panda with Franka's hand."""
    example = (ROOT / "examples" / "add_a_gripper.py").read_text(encoding="utf-8")
    hand = re.search(r'^HAND = """(.*?)"""', example, re.DOTALL | re.MULTILINE)[1]
    arm = (ROOT / "config" / "robots" / "panda.urdf").read_text(encoding="utf-8")
    return arm.replace("</robot>", hand)


def poses_by_pinocchio(urdf, positions):
    """Poses of all links in the root, by Pinocchio, at positions of all joints that move."""
    model = pinocchio.buildModelFromXML(urdf)
    data, q = model.createData(), pinocchio.neutral(model)
    for name, position in positions.items():
        q[model.joints[model.getJointId(name)].idx_q] = position
    pinocchio.framesForwardKinematics(model, data, q)
    return {
        frame.name: placement.homogeneous
        for frame, placement in zip(model.frames, data.oMf, strict=True)
        if frame.type == pinocchio.FrameType.BODY
    }


def poses_by_frames(*messages):
    """Poses of all frames in the root of the tree that messages of /tf and /tf_static make."""
    frames = {entry.child_frame_id: entry for message in messages for entry in message.transforms}

    def pose(name):
        if name not in frames:
            return np.eye(4)
        place, turn = frames[name].transform.translation, frames[name].transform.rotation
        step = np.eye(4)
        step[:3, 3] = place.x, place.y, place.z
        step[:3, :3] = matrix_from_quaternion([turn.x, turn.y, turn.z, turn.w])
        return pose(frames[name].header.frame_id) @ step

    return {name: pose(name) for name in frames}
