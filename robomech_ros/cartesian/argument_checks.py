"""Checks of what functions of Cartesian motions are given."""

from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import real_number


def above_zero(what: str, value: object) -> float:
    """Check a number above 0, which may be infinite."""
    number = real_number(what, value, "a number above 0")
    if not number > 0.0:
        raise BadValueError(what, number, "a number above 0")
    return number


def whole_number(what: str, value: object, least: int) -> int:
    """Check a whole number that is not below the least."""
    expected = f"a whole number of at least {least}"
    number = real_number(what, value, expected)
    if not (number >= least and number.is_integer()):
        raise BadValueError(what, value, expected)
    return int(number)
