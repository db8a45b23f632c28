"""Has a robot go on in periods, on the thread of the page, as long as it moves."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from robomech_ros.rvs.page.layer import LayerContext

# How often it is drawn while it moves (s), and what is made up for at most (s).
TICK, MOST = 0.05, 0.4


class Stepping:
    """Asks for steps from a thread of its own.

    Parameters
    ----------
    place : LayerContext
    period : float
        Of the robot (s).
    go_on : callable
        Makes so many periods, and says whether the robot still moves; called in requests.
    moved_joint : callable
        Gives the number of the slider that is not set back meanwhile, or None.
    """

    def __init__(
        self,
        place: LayerContext,
        period: float,
        go_on: Callable[[int], bool],
        moved_joint: Callable[[], int | None],
    ) -> None:
        self._place, self._period = place, period
        self._go_on, self._moved_joint = go_on, moved_joint
        self._moves, self._closing = threading.Event(), threading.Event()
        self._stepped = 0.0
        self._thread = threading.Thread(target=self._run, name="steps", daemon=True)
        self._thread.start()

    @property
    def moves(self) -> bool:
        """Whether steps are asked for."""
        return self._moves.is_set()

    def begin(self) -> None:
        """Go on from now, unless it does already; in requests alone."""
        if not self.moves:
            self._stepped = time.monotonic()
            self._moves.set()

    def close(self) -> None:
        """End the thread."""
        self._closing.set()
        self._moves.set()
        self._thread.join()

    def _run(self) -> None:
        while True:
            self._moves.wait()
            if self._closing.wait(TICK):
                return
            self._place.ask((self, "step"), self._step, self._moved_joint())

    def _step(self) -> None:
        now = time.monotonic()
        steps, most = int((now - self._stepped) / self._period), int(MOST / self._period)
        # What was missed for long is not made up for.
        self._stepped = now if steps > most else self._stepped + steps * self._period
        if not self._go_on(min(steps, most)):
            self._moves.clear()
