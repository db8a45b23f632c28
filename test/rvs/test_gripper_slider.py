"""The slider of a gripper on a page without ROS."""

import sys
from pathlib import Path

import msgspec.msgpack
import numpy as np
import pytest

pytest.importorskip("viser")
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "nodes" / "motion"))

from gripper_cases import panda_with_hand, poses_by_pinocchio
from raw_client import Client, camera, send_value, wait_until

from robomech_ros.rvs import view

FINGERS = ("panda_finger_joint1", "panda_finger_joint2")


@pytest.fixture
def hand():
    """A page of a Panda with a hand, its layer of the gripper, and a raw client that commands."""
    with (
        view(panda_with_hand(), port=0, tip="panda_hand_tcp") as page,
        Client(page).connect() as connection,
    ):
        connection.send(msgspec.msgpack.encode(camera()))
        layer = page._layers[0]
        wait_until(lambda: layer._slider is not None)
        yield page, layer, connection


def test_the_slider_moves_the_fingers(hand):
    page, layer, connection = hand
    send_value(connection, layer._slider._impl.uuid, 0.06)
    wait_until(lambda: page._arm.positions[FINGERS[0]] == pytest.approx(0.03))
    seen = page._layers[0]._context.seen
    T = seen.tree.link_poses(page._arm.positions)["panda_rightfinger"]
    at = {joint: page._arm.positions.get(joint, 0.0) for joint in seen.tree.joint_names}
    expected = poses_by_pinocchio(panda_with_hand(), at | dict.fromkeys(FINGERS, 0.03))
    np.testing.assert_allclose(T, expected["panda_rightfinger"], atol=1e-12)
    # The arm moves without the fingers, and the slider stays.
    page.set_joint(0, 0.4)
    wait_until(lambda: page._arm.q[0] == 0.4)
    assert page._arm.positions[FINGERS[0]] == pytest.approx(0.03)
    assert layer._slider.value == 0.06


@pytest.mark.parametrize("value", [0.2, -0.01, True])
def test_what_is_no_width_is_refused(hand, value):
    page, layer, connection = hand
    send_value(connection, layer._slider._impl.uuid, value)
    wait_until(lambda: "Refused" in str(page._stage._notice.content))
    assert page._arm.positions[FINGERS[0]] == 0.0
    wait_until(lambda: layer._slider.value == 0.0)


def test_an_arm_without_fingers_has_no_slider(page, commander):
    assert page._layers[0]._slider is None
