"""Factors of the Jacobian's determinant that have names: shoulder, elbow, wrist.

Arms with a spherical wrist, with parallel axes or with spherical shoulder and wrist have such.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from robomech_ros._kernels.kinetostatics import posture_factors as kind
from robomech_ros.kinematics.axis_points import common_point, nearest_points
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.kinematics.tolerances import ARM_RANK
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.typing import Array, IntArray

# Axes that miss a common point by less than this (over the size) meet, for the name of a part.
NAMED_MISFIT = 1e-6

_Joints = tuple[int, ...]

# Names of the factors, in the order in which the kernel writes them.
_NAMES = {
    kind.SPHERICAL_ENDS: ("shoulder", "wrist"),
    kind.ONE_ELBOW: ("shoulder", "elbow", "wrist"),
    kind.ARM_AND_WRIST: ("arm", "wrist"),
    kind.SHOULDER_ELBOW_WRIST: ("shoulder", "elbow", "wrist"),
    kind.PARALLEL: ("elbow",),
    kind.PARALLEL_OUTER: ("elbow", "wrist"),
    kind.PARALLEL_SIX: ("shoulder", "elbow", "wrist"),
    kind.WRIST: ("wrist",),
}


class NamedParts(NamedTuple):
    """Data of an arm for the kernel ``posture_factors``, the same in every posture.

    Each name is that of a factor without unit, zero where this part of the arm is singular.  The
    joints (6,) are the kind of arm; the first joint of the shoulder, that of the wrist, and three
    with parallel axes, from 0.  The size is that of the arm (m).
    """

    names: tuple[str, ...]
    joints: IntArray
    size: float


@lru_cache(maxsize=64)
def named_parts(chain: SerialChain) -> NamedParts:
    """Find the parts of an arm whose singularities have names.

    References
    ----------
    Angeles, Fundamentals of Robotic Mechanical Systems, 4th ed., section 5.4.
    """
    size = arm_size(chain)
    if chain.coupling is not None:
        # The factors belong to joints that move independently.
        return NamedParts((), np.zeros(6, dtype=np.int64), size)
    links = chain.transforms
    turning = tuple(i for i in range(chain.n) if chain.types[i] != PRISMATIC)
    parallel = _parallel(chain, links)
    first, last = (_concurrent(links, joints, size) for joints in (turning[:3], turning[-3:]))
    found = _kind(chain, links, size, turning, (first, last, parallel))
    three = parallel[:3] if len(parallel) > 2 else (0, 0, 0)
    joints = np.array([found, *(first[:1] or (0,)), *(last[:1] or (0,)), *three])
    return NamedParts(_NAMES.get(found, ()), joints, size)


def _kind(
    chain: SerialChain,
    links: Array,
    size: float,
    turning: _Joints,
    parts: tuple[_Joints, _Joints, _Joints],
) -> int:
    """Tell what an arm is made of, 0 if of nothing that has a name."""
    first, last, parallel = parts
    if last and first and last[0] > first[-1]:
        return kind.ONE_ELBOW if last[0] - first[-1] == 2 else kind.SPHERICAL_ENDS
    if last == (3, 4, 5) and chain.n == 6:
        return kind.SHOULDER_ELBOW_WRIST if parallel[:2] == (1, 2) else kind.ARM_AND_WRIST
    if len(parallel) >= 3:
        if turning != (0, 1, 2, 3, 4, 5) or parallel != (1, 2, 3):
            return kind.PARALLEL
        outer = nearest_points(links[5])
        meet = outer is not None and outer[2] <= NAMED_MISFIT * size
        return kind.PARALLEL_SIX if meet else kind.PARALLEL_OUTER
    return kind.WRIST if last else 0


def _parallel(chain: SerialChain, links: Array) -> _Joints:
    """Return the longest run of revolute joints with parallel axes, if it is two or more."""
    runs: list[list[int]] = [[]]
    direct = np.eye(3)
    for i in range(chain.n):
        if i:
            direct = direct @ links[i, :3, :3]
        if chain.types[i] == PRISMATIC:
            continue
        if runs[-1] and np.hypot(*direct[:2, 2]) > ARM_RANK:
            runs.append([])
        runs[-1].append(i)
        direct = np.eye(3)
    longest = max(runs, key=len)
    return tuple(longest) if len(longest) > 1 else ()


def _concurrent(links: Array, joints: _Joints, size: float) -> _Joints:
    """Return three neighbouring joints if their axes meet in one point, else none."""
    if len(joints) < 3 or joints[2] - joints[0] != 2:
        return ()
    found = common_point(links[joints[1]], links[joints[2]])
    return joints if found is not None and found[2] <= NAMED_MISFIT * size else ()
