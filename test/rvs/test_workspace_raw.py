"""Raw messages to the folder "Workspace": carried out, or rejected, server alive."""

import contextlib
import math

import msgspec.msgpack
import numpy as np
import pytest

pytest.importorskip("viser")

from raw_client import Client, camera, inside_limits, send_value, wait_until
from test_layers_raw import alive, control

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.rvs import view
from robomech_ros.rvs.layers.workspace import POINT


def layer(page):
    """The workspace of a page; None while another robot comes."""
    found = (one for one in page._layers if type(one).__name__ == "WorkspaceLayer")
    return next(found, None)


def known(page, label):
    """Wait until all controls of the folder are there, and give the identifier of one."""

    def there():
        with contextlib.suppress(KeyError):
            return control(page, "See all of it") is not None

    wait_until(there)
    return control(page, label)._impl.uuid


def switch_on(page, commander, label):
    """Tick a checkbox of the folder."""
    send_value(commander, known(page, label), True)


def press(page, commander, label):
    """Press a button of the folder."""
    switch_on(page, commander, label)


def click(page, index):
    """The message of a click on a point of the map."""
    name = layer(page)._nodes._points.name
    message = {"type": "SceneNodeClickMessage", "name": name, "owner": ""}
    message |= {"instance_index": index, "modifier": None}
    return message | {
        "ray_origin": [0.0] * 3,
        "ray_direction": [0.0, 0.0, 1.0],
        "screen_pos": [0.5, 0.5],
    }


def assert_all_take(page, T):
    """There are postures, and all take a pose."""
    postures = page._arm.study.postures
    assert postures
    for posture in postures:
        found = forward_kinematics(page._arm.chain, posture.q)
        np.testing.assert_allclose(found, T, atol=1e-6)


@pytest.fixture
def puma():
    """A page of a PUMA 560, and a client that commands it."""
    with view("puma560", port=0) as page, Client(page).connect() as connection:
        connection.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: page._panel is not None)
        yield page, connection


@pytest.fixture
def mapped(page, commander):
    """A page of a UR5e with a coarse map."""
    switch_on(page, commander, "reach map")
    send_value(commander, known(page, "points"), "coarse")
    wait_until(lambda: layer(page)._on["reach_map"])
    wait_until(lambda: layer(page)._chosen.density == "coarse")
    press(page, commander, "Compute the map")
    wait_until(lambda: layer(page)._shown is not None)
    return page, commander


def test_nothing_is_computed_before_it_is_asked_for(page, commander):
    alive(page, commander)
    assert not layer(page)._asked and layer(page)._map is None
    press(page, commander, "Compute the map")
    wait_until(lambda: "Refused" in page._stage._notice.content)
    assert not layer(page)._running and layer(page)._map is None
    alive(page, commander)


def test_an_arm_without_a_boundary_says_why(page, commander):
    switch_on(page, commander, "boundary")
    wait_until(lambda: "axes 4, 5 and 6 do not meet" in layer(page)._text.content)
    assert layer(page)._plot.content == ""
    alive(page, commander)


def test_a_place_of_the_section_is_taken_in_the_present_orientation(puma):
    page, connection = puma
    switch_on(page, connection, "boundary")
    wait_until(lambda: layer(page)._view is not None)
    before = page._arm.tip
    send_value(connection, known(page, POINT), "0.5, 0.3")
    section = layer(page)._view
    wait_until(lambda: np.allclose(section.coordinates(page._arm.target), [0.5, 0.3], atol=1e-9))
    wait_until(lambda: np.allclose(page._arm.tip, page._arm.target, atol=1e-9))
    np.testing.assert_allclose(page._arm.tip[:3, :3], before[:3, :3], atol=1e-9)
    assert_all_take(page, page._arm.target)
    # Out of reach: the reason, as for the gizmo, and the arm stays.
    q = page._arm.q
    send_value(connection, known(page, POINT), "1.5, 0.3")
    wait_until(lambda: not page._arm.study.postures)
    assert "reach" in page._arm.study.sentence
    np.testing.assert_array_equal(page._arm.q, q)


@pytest.mark.parametrize("text", ["nonsense", "0.5", "nan, 1", "1e999, 0", "1, 2, 3", math.nan, 7])
def test_what_is_no_place_is_refused(puma, text):
    page, connection = puma
    switch_on(page, connection, "boundary")
    wait_until(lambda: layer(page)._view is not None)
    q = page._arm.q
    send_value(connection, known(page, POINT), text)
    alive(page, connection)
    np.testing.assert_array_equal(page._arm.q[:5], q[:5])


def test_a_click_on_a_point_of_the_map_lists_its_postures(mapped):
    page, commander = mapped
    shown, R = layer(page)._shown, page._arm.tip[:3, :3]
    k = int(np.argmax(shown.values - np.linalg.norm(shown.points - page._arm.tip[:3, 3], axis=1)))
    commander.send(msgspec.msgpack.encode(click(page, k)))
    wait_until(lambda: np.allclose(page._arm.target[:3, 3], shown.points[k], atol=1e-9))
    np.testing.assert_allclose(page._arm.target[:3, :3], R, atol=1e-9)
    assert_all_take(page, page._arm.target)


@pytest.mark.parametrize("index", [None, 10**9, -1, 1.5, "0"])
def test_a_click_on_no_point_moves_nothing(mapped, index):
    page, commander = mapped
    q = page._arm.q
    commander.send(msgspec.msgpack.encode(click(page, index)))
    alive(page, commander)
    np.testing.assert_array_equal(page._arm.q[:5], q[:5])


def test_who_only_watches_moves_nothing_by_a_click(mapped):
    page, commander = mapped
    q = page._arm.q
    with Client(page).connect() as watching:
        watching.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: page.browsers == 2)
        for k in range(5):
            watching.send(msgspec.msgpack.encode(click(page, k)))
        alive(page, commander)
        np.testing.assert_array_equal(page._arm.q[:5], q[:5])


def test_a_map_is_cancelled_and_one_of_another_robot_forgotten():
    with view("crx10ia", port=0) as page, Client(page).connect() as connection:
        connection.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: page._panel is not None)
        switch_on(page, connection, "reach map")
        send_value(connection, known(page, "points"), "fine")
        wait_until(lambda: layer(page)._chosen.density == "fine")
        press(page, connection, "Compute the map")
        wait_until(lambda: " points ..." in layer(page)._legend.content)
        press(page, connection, "Cancel")
        wait_until(lambda: "Cancelled" in layer(page)._legend.content)
        assert layer(page)._map is None and not layer(page)._running
        press(page, connection, "Compute the map")
        wait_until(lambda: layer(page)._running)
        first = layer(page)
        send_value(connection, known(page, "Change DH"), "2 a 0.6")
        wait_until(lambda: layer(page) not in (None, first))
        wait_until(lambda: first._mapper._closing and not first._mapper._thread.is_alive())
        assert first._map is None and layer(page)._map is None
        assert layer(page)._on["reach_map"] and inside_limits(page)
