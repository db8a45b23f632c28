"""How a solution of inverse kinematics ended."""

from enum import IntEnum

__all__ = ["Status"]


class Status(IntEnum):
    """Outcome of the mathematics; the numbers are those of ``robomech_interfaces/ErrorCode``."""

    SUCCESS = 0
    OUT_OF_REACH = 201
    ORIENTATION_UNREACHABLE = 202
    LIMITS_EXCLUDE_ALL = 203
    NOT_CONVERGED = 204
    TIMED_OUT = 205
    SINGULAR_CONTINUUM = 206
