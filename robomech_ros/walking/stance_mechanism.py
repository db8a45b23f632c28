"""Planted feet: the parallel robot that trunk, legs and ground make."""

from collections.abc import Sequence

import numpy as np
import scipy.linalg

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.parallel import Limb, Mechanism
from robomech_ros.parallel.mechanism.limb import Axis, chain_of_axes
from robomech_ros.robots import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.spatial.cross_product import cross_product_matrix
from robomech_ros.typing import Array

# Part of the greatest pivot below which one is zero.
_ZERO = 1e-9


def contact_rows(feet: Array) -> Array:
    """Return the matrix from trunk twist [w; v] to velocities of its points (3 m, 6)."""
    rows = np.zeros((len(feet), 3, 6))
    rows[:, :, 3:] = np.eye(3)
    rows[:, :, :3] = -cross_product_matrix(feet)
    return rows.reshape(-1, 6)


def stance_mechanism(
    names: Sequence[str], legs: Sequence[SerialChain], q: Array, robot: str
) -> Mechanism:
    """Make the mechanism of legs whose feet stand at joints q (k, 3), from ground to trunk."""
    poses = np.array([forward_kinematics(leg, one) for leg, one in zip(legs, q, strict=True)])
    drives = _holding(legs, q, poses[:, :3, 3])
    limbs = []
    for i, (name, leg, at) in enumerate(zip(names, legs, q, strict=True)):
        foot = poses[i, :3, 3]
        axes = [
            Axis(f"{name}_foot_{key}", f"{name}_foot_{key}_link", axis, foot)
            for key, axis in zip("xyz", np.eye(3), strict=True)
        ]
        J = jacobian(leg, at)
        # A rotation of the leg against the trunk is the opposite one of the trunk against the leg.
        for k in reversed(range(leg.n)):
            slides = bool(leg.types[k] == PRISMATIC)
            axis = J[3:, k] if slides else J[:3, k]
            point = foot if slides else foot - np.cross(J[3:, k], axis)
            limits = (float(leg.lower[k] - at[k]), float(leg.upper[k] - at[k]))
            joint = leg.joint_names[k]
            axes.append(Axis(joint, f"{joint}_link", -axis, point, slides, limits))
        tip = "trunk" if i == 0 else f"{name}_trunk"
        chain = chain_of_axes(robot, axes, np.eye(4), tip)
        limbs.append(Limb(chain, [joint for joint in leg.joint_names if joint in drives]))
    return Mechanism(limbs, name=robot)


def _holding(legs: Sequence[SerialChain], q: Array, feet: Array) -> set[str]:
    """Choose six joints whose rates tell most of the twist of the trunk."""
    J = [jacobian(leg, one)[3:] for leg, one in zip(legs, q, strict=True)]
    names = [joint for leg in legs for joint in leg.joint_names]
    rows = contact_rows(feet).reshape(-1, 3, 6)
    try:
        rates = np.concatenate([np.linalg.solve(a, b) for a, b in zip(J, rows, strict=True)])
    except np.linalg.LinAlgError:
        rates = np.zeros((len(names), 6))
    _, triangle, order = scipy.linalg.qr(rates.T, mode="economic", pivoting=True)
    pivots = np.abs(np.diag(triangle))
    if not pivots[-1] > _ZERO * pivots[0]:
        raise BadValueError("posture of the planted legs", q.tolist(), "one that holds the trunk")
    return {names[i] for i in order[:6]}
