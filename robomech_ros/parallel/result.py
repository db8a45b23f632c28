"""Results of the kinematics of parallel robots and of mechanisms."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from robomech_ros.outcomes import Code
from robomech_ros.printing import Printed
from robomech_ros.typing import Array, IntArray

_NOTHING = np.empty(0)
_NOTHING.setflags(write=False)


@dataclass(frozen=True, eq=False)
class DirectKinematicsResult(Printed):
    """All poses of the platform for given actuated joints, its assembly modes.

    Parameters
    ----------
    poses : ndarray, shape (k, 4, 4)
        ``T_base_platform`` (m), nearest to the seed first if there was one.
    multiplicity : ndarray of int, shape (k,)
        How many modes meet in each pose: 1, or more where the robot is singular.
    complete : bool
        Whether these are provably all real poses.
    family : str
        What kind of robot it is solved as.
    status : Code
        ``NONE``, ``OUT_OF_REACH`` where there is no real pose, ``SINGULAR_CONTINUUM`` where the
        platform can move with locked joints, ``NOT_CONVERGED`` where poses may be missing.
    reason : str
        In words, with numbers; empty where there is nothing to say.
    errors : ndarray, shape (k,)
        Largest error of the closure of a limb (m, or of a cosine), at each pose.
    """

    poses: Array
    multiplicity: IntArray
    complete: bool
    family: str
    status: Code
    reason: str = ""
    errors: Array = field(default_factory=lambda: _NOTHING)

    def __len__(self) -> int:
        return len(self.poses)


@dataclass(frozen=True, eq=False)
class FollowedPose:
    """Pose into which a known one moves when the joints move.

    Parameters
    ----------
    pose : ndarray, shape (4, 4)
        ``T_base_platform`` (m) at the end, or as far as it could be followed.
    certified : bool
        Whether it is provably the pose into which the given one moves while the squared lengths
        move along a line: the assembly mode is the same.
    status : Code
        ``NONE``; ``SINGULAR`` if the motion ends in a singular pose, in which modes meet;
        ``NOT_CONVERGED`` if the next step cannot be certified: the mode is unknown.
    part : float
        Certified part of the motion, 1 at its end.
    steps : int
        Number of certified steps; 0 if the motion is incomplete.
    reason : str
        Why the motion is incomplete; empty if it is complete.
    """

    pose: Array
    certified: bool
    status: Code
    part: float
    steps: int
    reason: str = ""


@dataclass(frozen=True, eq=False)
class LimbPostures:
    """All actuated joints of a robot of revolute limbs that hold its platform in a pose.

    Parameters
    ----------
    q : ndarray, shape (k, n)
        Actuated joints (rad), one row for each combination of the limbs' branches, nearest to the
        seed first if there was one, and within limits.
    branches : tuple of str
        Branches of each row: for each limb ``+`` or ``-``, or ``0`` where both branches meet.
    status : Code
        ``NONE``, ``OUT_OF_REACH`` where a limb does not reach the pose, ``LIMITS_EXCLUDE_ALL``
        where limits exclude all branches of a limb, ``SINGULAR_CONTINUUM`` where any angle of a
        limb will do.
    reason : str
        Which limb, and by how much; empty where there is nothing to say.
    excess : ndarray, shape (n,)
        By how much each limb misses the pose: m or rad, 0 where it does not.
    """

    q: Array
    branches: tuple[str, ...]
    status: Code
    reason: str
    excess: Array

    def __len__(self) -> int:
        return len(self.q)


@dataclass(frozen=True, eq=False)
class MechanismPostures(LimbPostures):
    """All joints of a mechanism for a pose of its platform, in all branches of its limbs.

    Parameters
    ----------
    q : ndarray, shape (k, n)
        All joints (rad or m), nearest to the seed first if there was one.
    branches, status, reason, excess
        As those of :class:`LimbPostures`; other branches have numbers, and the excess of a limb is
        that of the joint that its limit excludes.
    blocking : tuple of str
        The joint of each limb whose limit excludes the pose, empty where none does.
    """

    blocking: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class AssemblyModes(DirectKinematicsResult):
    """All poses of the platform for given drives, with all joints of each.

    Parameters
    ----------
    q : ndarray, shape (k, n)
        All joints (rad or m) of each pose, also where they are outside their limits.
    """

    q: Array = field(default_factory=lambda: np.empty((0, 0)))


@dataclass(frozen=True, eq=False)
class LoopClosure:
    """Joint positions after the drives moved.

    Parameters
    ----------
    q : ndarray, shape (n,)
        All joints (rad or m): for the drives asked for, or as far as the mode could be followed.
    status : Code
        ``NONE``; ``SINGULAR`` where a singularity, in which modes meet, is in the way;
        ``NOT_CONVERGED`` where the loops of the given posture are open, or the way is too long for
        one call.
    part : float
        The part of the way of the drives that was gone: 1 at the end.
    error : float
        Largest error of a loop: rad, or m over the mechanism's size.
    reason : str
        In words; empty where there is nothing to say.
    """

    q: Array
    status: Code
    part: float
    error: float
    reason: str = ""
