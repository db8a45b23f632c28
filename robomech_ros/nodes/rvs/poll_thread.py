"""A thread that looks at what a running robot says while somebody looks at the page."""

from __future__ import annotations

import math
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rclpy.node import Node

from robomech_ros.nodes.common.joints.joint_state_monitor import JointStateMonitor
from robomech_ros.nodes.middleware.throttled_log import ThrottledLog
from robomech_ros.nodes.rvs.settings import RvsSettings

if TYPE_CHECKING:
    from robomech_ros.rvs.page.live.live_page import LivePage

# Periods of the checks for a viewer, and for old states (s).
_IDLE_WAIT, _FAULT_PERIOD = 0.2, 0.1
# Messages that wait at the most; the latest counts.
DEPTH = 10


class PollThread(ABC):
    """A thread that looks again and again, as long as somebody watches a view.

    - ``view``: the page, whose ``wait_for_viewer`` says whether somebody watches it.
    - ``joints``: names of the joints that must be known.
    """

    def __init__(
        self, node: Node, settings: RvsSettings, view: LivePage, joints: Sequence[str]
    ) -> None:
        self._page, self._settings, self._joints = view, settings, joints
        self._period, self._log = 1.0 / settings.rate, ThrottledLog(node.get_logger())
        #: What is wrong with the messages of the robot; empty if nothing is, or if nobody watches.
        self.condition = ""
        self._monitor = JointStateMonitor(node)
        self._topic = node.resolve_topic_name("joint_states")
        self._updates, self._updated_at, self._looked_at = 0, -math.inf, -math.inf
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="states", daemon=True)

    def close(self) -> None:
        """End the thread."""
        self._closing.set()
        self._thread.join()

    @abstractmethod
    def show(self, now: float) -> None:
        """Read what has come and show it, at a time of the monotonic clock (s)."""

    @abstractmethod
    def fault(self, now: float) -> str:
        """Read what comes seldom, and say what is wrong with the state of the robot."""

    def _look(self, now: float) -> None:
        # Only what has been taken counts.
        self._monitor.known_positions(self._joints)
        updates = self._monitor.update_count(self._joints)
        if updates > self._updates:
            self._updates, self._updated_at = updates, now
        self.show(now)
        if now - self._looked_at >= _FAULT_PERIOD:
            self._looked_at = now
            self.condition = self.fault(now)
            self._page.show_state(self.condition)

    def _run(self) -> None:
        due = time.monotonic()
        while not self._closing.is_set():
            if not self._page.wait_for_viewer(_IDLE_WAIT):
                self.condition = ""
                continue
            now = time.monotonic()
            try:
                self._look(now)
            except Exception as error:
                # The thread goes on: it also says that states are old.
                self.condition = f"The robot cannot be shown: {error!r}."
                self._log.error(self.condition)
            # Missed periods are not made up for.
            due = max(due + self._period, now)
            self._closing.wait(max(due - time.monotonic(), 0.0))
