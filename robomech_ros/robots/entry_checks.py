"""Checks of names, of whole numbers, and of lists with one entry for each joint."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.spatial.arrays import listed


def bare_link(name: str) -> str:
    """Return the name of a link or frame without the leading slash that tf once had."""
    return name.removeprefix("/")


def check_name(what: str, name: object) -> None:
    """Refuse a name that is no text, or empty; ``what`` says in the message whose it is."""
    if not isinstance(name, str) or not name:
        raise BadValueError(what, name, "a name, as text")


def checked_entries(what: str, entries: object, kind: Any, n: int) -> tuple[Any, ...]:
    """Return the entries of a list that is empty or has one of a kind for each of n joints."""
    expected = f"a list of {n}, of type {getattr(kind, '__name__', kind)}"
    given = listed(what, entries, expected)
    for entry in given:
        if not isinstance(entry, kind):
            raise BadValueError(f"one of {what}", entry, expected)
    if given and len(given) != n:
        raise WrongSizeError(what, len(given), n)
    return given


def check_names(what: str, names: Sequence[str]) -> None:
    """Refuse names that are no texts, empty or not all different."""
    for name in listed(what, names, "a list of names"):
        check_name(f"one of {what}", name)
    if len(set(names)) < len(names):
        raise BadValueError(what, names, "different names")


def whole_number(what: str, value: object, least: int, most: float, expected: str) -> int:
    """Return a whole number between two bounds; ``expected`` says in the message what they are."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise BadValueError(what, value, expected)
    if not least <= value <= most:
        raise BadValueError(what, value, expected)
    return int(value)
