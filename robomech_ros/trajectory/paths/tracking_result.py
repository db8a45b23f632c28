"""Part of a pose path that a joint path follows, and the reason for its end."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from robomech_ros.outcomes import Code
from robomech_ros.trajectory.paths.joint_path import JointPath

# Least fraction of a path for a motion.
_SHORTEST = 1e-6


class PathTrackingStatus(Enum):
    """Part of a pose path that a joint path follows, and the reason for its end."""

    COMPLETE = "complete", Code.NONE
    NO_START = "no posture at the start", Code.IK_LOST
    LOST = "no posture", Code.IK_LOST
    JUMP = "only by a jump", Code.JUMP
    SINGULAR = "singular", Code.SINGULAR
    LIMIT = "beyond a joint limit", Code.LIMIT
    CONTACT = "in contact", Code.COLLISION
    REJECTED = "against a condition of the caller", Code.REJECTED

    _value_: str
    code: Code

    def __new__(cls, text: str, code: Code) -> PathTrackingStatus:
        """Make a status of its text and its number in the table of outcomes."""
        status = object.__new__(cls)
        status._value_, status.code = text, code
        return status


class PathCut(NamedTuple):
    """A place where a joint path must end, and why.

    Attributes
    ----------
    s : float
        Last path coordinate (m) that may be reached.
    status : PathTrackingStatus
    text : str
        The reason in words.
    joint : int or None
        Number of the joint to blame, where it is one.
    """

    s: float
    status: PathTrackingStatus
    text: str
    joint: int | None = None


@dataclass(frozen=True, eq=False)
class PathTracking:
    """A joint path along a pose path.

    Attributes
    ----------
    path : JointPath or None
        As far as it goes; None if it does not even begin.
    reached : float
        Last path coordinate that is followed (m).
    status : PathTrackingStatus
    reason : str
        In words; empty if the path is complete.
    length : float
        Length of the whole pose path (m).
    joint : int or None
        Number of the joint that ends the path, where it is one.
    move : float
        Where a joint would have to jump, by how much (rad or m).
    """

    path: JointPath | None
    reached: float
    status: PathTrackingStatus
    reason: str
    length: float
    joint: int | None = None
    move: float = 0.0

    @property
    def fraction(self) -> float:
        """Part of the pose path that is followed, 0 to 1."""
        complete = self.status is PathTrackingStatus.COMPLETE
        return 1.0 if complete else min(self.reached / self.length, 1.0)

    def cut(self, cut: PathCut) -> PathTracking:
        """Return the part up to a place; no joint path where that is too near to the start."""
        assert self.path is not None
        begins = cut.s > _SHORTEST * self.length
        return PathTracking(
            self.path.until(cut.s) if begins else None,
            cut.s if begins else 0.0,
            cut.status,
            f"at s = {cut.s:.6g} of {self.length:.6g} m: {cut.text}",
            self.length,
            cut.joint,
        )
