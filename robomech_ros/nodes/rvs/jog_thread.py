"""A thread that commands while a page holds a button, and to stand when it does not any more."""

import threading
import time
from collections.abc import Callable
from typing import Any, Generic, TypeVar

from robomech_ros.rvs.model.jog import HoldHeartbeat, JogSwitch

Held = TypeVar("Held")


class JogThread(Generic[Held]):
    """Sends commands from a thread of its own, which nothing else delays.

    What ends a press, and in how much time, is in :mod:`robomech_ros.rvs.model.jog`.

    Parameters
    ----------
    silence : float
        After so long (s) without a word of the page nothing is held.
    period : float
        How often it commands (s).
    send : callable
        Sends the command for what is held, and whether to move; or to stand.
    missing : callable
        Says why that cannot be followed now; empty for nothing.
    complain : callable
        Told why a jog ends that is held, or does not begin; an empty text when one begins.
    logger : rclpy.impl.rcutils_logger.RcutilsLogger
    """

    def __init__(
        self,
        silence: float,
        period: float,
        send: Callable[[Held, bool], None],
        missing: Callable[[Held], str],
        complain: Callable[[str], None],
        logger: Any,
    ) -> None:
        self._period, self._send, self._missing = period, send, missing
        self._complain, self._logger = complain, logger
        self._switch = JogSwitch[Held](silence, time.monotonic)
        self._thread = threading.Thread(target=self._run, name="jog", daemon=True)
        self._thread.start()

    def hold(self, what: Held, beat: HoldHeartbeat) -> None:
        """Go on with a press, or begin one."""
        self._switch.hold(what, beat.press, beat.age)

    def let_go(self) -> None:
        """End the press."""
        self._switch.release()

    @property
    def held(self) -> bool:
        """Whether a button is held."""
        return self._switch.held() is not None

    def close(self) -> None:
        """End what is held, and the thread."""
        self._switch.close()
        self._thread.join()

    def _run(self) -> None:
        while self._switch.wait():
            try:
                self._jog()
            except Exception as error:
                # Who follows brakes without commands, and the next press is tried again.
                self._switch.release()
                self._logger.error(f"a jog failed: {error!r}")
                self._complain(f"The jog failed: {error}")

    def _jog(self) -> None:
        """Command what is held, and then to stand."""
        last: Held | None = None
        while (jog := self._switch.held()) is not None:
            missing = self._missing(jog)
            if missing or last is None:
                self._complain(missing)
            if missing:
                self._switch.release()
                break
            self._send(jog, True)
            last = jog
            time.sleep(self._period)
        if last is not None:
            self._send(last, False)
