"""Singularity messages for a parallel robot."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import SingularPostureError
from robomech_ros.nodes.common.message_fields import floats
from robomech_ros.nodes.common.pose_messages import stamped_twist
from robomech_ros.parallel import LoopSingularity, Mechanism, ParallelRobot, loop_singularity
from robomech_ros.spatial import transfer_twist
from robomech_ros.typing import Array


def singularity_at(robot: ParallelRobot | Mechanism, q: Array, point: Array) -> LoopSingularity:
    """Judge a posture (n,) of all joints, and the motions of a point (3,) of the platform (m)."""
    mechanism = robot.mechanism
    T = mechanism.pose(q)
    own = q if isinstance(robot, Mechanism) else q[mechanism.drive_index]
    found = loop_singularity(robot, T, own)
    origin, at = np.zeros(3), T[:3, :3] @ point
    lost, free = (
        transfer_twist(twists, origin, at) if len(twists) else twists
        for twists in (found.lost_directions, found.free_directions)
    )
    return replace(found, lost_directions=lost, free_directions=free)


def jacobian_at(mechanism: Mechanism, q: Array, point: Array) -> Array | None:
    """Return the Jacobian (6, m) of a point (3,) of the platform, angular rows first, in the base.

    None where the drives do not determine its motion.
    """
    try:
        twists = mechanism.twist_matrix(q)
    except SingularPostureError:
        return None
    return transfer_twist(twists.T, np.zeros(3), mechanism.pose(q)[:3, :3] @ point).T


def encode_singularity(
    mechanism: Mechanism,
    q: Array,
    found: LoopSingularity,
    axes: Array | None,
    frame: str,
    response: Any,
) -> Any:
    """Fill an AnalyzeSingularity response.

    Parameters
    ----------
    mechanism : Mechanism
    q : ndarray, shape (n,)
        All joints (rad or m).
    found : LoopSingularity
    axes : ndarray, shape (3, 3), or None
        Rotation of the frame in the base in whose axes directions are given; None = base.
    frame : str
        Its name.
    response : AnalyzeSingularity.Response
    """
    values = _raw_values(mechanism, q)
    response.singular_values = floats(found.singular_values)
    response.rank = len(found.singular_values) - len(found.free_directions)
    response.manipulability = float(np.prod(values)) if len(values) else float("inf")
    response.condition_number = (
        float(values[0] / values[-1]) if len(values) and values[-1] > 0.0 else float("inf")
    )
    response.characteristic_length = found.length
    response.normalised_condition_number = found.condition_number
    response.lost_directions = [
        stamped_twist(_in_axes(twist, axes), frame) for twist in found.lost_directions
    ]
    response.singularity_types = list(found.kinds)
    response.summary = _summary(found, [_in_axes(twist, axes) for twist in found.free_directions])
    return response


def _raw_values(mechanism: Mechanism, q: Array) -> NDArray[np.floating[Any]]:
    """Return the singular values of the drives' twists, none if those are not determined."""
    try:
        return np.asarray(np.linalg.svd(mechanism.twist_matrix(q), compute_uv=False))
    except SingularPostureError:
        return np.empty(0)


def _in_axes(twist: Array, axes: Array | None) -> Array:
    return twist if axes is None else (twist.reshape(2, 3) @ axes).ravel()


def _summary(found: LoopSingularity, free: list[Array]) -> str:
    """Say what was found; free directions have no field of their own."""
    text = found.summary
    if not found.singular:
        text += (
            f": {found.distances[1]:.3g} from type 2 and {found.distances[0]:.3g} from type 1, "
            f"lengths over {found.length:.4g} m"
        )
    for twist in free:
        x, y, z, rx, ry, rz = (*twist[3:], *twist[:3])
        text += f"; free: [{x:.4g} {y:.4g} {z:.4g}] m/s with [{rx:.4g} {ry:.4g} {rz:.4g}] rad/s"
    return text
