"""Chains as arms for the tracking of paths."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.joint_values import check_chain
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import SerialChain
from robomech_ros.trajectory import Limits, SerialArm
from robomech_ros.typing import Array


def serial_arm(chain: SerialChain, task_mask: Sequence[bool] | None = None) -> SerialArm:
    """Make the arm that `track_path` and `along_path` take from a chain.

    Parameters
    ----------
    chain : SerialChain
        Chain of n joints.
    task_mask : sequence of six bool, optional
        Which of x, y, z, rx, ry, rz a path holds, along and about the axes of its pose, as for
        `inverse_kinematics`; default (and all False) the full pose.

    Returns
    -------
    SerialArm
        Its `inverse` gives the posture within the limits that is nearest to other joint values,
        which may be outside.

    Examples
    --------
    >>> from robomech_ros.cartesian import serial_arm
    >>> from robomech_ros.robots import load_robot
    >>> arm = serial_arm(load_robot("puma560"))
    >>> q = [0.1, -0.5, 0.4, 0.3, 0.8, 0.2]
    >>> arm.inverse(arm.forward(q), near=q).round(6).tolist()
    [0.1, -0.5, 0.4, 0.3, 0.8, 0.2]
    """
    check_chain(chain)
    # Loaded here, since a planner begins to serve before all of it is there.
    from robomech_ros.kinematics import inverse_kinematics

    def inverse(T: Array, near: Array) -> Array | None:
        seed = np.clip(near, chain.lower, chain.upper)
        found = inverse_kinematics(chain, T, seed=seed, max_solutions=1, task_mask=task_mask).q
        return found[0] if len(found) else None

    return SerialArm(
        lambda q: forward_kinematics(chain, q),
        inverse,
        lambda q: jacobian(chain, q),
        task_mask,
        Limits.of(chain),
    )


def load_inverse_kinematics() -> None:
    """Load what the first path of a process waits for otherwise: compiled code, some seconds."""
    import robomech_ros.kinematics.inverse.inverse_kinematics  # noqa: F401
