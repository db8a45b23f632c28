"""Reasons for rejecting a well-formed trajectory."""

from robomech_ros.errors import LimitExceededError, RobomechError, WrongSizeError

_TURN = 6.283185307179586


def start_mismatch(
    joint: str, start: float, present: float, apart: float, tolerance: float, unit: str
) -> str:
    """Say how far a joint is from where a trajectory starts, and how far it may be (rad or m).

    The distance is without whole turns of a continuous joint. The unit is empty where it is not
    known; with ``"rad"``, a distance of whole turns is called so.
    """
    of = f" {unit}" if unit else ""
    text = (
        f"the trajectory starts with joint '{joint}' at {start:.6g}{of}, but the joint is at "
        f"{present:.6g}{of}: {apart:.3g}{of} apart, allowed is {tolerance:.3g}{of}"
    )
    whole = round(apart / _TURN)
    if unit == "rad" and whole and abs(apart - whole * _TURN) <= tolerance:
        text += f" ({whole} whole turn(s), which this joint with its limits cannot skip)"
    return text


class TrajectoryRefusedError(RobomechError):
    """The trajectory is not executed, for a reason that lies outside its numbers."""


class TrajectoryOverError(TrajectoryRefusedError):
    """The trajectory should have ended by now: it began ``late`` ago and ``lasts`` so long (s)."""

    def __init__(self, late: float, lasts: float) -> None:
        self.late, self.lasts = float(late), float(lasts)
        super().__init__(
            f"the trajectory ended {self.late - self.lasts:.6g} s ago: its stamp is "
            f"{self.late:.6g} s old and it lasts {self.lasts:.6g} s"
        )


class JointMismatchError(WrongSizeError):
    """The joints of the trajectory are not those of the robot: some are missing or repeated."""


class StartMismatchError(TrajectoryRefusedError):
    """The first point, at time 0, is far from where the robot is (rad or m), by this joint most.

    The unit is empty where it is not known. Where a joint turns, a whole turn may be meant.
    """

    def __init__(
        self, joint: str, start: float, present: float, tolerance: float, unit: str = ""
    ) -> None:
        self.joint, self.unit, self.tolerance = joint, unit, float(tolerance)
        self.start, self.present = float(start), float(present)
        apart = abs(self.start - self.present)
        super().__init__(start_mismatch(joint, self.start, self.present, apart, tolerance, unit))


class AccelerationRefusedError(LimitExceededError):
    """The curve through the points accelerates a joint by many times its limit (rad/s^2 or m/s^2).

    ``said`` is what is wrong, with joint, time, value and limit; so many times the limit are
    allowed. The unit is empty where it is not known.
    """

    def __init__(
        self, said: str, joint: str, value: float, limit: float, allowed: float, unit: str = ""
    ) -> None:
        super().__init__("acceleration", joint, value, limit, unit)
        self.said = said
        self.allowed = float(allowed)
        text = f"{said}; at most {self.allowed:g} times is accepted (max_acceleration_ratio)"
        RobomechError.__init__(self, text)
