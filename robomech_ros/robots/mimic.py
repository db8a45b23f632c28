"""Mimic joints: the joint that each one follows, and the drives of a chain with such joints."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.chain.layout import ANGLE, COUPLING_WIDTH, SLIDE, TURN
from robomech_ros.errors import RobotDescriptionError
from robomech_ros.robots.chain_layout import PRISMATIC, REVOLUTE
from robomech_ros.robots.drives import Drive
from robomech_ros.robots.joint import Joint
from robomech_ros.robots.limit_arrays import KEYS
from robomech_ros.typing import Array, IntArray

_MOST_NAMES = 20


@dataclass(frozen=True)
class MimicJoint:
    """Position of a mimic joint as a function of the joint that it follows.

    It is ``multiplier`` times the position of joint ``leader``, which follows none, plus ``offset``
    (rad or m).
    """

    leader: str
    multiplier: float
    offset: float

    def position(self, of_leader: float) -> float:
        """Return the position (rad or m) for a position of the leader."""
        return self.multiplier * of_leader + self.offset


@dataclass(frozen=True, eq=False)
class Coupling:
    """Positions of the m joints of a chain as a function of the values q (n,) of its drives.

    Joint i stands at ``gain[i] q[drive[i]] + offset[i]``.
    """

    joint_names: tuple[str, ...]  #: All m joints from base to tip, followers included.
    types: IntArray  #: 0 revolute, 1 prismatic, shape (m,).
    drive: IntArray  #: Index of the drive that moves each joint, shape (m,).
    gain: Array  #: 1, or a ratio of rad and m, shape (m,).
    offset: Array  #: rad or m, shape (m,).

    @property
    def matrix(self) -> Array:
        """The matrix A (m, n) by which joint rates are A times those of the drives."""
        A = np.zeros((len(self.drive), int(self.drive.max()) + 1))
        A[np.arange(len(self.drive)), self.drive] = self.gain
        return A

    def first(self, count: int) -> "Coupling":
        """Return the coupling of the first ``count`` joints."""
        types, drive = self.types[:count], self.drive[:count]
        gain, offset = self.gain[:count], self.offset[:count]
        return Coupling(self.joint_names[:count], types, drive, gain, offset)

    def columns(self, types: IntArray) -> Array:
        """Return its columns (m + 1, 4) in a packed chain, for drives of these types (n,)."""
        rows = np.zeros((len(self.drive) + 1, COUPLING_WIDTH))
        rows[:-1, 0], rows[:-1, 1], rows[:-1, 2] = self.drive, self.gain, self.offset
        rows[-1, 0] = len(types)
        # A whole turn of a drive brings back joints that turn by a whole number of turns with it.
        moves = self.gain != 0.0
        whole = (self.types == REVOLUTE) & (self.gain == np.round(self.gain))
        for k, kind in enumerate(types):
            turns = bool(np.all(whole[moves & (self.drive == k)]))
            rows[k, 3] = SLIDE if kind == PRISMATIC else TURN if turns else ANGLE
        return rows


def drive_limits(leader: Joint, joints: Sequence[tuple[Joint, MimicJoint]]) -> Mapping[str, float]:
    """Return the six limits of a drive, narrowed by its followers."""
    limits = {key: float(getattr(leader, key)) for key in KEYS}
    for joint, follower in joints:
        gain = follower.multiplier
        if joint is leader or gain == 0.0:
            continue
        ends = _drive_range(joint, gain, follower.offset)
        # Many grippers turn some fingers the other way, with limits as if they did not.
        mirrored = _drive_range(joint, abs(gain), follower.offset)
        if not _overlap(limits, ends) > 0.0 and _overlap(limits, mirrored) > 0.0:
            ends = mirrored
        lower, upper = max(limits["lower"], ends[0]), min(limits["upper"], ends[1])
        if lower > upper:
            place = f"joint '{joint.name}'"
            why = (
                f"it stays inside its limits [{joint.lower:g}, {joint.upper:g}] only if joint "
                f"'{leader.name}', which it mimics with multiplier {gain:g} and offset "
                f"{follower.offset:g}, is in [{ends[0]:g}, {ends[1]:g}], but that joint is limited "
                f"to [{limits['lower']:g}, {limits['upper']:g}]; change the limits or the <mimic>"
            )
            raise RobotDescriptionError(place, why)
        limits["lower"], limits["upper"] = lower, upper
        for key in ("velocity", "acceleration", "jerk"):
            limits[key] = float(np.fmin(limits[key], getattr(joint, key) / abs(gain)))
    return limits


def _drive_range(joint: Joint, gain: float, offset: float) -> list[float]:
    """Return the two ends of the range of a drive in which a follower keeps its limits."""
    return sorted((end - offset) / gain for end in (joint.lower, joint.upper))


def _overlap(limits: Mapping[str, float], ends: list[float]) -> float:
    """Return how long the part of a range is that lies inside limits; negative if there is none."""
    return min(limits["upper"], ends[1]) - max(limits["lower"], ends[0])


def joined_drive(leader: Joint, joints: Sequence[tuple[Joint, MimicJoint]]) -> Drive:
    """Return the friction and rotor inertia of a drive, including those of its followers."""
    others = [pair for pair in joints if pair[0] is not leader and pair[0].drive != Drive()]
    if not others:
        return leader.drive
    parts = [(1.0, leader.drive), *((one.multiplier, joint.drive) for joint, one in others)]
    static = sum(abs(gain) * max(one.static, one.coulomb) for gain, one in parts)
    coulomb = sum(abs(gain) * one.coulomb for gain, one in parts)
    decays = [
        one.stribeck_velocity / abs(gain) for gain, one in parts if gain and one.stribeck_velocity
    ]
    return Drive(
        viscous=sum(gain**2 * one.viscous for gain, one in parts),
        coulomb=coulomb,
        static=static if static > coulomb else 0.0,
        stribeck_velocity=min(decays, default=0.0),
        rotor_inertia=sum(gain**2 * one.reflected_inertia for gain, one in parts),
    )


def followers(joints: Iterable[Joint]) -> dict[str, MimicJoint]:
    """Map each mimic joint to its leader, the joint at the end of a row of mimics.

    Parameters
    ----------
    joints : iterable of Joint
        Without faults (:func:`mimic_faults`).
    """
    by_name = {joint.name: joint for joint in joints}
    found: dict[str, MimicJoint] = {}
    for joint in by_name.values():
        path = []
        while joint.mimic is not None and joint.name not in found:
            path.append(joint)
            joint = by_name[joint.mimic]
        of_last = found.get(joint.name, MimicJoint(joint.name, 1.0, 0.0))
        for follower in reversed(path):
            of_last = MimicJoint(
                of_last.leader,
                follower.multiplier * of_last.multiplier,
                follower.multiplier * of_last.offset + follower.offset,
            )
            found[follower.name] = of_last
    return found


def mimic_faults(joints: Iterable[Joint]) -> dict[str, str]:
    """Find mimic joints whose leader is missing, does not move or is the joint itself.

    - ``joints``: all joints of a robot.

    Returns what is wrong, by joint.
    """
    by_name = {joint.name: joint for joint in joints}
    faults: dict[str, str] = {}
    seen: set[str] = set()
    for joint in by_name.values():
        path: dict[str, None] = {}
        while joint.mimic is not None and joint.name not in seen:
            path[joint.name] = None
            if joint.mimic not in by_name or not by_name[joint.mimic].moves:
                names = _listed([one.name for one in by_name.values() if one.moves])
                why = (
                    f"<mimic> names joint '{joint.mimic[:80]}', which does not exist or does not "
                    f"move; joints that move: {names}"
                )
                faults[joint.name] = why
                break
            if joint.mimic in path:
                circle = [*path][[*path].index(joint.mimic) :]
                names = _listed([*circle, joint.mimic])
                why = f"<mimic> is circular: {names}; let one of them mimic no joint"
                faults |= dict.fromkeys(circle, why)
                break
            joint = by_name[joint.mimic]
        seen.update(path)
    return faults


def _listed(names: list[str]) -> str:
    return ", ".join(f"'{name}'" for name in names[:_MOST_NAMES])
