"""Solutions of inverse kinematics that are not in contact with the world around the arm."""

from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.inverse.result.result import InverseKinematicsResult
from robomech_ros.kinematics.inverse.result.status import Status
from robomech_ros.robots.chain import SerialChain


class Scene(Protocol):
    """Required interface of a scene: its chain, and the least distances at postures (m, n)."""

    chain: SerialChain

    def clearance(self, q: Any) -> Any:
        """Return distances (m,) (m) and the two bodies of each."""


def without_contacts(
    result: InverseKinematicsResult, scene: Scene, most: int | None
) -> InverseKinematicsResult:
    """Leave out solutions in contact, and say how many, or which bodies touch.

    - ``result``: result with all solutions.
    - ``scene``: planning scene of a chain with the same joints.
    - ``most``: largest number of solutions to keep; None for all.
    """
    if not hasattr(scene, "clearance") or not hasattr(scene, "chain"):
        raise BadValueError("scene", scene, "a PlanningScene")
    if tuple(scene.chain.joint_names) != result.chain.joint_names:
        expected = f"one of joints {', '.join(result.chain.joint_names)}"
        raise BadValueError("scene", ", ".join(scene.chain.joint_names), expected)
    count = len(result)
    if not count:
        return result.keep(np.arange(0), replace(result.findings, clearances=np.empty(0)))
    found = scene.clearance(result.q)
    free = np.flatnonzero(found.distance > 0.0)
    kept = free if most is None else free[:most]
    findings = replace(result.findings, clearances=found.distance[kept])
    if len(free) == count:
        return result.keep(kept, findings)
    if len(free):
        left = f"{count - len(free)} of {count} solutions are in contact and left out"
        reason = f"{result.reason}; {left}" if result.reason else left
        return result.keep(kept, replace(findings, reason=reason))
    least = int(np.argmax(found.distance))
    first, second = found.bodies[least]
    depth = -found.distance[least]
    which = "the solution is" if count == 1 else f"all {count} solutions are"
    reason = f"{which} in contact; least deep are '{first}' and '{second}', by {depth:.3g} m"
    return result.keep(kept, replace(findings, status=Status.IN_COLLISION, reason=reason))
