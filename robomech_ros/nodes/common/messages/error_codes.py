"""Error codes of exceptions."""

from collections.abc import Iterable, Sequence
from typing import Any

from robomech_ros import errors
from robomech_ros.collision.libraries import MissingLibraryError
from robomech_ros.errors import RobomechError
from robomech_ros.execution.rejections import TrajectoryRefusedError
from robomech_ros.hands.conic_solver import ConicSolverUnavailableError
from robomech_ros.outcomes import Code


def shortened(names: Sequence[str], most: int) -> str:
    """List the first names and the number of the others."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


class FrameUnavailableError(RobomechError):
    """A frame without a known transform to the base of the chain."""

    def __init__(self, frame: str, known: Iterable[str], why: str) -> None:
        names = shortened(list(known), 30)
        super().__init__(f"frame {frame[:200]!r}: {why}; known frames: {names}")


class NoStateError(RobomechError):
    """The present state of the joints is required but unknown."""

    def __init__(self, joints: Iterable[str], topic: str, why: str = "nothing received") -> None:
        listed = ", ".join(joints)
        super().__init__(f"no present state of joint(s) {listed}: {why} on '{topic}'")


class RobotMovesError(NoStateError):
    """A joint moves, but the request needs the robot at rest.

    - ``speed``, ``tolerance``: speed of the joint, and the largest that counts as rest (rad/s or
      m/s).
    - ``unit``: ``"rad"`` or ``"m"``; empty where it is not known.
    """

    def __init__(self, joint: str, speed: float, tolerance: float, unit: str = "") -> None:
        per = f" {unit}/s" if unit else " per s"
        RobomechError.__init__(
            self,
            f"the robot moves: joint '{joint}' at {speed:.3g}{per}, at rest is up to "
            f"{tolerance:g}{per}; ask again when it stands, or name a start",
        )


class OutcomeError(RobomechError):
    """The requested result does not exist: an outcome of the mathematics, with its code.

    - ``code``: code of the answer.
    - ``text``: the reason.
    """

    def __init__(self, code: Code, text: str) -> None:
        self.code = code
        super().__init__(text)


# Searched along the bases of the error's class, so that a subclass finds its parent's code.
_CODES: dict[type[BaseException], Code] = {
    errors.UnknownLinkError: Code.UNKNOWN_LINK,
    errors.UnknownJointError: Code.UNKNOWN_JOINT,
    errors.BadQuaternionError: Code.BAD_QUATERNION,
    errors.NonFiniteError: Code.NON_FINITE,
    FrameUnavailableError: Code.FRAME_UNAVAILABLE,
    errors.SeedOutsideLimitsError: Code.SEED_OUTSIDE_LIMITS,
    NoStateError: Code.NO_STATE,
    errors.WrongSizeError: Code.WRONG_SIZE,
    errors.MissingLimitsError: Code.MISSING_LIMITS,
    errors.MissingInertiaError: Code.MISSING_INERTIA,
    errors.UnderdeterminedError: Code.UNDETERMINED,
    errors.InconsistentDataError: Code.CONTRADICTORY,
    errors.SingularPostureError: Code.SINGULAR,
    errors.LimitExceededError: Code.LIMIT,
    errors.DurationTooShortError: Code.LIMIT,
    TrajectoryRefusedError: Code.REJECTED,
    ConicSolverUnavailableError: Code.NOT_INSTALLED,
    MissingLibraryError: Code.NOT_INSTALLED,
    RobomechError: Code.BAD_VALUE,
}


def code_of(error: BaseException) -> Code:
    """Return the code of an exception; INTERNAL for one that is no RobomechError."""
    if isinstance(error, OutcomeError):
        return error.code
    for kind in type(error).__mro__:
        if kind in _CODES:
            return _CODES[kind]
    return Code.INTERNAL


def answer(response: Any, code: int = 0, text: str = "") -> Any:
    """Fill the last two fields of a response and return it."""
    response.error_code = int(code)
    response.error_msg = text
    return response
