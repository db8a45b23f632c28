"""Arms with more than six joints: all postures for each value of a parameter.

Covered are arms of seven revolute joints with a spherical shoulder and a spherical wrist, whose
parameter is the arm angle, and all others in which six neighbouring joints are an arm that moves
in all directions, one with a closed form before any other; the joints before and after them are
locked at values of choice.  A joint between the six need not be
locked: three axes next to each other that meet at an end of the six, or are parallel, stay
together when the first or the last joint of the arm is locked.
"""

from collections.abc import Sequence

import numpy as np

from robomech_ros._kernels.inverse.decoupled import layout as wrist_at
from robomech_ros._kernels.inverse.redundant import layout as at
from robomech_ros._kernels.inverse.six_joints import DECOUPLED, ITERATIVE
from robomech_ros._kernels.tolerances import ON_BOUNDARY
from robomech_ros.kinematics.axis_points import common_point, nearest_points
from robomech_ros.kinematics.inverse.families import decoupled, general
from robomech_ros.kinematics.inverse.families.decoupled import wrist_constants
from robomech_ros.kinematics.inverse.families.iterative import SearchGoal, iterative_data
from robomech_ros.kinematics.inverse.families.six_joints import (
    SixJointArm,
    chain_of,
    match_general,
    match_six,
    reversed_transforms,
)
from robomech_ros.kinematics.mobility import arm_size, moves_in_all_directions
from robomech_ros.kinematics.tolerances import CONCURRENT_EXACT
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import unpack_chain
from robomech_ros.typing import Array

# Three axes of a redundant arm this near (of its size) to a common point are solved as if they met
# there, every solution is polished, and near singular postures the general equations are asked.
NEARLY_SPHERICAL = 2e-3
# Shoulder and wrist of an arm whose axes miss two points by no more than this (of its size) still
# bring its postures near enough for Newton's steps: the Kinova Gen3's by a hundredth.
NEARLY_TWO_POINTS = 2e-2
# So many times what the axes pass each other by, a target may be beyond a boundary of the idealised
# arm and within reach of the true one.
SPHERICAL_SLACK = 10.0
# Values of the redundancy parameter for a list of solutions, with one locked joint and with the
# arm angle: 24 solutions and more for most poses.
LOCKED_SAMPLES = 16
ANGLE_SAMPLES = 8


# Of how many runs of six joints, from the base on, elimination is tried: each takes 0.1 s to judge.
_ELIMINATIONS = 8


def match(chain: SerialChain) -> Array | None:
    """Recognise a redundant arm with all postures known for each value of a parameter.

    Returns the constants that ``_kernels.inverse.redundant`` reads; None for fewer than seven
    joints and where no six neighbouring joints are solved completely. Of long chains only six near
    the base are solved by elimination.
    """
    if chain.n < 7:
        return None
    C = unpack_chain(chain.packed)
    parts = _arm_angle_parts(chain, C, CONCURRENT_EXACT)
    if parts is not None:
        data = _laid_out(chain, at.ARM_ANGLE, parts)
        data[at.SLACK] = ON_BOUNDARY
        return data
    sixes = [_six(chain, C, first) for first in range(chain.n - 5)]
    for find in (match_six, _idealised):
        for first, (six, types) in enumerate(sixes):
            arm = find(six, types)
            if arm is not None:
                return _locked(chain, first, arm, (six, types))
    best = match_general(sixes[:_ELIMINATIONS])
    return None if best is None else _locked(chain, *best, sixes[best[0]])


def _six(chain: SerialChain, C: Array, first: int) -> tuple[Array, list[int]]:
    """Return transforms, shape (7, 4, 4), and types of six neighbouring joints."""
    six = C[first : first + 7].copy()
    six[0] = six[6] = np.eye(4)
    return six, chain.types[first : first + 6].tolist()


def _locked(
    chain: SerialChain, first: int, arm: SixJointArm, six: tuple[Array, list[int]]
) -> Array:
    """Lay out an arm of which six joints from ``first`` on are solved and the others locked."""
    inexact = arm.family == DECOUPLED and arm.data[wrist_at.EXACT] == 0.0
    whole = general.match(chain_of(*six)) if inexact else None
    if whole is None:
        data = _laid_out(chain, at.LOCKED, arm.data)
    else:
        backed = arm.data.copy()
        backed[wrist_at.HAS_FALLBACK] = 1.0
        data = _laid_out(chain, at.LOCKED, backed, whole)
        data[at.GENERAL] = len(data) - len(whole)
    data[at.FIRST], data[at.BACKWARDS], data[at.SIX] = first, arm.backwards, arm.family
    C = unpack_chain(chain.packed)
    parts = _arm_angle_parts(chain, C, NEARLY_TWO_POINTS)
    if parts is not None:
        data[at.ANGLE] = len(data)
        idealised = _laid_out(chain, at.ARM_ANGLE, parts)
        idealised[at.SLACK] = NEARLY_TWO_POINTS
        return np.concatenate((data, idealised))
    _enter_stretched(chain, C, data)
    return data


def _enter_stretched(chain: SerialChain, C: Array, data: Array) -> None:
    """Lay out what tells where the locked joint brings shoulder and wrist nearest."""
    if chain.n != 7 or chain.types.any():
        return
    locked_first = data[at.FIRST] == 1.0
    links = reversed_transforms(C) if locked_first else C
    centre, other = common_point(links[1], links[2]), nearest_points(links[5])
    if centre is None or other is None or centre[2] > NEARLY_SPHERICAL * data[at.SIZE]:
        return
    height = (0.0, 0.0, other[1], 1.0)
    towards = (np.linalg.inv(links[6]) @ height)[:2]
    data[at.CENTRE : at.CENTRE + 3] = (links[0] @ (0.0, 0.0, centre[0], 1.0))[:3]
    data[at.TOWARDS : at.TOWARDS + 2] = towards
    data[at.STRETCHED] = 1.0


def locked_anyway(chain: SerialChain) -> Array | None:
    """Lay out seven joints of which the last or the first is locked and the others searched for.

    No six neighbouring ones are solved completely. None where the others do not move in all
    directions; else as :func:`match` gives it.
    """
    C = unpack_chain(chain.packed)
    for first in (0, 1):
        part = chain_of(*_six(chain, C, first))
        if moves_in_all_directions(part, arm_size(part)):
            rest = iterative_data(part, SearchGoal(respect_limits=False))
            data = _laid_out(chain, at.LOCKED, rest)
            data[at.FIRST], data[at.SIX] = first, ITERATIVE
            return data
    return None


def _laid_out(chain: SerialChain, kind: int, *parts: Array) -> Array:
    head = np.zeros(at.PARTS)
    head[at.KIND], head[at.JOINTS] = kind, chain.n
    head[at.SAMPLES] = ANGLE_SAMPLES if kind == at.ARM_ANGLE else LOCKED_SAMPLES
    head[at.SIZE] = max(float(np.linalg.norm(chain.packed[:, 10:], axis=1).sum()), 1e-3)
    return np.concatenate((head, chain.packed.ravel(), *parts))


def _idealised(C: Array, types: Sequence[int]) -> SixJointArm | None:
    """Find the closed form of six joints whose last or first three axes nearly meet."""
    for backwards in (False, True):
        links, kinds = (reversed_transforms(C), types[::-1]) if backwards else (C, types)
        if any(kinds[3:]):
            continue
        centre = common_point(links[4], links[5])
        size = max(float(np.linalg.norm(C[:, :3, 3], axis=1).sum()), 1e-3)
        if centre is None or centre[2] > NEARLY_SPHERICAL * size:
            continue
        found = decoupled.match(chain_of(_with_common_point(links, centre), kinds))
        if found is None:
            continue
        data = found.copy()
        data[wrist_at.EXACT] = 0.0
        slack = SPHERICAL_SLACK * centre[2] / data[wrist_at.SIZE]
        data[wrist_at.SLACK] = max(float(data[wrist_at.SLACK]), slack)
        data[wrist_at.PACKED : wrist_at.HAS_FALLBACK] = chain_of(links, kinds).packed.ravel()
        return SixJointArm(DECOUPLED, backwards, data)
    return None


def _with_common_point(C: Array, centre: tuple[float, float, float]) -> Array:
    """Move the last two of three axes through the ``centre`` of :func:`common_point`."""
    links = C.copy()
    height4, height6, _ = centre
    # The centre of the true wrist's axes 4 and 5, and the same place on axes 5 and 6.
    height5 = float((np.linalg.inv(links[4]) @ (0.0, 0.0, height4, 1.0))[2])
    links[4, :3, 3] = (0.0, 0.0, height4) - links[4, :3, 2] * height5
    links[5, :3, 3] = (0.0, 0.0, height5) - links[5, :3, 2] * height6
    return links


def _arm_angle_parts(chain: SerialChain, C: Array, slack: float) -> Array | None:
    """Lay out what is particular of an arm with a spherical shoulder and a spherical wrist."""
    if chain.n != 7 or chain.types.any():
        return None
    shoulder, wrist = common_point(C[1], C[2]), common_point(C[5], C[6])
    size = float(np.linalg.norm(C[:, :3, 3], axis=1).sum())
    if shoulder is None or wrist is None:
        return None
    if max(shoulder[2], wrist[2]) > slack * size:
        return None
    first, last = wrist_constants(C[1], C[2]), wrist_constants(C[5], C[6])
    if first is None or last is None:
        return None
    parts = np.zeros(at.LENGTH)
    parts[at.SHOULDER : at.SHOULDER + 10], parts[at.WRIST : at.WRIST + 10] = first, last
    centre3 = np.array([0.0, 0.0, shoulder[1]])
    centre4 = (C[4] @ (0.0, 0.0, wrist[0], 1.0))[:3]
    axis = C[3, :3, 2]
    from_shoulder = C[3, :3, 3] - centre3
    elbow = from_shoulder - (axis @ from_shoulder) * axis
    if min(np.linalg.norm(elbow), np.linalg.norm(centre4[:2])) < NEARLY_SPHERICAL * size:
        return None
    parts[at.CENTRE_0 : at.CENTRE_0 + 3] = (C[0] @ (0.0, 0.0, shoulder[0], 1.0))[:3]
    parts[at.CENTRE_3 : at.CENTRE_3 + 3] = centre3
    parts[at.CENTRE_4 : at.CENTRE_4 + 3] = centre4
    parts[at.CENTRE_7 : at.CENTRE_7 + 3] = (np.linalg.inv(C[7]) @ (0.0, 0.0, wrist[1], 1.0))[:3]
    parts[at.ELBOW : at.ELBOW + 3] = centre3 + elbow
    parts[at.REFERENCE : at.REFERENCE + 3] = C[0, :3, 2]
    parts[at.OTHER : at.OTHER + 3] = C[0, :3, 0]
    return parts
