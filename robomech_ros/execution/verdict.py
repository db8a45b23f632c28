"""How a motion has ended or must end."""

from typing import NamedTuple


class Verdict(NamedTuple):
    """What is to be said of a motion that is over.

    Attributes
    ----------
    code : int
        One of `Code`; 0 if the robot is where the trajectory ends.
    text : str
        The reason, with joint and amount; empty if there is nothing to say.
    """

    code: int
    text: str
