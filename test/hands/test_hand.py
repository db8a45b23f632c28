"""A hand: its document, Jacobian, mobility, motion, torques and postures."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from robomech_ros.errors import (
    BadValueError,
    RobotDescriptionError,
    UnknownRobotError,
    WrongSizeError,
)
from robomech_ros.hands import (
    Contact,
    Hand,
    contact_forces,
    finger_accelerations,
    finger_rates,
    finger_torques,
    grasp_matrix,
    grasp_mobility,
    grasp_postures,
    hand_jacobian,
    hand_postures,
    is_force_closed,
    list_hands,
    load_hand,
    object_twist,
    tip_postures,
)
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.spatial import pose_exponential

HAND = load_hand("three_fingered")
ANGLES = 2.0 * np.pi * np.arange(3) / 3.0


def contacts_of(model="point", radius=0.04):
    """Three contacts about an object, in its frame."""
    rim = [np.array([np.cos(a), np.sin(a), 0.0]) for a in ANGLES]
    return [Contact(radius * p, -p, model, 0.6, 0.005) for p in rim]


def lifted(height=0.08):
    T = np.eye(4)
    T[:3, 3] = 0.004, -0.003, height
    return T


def in_palm(contacts, T):
    turned = [(T[:3, :3] @ c.position + T[:3, 3], T[:3, :3] @ c.normal) for c in contacts]
    return [replace(c, position=p, normal=n) for c, (p, n) in zip(contacts, turned, strict=True)]


def grasp(model="point"):
    """A posture of the hand and its contacts in the frame of the palm."""
    T, contacts = lifted(), contacts_of(model)
    q = np.concatenate([found.q[0] for found in grasp_postures(HAND, T, contacts)])
    return q, in_palm(contacts, T)


def test_the_hand_of_the_library():
    assert "three_fingered" in list_hands()
    assert (HAND.n, len(HAND.fingers)) == (9, 3)
    assert HAND.joint_names[:2] == ("finger_1_spread", "finger_1_proximal")


def test_postures_touch_the_contacts_in_all_branches():
    T, contacts = lifted(), contacts_of()
    every = grasp_postures(HAND, T, contacts, respect_limits=False)
    for k, (found, contact) in enumerate(zip(every, in_palm(contacts, T), strict=True)):
        assert len(found.q) == 4
        assert found.complete
        for q in found.q:
            tip = forward_kinematics(HAND.fingers[k], q)[:3, 3]
            assert np.abs(tip - contact.position).max() < 1e-9
    within = grasp_postures(HAND, T, contacts)
    assert all(1 <= len(found.q) < 4 for found in within)


def test_what_is_out_of_reach_is_said_by_finger():
    found = grasp_postures(HAND, lifted(0.5), contacts_of())
    assert all(one.status.name == "OUT_OF_REACH" and one.reason for one in found)


def test_postures_are_sorted_by_the_way_from_the_seed():
    T, seed = lifted(), np.full(9, 0.4)
    every = grasp_postures(HAND, T, contacts_of(), seed=seed, respect_limits=False)
    for found, part in zip(every, HAND.split(seed), strict=True):
        away = np.linalg.norm(found.q - part, axis=1)
        assert (np.diff(away) >= 0.0).all()
    again = tip_postures(
        HAND, [c.position for c in in_palm(contacts_of(), T)], seed=seed, respect_limits=False
    )
    for one, other in zip(every, again, strict=True):
        np.testing.assert_allclose(one.q, other.q, atol=1e-12)


def test_whole_postures_are_all_combinations_the_nearest_first():
    T, seed = lifted(), np.full(9, 0.4)
    found = grasp_postures(HAND, T, contacts_of(), seed=seed, respect_limits=False)
    q, distance = hand_postures(HAND, found, seed=seed)
    assert len(q) == 4**3
    assert len({row.tobytes() for row in np.round(q, 9)}) == 4**3
    np.testing.assert_allclose(np.linalg.norm(q - seed, axis=1), distance)
    assert (np.diff(distance) >= -1e-12).all()
    few, near = hand_postures(HAND, found, seed=seed, most=5)
    np.testing.assert_array_equal(few, q[:5])
    np.testing.assert_array_equal(near, distance[:5])


def test_fingers_without_a_contact_stay_and_one_without_a_posture_leaves_none():
    T, seed = lifted(), np.full(9, 0.4)
    contacts = contacts_of()[:2]
    found = grasp_postures(HAND, T, contacts, fingers=[0, 1], seed=seed)
    q, _ = hand_postures(HAND, found, fingers=[0, 1], seed=seed)
    assert len(q) == len(found[0].q) * len(found[1].q)
    assert (q[:, 6:] == 0.4).all()
    far = grasp_postures(HAND, lifted(0.5), contacts, seed=seed)
    q, distance = hand_postures(HAND, (found[0], far[1]), seed=seed)
    assert q.shape == (0, 9)
    assert distance.shape == (0,)


def test_a_finger_has_one_tip():
    with pytest.raises(BadValueError, match=r"fingers is \[0, 0\], expected each finger once"):
        grasp_postures(HAND, lifted(), contacts_of()[:2], fingers=[0, 0])


@pytest.mark.parametrize("model", ["frictionless", "point", "soft"])
def test_hand_jacobian_is_the_derivative_of_the_contacts(model):
    q, contacts = grasp(model)
    J = hand_jacobian(HAND, q, contacts)
    rng = np.random.default_rng(12)
    rates, h = rng.normal(size=9), 1e-6
    rows = iter(J @ rates)
    ends = [HAND.split(q + s * h * rates) for s in (1.0, -1.0)]
    for k, contact in enumerate(contacts):
        now = forward_kinematics(HAND.fingers[k], HAND.split(q)[k])
        point = np.linalg.solve(now, [*contact.position, 1.0])
        after, before = (forward_kinematics(HAND.fingers[k], end[k]) for end in ends)
        v = ((after - before) @ point)[:3] / (2.0 * h)
        W = (after[:3, :3] - before[:3, :3]) / (2.0 * h) @ now[:3, :3].T
        turning = contact.normal @ [W[2, 1], W[0, 2], W[1, 0]]
        wanted = {"frictionless": [contact.normal @ v], "point": v, "soft": [*v, turning]}[model]
        assert [next(rows) for _ in range(contact.size)] == pytest.approx(wanted, abs=1e-8)


def test_nine_joints_move_an_object_of_six_freedoms():
    """Three point contacts take nine components; three internal forces, all set by torques."""
    q, contacts = grasp()
    found = grasp_mobility(HAND, q, contacts)
    assert found.mobility == 6
    assert found.object_twists.shape == (6, 6)
    assert found.loose_twists.shape == (6, 0)
    assert found.idle_rates.shape == (9, 0)
    assert found.internal_forces.shape == (9, 3)
    assert found.rigid_forces.shape == (9, 0)
    G = grasp_matrix(contacts, np.zeros(3))
    assert np.abs(G @ found.internal_forces).max() < 1e-12


def test_forces_between_contacts_of_one_link_need_no_torque():
    q, contacts = grasp()
    contacts = [*contacts, replace(contacts[0], position=contacts[0].position + [0.0, 0.0, 0.01])]
    owners = [0, 1, 2, 0]
    found = grasp_mobility(HAND, q, contacts, fingers=owners)
    J = hand_jacobian(HAND, q, contacts, fingers=owners)
    G = grasp_matrix(contacts, contacts[0].position)
    assert found.rigid_forces.shape == (12, 1)
    assert np.abs(J.T @ found.rigid_forces).max() < 1e-12
    assert np.abs(G @ found.rigid_forces).max() < 1e-12


def test_twist_and_rates_lead_to_each_other():
    q, contacts = grasp()
    t, o = np.array([0.3, -0.2, 0.5, 0.02, 0.01, -0.03]), np.array([0.01, 0.02, 0.1])
    rates, slip = finger_rates(HAND, q, contacts, t, origin=o)
    assert slip < 1e-12
    back, left = object_twist(HAND, q, contacts, rates, origin=o)
    assert back == pytest.approx(t, abs=1e-12)
    assert left < 1e-12
    np.testing.assert_array_equal(finger_rates(HAND, q, iter(contacts), t, origin=o)[0], rates)
    rates[0] += 0.1
    assert object_twist(HAND, q, contacts, rates)[1] > 1e-4


def followed(t, s):
    """Posture of the hand while the object moves by a constant spatial twist for a time s."""
    T = pose_exponential(s * t) @ lifted()
    found = grasp_postures(HAND, T, contacts_of())
    start = grasp_postures(HAND, lifted(), contacts_of())
    near = []
    for one, first in zip(found, start, strict=True):
        k = int(np.argmin(np.abs(one.q - first.q[0]).max(axis=1)))
        near.append(one.q[k])
    return np.concatenate(near)


def test_accelerations_are_the_second_differences_of_postures():
    """A constant twist about the origin of the palm: its rate there is w x v."""
    q, contacts = grasp()
    t, h = np.array([0.3, -0.2, 0.5, 0.02, 0.01, -0.03]), 3e-4
    rates, _ = finger_rates(HAND, q, contacts, t)
    after, before = followed(t, h), followed(t, -h)
    assert rates == pytest.approx((after - before) / (2 * h), abs=1e-5)
    # The twist of the point of the object at the origin, which moves on with v.
    rate = np.concatenate([np.zeros(3), np.cross(t[:3], t[3:])])
    found, slip = finger_accelerations(HAND, q, rates, contacts, t, rate)
    assert slip < 1e-12
    assert found == pytest.approx((after - 2 * q + before) / h**2, abs=1e-4)


@pytest.mark.parametrize("model", ["point", "soft"])
def test_an_object_that_a_fingertip_carries_gives_back_how_the_finger_moves(model):
    """Twist and its rate are differences of poses of the tip, on random motions."""
    rng, h = np.random.default_rng(30), 1e-4
    for k in (0, 1, 2) * 3:
        q, speed, rate = rng.uniform(0.2, 0.8, 9), np.zeros(9), np.zeros(9)
        own = slice(3 * k, 3 * k + 3)
        speed[own], rate[own] = rng.normal(size=(2, 3))
        chain = HAND.fingers[k]
        start = forward_kinematics(chain, q[own])
        after, before = (
            forward_kinematics(chain, (q + s * h * speed + 0.5 * h * h * rate)[own])
            @ np.linalg.inv(start)
            for s in (1.0, -1.0)
        )
        ends = [Rotation.from_matrix(T[:3, :3]).as_rotvec() for T in (after, before)]
        places = [T[:3, 3] for T in (after, before)]
        t = np.concatenate([ends[0] - ends[1], places[0] - places[1]]) / (2.0 * h)
        td = np.concatenate([ends[0] + ends[1], places[0] + places[1]]) / (h * h)
        touched = [Contact(start[:3, 3], rng.normal(size=3), model, 0.5, 0.01)]
        rates, slip = finger_rates(HAND, q, touched, t, fingers=[k])
        assert rates == pytest.approx(speed, abs=1e-6)
        assert slip < 1e-6
        found, slip = finger_accelerations(HAND, q, rates, touched, t, td, fingers=[k])
        assert found == pytest.approx(rate, abs=1e-4)
        assert slip < 1e-4


def branches_by_search(chain, point, rng):
    """Postures of a finger at a point that a solver finds from random starts, modulo turns."""
    found = []
    for _ in range(60):
        end = least_squares(
            lambda q: forward_kinematics(chain, q)[:3, 3] - point,
            rng.uniform(-np.pi, np.pi, chain.n),
            xtol=1e-14,
            ftol=1e-14,
            gtol=1e-14,
        )
        if np.abs(end.fun).max() < 1e-9:
            near = [np.abs((q - end.x + np.pi) % (2 * np.pi) - np.pi).max() < 1e-4 for q in found]
            if not any(near):
                found.append(end.x)
    return found


@pytest.mark.slow
def test_branches_of_a_finger_are_those_that_an_independent_search_finds():
    rng = np.random.default_rng(31)
    for k, chain in enumerate(HAND.fingers):
        for _ in range(3):
            point = forward_kinematics(chain, rng.uniform(0.2, 0.8, chain.n))[:3, 3]
            (found,) = tip_postures(HAND, point[None], fingers=[k], respect_limits=False)
            searched = branches_by_search(chain, point, rng)
            assert len(found.q) == len(searched)
            for q in searched:
                turned = np.abs((found.q - q + np.pi) % (2 * np.pi) - np.pi)
                assert turned.max(axis=1).min() < 1e-4


def test_soft_fingers_turn_with_the_object():
    q, contacts = grasp("soft")
    t, zero = np.array([0.3, -0.2, 0.5, 0.02, 0.01, -0.03]), np.zeros(6)
    one, two = contacts[:1], contacts
    rates, _ = finger_rates(HAND, q, one, t)
    still, _ = finger_accelerations(HAND, q, 0.0 * rates, one, zero, zero)
    assert np.abs(still).max() < 1e-12
    assert finger_rates(HAND, q, two, t)[1] > 1e-6  # twelve components, nine joints


def test_torques_do_the_power_of_the_load():
    q, contacts = grasp()
    assert is_force_closed(contacts)
    load = np.array([0.01, -0.02, 0.005, 0.3, 0.2, -2.0])
    found = contact_forces(contacts, load)
    torques = finger_torques(HAND, q, contacts, found.components)
    t = np.array([0.3, -0.2, 0.5, 0.02, 0.01, -0.03])
    rates, _ = finger_rates(HAND, q, contacts, t)
    assert torques @ rates == pytest.approx(-load @ t, abs=1e-9)


DOCUMENT = """
kind: hand
name: one
source: of our own
fingers:
  - name: thumb
    joints:
      - {name: a, type: revolute, a: 0.1, b: 0.0, alpha: 0.0, lower: -1.0, upper: 1.0}
"""


def test_documents_by_text_and_path(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(DOCUMENT)
    assert load_hand(path).n == load_hand(str(path)).n == load_hand(DOCUMENT).n == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("kind: hand", "kind: parallel"), "kind: 'parallel', expected hand"),
        (("name: thumb", "nom: thumb"), "unknown key"),
        (("revolute", "spherical"), "type is 'spherical'"),
        (("source: of our own", "source: ''"), "source"),
        (("alpha: 0.0", "alpha: x"), "finger 1.*alpha"),
    ],
)
def test_broken_documents_are_refused(change, message):
    with pytest.raises(RobotDescriptionError, match=message):
        load_hand(DOCUMENT.replace(*change))


def test_two_fingers_share_no_joint():
    chain = HAND.fingers[0]
    with pytest.raises(ValueError, match="finger_1_distal"):
        Hand("twice", (chain, chain), ("a", "b"))


def test_unknown_hands_and_too_many_contacts():
    with pytest.raises(UnknownRobotError, match="three_fingered"):
        load_hand("three_finger")
    q, contacts = grasp()
    with pytest.raises(WrongSizeError, match="number of fingers"):
        hand_jacobian(HAND, q, [*contacts, contacts[0]])
    assert hand_jacobian(HAND, q, [*contacts, contacts[0]], fingers=[0, 1, 2, 0]).shape == (12, 9)
