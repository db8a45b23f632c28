"""Why a trajectory that is well formed is not executed."""

from robomech_ros.errors import RobomechError, WrongSizeError

__all__ = [
    "JointMismatchError",
    "StartMismatchError",
    "TrajectoryOverError",
    "TrajectoryRefusedError",
]

_TURN = 6.283185307179586


class TrajectoryRefusedError(RobomechError):
    """The trajectory is not executed, for a reason that lies outside its numbers."""


class TrajectoryOverError(TrajectoryRefusedError):
    """The trajectory should have ended by now.

    Parameters
    ----------
    late : float
        How long ago it should have begun, s.
    lasts : float
        How long it lasts, s.
    """

    def __init__(self, late: float, lasts: float) -> None:
        self.late = float(late)
        self.lasts = float(lasts)
        super().__init__(
            f"the trajectory ended {self.late - self.lasts:.6g} s ago: its stamp is "
            f"{self.late:.6g} s old and it lasts {self.lasts:.6g} s"
        )

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.late, self.lasts)


class JointMismatchError(WrongSizeError):
    """The joints of the trajectory are not those of the robot: some are missing or repeated."""


class StartMismatchError(TrajectoryRefusedError):
    """The first point, at time 0, is far from where the robot is.

    Parameters
    ----------
    joint : str
        The joint that is farthest off.
    start, present : float
        Where the trajectory begins and where the joint is, rad or m.
    tolerance : float
        How far they may be apart, rad or m.
    turns : bool
        Whether the joint is a revolute one, for which a whole turn may be meant.
    """

    def __init__(
        self, joint: str, start: float, present: float, tolerance: float, turns: bool = False
    ) -> None:
        self.joint = joint
        self.start = float(start)
        self.present = float(present)
        self.tolerance = float(tolerance)
        self.turns = turns
        off = self.start - self.present
        text = (
            f"the trajectory starts with joint '{joint}' at {self.start:.6g}, but the joint is at "
            f"{self.present:.6g}: {abs(off):.3g} apart, allowed is {self.tolerance:.3g}"
        )
        whole = round(off / _TURN)
        if turns and whole and abs(off - whole * _TURN) <= self.tolerance:
            text += f" ({abs(whole)} whole turn(s), which this joint with its limits cannot skip)"
        super().__init__(text)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.joint, self.start, self.present, self.tolerance, self.turns)
