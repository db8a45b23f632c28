"""A connection to the page of the node rvs that is no browser."""

import html
import time

import msgspec.msgpack
import numpy as np
from raw_client import Client, camera, wait_until

PACK = msgspec.msgpack.encode


class Browser:
    """A connection to the page of a node, and what the node shows there."""

    def __init__(self, node):
        self.node, self.page = node, node._page
        self.layer = self.page._layers[0]
        self.client = Client(node)
        self._socket = self.client.connect()
        self._presses, self._pressed_at = 0, 0.0
        self.send(camera())
        wait_until(lambda: self.page._audience.commander is not None)

    def send(self, message):
        self._socket.send(PACK(message))

    def set(self, handle, value):
        """Set a control as a page does."""
        message = {"type": "GuiUpdateMessage", "uuid": handle._impl.uuid}
        self.send(message | {"updates": {"value": value}})

    def click(self, what):
        """Click one of the buttons about the goal."""
        self.set(self.layer._goal_buttons, what)

    def stop(self):
        """Click Stop."""
        handles = self.page._server.viser.gui._gui_input_handle_from_uuid.values()
        self.set(next(one for one in handles if getattr(one, "label", "") == "Stop"), True)

    def press(self):
        self._presses, self._pressed_at = self._presses + 1, time.monotonic()

    @property
    def press_has_ended(self):
        """Whether the node takes the present press for over."""
        jogger = self.node._robot._jogger
        switch = getattr(jogger, "_held", jogger)._switch
        return switch.held() is None and switch._ended == self._presses

    def hold(self, direction):
        """Say that a button is held."""
        age = round(1000 * (time.monotonic() - self._pressed_at))
        text = f"{direction} {self._presses} {age}"
        self.set(self.layer._pads[0].handle, text)

    def said(self, line="result"):
        """Return the text of a line of the page."""
        return html.unescape(self.layer._lines[line])

    def close(self):
        self._socket.close()


def drawn(browser):
    """Return the drawn joint positions of the robot (rad), shape (n,)."""
    latest = browser.layer._goal._robot
    return np.full(6, np.nan) if latest is None else latest


def hold_until(browser, direction, condition):
    """Hold a button until something is so.

    A press ends where the machine is too busy for its beats; then the button is pressed again.
    """
    browser.press()
    deadline = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < deadline, browser.said()
        if browser.press_has_ended:
            browser.press()
        browser.hold(direction)
        time.sleep(0.05)


def until_still(robot):
    """Wait until the robot has stood for some states."""
    seen = len(robot.states)
    robot.until(lambda: len(robot.states) > seen + 30)
    robot.until(lambda: np.ptp([s.position for s in robot.states[-30:]], axis=0).max() == 0.0)
