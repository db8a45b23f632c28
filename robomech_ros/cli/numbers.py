"""Numbers on the command line, as types for argparse: digits of other scripts are none."""

from robomech_ros.robots.documents.numbers_in_text import integer_in_text, number_in_text

__all__ = ["integer", "number"]


def number(text: str) -> float:
    """Read a number; argparse names this function where a word is none."""
    return number_in_text(text)


def integer(text: str) -> int:
    """Read an integer; argparse names this function where a word is none."""
    return integer_in_text(text)
