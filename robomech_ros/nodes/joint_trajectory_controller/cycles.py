"""The regular cycle of the controller."""

import threading
import time
import traceback
from collections.abc import Callable

from rclpy.node import Node

from robomech_ros.nodes.common.motion_clock import MotionClock
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog

_NANO = 1_000_000_000
_STOP_SECONDS = 3.0


class Cycles:
    """Calls a function at a fixed rate until `stop`.

    By the machine's time it does so in a thread of its own, since what the executor does before it
    waits again takes longer than a cycle; whatever the function shares with callbacks needs a lock.
    With simulated time, which comes through the executor, it is a timer of the node.  Cycles that
    are missed are left out, and those after them come when they would have come.

    - ``node``: the node that does the work.
    - ``rate``: cycles per second.
    - ``work``: called in each cycle.
    """

    def __init__(
        self, node: Node, clock: MotionClock, rate: float, work: Callable[[], None]
    ) -> None:
        self._node, self._log = node, ThrottledLog(node.get_logger())
        self._work = work
        self._period = round(_NANO / rate)
        self._over = threading.Event()
        self._thread: threading.Thread | None = None
        if clock.simulated:
            timer = node.create_timer(1.0 / rate, self._call, clock=clock.clock)
            # A timer that has not fired yet would wait until its old time comes again.
            clock.on_jump(lambda by: timer.reset())
        else:
            self._thread = threading.Thread(target=self._run, name="cycles", daemon=True)
            self._thread.start()

    def stop(self) -> None:
        """End after the present cycle; to be called before the node is destroyed."""
        self._over.set()
        if self._thread not in (None, threading.current_thread()):
            assert self._thread is not None
            self._thread.join(_STOP_SECONDS)

    def _run(self) -> None:
        due = time.monotonic_ns() + self._period
        while not self._over.wait((due - time.monotonic_ns()) / _NANO):
            if not self._node.context.ok():
                return
            self._call()
            missed = max(time.monotonic_ns() - due, 0) // self._period
            due += (1 + missed) * self._period

    def _call(self) -> None:
        try:
            self._work()
        except Exception:
            # The context may have ended in the meantime.
            if self._node.context.ok() and not self._over.is_set():
                self._log.error(f"a cycle failed, please report this:\n{traceback.format_exc()}")
