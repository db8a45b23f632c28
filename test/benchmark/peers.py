"""Build the peers' models from our chain, so that both sides solve the same arm."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio

from robomech_ros.typing import Array

if TYPE_CHECKING:
    from eaik.IK_Homogeneous import HomogeneousRobot

    from robomech_ros.robots import SerialChain


def constant_transforms(chain: SerialChain) -> Array:
    """Return the n + 1 constant transforms between the joint frames of `chain`, (n + 1, 4, 4)."""
    transforms = np.tile(np.eye(4), (chain.n + 1, 1, 1))
    transforms[:, :3, :3] = chain.packed[:, 1:10].reshape(-1, 3, 3)
    transforms[:, :3, 3] = chain.packed[:, 10:13]
    return transforms


def pinocchio_model(chain: SerialChain) -> tuple[Any, Any, int]:
    """Return Pinocchio's model of `chain`, its data, and the number of the frame at the tip."""
    placements = [pinocchio.SE3(t[:3, :3], t[:3, 3]) for t in constant_transforms(chain)]
    model = pinocchio.Model()
    joint = 0
    for index, name in enumerate(chain.joint_names):
        kind = pinocchio.JointModelPZ() if chain.types[index] else pinocchio.JointModelRZ()
        joint = model.addJoint(joint, kind, placements[index], name)
    frame = pinocchio.Frame("tip", joint, 0, placements[-1], pinocchio.FrameType.OP_FRAME)
    tip = model.addFrame(frame)
    return model, model.createData(), tip


def eaik_robot(chain: SerialChain) -> HomogeneousRobot:
    """Return EAIK's model of `chain`, a chain of revolute joints."""
    from eaik.IK_Homogeneous import HomogeneousRobot

    frames = np.empty((chain.n + 1, 4, 4))
    frame = np.eye(4)
    for index, transform in enumerate(constant_transforms(chain)):
        frame = frame @ transform
        frames[index] = frame
    return HomogeneousRobot(frames)
