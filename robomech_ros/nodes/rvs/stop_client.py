"""Requests stops of the robot, and reports when all nodes have answered.

Publisher and controller are asked at once, since either may hang.  The publisher may stop the robot
by a trajectory that brakes on the path; where that comes after the controller held, the robot would
move on to its end.  So the controller is asked to hold again once the publisher has answered.
"""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

from rclpy.client import Client
from std_srvs.srv import Trigger

from robomech_ros.errors import RobomechError
from robomech_ros.nodes.rvs.requests import Requests

if TYPE_CHECKING:
    from robomech_ros.rvs.layers.live import LiveLayer

# Time after which a silent node is named, and time for which its answer still counts (s).
_LATE_AFTER, _PATIENCE = 2.0, 60.0


class StopClient:
    """Calls the services that stop the robot, from any thread.

    - ``requests``: sends the requests.
    - ``cancel``, ``hold``: clients of the services (std_srvs/Trigger) of publisher and controller.
    - ``view``: shows the results.
    """

    def __init__(self, requests: Requests, cancel: Client, hold: Client, view: LiveLayer) -> None:
        self._requests, self._cancel, self._hold, self._view = requests, cancel, hold, view
        self._lock = threading.Lock()
        self._number, self._since, self._shown, self._named = 0, 0.0, True, False
        # For the latest stop: nodes without an answer, and errors.
        self._open: list[Client] = []
        self._faults: list[str] = []

    def stop(self) -> None:
        """Stop; what came of an earlier stop is shown no more."""
        clients = (self._cancel, self._hold)
        there = [client for client in clients if client.service_is_ready()]
        with self._lock:
            self._number += 1
            self._since, self._shown, self._named = time.monotonic(), True, False
            self._open = there[:]
            absent = [client for client in clients if client not in there]
            self._faults = [f"nobody serves {self._requests.name(one)}" for one in absent]
            number = self._number
        for client in there:
            self._send(number, client)
        self._show()

    def hide(self) -> None:
        """Show no more what comes of a stop, since something else was asked for."""
        self._shown = False

    def look(self) -> None:
        """Name, once, the nodes without an answer for some time."""
        if self._open and self._late and not self._named:
            self._named = True
            self._show()

    @property
    def _late(self) -> bool:
        return time.monotonic() > self._since + _LATE_AFTER

    def _send(self, number: int, client: Client) -> None:
        name = self._requests.name(client)

        def answered(answer: Any) -> None:
            try:
                fault = "" if answer.success else f"{name} refused: {answer.message}"
            except RobomechError as error:
                fault = f"{name} answered what cannot be read: {error}"
            end(fault)

        def end(fault: str) -> None:
            with self._lock:
                if number != self._number:
                    return
                self._open.remove(client)
                if fault and fault not in self._faults:
                    self._faults.append(fault)
                again = client is self._cancel and self._hold.service_is_ready()
                if again:
                    self._open.append(self._hold)
            if again:
                self._send(number, self._hold)
            self._show()

        self._requests.send(client, Trigger.Request(), answered, end, _PATIENCE)

    def _show(self) -> None:
        with self._lock:
            faults = list(self._faults)
            if self._late:
                silent = dict.fromkeys(map(self._requests.name, self._open))
                faults += [f"{name} does not answer" for name in silent]
            ended = not self._open
            # Under the lock: what is shown last is the latest.
            if faults:
                self._view.show_result(f"Stop may have failed: {'; '.join(faults)}.", failed=True)
            elif self._shown:
                self._view.show_result("Stopped." if ended else "Stopping ...")
