"""Errors of motions that the limits of joints do not allow."""

from robomech_ros.errors.formatting import of_unit
from robomech_ros.errors.values import RobomechError


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
            f"{what} of joint '{joint}' is {of_unit(self.value, unit)}, outside its limits "
            f"[{self.lower:.9g}, {self.upper:.9g}] by {of_unit(excess, unit, 3)}"
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
            f"{what} of joint '{joint}' is {of_unit(self.value, unit)}, over its limit "
            f"{of_unit(self.limit, unit)} by {of_unit(abs(self.value - self.limit), unit, 3)}"
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
