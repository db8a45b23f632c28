"""Past or required end of a motion."""

from typing import NamedTuple


class MotionResult(NamedTuple):
    """Result of a finished motion: one of `Code`, and the reason with joint and amount.

    The code is 0 if the robot is where the trajectory ends, the text empty if there is nothing to
    say.
    """

    code: int
    text: str
