"""Conversion of numbers, times and durations to fields of messages."""

import math
from array import array
from typing import Any

from builtin_interfaces.msg import Duration
from numpy.typing import NDArray
from std_msgs.msg import Header

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.typing import Array

# Nanoseconds of a second.
NANO = 1_000_000_000


def floats(values: Array) -> "array[float]":
    """Copy an array for a float64[] field, which takes it without conversion."""
    return array("d", values.tobytes())


def append_numbers(target: "array[Any]", values: NDArray[Any]) -> None:
    """Append the entries of an array, in its memory order, to a Python array."""
    target.frombytes(values.astype(target.typecode).tobytes())


def finite_number(what: str, value: float) -> float:
    """Return a finite number of a request, or raise NonFiniteError."""
    if not math.isfinite(value):
        raise NonFiniteError(what, value)
    return float(value)


def not_negative(what: str, value: float, expected: str) -> float:
    """Return a number of a request, which must be finite and not negative."""
    if finite_number(what, value) < 0.0:
        raise BadValueError(what, value, expected)
    return float(value)


def check_waypoints(what: str, count: int, most: int) -> None:
    """Reject too many waypoints to plan in some seconds."""
    if count > most:
        raise WrongSizeError(what, count, f"at most {most}, the parameter max_waypoints")


def seconds_from_duration(duration: Duration, what: str) -> float:
    """Convert a duration message, which must not be negative, to s."""
    seconds = duration.sec + duration.nanosec / NANO
    return not_negative(what, seconds, "a duration that is not negative (s)")


def fill_header(header: Header, frame: str, stamp: int) -> None:
    """Write a frame and a ROS time (ns) to a header."""
    header.frame_id = frame
    header.stamp.sec, header.stamp.nanosec = divmod(stamp, NANO)


def duration_from_seconds(seconds: float, message: Duration | None = None) -> Duration:
    """Convert s to a duration message, rounded to nanoseconds; a given one is filled sooner."""
    duration = Duration() if message is None else message
    duration.sec, duration.nanosec = map(int, divmod(round(seconds * NANO), NANO))
    return duration
