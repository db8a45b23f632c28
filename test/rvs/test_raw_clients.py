"""A page and whatever a client may send: nothing gets through that a page would not send."""

import math

import numpy as np
import pytest

pytest.importorskip("viser")

import msgspec.msgpack
from raw_client import camera, gizmo, grip, inside_limits, send_value, slider, wait_until
from websockets.exceptions import ConnectionClosed

PACK = msgspec.msgpack.encode
TOO_LONG = "x" * 5000

GARBAGE = [
    b"",
    b"\x00",
    b"\xff" * 100,
    "text",
    PACK(None),
    PACK([1, 2, 3]),
    PACK({"type": 7}),
    PACK({"type": "NoSuchMessage"}),
    PACK({"type": "ShareUrlRequest"}),
    PACK({"type": "ShareUrlDisconnect"}),
    PACK({"type": "FileTransferStartUpload", "source_component_uuid": "a"}),
    PACK({"type": "RunJavascriptMessage", "source": "alert(1)"}),
    PACK({"type": "ViewerCameraMessage"}),
    PACK(camera() | {"fov": math.nan}),
    PACK(camera() | {"position": "here"}),
    PACK(camera() | {"image_width": -1}),
    PACK(camera() | {"more": 1}),
    PACK(gizmo([math.nan, 0.0, 0.0])),
    PACK(gizmo([0.0, math.inf, 0.0])),
    PACK(gizmo([0.0, 0.0])),
    PACK(gizmo([0.0, 0.0, 0.3], wxyz=[math.nan] * 4)),
    PACK(gizmo(["a", "b", "c"])),
    PACK(gizmo([[], {}, None])),
    PACK({"type": "GuiUpdateMessage", "uuid": "x", "updates": {"update_cb": []}}),
    PACK({"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": math.nan}}),
    PACK({"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": {"a": 1}}}),
    PACK({"type": "GuiUpdateMessage", "uuid": "x", "updates": {"value": TOO_LONG}}),
    PACK({"type": "GuiUpdateMessage", "uuid": "x", "updates": {}}),
    PACK({"type": "GuiUpdateMessage", "uuid": ["x"], "updates": {"value": 1}}),
    PACK([[[[[[[[[]]]]]]]]] * 10),
]


def test_a_gizmo_of_the_commander_moves_the_arm(page, commander):
    arm = page._arm
    T = arm.tip
    T[2, 3] += 0.02
    owner = str(page._audience.commander)
    from robomech_ros.rvs.page.node_space import placed

    place = placed(T)
    hint = page._panel._hint
    assert hint.visible and "drag" in hint.text
    commander.send(PACK(grip(owner)))
    commander.send(PACK(gizmo(place["position"].tolist(), place["wxyz"].tolist(), owner)))
    wait_until(lambda: np.allclose(arm.tip, T, atol=1e-6))
    # Who has dragged it knows.
    assert not hint.visible
    assert inside_limits(page)


def test_the_gizmo_snaps_back_even_if_its_last_message_comes_late(page, commander):
    arm, owner = page._arm, str(page._audience.commander)
    tip, before = arm.tip, arm.q
    commander.send(PACK(grip(owner)))
    commander.send(PACK(gizmo([3.0, 0.0, 0.3], owner=owner)))
    wait_until(lambda: arm.study.nearest is not None)
    assert "No posture" in arm.study.sentence
    commander.send(PACK(grip(owner) | {"type": "TransformControlsDragEndMessage"}))
    commander.send(PACK(gizmo([3.0, 0.1, 0.3], owner=owner)))
    send_value(commander, slider(page, 5), 0.0625)
    wait_until(lambda: arm.q[5] == 0.0625)
    np.testing.assert_array_equal(arm.q[:5], before[:5])
    np.testing.assert_allclose(arm.target[:3, 3], tip[:3, 3], atol=1e-9)
    assert arm.study.postures
    wait_until(lambda: np.allclose(page._panel._gizmo.position, tip[:3, 3]))


@pytest.mark.parametrize("message", GARBAGE, ids=range(len(GARBAGE)))
def test_garbage_is_harmless(page, commander, message):
    before = page._arm.q
    commander.send(message)
    # The next one is answered, in its turn.
    test_a_slider_moves_and_refuses(page, commander)
    assert inside_limits(page) and not np.array_equal(page._arm.q, before)


def test_a_slider_moves_and_refuses(page, commander):
    send_value(commander, slider(page, 2), 1.25)
    wait_until(lambda: page._arm.q[2] == 1.25)
    for value in (100.0, -1e300, "far", True, [1.0, 2.0]):
        send_value(commander, slider(page, 2), value)
    send_value(commander, slider(page, 0), 0.125)
    wait_until(lambda: page._arm.q[0] == 0.125)
    assert inside_limits(page)


def test_a_value_beyond_a_limit_is_refused_in_words(page, commander):
    send_value(commander, slider(page, 2), 100.0)
    wait_until(lambda: "Refused" in page._stage._notice.content)
    assert (
        "elbow_joint" in page._stage._notice.content
        and "3.14159 rad" in page._stage._notice.content
    )
    wait_until(lambda: page._panel._sliders[2].value == pytest.approx(page._arm.q[2]))


@pytest.mark.slow
def test_a_flood_is_slowed_down_and_harmless(page, client, commander):
    rng = np.random.default_rng(0)
    owner = str(page._audience.commander)
    commander.send(PACK(grip(owner)))
    for k in range(3000):
        message = [
            gizmo(rng.uniform(-1.0, 1.0, 3).tolist(), owner=owner),
            gizmo([math.nan] * 3, owner=owner),
            camera(),
        ][k % 3]
        commander.send(PACK(message))
    status, _, _ = client.get("/", Cookie=client.cookie)
    assert status == 200
    with client.connect() as other:
        other.send(PACK(camera()))
        wait_until(lambda: len(page._audience._watching) == 1)
    assert inside_limits(page)


def test_what_cannot_be_used_fills_no_log(page, commander, caplog):
    """A slider reads what it is sent as a number; what is none is an error of its own."""
    speed = next(
        handle
        for handle in page._server.viser.get_clients()[
            page._audience.commander
        ].gui._gui_input_handle_from_uuid.values()
        if handle.label == "Speed"
    )
    for _ in range(20):
        send_value(commander, speed._impl.uuid, "x" * 4000)
    test_a_slider_moves_and_refuses(page, commander)
    dropped = [text for text in caplog.messages if "a message was dropped" in text]
    assert len(dropped) < 10 and all(len(text) < 300 for text in dropped) and dropped


def test_a_message_too_large_ends_its_connection_and_no_other(page, client, commander):
    with client.connect() as other:
        other.send(b"\x00" * 1_000_000)
        with pytest.raises(ConnectionClosed):
            while True:
                other.recv(timeout=60.0)
    test_a_slider_moves_and_refuses(page, commander)


def test_one_browser_commands_the_other_watches_and_takes_over(page, client, commander):
    first = page._audience.commander
    with client.connect() as second:
        second.send(PACK(camera()))
        wait_until(lambda: page._audience._watching)
        (number,) = page._audience._watching
        text, button = page._audience._watching[number]
        assert "Another browser commands" in text.content
        # What it sends in the name of the first does nothing.
        mine = slider(page, 1)
        send_value(second, mine, -1.0)
        second.send(PACK(grip(str(first))))
        second.send(PACK(gizmo([0.3, 0.3, 0.3], owner=str(first))))
        send_value(second, button._impl.uuid, True)
        wait_until(lambda: page._audience.commander == number)
        assert page._arm.q[1] == page._arm.chain.home()[1]
        send_value(commander, mine, -1.0)
        send_value(second, slider(page, 1), -1.25)
        wait_until(lambda: page._arm.q[1] == -1.25)
        assert list(page._audience._watching) == [first]
    wait_until(lambda: page._audience.commander is None)
    (text, _) = page._audience._watching[first]
    assert "No browser commands" in text.content
