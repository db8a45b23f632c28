"""Speeds of other links than the tip, over the coordinate of a path."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from robomech_ros.errors import UnknownJointError
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import SerialChain
from robomech_ros.spatial.arrays import check_kind
from robomech_ros.trajectory import JointPath, SpeedLimit
from robomech_ros.trajectory.paths.curve_arguments import as_number, as_positive
from robomech_ros.typing import Array


def link_speed_limit(
    chain: SerialChain,
    joints: JointPath,
    link: SerialChain,
    speed: float,
    standing: Mapping[str, float] | None = None,
) -> SpeedLimit:
    """Limit the speed of any link while the joints of a chain run along a path.

    Parameters
    ----------
    chain : SerialChain
        Whose joints move along the path.
    joints : JointPath
        Their values over the path coordinate.
    link : SerialChain
        The chain of the same robot to the link whose origin is not to be faster.
    speed : float
        Its largest speed (m/s), above 0.
    standing : mapping of str to float, optional
        Where the joints of `link` stand that are not in `chain`, by name (rad or m).

    Returns
    -------
    SpeedLimit
        For `plan_followed` and `along_joint_path`.

    Raises
    ------
    UnknownJointError
        A joint of `link` that neither moves nor stands.
    """
    check_chain(chain)
    check_chain(link)
    check_kind("joints", joints, JointPath, "a JointPath")
    check_kind("standing", standing, Mapping | None, "positions by the names of joints")
    names, given = chain.joint_names, dict(standing or {})
    known = {name: as_number(f"position of joint {name!r}", given[name]) for name in given}
    for name in link.joint_names:
        if name not in names and name not in known:
            raise UnknownJointError(name, (*names, *known))
    columns = [k for k, name in enumerate(link.joint_names) if name in names]
    sources = [names.index(link.joint_names[k]) for k in columns]
    rest = np.array([known.get(name, 0.0) for name in link.joint_names])

    def rate(s: Array) -> Array:
        q, first = joints.derivatives(np.minimum(s, joints.length))[:2]
        rows = np.tile(rest, (len(s), 1))
        rows[:, columns] = q[:, sources]
        moving = jacobian(link, rows)[:, 3:][:, :, columns]
        velocity = np.einsum("mij,mj->mi", moving, first[:, sources])
        return np.linalg.norm(velocity, axis=1)

    return SpeedLimit(rate, as_positive("speed", speed))
