"""Check of poses against strokes, cones and limits of the limbs."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from robomech_ros.errors import BadValueError
from robomech_ros.outcomes import Code
from robomech_ros.parallel.delta import Delta
from robomech_ros.parallel.kinetostatics.limb_geometry import leg_lengths, poses_of
from robomech_ros.parallel.kinetostatics.mechanism_poses import exclusion
from robomech_ros.parallel.kinetostatics.pose_samples import size_of
from robomech_ros.parallel.library import AnyParallelRobot
from robomech_ros.parallel.limbs import into_limits
from robomech_ros.parallel.mechanism.model import Mechanism
from robomech_ros.parallel.planar import Planar3RPR, Planar3RRR
from robomech_ros.parallel.spherical import Spherical3RRR
from robomech_ros.parallel.stewart_gough import StewartGough
from robomech_ros.typing import Array, ArrayLike, BoolArray

_LIMBS = 3
_MODES = tuple("".join(signs) for signs in product("-+", repeat=_LIMBS))


@dataclass(frozen=True, eq=False)
class PoseLimits:
    """Poses that a robot takes, and the reasons that exclude the others.

    Parameters
    ----------
    inside : ndarray of bool, shape (...)
        Whether a posture of the limbs holds the platform there, within all limits.
    cause : ndarray of str, shape (...)
        What excludes a pose most, such as "leg 3: too long", "limb 1: out of reach" or, of a
        mechanism, "limb 2: limits of leg2_hinge"; empty where nothing does.
    excess : ndarray, shape (...)
        By how much: m for lengths and reach, rad for cones, joints and spherical limbs; 0 where
        nothing does, infinite for a limb of any kind that misses a pose by an unknown amount.
    q : ndarray, shape (..., m)
        Drives of a posture that holds the platform, of a mechanism all joints (..., n); NaN where
        there is none.
    """

    inside: BoolArray
    cause: NDArray[np.str_]
    excess: Array
    q: Array


def pose_limits(
    robot: AnyParallelRobot, T: ArrayLike, *, branches: str | None = None
) -> PoseLimits:
    """Say which poses a robot takes within its limits, and which limb excludes the others.

    Parameters
    ----------
    robot : StewartGough, Delta, Planar3RPR, Planar3RRR, Spherical3RRR or Mechanism
    T : array_like, shape (..., 4, 4)
        ``T_base_platform``, or a shorter form as for :func:`velocity_matrices`.
    branches : str, optional
        Of the limbs, such as "---", as ``inverse`` names them; default any.  Robots with legs have
        none, and of a mechanism the posture nearest to its home is given.

    Examples
    --------
    >>> from robomech_ros.parallel import load_parallel, pose_limits
    >>> found = pose_limits(load_parallel("delta"), [[0, 0, -0.9], [0, 0, -1.9]])
    >>> found.inside.tolist(), str(found.cause[1]), round(float(found.excess[1]), 3)
    ([True, False], 'limb 1: out of reach', 0.136)
    """
    poses = poses_of(robot, T)
    flat = poses.reshape(-1, 4, 4)
    found = limits_at(robot, flat, as_branches(robot, branches))
    lead = poses.shape[:-2]
    return PoseLimits(*(part.reshape(lead + part.shape[1:]) for part in vars(found).values()))


def as_branches(robot: AnyParallelRobot, branches: object) -> str | None:
    """Check branches of the limbs."""
    if branches is None:
        return None
    if isinstance(robot, Mechanism):
        raise BadValueError("branches", branches, "none: of a mechanism the nearest posture counts")
    if isinstance(robot, StewartGough | Planar3RPR):
        raise BadValueError("branches", branches, "none: legs have no branches")
    if branches not in _MODES:
        raise BadValueError("branches", branches, f"one of {', '.join(_MODES)}")
    return str(branches)


def limits_at(robot: AnyParallelRobot, poses: Array, branches: str | None) -> PoseLimits:
    """Return :func:`pose_limits` of checked poses (k, 4, 4)."""
    if isinstance(robot, StewartGough | Planar3RPR):
        return _of_legs(robot, poses)
    if isinstance(robot, Mechanism):
        home = robot.home()
        return together([exclusion(robot, pose, home) for pose in poses], robot.n)
    return together([_of_limbs(robot, pose, branches) for pose in poses], _LIMBS)


def together(found: list[tuple[str, float, Array]], count: int) -> PoseLimits:
    """Put causes, excesses and joints (count,) of single poses together."""
    cause = np.array([one[0] for one in found], dtype=str)
    excess = np.array([one[1] for one in found])
    q = np.array([one[2] for one in found]).reshape(-1, count)
    return PoseLimits(cause == "", cause, excess, q)


def _of_legs(robot: StewartGough | Planar3RPR, poses: Array) -> PoseLimits:
    lengths = leg_lengths(robot, poses)
    count = lengths.shape[1]
    over, names = [], []
    if robot.strokes is not None:
        low, high = robot.strokes.T
        over += [lengths - high, low - lengths]
        names += [f"leg {k + 1}: too {how}" for how in ("long", "short") for k in range(count)]
    lengthwise = len(names)
    if isinstance(robot, StewartGough):
        over += list(np.moveaxis(robot.cone_margins(poses), 1, 0))
        names += [f"leg {k + 1}: {end} joint cone" for end in ("base", "platform")
                  for k in range(count)]  # fmt: skip
    if not over:
        nothing = np.zeros(len(poses))
        return PoseLimits(nothing == 0.0, np.full(len(poses), ""), nothing, lengths)
    excess = np.concatenate(over, axis=1)
    # Lengths and angles are compared as parts of the robot's size and of a radian.
    weighed = excess / np.where(np.arange(len(names)) < lengthwise, size_of(robot), 1.0)
    worst = weighed.argmax(axis=1)
    most = excess[np.arange(len(poses)), worst]
    inside = most <= 0.0
    cause = np.where(inside, "", np.array(names)[worst])
    return PoseLimits(inside, cause, np.maximum(most, 0.0), lengths)


def _of_limbs(
    robot: Delta | Planar3RRR | Spherical3RRR, pose: Array, branches: str | None
) -> tuple[str, float, Array]:
    """Return the cause, the excess and the drives (3,) of one pose."""
    nowhere = np.full(_LIMBS, np.nan)
    found = (robot if branches is None else _unlimited(robot)).inverse(pose)
    if found.status == Code.SINGULAR_CONTINUUM:
        return "any angle of a limb holds it", 0.0, nowhere
    if found.status != Code.NONE:
        limb = int(np.argmax(found.excess))
        reach = found.status == Code.OUT_OF_REACH
        cause = f"limb {limb + 1}: {'out of reach' if reach else 'joint limits'}"
        return cause, float(found.excess[limb]), nowhere
    if branches is None:
        return "", 0.0, found.q[0]
    row = next(
        k
        for k, name in enumerate(found.branches)
        if all(sign in ("0", wanted) for sign, wanted in zip(name, branches, strict=True))
    )
    placed = [
        into_limits(angle, *limits)
        for angle, limits in zip(found.q[row].tolist(), robot.limits.tolist(), strict=True)
    ]
    off = [over for _, over in placed]
    limb = int(np.argmax(off))
    if off[limb] > 0.0:
        return f"limb {limb + 1}: joint limits", off[limb], nowhere
    return "", 0.0, np.array([value for value, _ in placed])


def _unlimited(robot: Delta | Planar3RRR | Spherical3RRR) -> Delta | Planar3RRR | Spherical3RRR:
    free = copy.copy(robot)
    free.limits = np.tile([-np.pi, np.pi], (_LIMBS, 1))
    return free
