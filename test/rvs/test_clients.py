"""Commanding browser of a page, if controls cannot be made, or end during an action."""

import logging
import threading

import pytest

pytest.importorskip("viser")

import msgspec.msgpack
from raw_client import PATIENCE, Client, camera, send_value, slider, wait_until

from robomech_ros.robots import load_description
from robomech_ros.robots.robot_kinds import ARM
from robomech_ros.rvs.kind_registry import VIEW_KINDS
from robomech_ros.rvs.layers.contours import ContoursLayer
from robomech_ros.rvs.page.clients import AllControls
from robomech_ros.rvs.page.page import RobotPage


class Fragile:
    """A layer whose controls can be made, or not."""

    broken = True

    def __init__(self, context):
        pass

    def show(self):
        """It has nothing to show."""

    def controls(self, client):
        """Return none, or fail."""
        if self.broken:
            raise OSError("no controls today")
        return AllControls([])

    def close(self):
        """Nothing runs."""


@pytest.fixture
def fragile():
    """A page of a UR5e whose last layer is fragile."""
    robot = load_description("ur5e")
    layers = (*VIEW_KINDS[ARM].make_layers(), Fragile)
    with RobotPage(robot, robot.chain(), port=0, host="127.0.0.1", layers=layers) as served:
        yield served


def controls(page, number):
    """The controls of a browser, by their labels."""
    gui = page._server.viser.get_clients()[number].gui
    return {handle.label: handle for handle in gui._gui_input_handle_from_uuid.values()}


def moves(page, connection, joint, value):
    """The one who commands moves the arm."""
    send_value(connection, slider(page, joint), value)
    wait_until(lambda: page._arm.q[joint] == value)


def test_nobody_commands_with_half_of_the_controls(fragile):
    page, audience, (*_, layer) = fragile, fragile._audience, fragile._layers
    client = Client(page)
    with client.connect() as first, client.connect() as second:
        first.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: audience._watching)
        (one,) = audience._watching
        assert audience.commander is None and page._panel is None
        assert "No browser commands" in audience._watching[one][0].content
        assert list(controls(page, one)) == ["Take command"]
        assert not page._server.viser.get_clients()[one].scene._handle_from_node_name
        # It may try again.
        layer.broken = False
        send_value(first, audience._watching[one][1]._impl.uuid, True)
        wait_until(lambda: audience.commander == one)
        moves(page, first, 1, -1.25)
        # So may the one whom another leaves without command.
        second.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: audience._watching)
        (other,) = audience._watching
        layer.broken = True
        send_value(second, audience._watching[other][1]._impl.uuid, True)
        wait_until(lambda: audience.commander is None and len(audience._watching) == 2)
        for text, _ in audience._watching.values():
            wait_until(lambda text=text: "No browser commands" in text.content)
        layer.broken = False
        send_value(first, audience._watching[one][1]._impl.uuid, True)
        wait_until(lambda: audience.commander == one)
        moves(page, first, 1, -1.5)


def test_contours_are_switched_off_before_they_are_drawn(page, commander, caplog):
    layer = next(one for one in page._layers if isinstance(one, ContoursLayer))
    switch = controls(page, page._audience.commander)["contours"]
    busy = threading.Event()
    layer._worker.submit("busy", lambda: busy.wait(PATIENCE))
    try:
        with caplog.at_level(logging.ERROR):
            send_value(commander, switch._impl.uuid, True)
            wait_until(lambda: "draw" in layer._worker._waiting)
            send_value(commander, switch._impl.uuid, False)
            wait_until(lambda: layer._target is None)
            busy.set()
            send_value(commander, switch._impl.uuid, True)
            wait_until(lambda: "<svg" in layer._view._plot.content)
    finally:
        busy.set()
    assert "failed" not in caplog.text
