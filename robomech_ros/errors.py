"""The errors that a wrong request raises; one class for each cause a caller can act on.

An outcome of the mathematics (out of reach, singular) is never an error: it is a status in a
result.  Every message gives the value, what was expected and, where there is one, the list of
what is available; the same facts are attributes of the exception.
"""

import copyreg
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

import numpy as np

__all__ = [
    "BadQuaternionError",
    "BadValueError",
    "ContradictionError",
    "DurationTooShortError",
    "LimitExceededError",
    "MapFileError",
    "MissingInertiaError",
    "MissingLimitsError",
    "NonFiniteError",
    "NotEnoughMemoryError",
    "OpenLoopsError",
    "RobomechError",
    "RobotDescriptionError",
    "SeedOutsideLimitsError",
    "SingularPostureError",
    "UndeterminedError",
    "UnknownJointError",
    "UnknownLinkError",
    "UnknownRobotError",
    "WrongSizeError",
    "shown",
]

_LONGEST_VALUE = 200
_LONGEST_LIST = 40
_MOST_COMPARED = 500


def shown(value: object) -> str:
    """Show a value from outside: its representation, shortened, control characters escaped.

    Parameters
    ----------
    value : object
        Of any size.

    Returns
    -------
    str
        Up to 200 characters of it, and how many there are where there are more.

    Examples
    --------
    >>> from robomech_ros.errors import shown
    >>> shown("elbow" * 1000)[-30:]
    'elbowelbo... (5002 characters)'
    """
    text = repr(value)
    if len(text) > _LONGEST_VALUE:
        text = f"{text[:_LONGEST_VALUE]}... ({len(text)} characters)"
    return text


def _listed(names: Sequence[str], most: int = _LONGEST_LIST) -> str:
    if not names:
        return "none"
    text = ", ".join(shown(name)[1:-1] for name in names[:most])
    if len(names) > most:
        text += f", and {len(names) - most} more"
    return text


def _near(name: str, known: Sequence[str], most: int) -> list[str]:
    """Give the names that are like one, the nearest first."""
    candidates = [one for one in known[:_MOST_COMPARED] if len(one) < _LONGEST_VALUE]
    return get_close_matches(str(name)[:_LONGEST_VALUE], candidates, n=max(most, 1))


class RobomechError(ValueError):
    """Base of all errors that this package raises for a wrong request."""

    def __reduce__(self) -> tuple[object, ...]:
        # As it is: the arguments that made it are not those of ValueError.
        return copyreg.__newobj__, (type(self), *self.args), vars(self)  # type: ignore[attr-defined]


class _UnknownNameError(RobomechError):
    """A name that is not among the known ones."""

    kind = "name"
    most = _LONGEST_LIST

    def __init__(self, name: str, available: Iterable[str]) -> None:
        self.name = name
        self.available = tuple(available)
        close = _near(name, self.available, 1)
        hint = f" (did you mean '{close[0]}'?)" if close else ""
        listed = _listed(self.available, self.most)
        super().__init__(f"unknown {self.kind} {shown(name)}{hint}; available: {listed}")


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


class BadValueError(RobomechError):
    """A value is of the wrong kind or outside its range."""

    def __init__(self, what: str, value: object, expected: str) -> None:
        self.what = what
        self.value = value
        self.expected = expected
        super().__init__(f"{what} is {shown(value)}, expected {expected}")


class ContradictionError(BadValueError):
    """Samples that cannot all be right: nothing fits them, or what is said of them is wrong."""


class UndeterminedError(BadValueError):
    """Samples that leave a part of the answer free.

    Parameters
    ----------
    what, value, expected
        As for :class:`BadValueError`.
    free : sequence of sequences of float, optional
        Unit vectors of the directions that are free, where there are such; the message says in
        which frame.
    """

    def __init__(
        self, what: str, value: object, expected: str, free: Sequence[Sequence[float]] = ()
    ) -> None:
        self.free = tuple(tuple(float(x) for x in one) for one in free)
        super().__init__(what, value, expected)


class OpenLoopsError(BadValueError):
    """Joint values with which the limbs of a parallel robot do not hold one platform.

    ``limb``, from 1, is farthest off: by ``distance`` (m) and ``angle`` (rad) from limb 1.
    """

    def __init__(
        self, what: str, limb: int, distance: float, angle: float, expected: str = "closed loops"
    ) -> None:
        self.limb, self.distance, self.angle = limb, distance, angle
        super().__init__(what, (distance, angle), expected)
        RobomechError.__init__(
            self,
            f"{what} has open loops: limb {limb} ends {distance:.3g} m and {angle:.3g} rad from "
            f"where limb 1 holds the platform, expected {expected}",
        )


class SingularPostureError(BadValueError):
    """A posture in which the drives of a parallel robot do not hold it."""

    def __init__(self, what: str, value: object, expected: str) -> None:
        super().__init__(what, value, expected)
        RobomechError.__init__(self, f"{what} is singular, expected {expected}")


class WrongSizeError(RobomechError):
    """An array or list has the wrong shape or number of entries."""

    def __init__(self, what: str, got: object, expected: object) -> None:
        self.what = what
        self.got = got
        self.expected = expected
        noun = "shape" if isinstance(got, tuple) else "size"
        super().__init__(f"{what} has {noun} {got}, expected {expected}")


class NonFiniteError(RobomechError):
    """A number is NaN or infinite.

    Parameters
    ----------
    what : str
        Name of the quantity.
    value : array_like or object
        The quantity; of an array the message names the first entry at fault.
    """

    def __init__(self, what: str, value: object) -> None:
        self.what = what
        self.value = value
        self.index: tuple[int, ...] | None = None
        text = f"{what} is {shown(value)}"
        if isinstance(value, np.ndarray) and value.ndim and value.dtype.kind == "f":
            bad = np.argwhere(~np.isfinite(value))
            if len(bad):
                self.index = tuple(int(i) for i in bad[0])
                where = ", ".join(str(i) for i in self.index)
                text = f"{what}[{where}] is {float(value[self.index])!r}"
        super().__init__(f"{text}, expected finite numbers")


class BadQuaternionError(RobomechError):
    """A quaternion that stands for no rotation."""

    def __init__(self, value: object, reason: str) -> None:
        self.value = value
        self.reason = reason
        super().__init__(f"quaternion {shown(value)}: {reason}")


class MissingLimitsError(RobomechError):
    """Joints lack a limit that the request needs.

    Parameters
    ----------
    kind : str
        ``"position"``, ``"velocity"``, ``"acceleration"``, ``"jerk"`` or ``"effort"``.
    joints : iterable of str
        The joints without it.
    """

    def __init__(self, kind: str, joints: Iterable[str]) -> None:
        self.kind = kind
        self.joints = tuple(joints)
        noun = "joint" if len(self.joints) == 1 else "joints"
        super().__init__(f"no {kind} limit for {noun} {_listed(self.joints)}")


class MissingInertiaError(RobomechError):
    """Nothing is known of the mass of what some joints move.

    Parameters
    ----------
    links : iterable of str
        The links that the joints move.
    joints : iterable of str
        The joints.
    """

    def __init__(self, links: Iterable[str], joints: Iterable[str]) -> None:
        self.links = tuple(links)
        self.joints = tuple(joints)
        super().__init__(
            f"no mass and inertia of links {_listed(self.links)}, which joints "
            f"{_listed(self.joints)} move; give them in the robot's description"
        )


class RobotDescriptionError(RobomechError):
    """A robot's description is broken, hostile or of a kind that is not supported.

    Parameters
    ----------
    where : str
        The file, and the element in it, for example ``"arm.urdf: joint 'elbow'"``.
    why : str
        What is wrong with it and what is allowed.
    """

    def __init__(self, where: str, why: str) -> None:
        self.where = where
        self.why = why
        super().__init__(f"{where}: {why}")


def _of_unit(value: float, unit: str, digits: int = 9) -> str:
    """Show a number with its unit, if that is known."""
    return f"{value:.{digits}g} {unit}".rstrip()


class SeedOutsideLimitsError(RobomechError):
    """The seed or start of a joint lies outside the joint's limits.

    Parameters
    ----------
    joint : str
    value, lower, upper : float
        Its value and its limits, rad or m.
    what : str, optional
        What it is the value of.
    unit : str, optional
        ``"rad"`` or ``"m"``; empty where that is not known.
    """

    def __init__(
        self,
        joint: str,
        value: float,
        lower: float,
        upper: float,
        what: str = "seed",
        unit: str = "",
    ) -> None:
        self.what = what
        self.unit = unit
        self.joint = joint
        self.value = float(value)
        self.lower = float(lower)
        self.upper = float(upper)
        excess = max(self.lower - self.value, self.value - self.upper)
        super().__init__(
            f"{what} of joint '{joint}' is {_of_unit(self.value, unit)}, outside its limits "
            f"[{self.lower:.9g}, {self.upper:.9g}] by {_of_unit(excess, unit, 3)}"
        )


class LimitExceededError(RobomechError):
    """A joint's position, velocity, acceleration or jerk goes over its limit.

    Parameters
    ----------
    what : str
        The quantity.
    joint : str
    value, limit : float
        What it is, and what it may be (SI, rad or m).
    unit : str, optional
        Their unit, such as ``"rad/s"``; empty where it is not known.
    """

    def __init__(self, what: str, joint: str, value: float, limit: float, unit: str = "") -> None:
        self.what = what
        self.unit = unit
        self.joint = joint
        self.value = float(value)
        self.limit = float(limit)
        super().__init__(
            f"{what} of joint '{joint}' is {_of_unit(self.value, unit)}, over its limit "
            f"{_of_unit(self.limit, unit)} by {_of_unit(abs(self.value - self.limit), unit, 3)}"
        )


class DurationTooShortError(RobomechError):
    """A motion was asked for in less time than the limits of a joint allow.

    Parameters
    ----------
    duration : float
        The time asked for, in s.
    shortest : float
        The shortest possible time, in s.
    joint : str
        The joint that needs it.
    limit : str
        The limit of that joint that binds: ``"velocity"``, ``"acceleration"`` or ``"jerk"``, or
        several of them.
    """

    def __init__(self, duration: float, shortest: float, joint: str, limit: str) -> None:
        self.duration = float(duration)
        self.shortest = float(shortest)
        self.joint = joint
        self.limit = limit
        super().__init__(
            f"duration of {self.duration:.9g} s is too short: {self.shortest:.9g} s is the "
            f"shortest possible, because of the {limit} limit of joint '{joint}'"
        )


class MapFileError(RobomechError):
    """The file of a map is damaged, belongs to another map or robot, or cannot be written.

    Parameters
    ----------
    path : str
        The file.
    why : str
        What is wrong with it, and what would be right.
    """

    def __init__(self, path: str, why: str) -> None:
        self.path = path
        self.why = why
        super().__init__(f"{path}: {why}")


class NotEnoughMemoryError(RobomechError):
    """What was asked for does not fit into the memory of this machine.

    Parameters
    ----------
    what : str
        What was asked for.
    needed, available : int
        Bytes.
    """

    def __init__(self, what: str, needed: int, available: int) -> None:
        self.what = what
        self.needed = needed
        self.available = available
        super().__init__(
            f"{what} takes {_in_bytes(needed)} of memory, of which {_in_bytes(available)} "
            "are available"
        )


def _in_bytes(count: int) -> str:
    """Show a number of bytes; one that has more digits than tell anything as a power of ten."""
    return f"{count:,} bytes" if count < 10**18 else f"1e{len(str(count)) - 1} bytes"
