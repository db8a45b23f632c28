"""Walking machines on a page: they walk, and are posed over their feet; also by raw clients."""

import math

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, RobomechError, RobotDescriptionError
from robomech_ros.robots import load_description
from robomech_ros.rvs.kind_registry import VIEW_KINDS
from robomech_ros.rvs.model.running.observed_robot import observed_walker
from robomech_ros.rvs.model.walking.placed_tree import BODY_JOINTS, placed_tree, placing
from robomech_ros.rvs.model.walking.support import Support
from robomech_ros.rvs.model.walking.walker_view import WalkerView
from robomech_ros.spatial import pose_exponential
from robomech_ros.walking import LeggedRobot, list_legged, load_legged, stability_margin

ROBOTS = list_legged()


def feet_seen(walker):
    """Return the positions of the feet in the drawn tree."""
    poses = walker.description.link_poses(walker.positions)
    return np.array([poses[f"{leg}_foot"][:3, 3] for leg in walker.robot.leg_names])


def settled(walker, most=4000):
    for _ in range(most):
        walker.drive(1, brake=True)
        if walker.stands:
            return walker
    raise AssertionError("it never stands")


@pytest.mark.parametrize("name", ROBOTS)
def test_a_machine_walks_on_feet_that_stay_and_leaves_a_trail(name):
    walker = VIEW_KINDS["walking"].load(name)
    np.testing.assert_allclose(feet_seen(walker)[:, 2], 0.0, atol=1e-3)
    walker.command[:] = [0.0, 0.5 * walker.most[1], 0.0]
    lifted = set()
    for _ in range(round(1.1 * walker._walker.cycle / walker.period)):
        before, feet = walker.support, feet_seen(walker)
        walker.drive(1)
        after = walker.support
        stayed = before.contacts & after.contacts
        np.testing.assert_allclose(feet_seen(walker)[stayed], feet[stayed], atol=1e-9)
        np.testing.assert_allclose(feet_seen(walker), after.feet, atol=1e-9)
        margin = stability_margin(after.centre, after.feet[after.contacts, :2])
        assert margin >= walker.bound - 1e-9
        lifted |= set(np.flatnonzero(~after.contacts).tolist())
    assert lifted == set(range(len(walker.robot.legs)))
    assert walker.study.sentence.startswith("Walks on ") and not walker.stands
    trail = walker.trail.points
    assert len(trail) > 2 and (np.diff(trail[:, 0]) > 0.0).all()
    np.testing.assert_allclose(walker.path_ahead()[0, :2], [walker.positions["base_x"], 0.0])
    settled(walker)
    assert walker.support.contacts.all() and walker.study.sentence.startswith("Stands on ")
    walker.trail.clear()
    assert len(walker.trail.points) == 0


@pytest.mark.parametrize("name", ROBOTS)
def test_what_is_told_of_the_margin_is_what_the_walk_keeps(name):
    walker = VIEW_KINDS["walking"].load(name)
    walker.command[1] = 0.5 * walker.most[1]
    for _ in range(300):
        walker.drive(1)
        assert walker.support.margin == pytest.approx(walker._update.margin, abs=1e-9)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_trunk_moves_over_feet_that_stay(name):
    walker = VIEW_KINDS["walking"].load(name)
    feet = feet_seen(walker)
    walker.set_joint(2, 0.01)
    walker.set_joint(5, 0.05)
    settled(walker)
    assert walker.values[[2, 5]].tolist() == [0.01, 0.05]
    at = walker.positions
    assert at["body_z"] == pytest.approx(0.01) and at["body_yaw"] == pytest.approx(0.05)
    np.testing.assert_allclose(feet_seen(walker), feet, atol=1e-6)
    T = walker.tip @ pose_exponential([0.02, 0.0, 0.0, 0.01, 0.0, 0.0])
    walker.drag(T)
    settled(walker)
    np.testing.assert_allclose(walker.tip, T, atol=1e-9)
    walker.go_home()
    assert not walker.values.any() and walker.tip[0, 3] == 0.0


def test_a_pose_that_a_leg_cannot_follow_is_refused_with_leg_and_joint():
    walker = VIEW_KINDS["walking"].load("phantomx")
    before = walker.positions
    with pytest.raises(BadValueError, match="body_roll' is 0.3, expected one with which no leg"):
        walker.set_joint(3, 0.3)
    sentence = walker.study.sentence
    assert "of leg 'RM'" in sentence and "limits" in sentence
    assert walker.faulty_links == ("RM_coxa_link", "RM_femur_link", "RM_tibia_link")
    settled(walker)
    assert walker.positions == before and not walker.values.any()
    walker.set_joint(3, 0.05)
    assert not walker.faulty_links and walker.study.sentence.startswith("Stands on 6 feet")


def test_a_drag_that_would_tip_it_moves_nothing_and_says_so():
    walker = VIEW_KINDS["walking"].load("go1")
    T = walker.tip.copy()
    T[0, 3] += 0.15
    walker.drag(T)
    assert walker.study.sentence.startswith("The mass centre would move")
    assert walker.stands and walker.tip[0, 3] == 0.0


def test_the_gait_changes_once_it_stands():
    walker = VIEW_KINDS["walking"].load("phantomx")
    assert walker.gaits == ("wave", "ripple", "tripod")
    walker.command[1] = 0.05
    walker.drive(200)
    walker.choose_gait("wave")
    assert (walker.gait, walker.chosen_gait) == ("tripod", "wave")
    for _ in range(2000):
        walker.drive(1)
        if walker.gait == "wave":
            break
    walker.drive(500)
    assert int((~walker.support.contacts).sum()) <= 1
    with pytest.raises(BadValueError, match="trot"):
        walker.choose_gait("trot")


@pytest.mark.parametrize(
    "ask",
    [
        lambda walker: walker.set_joint(0, math.nan),
        lambda walker: walker.set_joint(1, 99.0),
        lambda walker: walker.drag(np.full((4, 4), math.nan)),
        lambda walker: walker.choose_gait("gallop"),
        lambda walker: walker.take(0),
    ],
)
def test_what_it_cannot_do_is_refused_and_it_stays(ask):
    walker = VIEW_KINDS["walking"].load("go1")
    before = walker.positions
    with pytest.raises(RobomechError):
        ask(walker)
    assert walker.positions == before and walker.stands


def test_the_nearest_edge_of_a_support():
    feet = np.array([[0.2, 0.1, 0.0], [0.2, -0.1, 0.0], [-0.2, 0.1, 0.0], [-0.2, -0.1, 0.03]])
    support = Support(("a", "b", "c", "d"), feet, np.array([True, True, True, False]), np.zeros(2))
    assert len(support.corners) == 3 and set(support.edge) == {"b", "c"}
    way = support.shortest_path()
    assert np.linalg.norm(way[1] - way[0]) == pytest.approx(abs(support.margin), abs=1e-12)
    apart = Support(support.legs, feet, support.contacts, np.array([0.0, 0.4]))
    assert apart.margin == pytest.approx(-0.3) and set(apart.edge) == {"a", "c"}
    line = Support(support.legs, feet, np.array([True, False, True, False]), np.array([0.0, 0.0]))
    assert line.margin == pytest.approx(-0.1) and line.border().shape == (3, 3)
    np.testing.assert_allclose(line.shortest_path()[1, :2], [0.0, 0.1])


def test_a_trunk_that_is_not_the_root_is_placed_all_the_same():
    robot = load_legged("phantomx")
    text = robot.description.document.replace(
        "</robot>",
        '<link name="case"/><joint name="mount" type="fixed"><parent link="case"/>'
        '<child link="base_link"/><origin xyz="0.1 0.2 0.3" rpy="0 0 0.5"/></joint></robot>',
    )
    tree = placed_tree(load_description(text), "base_link", 0.12)
    T = pose_exponential([0.1, -0.2, 0.3, 1.0, 2.0, 0.1])
    place = placing(np.array([0.7, -0.4, 2.0]), T, 0.12)
    np.testing.assert_allclose(tree.link_poses(place)["base_link"], T, atol=1e-12)


def test_a_machine_whose_links_have_names_of_those_that_place_it_is_refused():
    robot = load_legged("go1")
    text = robot.description.document.replace('"trunk"', '"odom"')
    feet = {leg: f"{leg}_foot" for leg in robot.leg_names}
    other = LeggedRobot.from_description(
        load_description(text), feet, trunk="odom", home=robot.home
    )
    with pytest.raises(RobotDescriptionError, match="odom"):
        WalkerView(other)


def controls_of(layer):
    return {handle.label: handle for handle in layer._folder._handles if hasattr(handle, "label")}


@pytest.fixture
def walked():
    """The page of a hexapod, and a raw client that commands it."""
    pytest.importorskip("viser")
    import msgspec.msgpack
    from raw_client import Client, camera, wait_until

    from robomech_ros.rvs import view

    with view("phantomx", port=0) as page, Client(page).connect() as connection:
        connection.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: page._audience.commander is not None and page._panel is not None)
        yield page, connection


def test_a_browser_has_it_walk_and_stop(walked):
    from raw_client import send_value, wait_until

    page, connection = walked
    walker, found = page._arm, controls_of(page._layers[0])
    send_value(connection, found["forward"]._impl.uuid, 0.08)
    wait_until(lambda: walker.command[1] == 0.08)
    assert walker.stands
    send_value(connection, found["walk"]._impl.uuid, True)
    wait_until(lambda: walker.positions["base_x"] > 0.03 and len(walker.trail.points) > 2)
    send_value(connection, found["walk"]._impl.uuid, False)
    wait_until(lambda: walker.stands and not page._layers[0].moves)
    assert walker.support.contacts.all()


def test_a_browser_poses_the_trunk_and_hears_why_not(walked):
    from raw_client import send_value, slider, wait_until

    page, connection = walked
    walker = page._arm
    send_value(connection, slider(page, BODY_JOINTS.index("body_z")), 0.02)
    wait_until(lambda: walker.positions["body_z"] == pytest.approx(0.02))
    wait_until(lambda: not page._layers[0].moves)
    roll = BODY_JOINTS.index("body_roll")
    send_value(connection, slider(page, roll), 0.5)
    wait_until(lambda: "tibia" in page._stage._summary.content)
    wait_until(lambda: page._panel._sliders[roll].value == 0.0)
    assert walker.positions["body_roll"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("value", [math.nan, "fast", True, [1.0], 1e9])
def test_commands_that_are_none_are_refused(walked, value):
    from raw_client import send_value, wait_until

    page, connection = walked
    walker = page._arm
    found = controls_of(page._layers[0]) | controls_of(page._layers[1])
    send_value(connection, found["forward"]._impl.uuid, value)
    send_value(connection, found["gait"]._impl.uuid, value)
    send_value(connection, found["walk"]._impl.uuid, value if value is not True else "yes")
    send_value(connection, found["support polygon"]._impl.uuid, value if value is not True else 2)
    send_value(connection, found["turn"]._impl.uuid, 0.1)
    wait_until(lambda: walker.command[0] == 0.1)
    assert walker.command[1] == 0.0 and walker.stands and walker.gait == "tripod"
    assert page._layers[1]._switches["support polygon"]


def test_the_gait_of_a_browser_is_taken_up_and_the_polygon_hidden(walked):
    from raw_client import send_value, wait_until

    page, connection = walked
    found = controls_of(page._layers[1])
    send_value(connection, found["gait"]._impl.uuid, "ripple")
    wait_until(lambda: page._arm.gait == "ripple" and not page._layers[0].moves)
    send_value(connection, found["support polygon"]._impl.uuid, False)
    wait_until(lambda: page._layers[1]._nodes._feet is None)
    send_value(connection, found["support polygon"]._impl.uuid, True)
    wait_until(lambda: page._layers[1]._nodes._feet is not None)


def test_nobody_who_looks_is_nobody_who_walks(walked):
    from raw_client import send_value, wait_until

    page, connection = walked
    walker, found = page._arm, controls_of(page._layers[0])
    send_value(connection, found["turn"]._impl.uuid, 0.2)
    send_value(connection, found["walk"]._impl.uuid, True)
    wait_until(lambda: walker.positions["base_heading"] > 0.02)
    connection.close()
    wait_until(lambda: walker.stands and not page._layers[0].moves)


def test_a_machine_that_runs_has_the_sliders_of_its_trunk():
    shifts = observed_walker(load_legged("go1")).shifts
    assert [shift.name for shift in shifts[2:4]] == ["body z", "body roll"]
    assert [shift.unit for shift in shifts] == 3 * ["m"] + 3 * ["rad"]
    assert all(0.1 < shift.most < 1.0 for shift in shifts)
