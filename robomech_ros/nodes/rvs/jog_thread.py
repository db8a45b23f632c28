"""A thread that commands while a page holds a button, and to stand when it does not any more."""

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Generic, TypeVar

from rclpy.node import Node

from robomech_ros.nodes.rvs.poll_thread import PollThread
from robomech_ros.rvs.model.running.jog import HoldHeartbeat, JogSwitch

Command = TypeVar("Command")


class JogThread(ABC, Generic[Command]):
    """Sends commands from a thread of its own, which nothing else delays.

    The module :mod:`robomech_ros.rvs.model.running.jog` says what ends a press, and how soon.

    - ``silence``: longest time without a message of the page (s); then the press ends.
    - ``period``: time between commands (s).
    - ``complain``: called with the reason when a jog fails to begin or ends while its button is
      held, and with an empty text when one begins.
    """

    def __init__(
        self, node: Node, silence: float, period: float, complain: Callable[[str], None]
    ) -> None:
        self._clock, self._logger = node.get_clock(), node.get_logger()
        self._period, self._complain = period, complain
        self._switch = JogSwitch[Command](silence, time.monotonic)
        self._thread = threading.Thread(target=self._run, name="jog", daemon=True)
        self._thread.start()

    @abstractmethod
    def send(self, what: Command, moves: bool) -> None:
        """Send the command for what is held, and whether to move; or to stand."""

    @abstractmethod
    def missing(self, what: Command) -> str:
        """Say why that cannot be followed now; empty for nothing."""

    def press(self, what: Command, beat: HoldHeartbeat) -> None:
        """Continue a press, or begin one."""
        self._switch.hold(what, beat.press, beat.age)

    def let_go(self) -> None:
        """End the press."""
        self._switch.release()

    @property
    def held(self) -> bool:
        """True if a button is held."""
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
        last: Command | None = None
        while (jog := self._switch.held()) is not None:
            missing = self.missing(jog)
            if missing or last is None:
                self._complain(missing)
            if missing:
                self._switch.release()
                break
            self.send(jog, True)
            last = jog
            time.sleep(self._period)
        if last is not None:
            self.send(last, False)


class JoggedRobot:
    """A running robot of a page: what it says goes to a view, and buttons of that jog it."""

    _feed: PollThread
    _jogger: JogThread

    @property
    def condition(self) -> str:
        """Fault of the state of the robot; empty for none."""
        return self._feed.condition

    @property
    def jogs(self) -> bool:
        """True if a jog button is held."""
        return self._jogger.held

    def let_go(self) -> None:
        """End the jog."""
        self._jogger.let_go()

    def close(self) -> None:
        """End what was begun; the topics go with the node."""
        self._jogger.close()
        self._feed.close()
