"""The one model of a serial chain: constant transforms between its joints, and limits."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels.chain.layout import COUPLING_WIDTH, PACKED_WIDTH, TURN
from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.errors.formatting import counted
from robomech_ros.printing import MOST_LINES, Printed
from robomech_ros.robots.bodies import Body, lump_bodies, pack_bodies
from robomech_ros.robots.chain_layout import MOST_JOINTS, PRISMATIC, REVOLUTE, unpack_chain
from robomech_ros.robots.dh_recovery import recover_dh
from robomech_ros.robots.dh_table import DHTable
from robomech_ros.robots.drives import Drive
from robomech_ros.robots.entry_checks import bare_link, check_name, check_names, checked_entries
from robomech_ros.robots.limit_arrays import (
    KEYS,
    LARGEST_ANGLE,
    check_limits,
    limit_arrays,
    position_limits,
    require_limits,
)
from robomech_ros.robots.link_frames import LinkFrame, find_frame, links_between, links_moved
from robomech_ros.robots.mimic import Coupling
from robomech_ros.robots.regular_posture import regular_posture
from robomech_ros.typing import Array, BoolArray, IntArray

LimitKind = Literal["position", "velocity", "acceleration", "jerk", "effort"]


@dataclass(frozen=True, eq=False)
class SerialChain(Printed):
    """A serial chain of revolute and prismatic joints from a base link to a tip link.

    Joints may follow others.  Joint values q, limits and names are then those of the n drives,
    and the m joints from base to tip stand at ``A q + b``, as ``coupling`` says.

    Instances are immutable and compare by identity, so they serve as keys of caches.

    Parameters
    ----------
    name : str
        The robot.
    base, tip : str
        The links whose relative pose the chain gives, ``T_base_tip``.
    joint_names : tuple of str
        The moving joints from base to tip; where some follow others, those that they follow, also
        if these are not on the chain.
    types : ndarray of int, shape (n,)
        0 revolute, 1 prismatic.
    packed : ndarray, shape (n + 1, 13), or (m + 1, 17) where joints follow others
        Row i holds the type of joint i + 1 (-1 in the last row) and the constant transform C_i:
        rotation row by row, then origin (m);
        ``T_base_tip = C_0 J_1(q_1) C_1 ... J_n(q_n) C_n``, J_i about or along z.  What follows in
        a row is that of the coupling; it is appended where it is not given.
    lower, upper : ndarray, shape (n,)
        Position limits (rad or m), infinite where there is none; 1e5 and more stands for none.
    velocity, acceleration, jerk, effort : ndarray, shape (n,)
        Magnitudes of the limits (rad/s or m/s and so on; N m or N), NaN where there is none.
    frames : tuple of LinkFrame
        Links along the chain, base and tip included, and links fixed to one of them.
    dh_given : DHTable or None
        The Denavit-Hartenberg table that the chain was made from.
    bodies : tuple of Body or None
        What moves with each of the n (or m) joints, in the frame in front of C_i that turns or
        slides with joint i; None where nothing is known of it.  Default nothing known.
    drives : tuple of Drive
        Friction and rotor of each drive.  Default none.
    home_given : ndarray, shape (n,), or None
        Where the robot stands to begin with (rad or m); see :meth:`home`.
    coupling : Coupling or None
        How joints follow the drives.  Default every joint is a drive.
    description : RobotDescription or None
        The robot that the chain is a part of, where it was made from one.
    """

    name: str
    base: str
    tip: str
    joint_names: tuple[str, ...]
    types: IntArray
    packed: Array
    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    effort: Array
    frames: tuple[LinkFrame, ...] = ()
    dh_given: DHTable | None = None
    bodies: tuple[Body | None, ...] = ()
    drives: tuple[Drive, ...] = ()
    home_given: Array | None = None
    coupling: Coupling | None = None
    description: Any = None

    def __post_init__(self) -> None:
        for what in ("name", "base", "tip"):
            check_name(what, getattr(self, what))
        check_names("joint_names", self.joint_names)
        check_names("names of links", [frame.name for frame in self.frames])
        n = len(self.joint_names)
        if n > MOST_JOINTS:
            raise BadValueError("number of joints", n, f"at most {MOST_JOINTS} in a chain")
        for field in KEYS:
            self._freeze(field, np.float64, (n,))
        check_limits(self.joint_names, {field: getattr(self, field) for field in KEYS})
        for field, values in zip(KEYS, position_limits(self.lower, self.upper), strict=False):
            object.__setattr__(self, field, values)
            self._freeze(field, np.float64, (n,))
        if not np.isin(self.types, (REVOLUTE, PRISMATIC)).all():
            raise BadValueError("types", self.types, "0 (revolute) or 1 (prismatic)")
        self._freeze("types", np.int64, (n,))
        m, width = len(self.all_joint_names), PACKED_WIDTH
        if self.coupling is not None:
            width += COUPLING_WIDTH
            if self.packed.shape[1] == PACKED_WIDTH:
                both = np.hstack((self.packed, self.coupling.columns(self.types)))
                object.__setattr__(self, "packed", both)
        self._freeze("packed", np.float64, (m + 1, width))
        if not np.isfinite(self.packed).all():
            raise NonFiniteError("packed", self.packed)
        longest = float(np.abs(self.packed[:, 10:PACKED_WIDTH]).max())
        if longest > LARGEST_LENGTH:
            raise BadValueError("longest offset", longest, f"at most {LARGEST_LENGTH:g} m")
        bodies = checked_entries("bodies", self.bodies, Body | None, m)
        object.__setattr__(self, "bodies", bodies or (None,) * m)
        drives = checked_entries("drives", self.drives, Drive, n)
        object.__setattr__(self, "drives", drives or (Drive(),) * n)
        if self.home_given is not None:
            self._freeze("home_given", np.float64, (n,))
            for name, value in zip(self.joint_names, self.home_given.tolist(), strict=True):
                if not np.isfinite(value):
                    raise BadValueError(f"home of joint '{name}'", value, "a finite number")

    def _freeze(self, field: str, dtype: type, shape: tuple[int, ...]) -> None:
        array: NDArray = np.array(getattr(self, field), dtype=dtype, order="C")
        if array.shape != shape:
            raise WrongSizeError(field, array.shape, shape)
        array.setflags(write=False)
        object.__setattr__(self, field, array)

    def __repr__(self) -> str:
        return (
            f"SerialChain({self.name!r}, {counted(self.n, 'joint')}, {self.base!r} to {self.tip!r})"
        )

    def __str__(self) -> str:
        rows = zip(self.joint_names, self.units, self.lower, self.upper, self.velocity, strict=True)
        joints = [
            f"  {name}: {low:.4g} to {high:.4g} {unit}"
            + ("" if np.isnan(speed) else f", {speed:.4g} {unit}/s")
            for name, unit, low, high, speed in rows
        ]
        if len(joints) >= MOST_LINES:
            joints[MOST_LINES - 2 :] = [f"  and {len(joints) - MOST_LINES + 2} more"]
        return "\n".join(
            [f"{self.name}: {counted(self.n, 'joint')}, {self.base} to {self.tip}", *joints]
        )

    @cached_property
    def n(self) -> int:
        """Number of drives: joints that move independently."""
        return len(self.joint_names)

    @property
    def all_joint_names(self) -> tuple[str, ...]:
        """All m joints from base to tip, those that follow others included."""
        return self.joint_names if self.coupling is None else self.coupling.joint_names

    @cached_property
    def uncoupled(self) -> SerialChain:
        """The chain whose m joints move independently, without limits; itself without coupling."""
        if self.coupling is None:
            return self
        m = len(self.all_joint_names)
        return replace(
            self,
            joint_names=self.all_joint_names,
            types=self.coupling.types,
            packed=self.packed[:, :PACKED_WIDTH],
            **limit_arrays(None, m),
            drives=(),
            home_given=None,
            coupling=None,
        )

    def joint_values(self, q: Array) -> Array:
        """Compute the values (..., m) of all joints (rad or m) from the drives' (..., n)."""
        if self.coupling is None:
            return q
        return self.coupling.gain * np.take(q, self.coupling.drive, -1) + self.coupling.offset

    def joint_rates(self, qd: Array) -> Array:
        """Compute the rates (..., m) of all joints from the drives' rates (..., n)."""
        if self.coupling is None:
            return qd
        return self.coupling.gain * np.take(qd, self.coupling.drive, -1)

    def drive_efforts(self, efforts: Array) -> Array:
        """Return the drive efforts (..., n) for efforts (..., m) at all joints (N m or N)."""
        return efforts if self.coupling is None else efforts @ self.coupling.matrix

    def drive_columns(self, columns: Array) -> Array:
        """Convert columns (..., k, m) for joint rates to columns (..., k, n) for drive rates."""
        return columns if self.coupling is None else columns @ self.coupling.matrix

    def drive_matrix(self, matrix: Array) -> Array:
        """Convert matrices (..., m, m) of all joints to matrices (..., n, n) of the drives."""
        if self.coupling is None:
            return matrix
        A = self.coupling.matrix
        return A.T @ matrix @ A

    def driven_joint(self, drive: int) -> tuple[int, float]:
        """Find the joint that a drive moves most, and its rate per rate of the drive."""
        if self.coupling is None:
            return drive, 1.0
        column = self.coupling.matrix[:, drive]
        joint = int(np.abs(column).argmax())
        return joint, float(column[joint]) or 1.0

    @property
    def transforms(self) -> Array:
        """The constant transforms C_0 .. C_n (m), shape (n + 1, 4, 4), a copy."""
        self.require_uncoupled()
        return unpack_chain(self.packed)

    def require_uncoupled(
        self,
        what: str = "chain",
        instead: str = "chain.uncoupled is one, at the joint values chain.joint_values(q)",
    ) -> None:
        """Raise an error if joints follow others; ``what`` and ``instead`` complete its text."""
        if self.coupling is not None:
            followers = [name for name in self.all_joint_names if name not in self.joint_names]
            noun = "joint" if len(followers) == 1 else "joints"
            named = f"{self.name} with mimic {noun} {', '.join(followers or self.all_joint_names)}"
            raise BadValueError(what, named, f"one whose joints move independently; {instead}")

    @cached_property
    def turns(self) -> BoolArray:
        """Joints whose value may change by a whole turn without effect, shape (n,)."""
        kinds = self.types if self.coupling is None else self.packed[: self.n, -1]
        return _frozen(kinds == TURN)

    @cached_property
    def continuous(self) -> BoolArray:
        """Mask (n,) of joints that turn without position limits."""
        unlimited = np.isneginf(self.lower) & np.isposinf(self.upper)
        return _frozen(self.turns & unlimited)

    @cached_property
    def units(self) -> tuple[str, ...]:
        """The units of the n joint values: rad, or m where a joint slides."""
        return tuple("m" if kind == PRISMATIC else "rad" for kind in self.types)

    @cached_property
    def largest(self) -> Array:
        """Largest magnitude of joint values that solvers start from (rad or m), shape (n,)."""
        return _frozen(np.where(self.types == PRISMATIC, LARGEST_LENGTH, LARGEST_ANGLE))

    @cached_property
    def links(self) -> tuple[str, ...]:
        """Names of the links along the chain, base to tip."""
        return links_between(self.frames, self.base, self.tip)

    @cached_property
    def dh(self) -> DHTable | None:
        """Denavit-Hartenberg table, given or recovered; None without joints or with coupling."""
        if self.dh_given is not None:
            return self.dh_given
        return recover_dh(self.packed) if self.n and self.coupling is None else None

    def link_frame(self, link: str) -> LinkFrame:
        """Find the frame of a link of this chain, or of one fixed to such a link.

        Raises
        ------
        UnknownLinkError
            There is none of this name; the error lists those there are.
        """
        return find_frame(self.frames, link)

    def with_tip(self, link: str) -> SerialChain:
        """Return the chain to another of its links, with only the joints that move that link."""
        check_name("link", link)
        link = bare_link(link)
        if link == self.tip:
            return self
        if link not in self._with_tip:
            self._with_tip[link] = self._cut_at(self.link_frame(link))
        return self._with_tip[link]

    @cached_property
    def _with_tip(self) -> dict[str, SerialChain]:
        """Cached chains to other links."""
        return {}

    def _cut_at(self, target: LinkFrame) -> SerialChain:
        k = target.joints
        rest = self.joint_values(np.clip(0.0, self.lower, self.upper))
        packed = self.packed[: k + 1, :PACKED_WIDTH].copy()
        packed[k, 0] = -1.0
        packed[k, 1:10] = target.offset[:3, :3].ravel()
        packed[k, 10:] = target.offset[:3, 3]
        bodies = lump_bodies(self.bodies, self.packed, rest, k)
        frames = tuple(frame for frame in self.frames if frame.joints <= k)
        coupling = self.coupling and self.coupling.first(k)
        if coupling is not None:
            # Drives stand in the order in which the joints of the chain need them.
            k = int(coupling.drive.max()) + 1 if k else 0
            if coupling.joint_names == self.joint_names[:k]:
                coupling = None
        return replace(
            self,
            tip=target.name,
            joint_names=self.joint_names[:k],
            types=self.types[:k],
            packed=packed,
            **{key: getattr(self, key)[:k] for key in KEYS},
            frames=frames,
            dh_given=None,
            bodies=bodies,
            drives=self.drives[:k],
            home_given=self.home()[:k],
            coupling=coupling,
        )

    @cached_property
    def packed_bodies(self) -> Array:
        """Bodies as the kernels read them, shape (n, 10).

        Mass (kg), centre of mass (m), and the moments xx, xy, xz, yy, yz, zz about it (kg m^2).

        Raises
        ------
        MissingInertiaError
            Of some joints nothing is known that moves with them; their links are named.
        """
        links = links_moved(self.frames, self.all_joint_names)
        return pack_bodies(self.bodies, links, self.all_joint_names)

    def home(self) -> Array:
        """Posture to begin with (rad or m), shape (n,): the one given, else a regular one.

        Where limits are narrower than the posture given, it is moved inside them.  A regular
        posture is far from singular and from the limits, which :meth:`midrange`, an arm stretched
        out or straight up, mostly is not.
        """
        if self.home_given is None:
            return self._regular.copy()
        return np.clip(self.home_given, self.lower, self.upper)

    @cached_property
    def _regular(self) -> Array:
        return regular_posture(self.packed, self.types, self.lower, self.upper, self.joint_values)

    def midrange(self) -> Array:
        """Middle of the position limits (rad or m), shape (n,).

        Where a joint has no limit or only one, it is 0, moved inside that one limit.
        """
        return self._midrange.copy()

    @cached_property
    def _midrange(self) -> Array:
        both = np.isfinite(self.lower) & np.isfinite(self.upper)
        middle = np.zeros(self.n)
        middle[both] = 0.5 * (self.lower[both] + self.upper[both])
        return np.clip(middle, self.lower, self.upper)

    def require_limits(self, kind: LimitKind) -> None:
        """Raise where a joint lacks a limit.

        Parameters
        ----------
        kind : {"position", "velocity", "acceleration", "jerk", "effort"}
            For ``"position"`` a joint that turns without limits lacks nothing.

        Raises
        ------
        MissingLimitsError
            It names the joints without this limit.
        """
        limits = {key: getattr(self, key) for key in KEYS}
        require_limits(kind, self.joint_names, limits, self.continuous)


def _frozen(array: NDArray) -> NDArray:
    array.setflags(write=False)
    return array
