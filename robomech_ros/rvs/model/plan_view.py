"""The plan that a page shows."""

from __future__ import annotations

from robomech_ros.errors import BadValueError
from robomech_ros.rvs.motion import Motion


class PlanView:
    """The plan that is shown of a robot, or none.

    Not for several threads at a time.

    Attributes
    ----------
    motion : Motion or None
    name : str
        What it is, for people.
    """

    def __init__(self) -> None:
        self.motion: Motion | None = None
        self.name = ""

    def show(self, motion: Motion, name: str) -> None:
        """Show a motion instead of what was shown."""
        self.motion, self.name = motion, name

    def forget(self) -> None:
        """Show none."""
        self.motion, self.name = None, ""


def check_same_joints(motion: Motion, joints: tuple[str, ...]) -> None:
    """Check that a motion is one of these joints."""
    if not isinstance(motion, Motion):
        raise BadValueError("motion", motion, "a Motion")
    names = tuple(motion.chain.joint_names)
    if names != joints:
        raise BadValueError("joints of the motion", names, ", ".join(joints))
