"""The work of a computation, counted: how fast the machine is plays no part in it."""

import sys
from pathlib import Path

import robomech_ros

_OURS = str(Path(robomech_ros.__file__).parent)


def lines_executed(function, *arguments, also=()):
    """Count the lines of Python that a call executes in the package; compiled code counts nothing.

    Lines of the files whose paths begin with one of `also` count as well.
    """
    counted, places = 0, (_OURS, *also)

    def count(frame, event, _):
        nonlocal counted
        if event == "call":
            return count if frame.f_code.co_filename.startswith(places) else None
        counted += event == "line"
        return count

    before = sys.gettrace()
    sys.settrace(count)
    try:
        function(*arguments)
    finally:
        sys.settrace(before)
    return counted
