"""The errors that a wrong request raises; one class for each cause a caller can act on.

An outcome of the mathematics (out of reach, singular) is never an error: it is a status in a
result.  Every message gives the value, what was expected and, where there is one, the list of
what is available; the same facts are attributes of the exception.
"""

from robomech_ros.errors.formatting import format_value
from robomech_ros.errors.limits import (
    DurationTooShortError,
    LimitExceededError,
    SeedOutsideLimitsError,
)
from robomech_ros.errors.machine import MapFileError, NotEnoughMemoryError
from robomech_ros.errors.names import UnknownJointError, UnknownLinkError, UnknownRobotError
from robomech_ros.errors.robots import (
    LoopClosureError,
    MissingInertiaError,
    MissingLimitsError,
    MissingSupportError,
    RobotDescriptionError,
    SingularPostureError,
)
from robomech_ros.errors.values import (
    BadQuaternionError,
    BadValueError,
    InconsistentDataError,
    NonFiniteError,
    RobomechError,
    UnderdeterminedError,
    WrongSizeError,
)

__all__ = [
    "BadQuaternionError",
    "BadValueError",
    "DurationTooShortError",
    "InconsistentDataError",
    "LimitExceededError",
    "LoopClosureError",
    "MapFileError",
    "MissingInertiaError",
    "MissingLimitsError",
    "MissingSupportError",
    "NonFiniteError",
    "NotEnoughMemoryError",
    "RobomechError",
    "RobotDescriptionError",
    "SeedOutsideLimitsError",
    "SingularPostureError",
    "UnderdeterminedError",
    "UnknownJointError",
    "UnknownLinkError",
    "UnknownRobotError",
    "WrongSizeError",
    "format_value",
]
