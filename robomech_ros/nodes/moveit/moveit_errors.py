"""Request errors in MoveIt's error codes."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from moveit_msgs.msg import MoveItErrorCodes

from robomech_ros.errors import RobomechError, UnknownLinkError
from robomech_ros.kinematics.inverse.status import Status
from robomech_ros.nodes.common.error_codes import (
    FrameUnavailableError,
    NoStateError,
    RobotMovesError,
)

# What these mean does not depend on the part of the request that they are found in.
_CODES = (
    (FrameUnavailableError, MoveItErrorCodes.FRAME_TRANSFORM_FAILURE),
    (RobotMovesError, MoveItErrorCodes.START_STATE_INVALID),
    (NoStateError, MoveItErrorCodes.ROBOT_STATE_STALE),
    (UnknownLinkError, MoveItErrorCodes.INVALID_LINK_NAME),
)


class RejectedError(RobomechError):
    """A request cannot be served; `code` is one of MoveItErrorCodes."""

    def __init__(self, code: int, reason: str) -> None:
        self.code = code
        self.reason = reason
        super().__init__(reason)


@contextmanager
def refused_as(code: int) -> Iterator[None]:
    """Turn what is found wrong with a part of a request into a refusal with this code.

    A frame, a present state or a link that is not known keeps the code of its own.
    """
    try:
        yield
    except RejectedError:
        raise
    except RobomechError as error:
        own = next((own for kind, own in _CODES if isinstance(error, kind)), code)
        raise RejectedError(own, str(error)) from error


def code_of_outcome(status: Status) -> int:
    """Return the code of inverse kinematics that found nothing."""
    if status == Status.TIMED_OUT:
        return int(MoveItErrorCodes.TIMED_OUT)
    return int(MoveItErrorCodes.NO_IK_SOLUTION)


def fill_code(message: Any, code: int, text: str, source: str) -> None:
    """Fill a MoveItErrorCodes message, and its texts in the versions that have them."""
    message.val = int(code)
    if hasattr(message, "message"):
        message.message, message.source = text, source
