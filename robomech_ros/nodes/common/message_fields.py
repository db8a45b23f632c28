"""Lists of numbers, times and durations as the fields of messages take them."""

from array import array
from typing import Any

from builtin_interfaces.msg import Duration
from numpy.typing import NDArray
from std_msgs.msg import Header

from robomech_ros.errors import BadValueError
from robomech_ros.typing import Array

# Nanoseconds of a second.
NANO = 1_000_000_000


def floats(values: Array) -> "array[float]":
    """Copy an array into what the messages' float64[] fields take without conversion."""
    result = array("d")
    result.frombytes(values.tobytes())
    return result


def append_numbers(target: "array[Any]", values: NDArray[Any]) -> None:
    """Append the entries of an array, in its own order, to one of Python's arrays."""
    target.frombytes(values.astype(target.typecode).tobytes())


def seconds_from_duration(duration: Duration, what: str) -> float:
    """Convert a duration message to s.

    Raises
    ------
    BadValueError
        It is negative.
    """
    seconds = float(duration.sec + duration.nanosec / NANO)
    if seconds < 0.0:
        raise BadValueError(what, seconds, "a duration that is not negative (s)")
    return seconds


def fill_header(header: Header, frame: str, stamp: int) -> None:
    """Write a frame and a ROS time (ns) to a header."""
    header.frame_id = frame
    header.stamp.sec, header.stamp.nanosec = divmod(stamp, NANO)


def duration_from_seconds(seconds: float) -> Duration:
    """Convert s to a duration message, rounded to nanoseconds."""
    whole, nano = divmod(round(seconds * NANO), NANO)
    return Duration(sec=int(whole), nanosec=int(nano))
