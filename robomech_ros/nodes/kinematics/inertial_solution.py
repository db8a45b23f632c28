"""Inverse kinematics in inertial space: of an arm whose floating base reacts."""

from typing import Any

import numpy as np

from robomech_ros.cartesian import waypoint_path
from robomech_ros.dynamics import FloatingChain
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.inverse.request.task import FULL_TASK
from robomech_ros.kinematics.inverse.result.contacts import Scene, without_contacts
from robomech_ros.kinematics.inverse.result.result import Findings, InverseKinematicsResult, Listing
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.nodes.common.robot.inertial_paths import follow_inertial
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array

_FAMILY = "floating"


def solve_inertial(
    robot: FloatingChain, T: Array, seed: Array, scene: Scene | None, options: dict[str, Any]
) -> InverseKinematicsResult:
    """Find the posture at the end of the straight motion of the tip from the seed, from rest.

    - ``T``: target in inertial space, in the base before the motion (m), shape (4, 4).
    - ``seed``: joint values (rad or m) before the motion, shape (n,).
    - ``scene``: for the check of the solution.
    - ``options``: keywords of `inverse_kinematics`.

    Returns one solution, whose errors are those in inertial space, or none.

    Raises BadValueError: a part of the pose is wanted.
    """
    if options.get("task_mask", FULL_TASK) != FULL_TASK:
        expected = "all true or all false for a target in inertial space"
        raise BadValueError("task_mask", list(options["task_mask"]), expected)
    chain, q, base, reason = robot.chain, seed, np.eye(4), ""
    path = waypoint_path(forward_kinematics(chain, seed), [T])
    if path is not None:
        end = follow_inertial(robot, path, seed)
        q, base, reason = end.q, end.base, end.tracking.reason
    moved = np.linalg.norm(base[:3, 3])
    angle = np.arccos(np.clip(0.5 * (np.trace(base[:3, :3]) - 1.0), -1.0, 1.0))
    text = f"the base moves by {moved:.4g} m and {angle:.4g} rad"
    status = Status.NOT_CONVERGED if reason else Status.SUCCESS
    findings = Findings(_FAMILY, False, status, reason or text)
    rows = np.empty((0, chain.n)) if reason else q[None]
    distance = np.abs(q - seed).max() if options["metric"] == "linf" else np.linalg.norm(q - seed)
    listing = Listing(
        rigid_inverse(base) @ T, np.full(len(rows), distance), np.zeros(len(rows), dtype=np.int64)
    )
    found = InverseKinematicsResult(chain, rows, findings, listing)
    kept = found.within(
        options.get("position_tolerance", 1e-9), options.get("orientation_tolerance", 1e-9)
    )
    return kept if scene is None else without_contacts(kept, scene, None)
