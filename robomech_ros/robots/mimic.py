"""Joints that mimic others: who follows whom in the end, and where."""

from collections.abc import Iterable
from dataclasses import dataclass

from robomech_ros.robots.joint import Joint

__all__ = ["Follower", "followers", "mimic_faults"]

_MOST_NAMES = 20


@dataclass(frozen=True)
class Follower:
    """How a joint follows another, which itself follows none.

    It stands at ``multiplier`` times the position of joint ``leader`` plus ``offset`` (rad or m).
    """

    leader: str
    multiplier: float
    offset: float

    def position(self, of_leader: float) -> float:
        """Give the position (rad or m) that belongs to one of the leader."""
        return self.multiplier * of_leader + self.offset


def followers(joints: Iterable[Joint]) -> dict[str, Follower]:
    """Find the joints that follow others; where those follow again, the first of all is the leader.

    Parameters
    ----------
    joints : iterable of Joint
        Those that mimic others have one to follow (:func:`mimic_faults`).
    """
    by_name = {joint.name: joint for joint in joints}
    found: dict[str, Follower] = {}
    for joint in by_name.values():
        path = []
        while joint.mimic is not None and joint.name not in found:
            path.append(joint)
            joint = by_name[joint.mimic]
        of_last = found.get(joint.name, Follower(joint.name, 1.0, 0.0))
        for follower in reversed(path):
            of_last = Follower(
                of_last.leader,
                follower.multiplier * of_last.multiplier,
                follower.multiplier * of_last.offset + follower.offset,
            )
            found[follower.name] = of_last
    return found


def mimic_faults(joints: Iterable[Joint]) -> dict[str, str]:
    """Find joints that mimic one that does not exist or does not move, or in the end themselves.

    Parameters
    ----------
    joints : iterable of Joint
        All of a robot.

    Returns
    -------
    dict of str to str
        What is wrong, by joint.
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
                why = f"<mimic> names joint '{joint.mimic[:80]}', expected one that moves: {names}"
                faults[joint.name] = why
                break
            if joint.mimic in path:
                circle = [*path][[*path].index(joint.mimic) :]
                names = _listed([*circle, joint.mimic])
                why = f"<mimic> goes in a circle: {names}; expected a joint that mimics none"
                faults |= dict.fromkeys(circle, why)
                break
            joint = by_name[joint.mimic]
        seen.update(path)
    return faults


def _listed(names: list[str]) -> str:
    return ", ".join(f"'{name}'" for name in names[:_MOST_NAMES])
