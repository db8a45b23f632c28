"""A limb of a mechanism: a chain from the base to the platform, and how it is solved for a pose."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, UnknownJointError
from robomech_ros.kinematics import Status, inverse_kinematics
from robomech_ros.outcomes import Code
from robomech_ros.robots import LinkFrame, SerialChain
from robomech_ros.robots.chain_layout import pack_chain
from robomech_ros.robots.joint import rotation_from_z
from robomech_ros.robots.limit_arrays import limit_arrays
from robomech_ros.spatial.arrays import listed
from robomech_ros.spatial.poses import assembled, rigid_inverse
from robomech_ros.typing import Array, ArrayLike, IntArray

# Errors (m, rad) of a pose that a chain holds.
_HELD = 1e-9
_DRIVE_LIMITS = ("velocity", "acceleration", "jerk", "effort")


@dataclass(frozen=True, eq=False)
class LimbBranches:
    """All joints of one limb for a pose of the platform, limits disregarded.

    The joints q (k, n) are those of the branches of these names.  By the excess (m or rad) the
    limb misses the pose; the code and the reason, empty where the excess says all, tell why.  In a
    continuum the joints can move while the platform stays; q may then be empty.
    """

    q: Array
    names: tuple[str, ...]
    excess: float = 0.0
    continuum: bool = False
    code: Code = Code.OUT_OF_REACH
    reason: str = ""


Solver = Callable[[Array, Array | None], LimbBranches]


@dataclass(frozen=True, eq=False)
class Limb:
    """A chain from the base to the platform, its joint to the platform included.

    Parameters
    ----------
    chain : SerialChain
        From the base to a link that is fixed to the platform.
    actuated : sequence of str
        The joints that have a drive; the others are passive.
    solver : callable, optional
        Gives :class:`LimbBranches` for a pose (4, 4) of the platform, and positions of the drives
        of the limb where they are known, else None: with them also where every position of a
        drive holds the pose.  By default the inverse kinematics of the chain.
    cones : sequence of (str, float), optional
        The first of two joints whose axes meet at a right angle, and how far they may bend what
        follows from where both are at zero (rad).
    """

    chain: SerialChain
    actuated: Sequence[str]
    solver: Solver | None = None
    cones: Sequence[tuple[str, float]] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.chain, SerialChain):
            raise BadValueError("chain of the limb", self.chain, "a SerialChain")
        self.chain.require_uncoupled("chain of the limb", "describe the limb without <mimic>")
        names = listed("actuated", self.actuated, "names of joints")
        for name in names:
            if name not in self.chain.joint_names:
                raise UnknownJointError(name, self.chain.joint_names)
        object.__setattr__(self, "actuated", names)
        object.__setattr__(self, "cones", tuple(self.cones))
        for name, _ in self.cones:
            if name not in self.chain.joint_names[:-1]:
                raise UnknownJointError(name, self.chain.joint_names[:-1])

    @cached_property
    def bent(self) -> tuple[IntArray, Array]:
        """The first joints of the cones, and the angles of these (rad)."""
        at = [self.chain.joint_names.index(name) for name, _ in self.cones]
        return np.array(at, np.int64), np.array([angle for _, angle in self.cones])

    @property
    def passive(self) -> tuple[str, ...]:
        """The joints without a drive."""
        return tuple(name for name in self.chain.joint_names if name not in self.actuated)

    def limit_excess(self, q: Array) -> Array:
        """Say by how much joints (..., n) are outside their limits (rad or m), 0 inside."""
        return np.maximum(-limit_margins(q, self.chain, *self.bent), 0.0)

    def branches(self, T: Array, drives: Array | None = None) -> LimbBranches:
        """Find all joints of the limb for a pose (4, 4) of the platform (m).

        Where the positions of its drives are known, branches may be left out that have others.
        """
        return (self.solver or self._by_chain)(T, drives)

    def _by_chain(self, T: Array, drives: Array | None) -> LimbBranches:
        found = inverse_kinematics(self.chain, T, respect_limits=False)
        misses = np.maximum(found.position_error, found.orientation_error)
        continuum = found.status == Status.SINGULAR_CONTINUUM
        q = found.q if continuum else found.q[misses <= _HELD]
        if continuum or len(q):
            return LimbBranches(q, tuple(map(str, range(1, len(q) + 1))), continuum=continuum)
        excess = float(misses.min(initial=np.inf))
        # Solutions that miss the pose are those of least squares.
        missed = found.status == Status.SUCCESS
        code = Code.OUT_OF_REACH if missed else Code[found.status.name]
        return LimbBranches(q, (), excess, code=code, reason=found.reason)


def limit_margins(q: Array, limits: Any, at: IntArray, angles: Array) -> Array:
    """Say how far joints (..., n) are inside limits (rad or m), and inside cones (c,).

    These are given by the numbers of the first joints of cones, and their angles (rad).
    """
    margin: Array = np.minimum(q - limits.lower, limits.upper - q)
    if len(at):
        one, two = q[..., at], q[..., at + 1]
        across = np.hypot(np.sin(one) * np.cos(two), np.sin(two))
        bend = np.arctan2(across, np.cos(one) * np.cos(two))
        # Limits of both joints are those of the cone; beyond a right angle, the second one has
        # turned over, and bends the same way with the first one at half a turn.
        margin[..., at] = angles - bend
        margin[..., at + 1] = 0.5 * np.pi - np.abs(two)
    return margin


@dataclass(frozen=True, eq=False)
class Axis:
    """A joint of a limb and the link that it moves, where all joints of the limb are at zero.

    The direction is a unit vector and the point is on the axis, both in the base (m).
    """

    name: str
    link: str
    direction: Array
    point: Array
    slides: bool = False
    limits: tuple[float, float] = (-np.inf, np.inf)


def chain_of_axes(name: str, axes: Sequence[Axis], T: Array, tip: str) -> SerialChain:
    """Make a chain of a robot from the axes of its joints, all at zero, and ``T_base_tip`` (m)."""
    frames = [assembled(rotation_from_z(one.direction)[:3, :3], one.point) for one in axes]
    steps = [frames[0], *(rigid_inverse(a) @ b for a, b in pairwise([*frames, T]))]
    types = np.array([one.slides for one in axes], np.int64)
    links = ["base_link", *(one.link for one in axes)]
    along = [
        LinkFrame(link, i, np.eye(4), links[i - 1] if i else "") for i, link in enumerate(links)
    ]
    along.append(LinkFrame(tip, len(axes), steps[-1], links[-1]))
    unknown: dict[str, Any] = dict.fromkeys(_DRIVE_LIMITS, np.full(len(axes), np.nan))
    return SerialChain(
        name=name,
        base="base_link",
        tip=tip,
        joint_names=tuple(one.name for one in axes),
        types=types,
        packed=pack_chain(np.array(steps), types),
        lower=np.array([one.limits[0] for one in axes]),
        upper=np.array([one.limits[1] for one in axes]),
        frames=tuple(along),
        **unknown,
    )


def checked_drive_limits(
    limits: Mapping[str, ArrayLike] | ArrayLike | None, count: int
) -> dict[str, Array]:
    """Read the limits of drives, one number for all of them or one for each; NaN where none is."""
    if limits is not None and not isinstance(limits, Mapping):
        expected = "a mapping with keys among " + ", ".join(_DRIVE_LIMITS)
        raise BadValueError("drive_limits", limits, expected)
    for key in limits or {}:
        if key not in _DRIVE_LIMITS:
            raise BadValueError("key of drive_limits", key, "one of " + ", ".join(_DRIVE_LIMITS))
    found = limit_arrays(limits, count)
    for key in _DRIVE_LIMITS:
        if (found[key] <= 0.0).any():
            raise BadValueError(f"{key} of drive_limits", found[key].tolist(), "more than 0")
    return {key: found[key] for key in _DRIVE_LIMITS}


def with_drive_limits(limbs: Sequence[Limb], limits: Mapping[str, Array]) -> list[Limb]:
    """Return the drives of limbs, counted limb by limb, their limits (m,)."""
    found, drive = [], 0
    for limb in limbs:
        chain, index = limb.chain, []
        for name in limb.chain.joint_names:
            index.append(drive if name in limb.actuated else -1)
            drive += name in limb.actuated
        of_joints: dict[str, Any] = {
            key: np.append(row, np.nan)[index] for key, row in limits.items()
        }
        found.append(replace(limb, chain=replace(chain, **of_joints)))
    return found


def checked_limbs(limbs: Sequence[Limb]) -> tuple[Limb, ...]:
    """Check that limbs fit together: two or more, from one base, names all different."""
    given = listed("limbs", limbs, "two limbs or more")
    if len(given) < 2 or not all(isinstance(limb, Limb) for limb in given):
        raise BadValueError("limbs", limbs, "two limbs or more")
    bases = {limb.chain.base for limb in given}
    if len(bases) > 1:
        raise BadValueError("base links", sorted(bases), "the same for all limbs")
    for what, names in (
        ("joint", [name for limb in given for name in limb.chain.joint_names]),
        ("link", [link for limb in given for link in limb.chain.links[1:]]),
    ):
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise BadValueError(f"{what} names of the limbs", twice[0], "different ones")
    return given
