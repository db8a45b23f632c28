"""A thread that calls a function periodically while it is switched on."""

import threading
from collections.abc import Callable


class Ticker:
    """Calls ``tick`` after every ``period`` (s) for as long as it is on."""

    def __init__(self, name: str, period: float, tick: Callable[[], None]) -> None:
        self._period, self._tick = period, tick
        self._on, self._closing = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    @property
    def is_on(self) -> bool:
        """True if it ticks."""
        return self._on.is_set()

    @property
    def is_closed(self) -> bool:
        """True if it never ticks again."""
        return self._closing.is_set()

    def start(self) -> None:
        """Begin to tick, one period from now."""
        self._on.set()

    def stop(self) -> None:
        """Tick no more, until it is started again."""
        self._on.clear()

    def close(self) -> None:
        """End the thread."""
        self._closing.set()
        self._on.set()
        if self._thread is not threading.current_thread():
            self._thread.join()

    def _run(self) -> None:
        while True:
            self._on.wait()
            if self._closing.wait(self._period):
                return
            self._tick()
