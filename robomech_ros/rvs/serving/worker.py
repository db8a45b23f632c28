"""One thread that does what pages ask for, of each kind of request only the latest."""

import logging
import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable

_LOG = logging.getLogger(__name__)


class Worker:
    """Does requests one after the other, in the order in which their kinds came.

    A request that waits is given up when a later one of its kind comes, so that whatever is dragged
    is never behind by more than the one that is under way.
    """

    def __init__(self) -> None:
        self._waiting: OrderedDict[Hashable, Callable[[], None]] = OrderedDict()
        self._change = threading.Condition()
        self._closing = False
        self._thread = threading.Thread(target=self._work, name="view", daemon=True)
        self._thread.start()

    def submit(self, kind: Hashable, request: Callable[[], None]) -> None:
        """Ask for something to be done, instead of what waits of this kind."""
        with self._change:
            self._waiting.pop(kind, None)
            self._waiting[kind] = request
            self._change.notify_all()

    def close(self, *, wait: bool = True) -> None:
        """Drop waiting jobs and end after the running one; wait for it or not."""
        with self._change:
            self._closing = True
            self._waiting.clear()
            self._change.notify_all()
        if wait and threading.current_thread() is not self._thread:
            self._thread.join()

    def _work(self) -> None:
        while True:
            with self._change:
                self._change.wait_for(lambda: self._waiting or self._closing)
                if self._closing:
                    return
                _, request = self._waiting.popitem(last=False)
            try:
                request()
            except Exception:
                # The page goes on; the log says why.
                _LOG.exception("a request of the page failed")
