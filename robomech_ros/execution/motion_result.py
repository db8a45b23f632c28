"""How a motion has ended or must end."""

from typing import NamedTuple


class MotionResult(NamedTuple):
    """Result of a finished motion, to be reported.

    Attributes
    ----------
    code : int
        One of `Code`; 0 if the robot is where the trajectory ends.
    text : str
        The reason, with joint and amount; empty if there is nothing to say.
    """

    code: int
    text: str
