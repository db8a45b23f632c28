"""Ends of joint paths at a singular posture: which part of the arm it is, and where to stop."""

import numpy as np
from numpy.typing import NDArray

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.kinetostatics import jacobian
from robomech_ros.kinetostatics.singularities.determinant_factors import named_parts
from robomech_ros.kinetostatics.singularities.report import posture_report
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory import JointPath, Limits, PathCut, PathTracking, PathTrackingStatus
from robomech_ros.trajectory.paths.path_cuts import PLACES

__all__ = ["SLOWEST", "dead_end", "singular_part"]

Array = NDArray[np.float64]
# Below this speed along the path (m/s) the way to a dead end is pointless: it takes minutes for
# less than a tenth of a millimetre.  Of an arm that is slow everywhere, this part of its fastest.
SLOWEST, _PART_OF_FASTEST = 0.01, 0.05
# A part of an arm whose factor of the determinant is below this is named as nearly singular.
_NEARLY = 0.1
# How far before the end of a path the arm is looked at for the way that its wrist goes, as its
# part; and halvings until the place of a speed is found.
_BEFORE, _HALVINGS = 1e-3, 50
# Parts of a path at which the speeds of joints are compared with those at its end, and how many
# times the end must be faster to be near a singularity.
_EARLIER, _MUCH_FASTER = (0.25, 0.5, 0.75), 2.0
_BY_ITSELF = (PathTrackingStatus.LOST, PathTrackingStatus.JUMP, PathTrackingStatus.SINGULAR)


def dead_end(tracking: PathTracking, chain: SerialChain, limits: Limits) -> PathCut | None:
    """End a path that cannot go on beyond a singular posture before it is pointlessly slow.

    Parameters
    ----------
    tracking : PathTracking
        As far as the joints of the chain could follow the path.
    chain : SerialChain
    limits : Limits
        Of the joint velocities.

    Returns
    -------
    PathCut or None
        Where to end, with the part of the arm in words; None where the path is complete, does not
        begin, or ends at a joint limit.
    """
    joints = tracking.path
    if joints is None or tracking.status not in _BY_ITSELF:
        return None
    s, left_out = _last_fast_place(joints, limits), ""
    if s < joints.length:
        left_out = (
            f"; the last {joints.length - s:.2g} m, on which the joints allow less than "
            f"{_slowest(joints, limits):.2g} m/s, are left out"
        )
    text = _beyond(tracking, chain, singular_part(chain, joints)) + left_out
    return PathCut(s, tracking.status, text, tracking.joint)


def _beyond(tracking: PathTracking, chain: SerialChain, part: str) -> str:
    """Say what is beyond the end of a path."""
    because = f"{part}: " if part else ""
    if tracking.status is PathTrackingStatus.LOST:
        beyond = "out of reach beyond" if part else "the arm has no posture beyond"
        return because + beyond
    if tracking.joint is None:
        return f"{because}the joint values change too fast, too near to a singularity"
    name, unit = chain.joint_names[tracking.joint], chain.units[tracking.joint]
    jump = f"joint '{name}' would have to jump by {tracking.move:.3g} {unit}"
    return f"{because}out of reach beyond on this branch; to reach it, {jump}" if part else jump


def singular_part(chain: SerialChain, joints: JointPath) -> str:
    """Say which part of an arm is singular, or nearly, at the end of a joint path.

    Returns
    -------
    str
        Such as "the elbow is straight"; of an arm whose parts have no names, the joint that turns
        or slides ever faster; empty where neither is so.
    """
    q = joints.derivatives(joints.length)[0]
    factors = posture_report(chain, q, length=arm_size(chain)).factors
    if not factors:
        return _ever_faster(chain, joints)
    name = min(factors, key=lambda one: abs(factors[one]))
    if abs(factors[name]) > _NEARLY:
        return ""
    if name != "elbow":
        return f"the {name} is singular"
    before = joints.derivatives(joints.length * (1.0 - _BEFORE))[0]
    return f"the elbow is {'straight' if _stretches(chain, before, q) else 'folded'}"


def _ever_faster(chain: SerialChain, joints: JointPath) -> str:
    """Say which joint is fastest at the end of a path, if it is much faster than before."""
    rates = np.abs(joints.derivatives(joints.length * np.array([*_EARLIER, 1.0]))[1])
    joint = int(np.argmax(rates[-1]))
    if rates[-1, joint] < _MUCH_FASTER * rates[:-1, joint].max():
        return ""
    moves = "turns" if chain.units[joint] == "rad" else "slides"
    return f"joint '{chain.joint_names[joint]}' {moves} ever faster"


def _stretches(chain: SerialChain, before: Array, q: Array) -> bool:
    """Whether the wrist moves away from the shoulder.

    Both are the outer ones of three parallel axes; in other arms the second axis, and the last but
    one, where it is nearest to the tip.
    """
    both = np.stack([before, q])
    J, tips = jacobian(chain, both), forward_kinematics(chain, both)[:, :3, 3]
    axes, moves = J[:, :3], J[:, 3:]
    first, _, last = named_parts(chain).joints[3:].tolist()
    i, k = (first, last) if last else (1, chain.n - 2)
    wrists = tips - np.cross(moves[:, :, k], axes[:, :, k])
    apart = np.cross(axes[:, :, i], wrists - tips) + moves[:, :, i]
    away = np.linalg.norm(apart, axis=1)
    return bool(away[1] > away[0])


def _speeds(joints: JointPath, places: Array, limits: Limits) -> Array:
    """Give the speeds along a path (m/s) that joint velocities allow at places (m)."""
    rates = np.abs(joints.derivatives(places)[1])
    with np.errstate(divide="ignore"):
        fastest: Array = np.min(limits.velocity / rates, axis=-1)
    return fastest


def _slowest(joints: JointPath, limits: Limits) -> float:
    places = np.linspace(0.0, joints.length, PLACES + 1)
    return min(SLOWEST, _PART_OF_FASTEST * float(_speeds(joints, places, limits).max()))


def _last_fast_place(joints: JointPath, limits: Limits) -> float:
    """Find the last place (m) where the path is not pointlessly slow."""
    places, least = np.linspace(0.0, joints.length, PLACES + 1), _slowest(joints, limits)
    fast = np.flatnonzero(_speeds(joints, places, limits) >= least)
    if not len(fast) or fast[-1] == PLACES:
        return joints.length
    low, high = float(places[fast[-1]]), joints.length
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if _speeds(joints, np.array([middle]), limits)[0] >= least:
            low = middle
        else:
            high = middle
    return low
