"""Distance of a mechanism's posture from a singularity, and the singular part."""

import numpy as np

from robomech_ros.cartesian import PathCheck
from robomech_ros.errors import BadValueError
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.trajectory import JointPath, PathCut, PathTrackingStatus
from robomech_ros.trajectory.paths.path_cuts import PLACES, last_valid_coordinate
from robomech_ros.typing import Array, BoolArray

# A direction is named after a coordinate axis if it is as near to it as this cosine.
_ALONG = 0.99
# A turn counts as one if its part of a twist, lengths over the size, is at least this.
_TURN = 0.7
# The part of a twist that the drives cannot give at all, over all of it, that is rounding.
_ROUNDING = 1e-6


def singular_values(mechanism: Mechanism, q: Array) -> Array:
    """Find the singular values (k, m), largest first, of the twists that the drives give.

    Linear rows are divided by the size, and so are drives that slide.  Where drives do not hold
    the platform at all in a closed posture of q (k, n), they are infinite and zero.
    """
    try:
        return np.asarray(np.linalg.svd(mechanism.scaled_twists(q), compute_uv=False))
    except BadValueError:
        if len(q) == 1:
            return np.array([[np.inf] + [0.0] * (mechanism.dof - 1)])
        return np.concatenate([singular_values(mechanism, row[None]) for row in q])


def named_singularity(mechanism: Mechanism, start: Array, q: Array) -> str:
    """Say against which motion the drives hardly hold the platform, or which they hardly give it.

    That is in a posture q (n,); the start (n,) is one further from the singularity.
    """
    try:
        before, here = (mechanism.scaled_twists(row) for row in (start, q))
    except BadValueError:
        return "the drives do not hold the platform"
    usual = np.linalg.svd(before, compute_uv=False)
    directions, values, _ = np.linalg.svd(here, full_matrices=False)
    if values[0] / usual[0] >= usual[-1] / values[-1]:
        return f"the drives hardly hold the platform against {_motion(directions[:, 0])}"
    return f"the drives hardly give the platform {_motion(directions[:, -1])}"


def require_possible(mechanism: Mechanism, q: Array, twist: Array) -> None:
    """Check that the platform has a motion (6,) in the base, in a regular posture (n,)."""
    given, wanted = mechanism.scaled_twists(q), twist.copy()
    wanted[3:] /= mechanism.size
    left = wanted - given @ np.linalg.lstsq(given, wanted, rcond=None)[0]
    if np.linalg.norm(left) > _ROUNDING * np.linalg.norm(wanted):
        what = f"motion of the platform of '{mechanism.name}'"
        expected = f"one of its {mechanism.dof} freedoms"
        raise BadValueError(what, _motion(left), expected)


def _motion(twist: Array) -> str:
    """Put a twist (6,), lengths over the size, into words."""
    turn, way = np.linalg.norm(twist[:3]), np.linalg.norm(twist[3:])
    if turn < _TURN * np.hypot(turn, way):
        return f"a move along {_axis(twist[3:] / way)}"
    return f"a turn about {_axis(twist[:3] / turn)}"


def _axis(direction: Array) -> str:
    k = int(np.argmax(np.abs(direction)))
    if abs(direction[k]) > _ALONG:
        return "xyz"[k]
    signed = direction * np.sign(direction[k])
    return "(" + " ".join(f"{value + 0.0:.2f}" for value in signed) + ")"


def crossing_cut(mechanism: Mechanism, most: float) -> PathCheck:
    """End a joint path before a singularity that it crosses between two places.

    There the drives give the platform twists whose determinant changes its sign.  Up to ``most``
    of the condition number the path is kept.
    """

    def check(joints: JointPath) -> PathCut | None:
        places = np.linspace(0.0, joints.length, PLACES + 1)
        q = joints.derivatives(places)[0]
        try:
            twists = mechanism.scaled_twists(q)
        except BadValueError:  # a place is singular to rounding
            return None
        turned = np.linalg.det(np.linalg.pinv(twists[:-1]) @ twists[1:]) <= 0.0
        if not turned.any():
            return None
        k = int(np.argmax(turned))
        before = np.linalg.pinv(twists[k])

        def beyond(rows: Array) -> BoolArray:
            values = singular_values(mechanism, rows)
            above = values[:, 0] > most * values[:, -1]
            flips = [np.linalg.det(before @ mechanism.scaled_twists(row)) <= 0.0 for row in rows]
            return np.asarray(above | flips)

        part = (float(places[k]), float(places[k + 1]))
        s = last_valid_coordinate(joints, beyond, count=1, part=part)
        if s is None:
            return None
        near = joints.derivatives(s)[0]
        text = f"too near to a singularity: {named_singularity(mechanism, q[0], near)}"
        return PathCut(s, PathTrackingStatus.SINGULAR, text)

    return check
