"""Robots on which joints follow others, and all their postures by a search of another kind."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import Body, load_description, load_robot

DATA = Path(__file__).parent / "data" / "coupled"
INERTIA = (
    '<inertial><mass value="2"/><origin xyz="0.05 0 0.03"/>'
    '<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)


def coupled(name):
    """One of the robots, by the name of its file."""
    return load_robot(DATA / f"{name}.urdf")


def with_bodies(chain, seed=0):
    """The chain with a body for each of its joints."""
    random = np.random.default_rng(seed)
    bodies = tuple(
        Body(random.uniform(1.0, 2.0), random.normal(size=3) * 0.1, np.diag([0.02, 0.03, 0.04]))
        for _ in chain.all_joint_names
    )
    return replace(chain, bodies=bodies)


def palletizer_with_bodies():
    """The URDF of the palletizer with bodies of 2 kg, and drives that hold them."""
    text = (DATA / "palletizer.urdf").read_text(encoding="utf-8")
    for link in load_description(text).links[1:]:
        text = text.replace(f'<link name="{link}"/>', f'<link name="{link}">{INERTIA}')
    return text.replace('effort="10"', 'effort="60"')


def lifter():
    """A column of two stages, the second of which slides as far as the first."""
    joints = (
        ("turn", "revolute", "0 0 0.1", "0 0 1", ""),
        ("lift", "prismatic", "0 0 0.3", "0 0 1", ""),
        ("stage", "prismatic", "0 0 0.3", "0 0 1", '<mimic joint="lift" offset="0.02"/>'),
        ("swing", "revolute", "0.3 0 0.1", "0 0 1", ""),
    )
    text, parent = '<robot name="lifter"><link name="base"/>', "base"
    for name, kind, xyz, axis, mimic in joints:
        text += (
            f'<link name="{name}_link"/><joint name="{name}" type="{kind}">'
            f'<parent link="{parent}"/><child link="{name}_link"/><origin xyz="{xyz}"/>'
            f'<axis xyz="{axis}"/>'
            f'<limit lower="-1" upper="1" effort="1" velocity="1"/>{mimic}</joint>'
        )
        parent = f"{name}_link"
    tool = (
        '<link name="tool"/><joint name="tool_joint" type="fixed"><parent link="swing_link"/>'
        '<child link="tool"/><origin xyz="0.2 0 0"/></joint></robot>'
    )
    return load_robot(text + tool)


def found_by_newton(chain, T, starts):
    """All postures inside the limits that Newton's method reaches from random starts.

    It runs on all starts at once, on the 12 entries of the pose.
    """
    q = np.random.default_rng(1).uniform(chain.lower, chain.upper, (starts, chain.n))
    wanted = T[:3].T.ravel()
    for _ in range(60):
        poses, J = forward_kinematics(chain, q), jacobian(chain, q)
        turned = np.cross(
            J[:, None, :3].swapaxes(2, 3), poses[:, :3, :3].swapaxes(1, 2)[:, :, None]
        )
        rows = np.concatenate((turned.swapaxes(2, 3).reshape(starts, 9, -1), J[:, 3:]), axis=1)
        missed = wanted - poses[:, :3].swapaxes(1, 2).reshape(starts, 12)
        normal = rows.swapaxes(1, 2) @ rows + 1e-12 * np.eye(chain.n)
        step = np.linalg.solve(normal, (rows.swapaxes(1, 2) @ missed[..., None]))[..., 0]
        longest = np.abs(step).max(axis=1, keepdims=True)
        q = q + step * np.minimum(1.0, 0.5 / np.maximum(longest, 1e-12))
    error = np.abs(forward_kinematics(chain, q) - T).max(axis=(1, 2))
    q = q[error < 1e-9]
    turned = np.remainder(q + np.pi, 2.0 * np.pi) - np.pi
    q = np.where(chain.turns, turned, q)
    q = q[((q >= chain.lower) & (q <= chain.upper)).all(axis=1)]
    kept = []
    for row in q:
        if all(np.abs(row - other).max() > 1e-5 for other in kept):
            kept.append(row)
    return kept
