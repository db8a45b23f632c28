"""Errors of names that are not known."""

from collections.abc import Iterable, Sequence
from difflib import get_close_matches

from robomech_ros.errors.formatting import LONGEST_LIST, LONGEST_VALUE, format_value, listed
from robomech_ros.errors.values import RobomechError

_MOST_COMPARED = 500


def _near(name: str, known: Sequence[str], most: int) -> list[str]:
    """Return the names that are like one, the nearest first."""
    candidates = [one for one in known[:_MOST_COMPARED] if len(one) < LONGEST_VALUE]
    return get_close_matches(str(name)[:LONGEST_VALUE], candidates, n=max(most, 1))


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a hint at the name that is most like one; empty if none is."""
    close = _near(name, tuple(known), 1)
    return f" (did you mean '{close[0]}'?)" if close else ""


class _UnknownNameError(RobomechError):
    """A name that is not among the known ones."""

    kind = "name"
    most = LONGEST_LIST

    def __init__(self, name: str, available: Iterable[str]) -> None:
        self.name = name
        self.available = tuple(available)
        hint = did_you_mean(name, self.available)
        known = listed(self.available, self.most)
        super().__init__(f"unknown {self.kind} {format_value(name)}{hint}; available: {known}")


class UnknownRobotError(_UnknownNameError):
    """No robot of this name, and no file of this name either; the nearest names come first."""

    kind = "robot"
    most = 100

    def __init__(self, name: str, available: Iterable[str]) -> None:
        known = tuple(available)
        near = _near(name, known, len(known))
        super().__init__(name, (*near, *(one for one in known if one not in near)))


class UnknownLinkError(_UnknownNameError):
    """The chain or the robot has no link of this name."""

    kind = "link"


class UnknownJointError(_UnknownNameError):
    """The chain has no joint of this name."""

    kind = "joint"
