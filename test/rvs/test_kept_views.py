"""Stored parts of a page: its view as a text, recordings, and files of plans."""

import time

import numpy as np
import pytest

pytest.importorskip("viser")

import msgspec.msgpack
import zstandard
from raw_client import PATIENCE, camera, inside_limits, send_value, slider, wait_until

from robomech_ros.errors import BadValueError
from robomech_ros.robots import load_robot
from robomech_ros.rvs.layers.recording import END, RecordingLayer
from robomech_ros.rvs.model.motions.recorder import MOST_POSTURES_KEPT, NEAREST, Recorder
from robomech_ros.rvs.model.view_state import ViewState, state_from_text, text_from_state

PACK = msgspec.msgpack.encode
ARM = load_robot("ur5e")
NAMES = ("ghosts", "joint axes", "dark")
GOOD = "q:0,0,0,0,0,0;eye:1,-1,1;at:0,0,0.3;show:ghosts,joint_axes"
HOSTILE = [
    "",
    "x" * 5000,
    "q",
    GOOD + ";q:0",
    GOOD + ";script:alert(1)",
    GOOD.replace("0,0,0,0,0,0", "0,0,0"),
    GOOD.replace("0,0,0,0,0,0", "nan,0,0,0,0,0"),
    GOOD.replace("0,0,0,0,0,0", "1e999,0,0,0,0,0"),
    GOOD.replace("0,0,0,0,0,0", "<script>,0,0,0,0,0"),
    GOOD.replace("1,-1,1", "inf,0,0"),
    GOOD.replace("1,-1,1", "0,0,0.3"),
    GOOD.replace("1,-1,1", "0,0,5"),
    GOOD.replace("1,-1,1", "1e5,0,0"),
    GOOD.replace("ghosts", "everything"),
]


def test_a_view_is_read_as_it_was_written():
    shown = {"ghosts": False, "joint axes": True, "dark": True}
    q = ARM.home() + 0.123456789
    state = ViewState(q, np.array([1.25, -2.0, 0.5]), np.array([0.0, -0.0, 0.3]), shown)
    text = text_from_state(state)
    # Nothing of it needs escaping in an address, or in a script.
    assert set(text) <= set("abcdefghijklmnopqrstuvwxyz0123456789.,:;_-+")
    read = state_from_text(text, 6, NAMES)
    np.testing.assert_allclose(read.q, q, atol=1e-9)
    np.testing.assert_allclose(read.eye, state.eye)
    assert read.shown == shown


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_what_is_no_view_is_refused_in_words(text):
    with pytest.raises(BadValueError, match="view"):
        state_from_text(text, 6, NAMES)


def test_a_recording_stands_still_where_nothing_moved():
    recorder, q = Recorder(), ARM.home()
    recorder.begin(10.0, q)
    recorder.add(10.0, q)
    recorder.add(12.0, q + 0.1)
    recorder.add(12.02, q + 0.2)
    motion = recorder.end(13.0, ARM)
    np.testing.assert_allclose(motion.at([1.0, 1.9]), [q, q], atol=1e-9)
    np.testing.assert_allclose(motion.at([2.02, 2.9]), [q + 0.2, q + 0.2], atol=1e-9)
    assert motion.duration == pytest.approx(3.0, abs=0.01) and not recorder.running


def test_a_recording_keeps_its_pauses_whenever_it_begins():
    q = ARM.home()
    for begun in np.geomspace(1e3, 1e6, 500):
        recorder = Recorder()
        recorder.begin(begun, q)
        recorder.add(begun + 1.0, q + 0.1)
        recorder.add(begun + 2.5, q + 0.2)
        motion = recorder.end(begun + 3.0, ARM)
        assert len(motion.times) == 6
        np.testing.assert_allclose(motion.at([0.9, 2.4]), [q, q + 0.1], atol=1e-9)


def test_a_recording_of_nothing_is_refused_and_one_without_end_ends():
    recorder, q = Recorder(), ARM.home()
    recorder.begin(0.0, q)
    with pytest.raises(BadValueError, match="recording"):
        recorder.end(5.0, ARM)
    recorder.begin(0.0, q)
    for k in range(1, MOST_POSTURES_KEPT + 5):
        recorder.add(0.01 * k, q + 1e-6 * k)
    assert not recorder.running
    assert len(recorder.end(1e4, ARM).times) <= MOST_POSTURES_KEPT + 1


@pytest.fixture
def kept(page, commander):
    """The layer that keeps, with its controls."""
    layer = next(layer for layer in page._layers if isinstance(layer, RecordingLayer))
    wait_until(lambda: layer.is_open)
    return layer


def test_what_the_arm_does_becomes_a_plan(page, commander, kept):
    send_value(commander, kept.record._impl.uuid, True)
    wait_until(lambda: kept.recorder.running)
    slider = page._panel._sliders[2]._impl.uuid
    for value in (0.5, 0.75, 1.0):
        send_value(commander, slider, value)
        wait_until(lambda v=value: kept.recorder._q[-1][2] == v)
        time.sleep(2.0 * NEAREST)  # nearer postures are one
    assert len(kept.recorder._times) >= 3
    send_value(commander, kept.record._impl.uuid, True)
    wait_until(lambda: page._plan.name == "recording")
    assert page._plan.motion.q[-1, 2] == 1.0


def test_the_view_is_shown_and_taken(page, commander, kept):
    wait_until(lambda: kept.view.value.startswith("q:"))
    text = kept.view.value
    state = state_from_text(text, 6, tuple(page._switched()))
    np.testing.assert_allclose(state.q, page._arm.q, atol=1e-8)
    wanted = state._replace(q=state.q + 0.1, shown={**state.shown, "frames": True, "dark": True})
    send_value(commander, kept.view._impl.uuid, text_from_state(wanted))
    wait_until(lambda: np.allclose(page._arm.q, state.q + 0.1))
    wait_until(lambda: page._switched()["frames"] and page._switched()["dark"])
    wait_until(lambda: page._panel._shown._boxes["frames"].value)


def test_a_view_switches_what_layers_show_and_marks_it(page, commander, kept):
    layers = {type(layer).__name__: layer for layer in page._layers}
    understand, workspace = layers["AnalysisLayer"], layers["WorkspaceLayer"]
    wait_until(lambda: kept.view.value.startswith("q:"))
    assert kept.view.value.endswith("show:ghosts,ground,gizmo,cut_open")
    before = kept.view.value.rpartition("show:")[0]
    names = ["numbers", "force ellipsoid", "boundary", "contours"]
    text = f"{before}show:ghosts,{','.join(names).replace(' ', '_')}"
    send_value(commander, kept.view._impl.uuid, text)
    wait_until(lambda: [name for name, on in page._switched().items() if on] == ["ghosts", *names])
    wait_until(lambda: "force" in understand._nodes and understand._nodes["force"].visible)
    assert "velocity" not in understand._nodes
    wait_until(lambda: "No boundary" in workspace._text.content)
    boxes = {**understand._folder._boxes, **workspace._folder._boxes}
    boxes["contours"] = layers["ContoursLayer"]._box
    wait_until(lambda: {name for name, box in boxes.items() if box.value} == set(names))
    # And back, by a checkbox, which the text follows.
    send_value(commander, boxes["force ellipsoid"]._impl.uuid, False)
    wait_until(lambda: "force_ellipsoid" not in kept.view.value)
    wait_until(lambda: "numbers" in kept.view.value)
    assert not understand._nodes["force"].visible


def test_a_view_of_elsewhere_is_refused_as_a_whole(page, commander, kept):
    wait_until(lambda: kept.view.value.startswith("q:"))
    q, shown, right = page._arm.q, page._switched(), kept.view.value
    beyond = GOOD.replace("q:0", "q:100").replace("joint_axes", "frames")
    for text in (*HOSTILE[2:], beyond):
        send_value(commander, kept.view._impl.uuid, text)
        wait_until(lambda: "Refused" in page._stage._notice.content)
        # What was refused goes.
        wait_until(lambda: kept.view.value == right)
        page._ask("next", lambda: None)
        wait_until(lambda: "Refused" not in page._stage._notice.content)
    np.testing.assert_array_equal(page._arm.q, q)
    assert page._switched() == shown and inside_limits(page)


def test_a_recording_that_fills_up_when_nobody_commands_is_shown(page, client):
    with client.connect() as connection:
        connection.send(PACK(camera()))
        layer = next(layer for layer in page._layers if isinstance(layer, RecordingLayer))
        wait_until(lambda: layer.is_open)
        button = layer.record
        send_value(connection, button._impl.uuid, True)
        wait_until(lambda: button.label == END)
    wait_until(lambda: page._audience.commander is None)
    recorder, arm = layer.recorder, page._arm

    def fill():
        begun = time.monotonic() - 0.01 * MOST_POSTURES_KEPT
        recorder.begin(begun, arm.q)
        for k in range(1, MOST_POSTURES_KEPT - 1):
            recorder.add(begun + 0.01 * k, arm.q + 1e-6 * k)

    page._ask("fill", fill)
    wait_until(lambda: page._plan.name == "recording")
    assert not recorder.running


def scripts(connection, last):
    """Read what a page gets until a script has a text; gives them all."""
    heard = b""
    while last not in heard:
        frame = connection.recv(timeout=PATIENCE)
        length = int.from_bytes(frame[8:16], "little")
        heard += zstandard.decompress(frame[16 : 16 + length])
    return heard


def test_a_browser_brings_its_address_once(page, client, commander):
    # Whoever commands is given the address of what is seen, after all that came before.
    read, kept = b"get('view')", b"history.replaceState"
    audience, first = page._audience, page._audience.commander
    camera_of_first = page._server.viser.get_clients()[first].camera
    assert scripts(commander, kept).count(read) == 1
    heeding = len(camera_of_first._state.camera_cb)
    with client.connect() as second:
        second.send(PACK(camera()))
        wait_until(lambda: audience._watching)
        (number,) = audience._watching
        send_value(second, audience._watching[number][1]._impl.uuid, True)
        wait_until(lambda: audience.commander == number)
        assert scripts(second, kept).count(read) == 1
        send_value(second, slider(page, 1), -1.25)
        wait_until(lambda: page._arm.q[1] == -1.25)
        send_value(commander, audience._watching[first][1]._impl.uuid, True)
        wait_until(lambda: audience.commander == first)
        assert read not in scripts(commander, kept)
    assert page._arm.q[1] == -1.25
    assert len(camera_of_first._state.camera_cb) == heeding
