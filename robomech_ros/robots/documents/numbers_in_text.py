"""Numbers in texts from outside, such as attributes of XML and words of a command line."""

import math


def number(text: str) -> float:
    """Read a number in ASCII, since Python also reads digits of other scripts, and underscores.

    Raises
    ------
    ValueError
        The text is no number.
    """
    return float(_plain(text))


def integer(text: str) -> int:
    """Read an integer as :func:`number` reads a number.

    Raises
    ------
    ValueError
        The text is none.
    """
    return int(_plain(text))


def _plain(text: str) -> str:
    if not text.isascii() or "_" in text:
        raise ValueError(f"'{text[:80]}' is no number")
    return text


def finite_number(text: str) -> float:
    """Read a finite number; raises ValueError if the text is not one."""
    value = number(text)
    if not math.isfinite(value):
        raise ValueError(f"'{text[:80]}' is not finite")
    return value
