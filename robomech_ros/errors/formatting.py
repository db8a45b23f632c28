"""Text of outside values, lists, counts, quantities and sizes in error messages."""

import re
from collections.abc import Sequence

LONGEST_VALUE = 200
# In the representation of objects that have none of their own, functions included.
_ADDRESS = re.compile(r" (?:object )?at 0x[0-9A-Fa-f]+(?=>)")
LONGEST_LIST = 40


def format_value(value: object) -> str:
    """Show a value from outside: its representation, shortened, without addresses in memory.

    Parameters
    ----------
    value : object
        Value of any size.

    Returns
    -------
    str
        Up to 200 characters of it, and how many there are where there are more.

    Examples
    --------
    >>> from robomech_ros.errors import format_value
    >>> format_value("elbow" * 1000)[-30:]
    'elbowelbo... (5002 characters)'
    """
    if getattr(value, "shape", None) == () and hasattr(value, "item"):
        value = value.item()  # NumPy shows the types of its numbers, too
    text = _ADDRESS.sub("", repr(value))
    if len(text) > LONGEST_VALUE:
        text = f"{text[:LONGEST_VALUE]}... ({len(text)} characters)"
    return text


def listed(names: Sequence[str], most: int = LONGEST_LIST) -> str:
    """List names, so many at most."""
    if not names:
        return "none"
    text = ", ".join(format_value(name)[1:-1] for name in names[:most])
    if len(names) > most:
        text += f", and {len(names) - most} more"
    return text


def counted(count: int, noun: str) -> str:
    """Show a count with its noun, such as "1 leg" and "2 legs"."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def of_unit(value: float, unit: str, digits: int = 9) -> str:
    """Show a number with its unit, if that is known."""
    return f"{value:.{digits}g} {unit}".rstrip()


def in_bytes(count: int) -> str:
    """Show a number of bytes; one that has more digits than tell anything as a power of ten."""
    return f"{count:,} bytes" if count < 10**18 else f"1e{len(str(count)) - 1} bytes"
