"""Arms whose last three revolute axes meet in one point: recognition and constants."""

import math

import numpy as np

from robomech_ros._kernels.inverse.decoupled import layout as at
from robomech_ros._kernels.tolerances import IDEALISED_SLACK
from robomech_ros.kinematics.axis_points import common_point
from robomech_ros.kinematics.mobility import scaled_jacobians
from robomech_ros.kinematics.tolerances import ARM_RANK, CONCURRENT, CONCURRENT_EXACT, NEARLY_NAMED
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import REVOLUTE, pack_chain, shift, unpack_chain
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array, IntArray

# Neighbouring axes of the arm this nearly parallel or meeting are solved as if they were, since
# the general equations lose as many digits; the posture is improved afterwards.
NEARLY_SPECIAL = 1e-5
# How far beyond a boundary (relative) a candidate is kept, to be judged by its residual, where the
# geometry is exact.
CANDIDATE_SLACK = 1e-9


_KINDS = {
    "RRR": at.REVOLUTE_QUARTIC,
    "PRR": at.SLIDE_TURN_TURN,
    "RPR": at.TURN_SLIDE_TURN,
    "RPP": at.TURN_SLIDE_SLIDE,
    "PRP": at.SLIDE_TURN_SLIDE,
    "PPP": at.SLIDES,
}


def match(chain: SerialChain) -> Array | None:
    """Recognise an arm with a spherical wrist after any three joints.

    Returns the constants that ``_kernels.inverse.decoupled`` reads; None where the last three
    joints are not revolute with axes through one point, or the arm cannot move in all directions.
    """
    if chain.n != 6 or chain.types[3:].any():
        return None
    C = unpack_chain(chain.packed)
    centre = common_point(C[4], C[5])
    if centre is None:
        return None
    height4, height6, apart = centre
    size = _size(C, height4)
    if apart > CONCURRENT * size:
        return None
    data = np.zeros(at.LENGTH)
    data[at.SIZE] = size
    data[at.TYPES : at.TYPES + 3] = chain.types[:3]
    data[at.PACKED : at.HAS_FALLBACK] = chain.packed.ravel()
    data[at.BASE : at.BASE + 12] = C[0, :3].ravel()
    data[at.TIP : at.TIP + 9] = C[6, :3, :3].T.ravel()
    data[at.CENTRE : at.CENTRE + 3] = (rigid_inverse(C[6]) @ (0.0, 0.0, height6, 1.0))[:3]
    wrist = wrist_constants(C[4], C[5])
    if wrist is None:
        return None
    data[at.ANGLES : at.ANGLES + len(wrist)] = wrist
    data[at.WRIST : at.WRIST + 3] = (C[3] @ (0.0, 0.0, height4, 1.0))[:3] / size
    links = C[1:4].copy()
    links[:, :3, 3] /= size
    data[at.C1 : at.C1 + 12] = links[0, :3].ravel()
    data[at.C2 : at.C2 + 12] = links[1, :3].ravel()
    data[at.C3 : at.C3 + 12] = links[2, :3].ravel()
    data[at.REGULAR] = _largest_determinant(chain.types[:3], links, data)
    if data[at.REGULAR] < ARM_RANK:
        return None
    data[at.EXACT] = apart <= CONCURRENT_EXACT * size
    exact = _enter_arm(data, chain.types[:3], links) and data[at.EXACT] == 1.0
    data[at.SLACK] = CANDIDATE_SLACK if exact else IDEALISED_SLACK
    data[at.NAMED] = _side(chain.types[:3], links, data)
    data.setflags(write=False)
    return data


def _size(C: Array, height4: float) -> float:
    """Measure the arm from axis 1 to the wrist centre (m), 1 where it has no extent."""
    last = C[3] @ (0.0, 0.0, height4, 1.0)
    lengths = [np.linalg.norm(C[1, :3, 3]), np.linalg.norm(C[2, :3, 3]), np.linalg.norm(last[:3])]
    return float(sum(lengths)) or 1.0


def wrist_constants(link: Array, following: Array) -> Array | None:
    """Return a spherical joint's angles as ``decoupled.layout`` has them from ANGLES on.

    None where neighbouring axes are parallel. The constant transforms (4, 4) are those between its
    first two and its last two axes (m).
    """
    before4, alpha4, after4 = _zxz(link[:3, :3])
    before5, alpha5, after5 = _zxz(following[:3, :3])
    data = np.zeros(at.PACKED)
    angles = (before4, after4 + before5, after5)
    # Each may exceed a turn by rounding only when wrapped here.
    data[at.ANGLES : at.ANGLES + 3] = [math.remainder(angle, 2.0 * math.pi) for angle in angles]
    data[at.COS4], data[at.SIN4] = _cosine(alpha4), math.sin(alpha4)
    data[at.COS5], data[at.SIN5] = _cosine(alpha5), math.sin(alpha5)
    orthogonal = data[at.COS4] == 0.0 and data[at.COS5] == 0.0
    data[at.NEAREST] = 0.0 if orthogonal else abs(alpha4 - alpha5)
    farthest = min(alpha4 + alpha5, 2.0 * math.pi - alpha4 - alpha5)
    data[at.FARTHEST] = math.pi if orthogonal else farthest
    data[at.UNFLIPPED] = 1.0 if math.cos(angles[1]) > -1e-6 else -1.0
    if min(data[at.SIN4], data[at.SIN5]) <= ARM_RANK:
        return None
    return data[at.ANGLES :]


def _cosine(alpha: float) -> float:
    """Cosine, exactly zero where the angle is 90 degrees up to rounding."""
    c = math.cos(alpha)
    return 0.0 if abs(c) < 1e-15 else c


def _zxz(R: Array) -> tuple[float, float, float]:
    """Angles of ``R = Rz(first) Rx(middle) Rz(last)`` with the middle one in [0, pi]."""
    first = math.atan2(R[0, 2], -R[1, 2])
    middle = math.atan2(math.hypot(R[0, 2], R[1, 2]), R[2, 2])
    last = math.atan2(R[2, 0], R[2, 1])
    return first, middle, last


def _largest_determinant(types: IntArray, links: Array, data: Array) -> float:
    """Largest determinant of the wrist centre's Jacobian among some postures."""
    to_centre = shift(data[at.WRIST : at.WRIST + 3])
    packed = pack_chain(np.stack([np.eye(4), *links[:2], to_centre]), types)
    postures = np.random.default_rng(0).uniform(-np.pi, np.pi, (32, 3))
    return float(np.abs(np.linalg.det(scaled_jacobians(packed, postures, 1.0)[:, 3:])).max())


def _enter_arm(data: Array, types: IntArray, links: Array) -> bool:
    """Choose the direction and the way of solution; False where the geometry is idealised."""
    letters = "".join("RP"[kind] for kind in types)
    forward, backward = [links[0], links[1]], [rigid_inverse(links[1]), rigid_inverse(links[0])]
    from_tip = letters not in _KINDS
    if letters == "RRR":
        from_tip = _separated(backward[0])[1] < NEARLY_SPECIAL <= _separated(forward[0])[1]
    first, second = backward if from_tip else forward
    data[at.FROM_TIP] = from_tip
    data[at.FIRST : at.FIRST + 12] = first[:3].ravel()
    data[at.SECOND : at.SECOND + 12] = second[:3].ravel()
    kind = _KINDS[letters[::-1] if from_tip else letters]
    data[at.KIND] = kind
    exact = True
    if kind == at.REVOLUTE_QUARTIC:
        equations, apart = _separated(first)
        data[at.EQUATIONS : at.EQUATIONS + 7] = equations
        if apart < NEARLY_SPECIAL:
            data[at.KIND] = at.REVOLUTE_SPLIT
            exact = apart <= CONCURRENT_EXACT
    elif kind in (at.SLIDE_TURN_TURN, at.TURN_SLIDE_TURN):
        along = abs(first[2, 2])
        data[at.EQUATIONS] = along < NEARLY_SPECIAL
        exact = not CONCURRENT_EXACT < along < NEARLY_SPECIAL
    elif kind == at.SLIDES:
        directions = np.column_stack(
            (np.array([0.0, 0.0, 1.0]), first[:3, 2], (first @ second)[:3, 2])
        )
        data[at.SLIDE_INVERSE : at.SLIDE_INVERSE + 9] = np.linalg.inv(directions).ravel()
    return bool(exact)


def _separated(link: Array) -> tuple[list[float], float]:
    """Combine the two linear equations of ``decoupled.arm_revolute`` for a link.

    Returns e_M, e_N, g_M, g_N, g_x, g_y, eta, and how far the link's axes are from being parallel
    (a sine) or from meeting (a distance over the size), whichever is less.
    """
    n = link[2, :2]
    s = (link[:3, :3].T @ link[:3, 3])[:2]
    sine = float(np.hypot(*n))
    cross = float(n[0] * s[1] - n[1] * s[0])
    distance = abs(cross) / sine if sine > 0.0 else math.inf
    if sine < distance:
        arm = max(float(np.hypot(*s)), 1e-300)
        g = s / arm
        return [1.0, -float(n @ g) / arm, 0.0, 1.0 / arm, *g, -cross / arm], sine
    g = n / sine
    return [-float(s @ g) / sine, 1.0, 1.0 / sine, 0.0, *g, cross / sine], distance


def _side(types: IntArray, links: Array, data: Array) -> float:
    """Return the sign that makes a posture "right", 0 where shoulder and elbow have no meaning.

    They have one where axis 1 is perpendicular to the parallel axes 2 and 3, as nearly as
    NEARLY_NAMED: "right" is the posture whose plane lies, seen towards the wrist centre, to the
    right of axis 1.
    """
    if (types != REVOLUTE).any():
        return 0.0
    upright = abs(links[0, 2, 2]) < NEARLY_NAMED
    parallel = math.hypot(links[1, 0, 2], links[1, 1, 2]) < NEARLY_NAMED
    if not (upright and parallel):
        return 0.0
    w = data[at.WRIST : at.WRIST + 3]
    height = links[1, 2, 3] + float(links[1, 2, :3] @ w)
    offset = height + float(links[0, :3, 2] @ links[0, :3, 3])
    return -1.0 if offset < -NEARLY_NAMED else 1.0
