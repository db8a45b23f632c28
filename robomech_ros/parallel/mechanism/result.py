"""Results of a mechanism."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from robomech_ros.outcomes import Code
from robomech_ros.parallel.result import DirectKinematicsResult, LimbPostures
from robomech_ros.typing import Array


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
