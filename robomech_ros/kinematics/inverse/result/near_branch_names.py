"""Shoulder, elbow and wrist of arms that only nearly have them.

Descriptions with rounded angles, 1.5708 for a right one, have wrist axes that miss each other by a
little, or axes that are not quite parallel.  Such an arm is solved by a family that assumes
nothing about it, which numbers its postures.  Here they get the names that the same joint values
have in the arm that was meant.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.inverse import branch_bits as bit
from robomech_ros._kernels.inverse.decoupled import layout as decoupled_layout
from robomech_ros._kernels.inverse.parallel import layout as parallel_layout
from robomech_ros._kernels.inverse.six_joints import (
    DECOUPLED,
    MAX_SOLUTIONS,
    THREE_PARALLEL,
    six_joint_postures,
)
from robomech_ros.kinematics.axis_points import nearest_points
from robomech_ros.kinematics.forward import forward_kinematics
from robomech_ros.kinematics.inverse.families import decoupled, three_parallel
from robomech_ros.kinematics.inverse.families.six_joints import chain_of
from robomech_ros.kinematics.inverse.result.branch_names import largest_difference
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.kinematics.tolerances import NEARLY_NAMED
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import unpack_chain
from robomech_ros.typing import Array, IntArray

# A posture is found again (rad) from its own pose to this, though it be a double root.
SAME_NAMED = 1e-4


_NAME = bit.SHOULDER_RIGHT | bit.ELBOW_DOWN | bit.WRIST_FLIP
_NUMBER = bit.ARM_NUMBERED | bit.POSTURE_NUMBERED | bit.ARM_MASK
# Families with named postures, and where in their constants it stands that they have names.
_NAMED = (
    (decoupled.match, DECOUPLED, decoupled_layout.NAMED),
    (three_parallel.match, THREE_PARALLEL, parallel_layout.NAMED),
)


class _Namesake(NamedTuple):
    """The arm that was meant, with the number of its family and the constants of that."""

    chain: SerialChain
    family: int
    data: Array


def named_branches(chain: SerialChain, q: Array, branch: IntArray) -> IntArray:
    """Name numbered postures q (k, 6) of an arm of six joints by their nearest branches.

    Returns their bits (k,) with names in place of numbers, where the arm nearly has them.
    """
    arm = _namesake(chain)
    if arm is None:
        return branch
    others, bits = np.empty((MAX_SOLUTIONS, 6)), np.empty(MAX_SOLUTIONS, np.int64)
    named = branch.copy()
    for k, T in enumerate(forward_kinematics(arm.chain, q)):
        count = six_joint_postures(arm.family, False, arm.data, T, q[k], others, bits)
        away = largest_difference(chain, others[:count], q[k])
        if count and away.min() < SAME_NAMED:
            named[k] = branch[k] & ~(_NUMBER | _NAME) | bits[np.argmin(away)] & _NAME
    return named


@lru_cache(maxsize=128)
def _namesake(chain: SerialChain) -> _Namesake | None:
    """Find the arm with named postures that an arm nearly is."""
    meant = _straightened(chain)
    for match, family, named in _NAMED:
        data = match(meant)
        if data is not None and data[named] != 0.0:
            return _Namesake(meant, family, data)
    return None


def _straightened(chain: SerialChain) -> SerialChain:
    """Make neighbouring axes parallel, or meet, that nearly do, and the last three in one point."""
    C = unpack_chain(chain.packed)
    slack = NEARLY_NAMED * arm_size(chain)
    for link in C[1:6]:
        _align(link)
        points = nearest_points(link)
        if points is not None and points[2] < slack:
            link[:3, 3] -= _across(link)
    before, behind = nearest_points(C[4]), nearest_points(C[5])
    if before is not None and behind is not None and abs(before[1] - behind[0]) < slack:
        C[5, 2, 3] += before[1] - behind[0]
    return chain_of(C, chain.types.tolist())


def _align(link: Array) -> None:
    """Make the axes before and behind a link, (4, 4), parallel if they nearly are."""
    x, y, z = link[:3, 2]
    sine = math.hypot(x, y)
    if 0.0 < sine < NEARLY_NAMED:
        # The shortest turn, about (y, -x, 0), that takes the axis behind to that before.
        u, v = y / sine, -x / sine
        s, c = math.copysign(sine, z), abs(z)
        versine = 1.0 - c
        turn = [
            [c + versine * u * u, versine * u * v, s * v],
            [versine * u * v, c + versine * v * v, -s * u],
            [-s * v, s * u, c],
        ]
        link[:3, :3] = np.array(turn) @ link[:3, :3]
        link[:3, 2] = 0.0, 0.0, math.copysign(1.0, z)


def _across(link: Array) -> Array:
    """Return the vector by which the axis behind a link passes that before."""
    normal = np.array([-link[1, 2], link[0, 2], 0.0])
    normal /= np.linalg.norm(normal)
    return (link[:3, 3] @ normal) * normal
