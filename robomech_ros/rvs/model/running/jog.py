"""Jogging by pressed buttons: directions, and the end of a press.

What stops the robot:

- The page says that the button is let go, or that the page is hidden or left; somebody clicks Stop;
  another browser takes command; the connection is closed.  The press ends at once.
- The page says nothing for ``silence``.  The press ends that long after its last word.
- What the page says comes later and later, as where messages queue up.  Every word tells how old
  its press is by the clock of the page, so the server knows how much longer a word took than the
  fastest one of this press; the two clocks need not agree.  The press ends with the first word that
  took longer by ``silence``.

So whatever becomes of the connection, the press has ended at most twice ``silence`` after the
button was let go: the last word came up to one ``silence`` late, and counts for another.  What the
first word took cannot be seen, and comes on top: the motion began as much later.

The thread that commands the servo looks every 0.02 s whether the press has ended, and commands to
stand.  If it cannot, since the process hangs or is gone, the servo brakes after its
``command_timeout`` (0.1 s); if the servo is gone, the controller follows the plan to stop in the
servo's last message.
"""

import re
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

from robomech_ros.errors import BadValueError

AXES = "xyz"
Command = TypeVar("Command")
_HOLD = re.compile(r"(joint|linear|angular) ([0-9]{1,3}) ([+-]) ([0-9]{1,16}) ([0-9]{1,9})")


@dataclass(frozen=True)
class JogDirection:
    """A joint, or an axis of the tip, and the sign of its motion."""

    #: One of "joint", "linear" (the tip along an axis), "angular" (the tip about an axis).
    kind: str
    #: Index of the joint, or of the axis, from 0.
    index: int
    #: Sign of the motion, 1 or -1.
    sign: int


class HoldHeartbeat(NamedTuple):
    """Message that a page repeats while a button is pressed."""

    direction: JogDirection
    #: Number of the press, the same for as long as the button is held.
    press: int
    #: Age of the press (s) when the page sent the message.
    age: float


def read_beat(text: str, joints: int) -> HoldHeartbeat:
    """Read the message of a page while a button is pressed.

    - ``text``: direction, number of the press and its age (ms): ``"joint 2 + 1712 500"``.
    - ``joints``: number of joints.
    """
    found = _HOLD.fullmatch(text)
    if found is None:
        expected = "'joint', 'linear' or 'angular', a number, + or -, and two counts"
        raise BadValueError("jog", text[:80], expected)
    kind, index = found[1], int(found[2])
    count = joints if kind == "joint" else len(AXES)
    if index >= count:
        raise BadValueError(f"number of the {kind} jog", index, f"0 to {count - 1}")
    direction = JogDirection(kind, index, 1 if found[3] == "+" else -1)
    return HoldHeartbeat(direction, int(found[4]), 1e-3 * int(found[5]))


class JogSwitch(Generic[Command]):
    """A switch that is on only while messages repeat that; for several threads.

    A press that has ended, for whatever reason, stays ended; see above for the reasons.

    - ``silence``: longest time without a message (s), and largest delay of a message against the
      fastest one of the press (s); beyond either, the switch is off.
    - ``clock``: returns the time (s).
    """

    def __init__(self, silence: float, clock: Callable[[], float]) -> None:
        self._silence, self._clock = silence, clock
        self._change = threading.Condition()
        self._what: Command | None = None
        self._press = self._ended = -1
        # Times of the last message, and of the start of the press by the fastest message.
        self._last_beat = self._begun = 0.0
        self._closed = False

    def hold(self, what: Command, press: int, age: float) -> None:
        """Continue a press, or begin one.

        - ``what``: the held command.
        - ``press``: number of the press.
        - ``age``: its age (s) when the message was sent.
        """
        with self._change:
            self._end_if_silent()
            if press == self._ended:
                return
            now = self._clock()
            if press != self._press:
                self._ended, self._begun = self._press, now - age
            self._begun = min(self._begun, now - age)
            self._what, self._press, self._last_beat = what, press, now
            if now - age - self._begun > self._silence:
                self._end()
            self._change.notify_all()

    def release(self) -> None:
        """End the press."""
        with self._change:
            self._end()

    def held(self) -> Command | None:
        """Return the present command; None without a press."""
        with self._change:
            self._end_if_silent()
            return self._what

    def wait(self) -> bool:
        """Wait for a press; False once the switch is closed."""
        with self._change:
            self._change.wait_for(lambda: self._what is not None or self._closed)
            return not self._closed

    def close(self) -> None:
        """End the press, and all waiting."""
        with self._change:
            self._closed = True
            self._end()
            self._change.notify_all()

    def _end_if_silent(self) -> None:
        if self._what is not None and self._clock() - self._last_beat > self._silence:
            self._end()

    def _end(self) -> None:
        if self._what is not None:
            self._what, self._ended = None, self._press
