"""Paths of a tool that end before contact."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from robomech_ros.trajectory.paths.joint_path import JointPath
from robomech_ros.trajectory.paths.tracking_result import PathCut, PathTrackingStatus

if TYPE_CHECKING:
    from robomech_ros.collision.scene import PlanningScene

# Distance between the end of a path and a contact (m along the path).
_BEFORE = 1e-3


def stop_before_contact(scene: PlanningScene) -> Callable[[JointPath], PathCut | None]:
    """Make a check of `PathStopLimits` that ends a path shortly before contact.

    A path that cannot be proved free ends there, too.

    Parameters
    ----------
    scene : PlanningScene
        Scene of the chain that follows the path.
    """

    def check(joints: JointPath) -> PathCut | None:
        found = scene.check_motion(joints)
        if found.certified:
            return None
        first, second = found.bodies
        how = "may" if found.free else "would"
        text = f"'{first}' and '{second}' {how} touch"
        return PathCut(max(found.parameter - _BEFORE, 0.0), PathTrackingStatus.CONTACT, text)

    return check
