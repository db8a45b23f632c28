"""Singular part of an arm at the end of a joint path."""

from collections.abc import Sequence

import numpy as np

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.mobility import arm_size
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory import JointPath
from robomech_ros.typing import Array

# A part of an arm whose factor of the determinant is below this is named as nearly singular.
_NEARLY = 0.1
# How far before the end of a path the arm is looked at for the way that its wrist goes, as its
# part.
_BEFORE = 1e-3
# Parts of a path at which the speeds of joints are compared with those at its end, and how many
# times the end must be faster to be near a singularity.
_EARLIER, _MUCH_FASTER = (0.25, 0.5, 0.75), 2.0


def singular_part(chain: SerialChain, joints: JointPath) -> str:
    """Say which part of an arm is singular, or nearly, at the end of a joint path.

    Such as "the elbow is straight"; of an arm whose parts have no names, the joint that turns or
    slides ever faster; empty where neither is so.
    """
    # Compiled for those who come to such an end.
    from robomech_ros.kinetostatics.singularities.report import posture_report

    q = joints.derivatives(joints.length)[0]
    factors = posture_report(chain, q, length=arm_size(chain)).factors
    if not factors:
        return ever_faster(chain.joint_names, chain.units, joints)
    name = min(factors, key=lambda one: abs(factors[one]))
    if abs(factors[name]) > _NEARLY:
        return ""
    if name != "elbow":
        return f"the {name} is singular"
    before = joints.derivatives(joints.length * (1.0 - _BEFORE))[0]
    return f"the elbow is {'straight' if _stretches(chain, before, q) else 'folded'}"


def ever_faster(names: Sequence[str], units: Sequence[str], joints: JointPath) -> str:
    """Say which joint is fastest at the end of a path, if it is much faster than before."""
    rates = np.abs(joints.derivatives(joints.length * np.array([*_EARLIER, 1.0]))[1])
    joint = int(np.argmax(rates[-1]))
    if rates[-1, joint] < _MUCH_FASTER * rates[:-1, joint].max():
        return ""
    moves = "turns" if units[joint] == "rad" else "slides"
    return f"joint '{names[joint]}' {moves} ever faster"


def _stretches(chain: SerialChain, before: Array, q: Array) -> bool:
    """Return whether the wrist moves away from the shoulder.

    Both are the outer ones of three parallel axes; in other arms the second axis, and the last but
    one, where it is nearest to the tip.
    """
    both, chain = chain.joint_values(np.stack([before, q])), chain.uncoupled
    J, tips = jacobian(chain, both), forward_kinematics(chain, both)[:, :3, 3]
    axes, moves = J[:, :3], J[:, 3:]
    from robomech_ros.kinetostatics.singularities.determinant_factors import named_parts

    first, _, last = named_parts(chain).joints[3:].tolist()
    i, k = (first, last) if last else (1, chain.n - 2)
    wrists = tips - np.cross(moves[:, :, k], axes[:, :, k])
    apart = np.cross(axes[:, :, i], wrists - tips) + moves[:, :, i]
    away = np.linalg.norm(apart, axis=1)
    return bool(away[1] > away[0])
