"""Outcome of a solution of inverse kinematics."""

from enum import IntEnum

from robomech_ros.outcomes import Code


class Status(IntEnum):
    """Outcome of the mathematics; numbers, and all names but two, are those of all outcomes."""

    SUCCESS = Code.NONE
    OUT_OF_REACH = Code.OUT_OF_REACH
    ORIENTATION_UNREACHABLE = Code.ORIENTATION_UNREACHABLE
    LIMITS_EXCLUDE_ALL = Code.LIMITS_EXCLUDE_ALL
    NOT_CONVERGED = Code.NOT_CONVERGED
    TIMED_OUT = Code.TIMED_OUT
    SINGULAR_CONTINUUM = Code.SINGULAR_CONTINUUM
    IN_COLLISION = Code.COLLISION
