"""A page whose robot is replaced by another, asked by a raw client."""

import numpy as np
import pytest

pytest.importorskip("viser")

import msgspec.msgpack
import zstandard
from raw_client import PATIENCE, camera, inside_limits, send_value, slider, wait_until

from robomech_ros.robots import load_description

PACK = msgspec.msgpack.encode
BROKEN = """<robot name="b"><link name="a"/><link name="c"><visual><geometry><box size="1 1 1"/>
</geometry><material name="m"><color rgba="red 0 0 1"/></material></visual></link><joint name="j"
type="revolute"><parent link="a"/><child link="c"/><limit lower="-1" upper="1" velocity="1"
effort="1"/></joint></robot>"""


def test_another_robot_is_shown_and_commanded(page, commander):
    before, old = page._arm, slider(page, 2)
    robot = load_description("iiwa14")
    page.replace(robot, robot.chain())
    wait_until(lambda: page._panel is not None and len(page._panel._sliders) == 7)
    nodes = page._server.viser.scene._handle_from_node_name
    assert not any("upper_arm" in name for name in nodes)
    assert any("link_7" in name for name in nodes)
    send_value(commander, slider(page, 6), 0.25)
    wait_until(lambda: page._arm.q[6] == 0.25)
    send_value(commander, old, 0.5)
    send_value(commander, slider(page, 5), 0.125)
    wait_until(lambda: page._arm.q[5] == 0.125)
    assert before.q[2] != 0.5 and inside_limits(page)


def test_what_is_shown_stays_shown_and_so_does_the_posture(page, commander):
    page.show("frames", True)
    page.show("dark", True)
    page.set_joint(1, -0.75)
    wait_until(lambda: page._arm.q[1] == -0.75)
    before, q = page._panel, page._arm.q
    robot = load_description("ur5e")
    page.replace(robot, robot.chain())
    wait_until(lambda: page._panel is not before and page._panel is not None)
    assert all(node.show_axes for node in page._stage._robot._nodes.values())
    boxes = {label: box.value for label, box in page._panel._shown._boxes.items()}
    assert boxes == {**page._switches, "dark": True} and boxes["frames"]
    np.testing.assert_array_equal(page._arm.q, q)


def test_a_robot_replaced_while_nobody_commands_waits_for_who_comes(page, client):
    robot = load_description("scara")
    page.replace(robot, robot.chain())
    wait_until(lambda: page._arm.chain.n == 4)
    with client.connect() as connection:
        connection.send(PACK(camera()))
        wait_until(lambda: page._panel is not None)
        assert len(page._panel._sliders) == 4


def test_a_robot_that_cannot_be_shown_is_refused_and_this_one_stays(page, commander):
    arm, panel = page._arm, page._panel
    robot = load_description(BROKEN)
    page.replace(robot, robot.chain())
    wait_until(lambda: "Refused" in page._stage._notice.content)
    assert page._arm is arm and page._panel is panel
    assert "red" in page._stage._notice.content
    send_value(commander, slider(page, 2), 1.25)
    wait_until(lambda: page._arm.q[2] == 1.25)


def hear(connection, words):
    """Receive until a message has these words."""
    while True:
        raw = connection.recv(timeout=PATIENCE)
        length = int.from_bytes(raw[8:16], "little")
        if words in zstandard.ZstdDecompressor().decompress(raw[16 : 16 + length]):
            return


def test_robots_replaced_again_and_again_reach_all_who_look_while_others_come_and_go(
    page, commander, client
):
    robots = [load_description(name) for name in ("scara", "iiwa14")]
    with client.connect() as watcher:
        watcher.send(PACK(camera()))
        for k in range(10):
            robot = robots[k % 2]
            with client.connect() as passer:
                passer.send(PACK(camera()))
                page.replace(robot, robot.chain())
            link = f"_{robot.chain().tip}".encode()
            hear(commander, link)
            hear(watcher, link)
        wait_until(lambda: page.browsers == 2)
    send_value(commander, slider(page, 6), 0.25)
    wait_until(lambda: page._arm.q[6] == 0.25)
