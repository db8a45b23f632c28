"""Jogging by buttons that are held: which way, and when it has to end."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable
from dataclasses import dataclass

from robomech_ros.errors import BadValueError

__all__ = ["AXES", "JogDirection", "JogSwitch", "read_hold"]

AXES = "xyz"
_HOLD = re.compile(r"(joint|linear|angular) ([0-9]{1,3}) ([+-]) ([0-9]{1,16}) [0-9]{1,9}")


@dataclass(frozen=True)
class JogDirection:
    """One way to jog.

    Parameters
    ----------
    kind : {"joint", "linear", "angular"}
        A joint, or the tip along or about an axis.
    index : int
        Of the joint, or of the axis, from 0.
    sign : int
        1 or -1.
    """

    kind: str
    index: int
    sign: int


def read_hold(text: str, joints: int) -> tuple[JogDirection, int]:
    """Read what a page says while a button is held.

    Parameters
    ----------
    text : str
        Direction, number of the press and count of the beat: ``"joint 2 + 1712 5"``.
    joints : int
        How many there are.

    Returns
    -------
    direction : JogDirection
    press : int
        The same as long as the button is held.

    Raises
    ------
    BadValueError
        It is something else, or there is no such joint or axis.
    """
    found = _HOLD.fullmatch(text)
    if found is None:
        expected = "'joint', 'linear' or 'angular', a number, + or -, and two counts"
        raise BadValueError("jog", text[:80], expected)
    kind, index = found[1], int(found[2])
    count = joints if kind == "joint" else len(AXES)
    if index >= count:
        raise BadValueError(f"number of the {kind} jog", index, f"0 to {count - 1}")
    return JogDirection(kind, index, 1 if found[3] == "+" else -1), int(found[4])


class JogSwitch:
    """A switch that is on only while somebody keeps saying so; for several threads.

    A press that has ended, for whatever reason, stays ended.

    Parameters
    ----------
    silence : float
        After so long (s) without a word it is off.
    clock : callable
        Gives the time (s).
    """

    def __init__(self, silence: float, clock: Callable[[], float]) -> None:
        self._silence, self._clock = silence, clock
        self._change = threading.Condition()
        self._direction: JogDirection | None = None
        self._press = self._ended = -1
        self._heard = 0.0
        self._closed = False

    def hold(self, direction: JogDirection, press: int) -> None:
        """Go on with a press, or begin one."""
        with self._change:
            self._end_if_silent()
            if press == self._ended:
                return
            if press != self._press:
                self._ended = self._press
            self._direction, self._press, self._heard = direction, press, self._clock()
            self._change.notify_all()

    def release(self) -> None:
        """End the press."""
        with self._change:
            self._end()

    def held(self) -> JogDirection | None:
        """Give the direction that is held now; None if there is none."""
        with self._change:
            self._end_if_silent()
            return self._direction

    def wait(self) -> bool:
        """Wait for a press; False once the switch is closed."""
        with self._change:
            self._change.wait_for(lambda: self._direction is not None or self._closed)
            return not self._closed

    def close(self) -> None:
        """End the press, and the waiting for others."""
        with self._change:
            self._closed = True
            self._end()
            self._change.notify_all()

    def _end_if_silent(self) -> None:
        if self._direction is not None and self._clock() - self._heard > self._silence:
            self._end()

    def _end(self) -> None:
        if self._direction is not None:
            self._direction, self._ended = None, self._press
