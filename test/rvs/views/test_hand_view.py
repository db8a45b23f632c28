"""Hands on a page: fingers follow the object that they touch, and what holds a load is said."""

import math
import sys

import numpy as np
import pytest

from robomech_ros.errors import RobomechError
from robomech_ros.hands import grasp_matrix, load_hand
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.rvs.kind_registry import VIEW_KINDS
from robomech_ros.rvs.model.bodies.visual_model import load_visual_model
from robomech_ros.rvs.model.hands.grasp import quality_line, study_grasp
from robomech_ros.rvs.model.hands.hand_view import SHAPES, HandView, HeldObject, Spot
from robomech_ros.spatial import pose_exponential

HAND = "three_fingered"


@pytest.fixture
def hand():
    return VIEW_KINDS["hand"].load(HAND)


def tips(hand):
    """Return the tips of the fingers, by the fingers alone, and check the drawn tree."""
    parts = hand.hand.split(hand.fingers_q)
    own = [forward_kinematics(f, q)[:3, 3] for f, q in zip(hand.hand.fingers, parts, strict=True)]
    links = hand.description.link_poses(hand.positions)
    drawn = [links[finger.tip][:3, 3] for finger in hand.hand.fingers]
    np.testing.assert_allclose(own, drawn, atol=1e-12)
    return np.array(own)


def assert_touches(hand):
    contacts = hand.contacts(hand.reached)
    places = [one.position for one in contacts]
    np.testing.assert_allclose(tips(hand)[list(hand.reached)], places, atol=1e-8)


def test_fingers_touch_the_object_at_first_in_all_their_postures(hand):
    assert hand.reached == (0, 1, 2) and hand.faulty_links == ()
    assert hand.study.sentence == "8 postures touch the object so; these are all."
    assert_touches(hand)
    for number in range(8):
        hand.take(number)
        assert_touches(hand)
        assert hand.study.postures[number].is_here
        assert sum(posture.is_here for posture in hand.study.postures) == 1


@pytest.mark.parametrize("shape", SHAPES)
def test_fingers_follow_an_object_that_is_moved_and_turned(hand, shape):
    hand.held = HeldObject(shape, hand.held.size)
    hand.touch()
    home = hand.tip
    for k in range(20):
        s = k / 19
        T = pose_exponential([0.1 * s, -0.05 * s, 0.15 * s, 0.005 * s, -0.005 * s, 0.01 * s])
        T[:3, 3] += home[:3, 3]
        before = hand.fingers_q
        hand.drag(T)
        np.testing.assert_allclose(hand.tip, T, atol=1e-12)
        assert hand.reached == (0, 1, 2)
        assert_touches(hand)
        assert np.abs(hand.fingers_q - before).max() < 0.5
    hand.go_home()
    np.testing.assert_allclose(hand.tip, home)


@pytest.mark.parametrize("shape", SHAPES)
def test_contacts_are_on_the_surface_and_press_into_it(shape):
    held = HeldObject(shape, 0.05)
    vertices = held.solid.vertices
    for angle in np.linspace(-math.pi, math.pi, 13):
        for height in (-0.9, 0.0, 0.5):
            place, normal = held.touched(float(angle), height)
            assert np.linalg.norm(normal) == pytest.approx(1.0)
            # A convex body is behind each of its tangent planes.
            assert ((vertices - place) @ normal).min() > -1e-9
            assert math.remainder(math.atan2(place[1], place[0]) - angle, 2 * math.pi) < 1e-9


def test_a_finger_that_does_not_reach_is_named_with_the_reason(hand):
    T = hand.tip
    T[0, 3] += 0.03
    hand.drag(T)
    assert hand.reached == (0,)
    assert "finger_2: " in hand.study.sentence and "joint 'finger_2_spread'" in hand.study.sentence
    assert "finger_3_proximal_link" in hand.faulty_links
    assert not any(link.startswith("finger_1") for link in hand.faulty_links)
    assert hand.study.postures == ()
    T[0, 3] = 0.15
    hand.drag(T)
    assert hand.reached == () and "out of reach" in hand.study.sentence
    assert study_grasp(hand.grasp).lines == (("closure", "no finger touches the object"),)
    hand.go_home()
    assert hand.reached == (0, 1, 2)


def test_forces_hold_the_load_inside_their_cones_and_are_as_golden(hand):
    hand.spots = [Spot(True, angle) for angle in 2.0 * np.pi * np.arange(3) / 3]
    hand.touch()
    study = study_grasp(hand.grasp)
    texts = dict(study.lines)
    assert texts["closure"] == "force closed: every load is held"
    # Each finger bears a third of 2 N by friction 0.6, and what that takes of normal force.
    assert np.linalg.norm(study.forces, axis=1) == pytest.approx(np.hypot(2 / 3, 2 / 1.8), abs=1e-6)
    assert "1.296 N at most, 3.333 N of normal forces in all" in texts["forces"]
    assert "all of its friction" in texts["finger_1"]
    contacts, load = hand.grasp.contacts, hand.load
    G = grasp_matrix(contacts, hand.tip[:3, 3])
    np.testing.assert_allclose(G @ study.forces.ravel(), -load, atol=1e-8)
    name, text = quality_line(hand.grasp)
    lower, upper = (float(part) for part in text.split(" N in")[0].split(" to "))
    assert name == "quality" and lower - 1e-3 <= 0.3464 <= upper + 1e-3


def test_efforts_are_those_of_the_jacobian_and_too_much_is_said(hand):
    hand.load[3:] = [0.0, 0.0, -40.0]
    texts = dict(study_grasp(hand.grasp).lines)
    assert "too much" in texts["finger_1"] and "of 1 N m at finger_1_" in texts["finger_1"]


def test_a_load_that_is_not_held_is_told_with_what_separates(hand):
    hand.spots[1] = Spot(False, 0.0)
    hand.touch()
    hand.load[:] = [0.0, 0.1, 0.0, 0.0, 0.0, -2.0]
    study = study_grasp(hand.grasp)
    s = study.separating
    assert dict(study.lines)["forces"].startswith("not held: the contacts exert nothing along")
    assert s @ hand.load < 0.0
    wrenches = grasp_matrix(hand.grasp.contacts, hand.tip[:3, 3])
    for one, block in zip(hand.grasp.contacts, np.hsplit(wrenches, 2), strict=True):
        # The greatest of s . w over the cone is along the normal and across.
        along = block.T @ s
        normal = float(one.normal @ along)
        across = float(np.linalg.norm(along - normal * one.normal))
        assert normal + hand.friction * across < 1e-6
    assert quality_line(hand.grasp) == ("quality", "0")


def test_without_the_solver_its_text_stands_for_the_forces(hand, monkeypatch):
    monkeypatch.setitem(sys.modules, "clarabel", None)
    texts = dict(study_grasp(hand.grasp).lines)
    assert "pip install 'robomech_ros[hands]'" in texts["forces"]
    assert texts["closure"] == "force closed: every load is held"


def test_no_finger_is_asked_to_touch(hand):
    before = hand.fingers_q
    hand.spots = [Spot(False, 0.0)] * 3
    hand.touch()
    assert hand.reached == () and hand.study.postures == ()
    np.testing.assert_array_equal(hand.fingers_q, before)


@pytest.mark.parametrize(
    "ask",
    [
        lambda hand: hand.set_joint(0, math.nan),
        lambda hand: hand.set_joint(1, 99.0),
        lambda hand: hand.drag(np.full((4, 4), math.nan)),
        lambda hand: hand.take(8),
        lambda hand: hand.slide(0.1),
    ],
)
def test_what_it_cannot_do_is_refused_and_it_stays(hand, ask):
    before = hand.q
    with pytest.raises(RobomechError):
        ask(hand)
    np.testing.assert_array_equal(hand.q, before)


def test_ghosts_are_the_fingers_in_each_posture(hand):
    ghosts = hand.ghosts(load_visual_model(hand.description))
    postures = [posture.q for posture in hand.study.postures]
    pieces = ghosts.placed(postures, [(k, 0, 0) for k in range(8)])
    assert len(pieces.positions) == 8 * ghosts.pieces
    np.testing.assert_array_equal(pieces.colours[:: ghosts.pieces, 0], range(8))
    middles = ghosts.middles(postures)
    assert len({tuple(row) for row in middles.round(6).tolist()}) == 8


def test_any_hand_of_the_library_is_seen():
    from robomech_ros.hands import list_hands

    for name in list_hands():
        found = HandView(load_hand(name))
        assert found.study.postures


def controls_of(page):
    """The controls of a page of a hand, by their labels."""
    layer = page._layers[0]
    handles = [*layer._folder._handles, *layer._contacts._handles]
    return {handle.label: handle for handle in handles if hasattr(handle, "label")}


@pytest.fixture
def held():
    """The page of a hand, and a raw client that commands it."""
    pytest.importorskip("viser")
    import msgspec.msgpack
    from raw_client import Client, camera, wait_until

    from robomech_ros.rvs import view

    with view(HAND, port=0) as page, Client(page).connect() as connection:
        connection.send(msgspec.msgpack.encode(camera()))
        wait_until(lambda: page._audience.commander is not None and page._panel is not None)
        wait_until(lambda: page._layers[0].is_open)
        yield page, connection


def test_a_browser_changes_object_contacts_and_load(held):
    from raw_client import send_value, wait_until

    page, connection = held
    hand, found = page._arm, controls_of(page)
    given = {
        "shape": "cylinder",
        "size": 0.03,
        "contacts": "soft",
        "friction": 0.3,
        "torsional": 0.02,
        "force": [0.5, 0.0, -1.0],
        "moment": [0.0, 0.0, 0.01],
        "finger_1 angle": 0.1,
        "finger_1 height": -0.2,
        "finger_2 touches": False,
        "cones": False,
    }
    for label, value in given.items():
        send_value(connection, found[label]._impl.uuid, value)
    wait_until(lambda: not page._layers[0].on["cones"])
    assert hand.held == HeldObject("cylinder", 0.03)
    assert (hand.model, hand.friction, hand.torsional) == ("soft", 0.3, 0.02)
    assert hand.load.tolist() == [0.0, 0.0, 0.01, 0.5, 0.0, -1.0]
    assert hand.spots[0] == Spot(True, 0.1, -0.2) and not hand.spots[1].touches
    assert hand.reached == (0, 2)
    table = page._layers[0]._table
    wait_until(lambda: "closure" in table.content and "looking" not in table.content)


@pytest.mark.parametrize("value", [math.nan, "many", [1.0, 2.0], 1e9, math.inf, None])
def test_values_that_are_none_are_refused(held, value):
    from raw_client import send_value, wait_until

    page, connection = held
    hand, found = page._arm, controls_of(page)
    before = (hand.state, page._layers[0].on.copy())
    labels = ("shape", "size", "contacts", "friction", "force", "finger_1 angle", "cones")
    for label in labels:
        send_value(connection, found[label]._impl.uuid, value)
    assert (hand.state, page._layers[0].on) == before
    send_value(connection, found["finger_3 height"]._impl.uuid, 0.25)
    wait_until(lambda: hand.spots[2].height == 0.25)
    first = VIEW_KINDS["hand"].load(HAND)
    assert hand.spots[:2] == first.spots[:2] and hand.held == first.held
    assert hand.friction == 0.6 and hand.model == "point"
