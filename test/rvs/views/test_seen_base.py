"""Rolling robots on a page: placed, driven within their limits, and commanded by raw clients."""

import math

import numpy as np
import pytest

from robomech_ros.errors import RobomechError
from robomech_ros.rolling import list_rolling
from robomech_ros.rolling.arcs import moved
from robomech_ros.rvs.kind_registry import VIEW_KINDS
from robomech_ros.rvs.model.kinds.rolling import PERIOD
from robomech_ros.spatial import pose_exponential

ROBOTS = list_rolling()


def arrived(base, steps=500):
    for _ in range(steps):
        base.drive(1)
    return base


@pytest.mark.parametrize("name", ROBOTS)
def test_a_base_drives_as_commanded_on_an_arc_and_leaves_a_trail(name):
    base = VIEW_KINDS["rolling"].load(name)
    base.command[:] = base.robot.base.feasible(0.2 * base.most)
    arrived(base, 500)
    np.testing.assert_allclose(base.motion.twist, base.command, atol=1e-9)
    before = base.pose
    base.drive(10)
    went = moved(before, base.command * 10 * PERIOD)
    np.testing.assert_allclose(base.pose[:2], went[:2], atol=1e-9)
    assert math.remainder(base.pose[2] - went[2], 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(base.trail.points[-1, :2], base.pose[:2], atol=0.02)
    np.testing.assert_allclose(base.path_ahead()[0, :2], base.pose[:2])
    joints, rates = base.positions, dict(base.facts())
    assert set(joints) == set(base.state_joints)
    assert all(f"wheel {wheel}" in rates for wheel in base.robot.base.names)
    arrived_at = base.pose
    for _ in range(2000):
        base.drive(1, brake=True)
        if base.stands:
            break
    assert base.stands and not np.array_equal(base.pose, arrived_at)
    base.trail.clear()
    assert len(base.trail.points) == 0


def test_wheels_at_their_limits_are_named_and_marked():
    base = VIEW_KINDS["rolling"].load("mecanum")
    assert base.study.sentence == "mecanum drive, mobility (3,0)."
    base.command[:] = [0.0, 0.8, 0.8]
    base.preview()
    assert base.study.sentence == (
        "At the limit of front_right, rear_left: slower, on the same curve."
    )
    assert base.faulty_links == ("front_right_link", "rear_left_link")
    ahead = base.path_ahead()
    np.testing.assert_allclose(ahead[:, 0], ahead[:, 1], atol=1e-12)


def test_a_turn_too_sharp_for_the_steering_is_said():
    base = VIEW_KINDS["rolling"].load("ackermann")
    base.command[:] = [8.0, 0.3, 0.0]
    base.preview()
    assert base.study.sentence.startswith("Steering does not turn so sharply.")


def test_a_base_is_put_on_the_ground_wherever_it_is_dragged():
    base = VIEW_KINDS["rolling"].load("omni")
    T = pose_exponential([0.3, -0.2, 0.9, 1.0, -2.0, 0.7])
    base.drag(T)
    np.testing.assert_allclose(base.pose[:2], T[:2, 3])
    np.testing.assert_allclose(base.tip[:3, 2], [0.0, 0.0, 1.0], atol=1e-12)
    assert base.pose[2] == pytest.approx(math.atan2(T[1, 0], T[0, 0]))
    base.set_joint(0, 1.5)
    assert base.pose[0] == 1.5
    base.go_home()
    assert not base.q.any()


@pytest.mark.parametrize(
    "ask",
    [
        lambda base: base.set_joint(0, math.nan),
        lambda base: base.set_joint(1, 99.0),
        lambda base: base.drag(np.full((4, 4), math.nan)),
        lambda base: base.take(0),
        lambda base: base.slide(0.1),
    ],
)
def test_what_it_cannot_do_is_refused_and_it_stays(ask):
    base = VIEW_KINDS["rolling"].load("mecanum")
    with pytest.raises(RobomechError):
        ask(base)
    assert not base.q.any()


def controls_of(page):
    return {handle.label: handle for handle in page._layers[0]._folder._handles
            if hasattr(handle, "label")}  # fmt: skip


@pytest.fixture
def driven():
    """The page of a mecanum base, and a raw client that commands it."""
    pytest.importorskip("viser")
    import msgspec.msgpack
    from raw_client import Client, camera, wait_until

    from robomech_ros.rvs import view

    with view("mecanum", port=0) as page, Client(page).connect() as connection:
        connection.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: page._audience.commander is not None and page._panel is not None)
        yield page, connection


def test_a_browser_drives_the_base_and_lets_it_brake(driven):
    from raw_client import send_value, wait_until

    page, connection = driven
    base, found = page._arm, controls_of(page)
    send_value(connection, found["forward"]._impl.uuid, 0.5)
    wait_until(lambda: base.command[1] == 0.5)
    assert not base.pose.any()
    send_value(connection, found["drive"]._impl.uuid, True)
    wait_until(lambda: base.motion.twist[1] == pytest.approx(0.5) and len(base.trail.points) > 10)
    send_value(connection, found["drive"]._impl.uuid, False)
    wait_until(lambda: base.stands)
    wait_until(lambda: not page._layers[0].moves)
    assert base.pose[0] > 0.0 and abs(base.pose[1]) < 1e-9


@pytest.mark.parametrize("value", [math.nan, "fast", True, [1.0], 1e9, math.inf])
def test_commands_that_are_none_are_refused(driven, value):
    from raw_client import send_value, wait_until

    page, connection = driven
    base, found = page._arm, controls_of(page)
    send_value(connection, found["forward"]._impl.uuid, value)
    send_value(connection, found["drive"]._impl.uuid, value if value is not True else "yes")
    send_value(connection, found["turn"]._impl.uuid, 0.25)
    wait_until(lambda: base.command[0] == 0.25)
    assert base.command[1] == 0.0 and not base.pose.any()


def test_nobody_who_looks_is_nobody_who_drives(driven):
    from raw_client import send_value, wait_until

    page, connection = driven
    base, found = page._arm, controls_of(page)
    send_value(connection, found["forward"]._impl.uuid, 0.3)
    send_value(connection, found["drive"]._impl.uuid, True)
    wait_until(lambda: base.pose[0] > 0.05)
    connection.close()
    wait_until(lambda: base.stands and not page._layers[0].moves)
