"""The node of hands: its answers against the library and known grasps, and what it refuses."""

import math
import sys
import threading

import numpy as np
import pytest
from geometry_msgs.msg import Point, PoseStamped, Vector3, Wrench
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import AnalyzeGrasp, ContactForces, SolveGrasp
from robomech_ros.errors import UnknownRobotError
from robomech_ros.hands import (
    Contact,
    contact_forces,
    finger_torques,
    grasp_matrix,
    grasp_mobility,
    grasp_postures,
    hand_jacobian,
    load_hand,
)
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.grasping import node as grasping_node
from robomech_ros.nodes.grasping.node import GraspingNode

HAND = load_hand("three_fingered")
ANGLES = 2.0 * np.pi * np.arange(3) / 3.0
EQUATOR = np.stack([np.cos(ANGLES), np.sin(ANGLES), 0.0 * ANGLES], axis=1)
CUBE = np.vstack([np.eye(3), -np.eye(3)])
TETRAHEDRON = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3.0)
PAIR = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
LIFTED = np.array([0.004, -0.003, 0.08])
FORCE_FIRST = [3, 4, 5, 0, 1, 2]


def requested(kind, points, model="point", friction=0.5, torsional=0.0, **more):
    """A request about contacts that press towards the origin."""
    return kind.Request(
        positions=[Point(x=x, y=y, z=z) for x, y, z in np.asarray(points).tolist()],
        normals=[Vector3(x=-x, y=-y, z=-z) for x, y, z in np.asarray(points).tolist()],
        models=[model],
        friction=[friction],
        torsional=[torsional],
        **more,
    )


def loaded(force=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0)):
    wrench = Wrench()
    wrench.force.x, wrench.force.y, wrench.force.z = map(float, force)
    wrench.torque.x, wrench.torque.y, wrench.torque.z = map(float, torque)
    return wrench


def six(stamped):
    """A wrench, force first."""
    force, torque = stamped.wrench.force, stamped.wrench.torque
    return np.array([force.x, force.y, force.z, torque.x, torque.y, torque.z])


def rows(numbers, count):
    return np.reshape(numbers, (count, -1))


@pytest.fixture
def ask(shared):
    """Ask a node that has the hand of three fingers."""
    graph = shared(GraspingNode, robot_description="three_fingered")

    def call(kind, name, request):
        return graph.call(kind, f"grasping/{name}", request)

    return call


@pytest.fixture
def analyze(ask):
    return lambda request: ask(AnalyzeGrasp, "analyze_grasp", request)


@pytest.fixture
def hold(ask):
    return lambda request: ask(ContactForces, "contact_forces", request)


@pytest.fixture
def solve(ask):
    return lambda request: ask(SolveGrasp, "solve_grasp", request)


def test_1_qualities_of_known_grasps(analyze):
    for points, model, friction, low, high in (
        (CUBE, "point", 0.5, 0.5 * math.sqrt(2.0 / 3.0), 0.5 * math.sqrt(2.0 / 3.0)),
        (TETRAHEDRON, "point", 0.5, 0.5 / math.sqrt(2.0) - 2e-5, 0.5 / math.sqrt(2.0) + 2e-5),
        (CUBE, "point", 0.9, 0.9 * math.sqrt(2.0 / 3.0), 0.9 * math.sqrt(2.0 / 3.0)),
        (EQUATOR, "point", 0.3, 0.165250, 0.165287),
        (EQUATOR, "point", 1.0, 0.577326, 0.577391),
    ):
        answer = analyze(requested(AnalyzeGrasp, points, model, friction, length=1.0))
        assert (answer.error_code, answer.force_closed, answer.certified) == (0, True, True)
        assert answer.quality_lower <= high + 1e-9
        assert answer.quality_upper >= low - 1e-9
        assert answer.quality_upper - answer.quality_lower <= 1e-4
        assert answer.summary.startswith("force closed: every load is held; quality 0.")


@pytest.mark.parametrize(("model", "torsional"), [("point", 0.0), ("soft", 0.3)])
def test_2_the_order_and_the_frame_of_contacts_do_not_matter(analyze, model, torsional):
    once = analyze(requested(AnalyzeGrasp, CUBE, model, 0.4, torsional, length=1.0))
    turn = np.array([[0.0, -1.0, 0.0], [0.6, 0.0, -0.8], [0.8, 0.0, 0.6]])
    request = requested(AnalyzeGrasp, CUBE[::-1] @ turn.T, model, 0.4, torsional, length=1.0)
    again = analyze(request)
    assert again.quality_lower <= once.quality_upper
    assert once.quality_lower <= again.quality_upper


def test_3_the_length_is_said_and_counts(analyze):
    whole = analyze(requested(AnalyzeGrasp, CUBE, length=1.0))
    free = analyze(requested(AnalyzeGrasp, CUBE))
    # The farthest contact is 1 m from the origin.
    assert (whole.length, free.length) == (1.0, 1.0)
    longer = analyze(requested(AnalyzeGrasp, CUBE, length=4.0))
    assert longer.length == 4.0
    assert longer.quality_upper < whole.quality_lower


@pytest.mark.parametrize(
    ("model", "friction", "torsional", "closed"),
    [("frictionless", 0.5, 0.1, False), ("point", 0.5, 0.0, False), ("soft", 0.5, 0.1, True)],
)
def test_4_and_8_of_opposed_contacts_only_soft_ones_close(
    analyze, model, friction, torsional, closed
):
    answer = analyze(requested(AnalyzeGrasp, PAIR, model, friction, torsional))
    assert (answer.error_code, answer.force_closed, answer.form_closed) == (0, closed, False)
    assert (answer.quality_lower > 1e-3) == closed
    assert answer.summary.startswith("force closed" if closed else "not closed: some loads")
    assert np.any(six(answer.weakest)) == closed


def test_7_normals_close_a_cube_only_with_more_contacts(analyze):
    corners = np.array([[1, 1, 0], [-1, 1, 0], [0, 1, 1], [0, -1, 0.5], [1, 0, 0.3], [-1, 0, 0.7]])
    assert not analyze(requested(AnalyzeGrasp, CUBE, "frictionless")).form_closed
    request = requested(AnalyzeGrasp, np.vstack([CUBE, 0.7 * corners]), "frictionless")
    rng = np.random.default_rng(0)
    for one in request.normals:
        one.x, one.y, one.z = (np.array([one.x, one.y, one.z]) + 0.4 * rng.normal(size=3)).tolist()
    answer = analyze(request)
    assert (answer.form_closed, answer.force_closed) == (True, True)


@pytest.mark.parametrize(("model", "size"), [("frictionless", 1), ("point", 3), ("soft", 4)])
def test_5_matrices_have_forces_first_and_internal_forces_no_wrench(analyze, model, size):
    origin = np.array([0.1, 0.2, -0.3])
    request = requested(AnalyzeGrasp, EQUATOR, model, 0.5, 0.1)
    request.origin.x, request.origin.y, request.origin.z = origin.tolist()
    answer = analyze(request)
    contacts = [Contact(p, -p, model, 0.5, 0.1) for p in EQUATOR]
    G = rows(answer.grasp_matrix, 6)
    assert G.shape == (6, answer.force_components) == (6, 3 * size)
    np.testing.assert_allclose(G, grasp_matrix(contacts, origin)[FORCE_FIRST], atol=1e-15)
    inner = np.reshape(answer.internal_forces, (answer.force_components, answer.internal_count))
    assert np.abs(G @ inner).max(initial=0.0) < 1e-12
    assert answer.rank == np.linalg.matrix_rank(G)


@pytest.mark.parametrize(
    ("model", "points", "torsional"),
    [("point", TETRAHEDRON, 0.0), ("soft", PAIR, 0.2), ("soft", EQUATOR, 0.2)],
)
@pytest.mark.parametrize("smallest", [0, 1])
def test_6_forces_are_in_the_cones_and_balance(hold, model, points, torsional, smallest):
    load = loaded((0.3, -0.2, -1.0), (0.05, 0.02, 0.0))
    request = requested(ContactForces, points, model, 0.6, torsional, wrench=load)
    request.smallest = smallest
    answer = hold(request)
    assert (answer.error_code, answer.error_msg) == (0, "")
    total = np.array([0.3, -0.2, -1.0, 0.05, 0.02, 0.0])
    for p, force, torsion in zip(points, answer.forces, answer.torsions, strict=True):
        f = np.array([force.x, force.y, force.z])
        normal = float(f @ -p)
        across = np.linalg.norm(f + normal * p)
        share = across / 0.6
        if torsional:
            share = math.hypot(share, torsion / torsional)
        assert share <= normal * (1.0 + 1e-7) + 1e-7
        total += np.concatenate([f, np.cross(p, f) - torsion * p])
    assert np.abs(total).max() < 1e-9
    sizes = [np.linalg.norm([f.x, f.y, f.z]) for f in answer.forces]
    assert answer.largest == pytest.approx(max(sizes), abs=1e-12)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_6_discs_hold_loads_in_their_plane_as_the_library_says(hold, count):
    """Forces out of the plane hold nothing of such a load, and make forces larger."""
    angles = 2.0 * np.pi * np.arange(count) / count
    rim = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    disc = [Contact(p, -p, "point", 0.5) for p in rim]
    points = np.hstack([rim, np.zeros((count, 1))])
    for torque, x, y in ((0.0, 0.0, -1.0), (0.2, 0.3, 0.1), (-0.3, 0.0, 0.0)):
        load = loaded((x, y, 0.0), (0.0, 0.0, torque))
        for number, smallest in enumerate(("largest", "total")):
            request = requested(ContactForces, points, "point", 0.5, wrench=load)
            request.smallest = number
            answer = hold(request)
            wanted = contact_forces(disc, [torque, x, y], smallest=smallest)
            assert answer.error_code == 0
            assert getattr(answer, smallest) == pytest.approx(getattr(wanted, smallest), abs=1e-6)


@pytest.mark.parametrize("model", ["frictionless", "point"])
def test_7_a_load_that_cannot_be_held_gets_the_wrench_that_separates(hold, model):
    request = requested(ContactForces, PAIR, model, 0.5)
    request.wrench = loaded(torque=(0.3, 0.0, 0.0))
    request.frame_id = "camera"
    answer = hold(request)
    assert answer.error_code == ErrorCode.LOAD_NOT_HELD
    assert answer.error_msg.startswith("no forces inside the friction cones hold this load")
    assert answer.separating_wrench.header.frame_id == "camera"
    s = six(answer.separating_wrench)
    assert s @ [0.0, 0.0, 0.0, 0.3, 0.0, 0.0] < -1e-3
    rng = np.random.default_rng(0)
    for p in PAIR:
        across = rng.normal(size=(200, 3)) * [0.0, 1.0, 1.0]
        across *= 0.5 / np.linalg.norm(across, axis=1)[:, None]
        forces = -p + (0.0 if model == "frictionless" else 1.0) * across
        wrenches = np.hstack([forces, np.cross(p, forces)])
        assert (wrenches @ s).max() < 1e-7
    assert not answer.forces


def test_8_a_soft_pair_holds_a_moment_about_its_normals_and_a_point_pair_does_not(hold):
    twist = loaded(torque=(0.1, 0.0, 0.0))
    soft = hold(requested(ContactForces, PAIR, "soft", 0.5, 0.2, wrench=twist))
    assert soft.error_code == 0
    assert soft.torsions[1] - soft.torsions[0] == pytest.approx(-0.1, abs=1e-9)
    point = hold(requested(ContactForces, PAIR, "point", 0.5, wrench=twist))
    assert point.error_code == ErrorCode.LOAD_NOT_HELD


def posture():
    """A posture of the hand and its contacts, in the frame of the palm."""
    T = np.eye(4)
    T[:3, 3] = LIFTED
    contacts = [Contact(0.04 * p, -p, "point", 0.6) for p in EQUATOR]
    q = np.concatenate([found.q[0] for found in grasp_postures(HAND, T, contacts)])
    return q, [Contact(0.04 * p + LIFTED, -p, "point", 0.6) for p in EQUATOR]


def of_hand(kind, contacts, q, **more):
    request = requested(kind, EQUATOR, "point", 0.6, **more)
    request.positions = [Point(x=x, y=y, z=z) for x, y, z in (c.position for c in contacts)]
    request.state = JointState(position=q.tolist())
    return request


def test_with_a_state_the_answer_says_what_moves(analyze):
    q, contacts = posture()
    answer = analyze(of_hand(AnalyzeGrasp, contacts, q))
    found = grasp_mobility(HAND, q, contacts)
    assert (answer.error_code, answer.mobility) == (0, found.mobility)
    assert answer.joint_names == list(HAND.joint_names)
    J = rows(answer.hand_jacobian, answer.force_components)
    np.testing.assert_allclose(J, hand_jacobian(HAND, q, contacts), atol=1e-12)
    assert len(answer.object_twists) == found.object_twists.shape[1] == 6
    assert len(answer.loose_twists) == found.loose_twists.shape[1] == 0
    first = answer.object_twists[0].angular
    np.testing.assert_allclose([first.x, first.y, first.z], found.object_twists[:3, 0], atol=1e-12)
    assert "mobility 6: the object moves in 6 directions" in answer.summary
    assert answer.weakest.header.frame_id == "palm"


def test_with_a_state_the_answer_has_the_efforts_and_who_is_overloaded(hold):
    q, contacts = posture()
    names = HAND.joint_names[::-1]
    loads = ((0.0, 0.0, -2.0), False), ((0.0, 0.0, -200.0), True), ((-200.0, 0.0, 0.0), True)
    for force, overloaded in loads:
        request = of_hand(ContactForces, contacts, q, wrench=loaded(force))
        request.state = JointState(name=list(names), position=q[::-1].tolist())
        answer = hold(request)
        assert (answer.error_code, answer.error_msg) == (0, "")
        components = np.concatenate([[f.x, f.y, f.z] for f in answer.forces])
        np.testing.assert_allclose(answer.efforts, finger_torques(HAND, q, contacts, components))
        assert bool(answer.overloaded_joints) == overloaded
        over = np.abs(answer.efforts) > np.concatenate([one.effort for one in HAND.fingers])
        assert answer.overloaded_joints == [HAND.joint_names[k] for k in np.flatnonzero(over)]


def pose_of(T):
    message = PoseStamped()
    message.pose.position.x, message.pose.position.y, message.pose.position.z = T.tolist()
    message.pose.orientation.w = 1.0
    return message


def touching(where=LIFTED, **more):
    points = (0.04 * EQUATOR).tolist()
    request = SolveGrasp.Request(object_pose=pose_of(where), **more)
    request.positions = [Point(x=x, y=y, z=z) for x, y, z in points]
    return request


def test_postures_of_the_hand_touch_the_object_nearest_first(solve):
    seed = np.full(9, 0.4)
    answer = solve(touching(ignore_limits=True, seed=JointState(position=seed.tolist())))
    assert (answer.error_code, answer.complete) == (0, True)
    assert (list(answer.counts), list(answer.codes)) == ([4, 4, 4], [0, 0, 0])
    assert len(answer.finger_postures) == 12
    assert len(answer.solutions) == 64
    q = np.array([point.positions for point in answer.solutions])
    np.testing.assert_allclose(np.linalg.norm(q - seed, axis=1), answer.seed_distances)
    assert (np.diff(answer.seed_distances) >= -1e-12).all()
    for row in q:
        for finger, part, place in zip(HAND.fingers, HAND.split(row), 0.04 * EQUATOR, strict=True):
            assert np.abs(forward_kinematics(finger, part)[:3, 3] - LIFTED - place).max() < 1e-9
    few = solve(touching(ignore_limits=True, max_solutions=3, seed=JointState(position=[0.4] * 9)))
    assert [point.positions for point in few.solutions] == [
        point.positions for point in answer.solutions[:3]
    ]


def test_limits_hold_and_fingers_may_be_chosen(solve):
    inside = solve(touching())
    assert inside.error_code == 0
    assert max(inside.counts) < 4
    lower = np.concatenate([finger.lower for finger in HAND.fingers])
    upper = np.concatenate([finger.upper for finger in HAND.fingers])
    for point in inside.solutions:
        assert (lower <= point.positions).all() and (point.positions <= upper).all()
    one = touching(fingers=["finger_2"])
    one.positions = one.positions[1:2]
    answer = solve(one)
    assert list(answer.counts) == list(inside.counts[1:2])
    assert len(answer.solutions) == answer.counts[0]


def test_who_does_not_reach_is_named(solve):
    answer = solve(touching(np.array([0.06, 0.0, 0.08])))
    assert answer.error_code in (ErrorCode.OUT_OF_REACH, ErrorCode.LIMITS_EXCLUDE_ALL)
    assert "finger_" in answer.error_msg
    assert not answer.solutions
    assert 0 in answer.counts
    far = solve(touching(np.array([0.0, 0.0, 0.5])))
    assert far.error_code == ErrorCode.OUT_OF_REACH
    assert far.error_msg.startswith("finger_1: ")


WRONG_CONTACTS = [
    ({"positions": []}, ErrorCode.WRONG_SIZE, "positions has size 0, expected 1 to 20"),
    ({"positions": [Point()] * 21}, ErrorCode.WRONG_SIZE, "1 to 20"),
    ({"normals": []}, ErrorCode.WRONG_SIZE, "normals has size 0, expected 3"),
    ({"normals": [Vector3()] * 3}, ErrorCode.BAD_VALUE, "normal of contact 0 is [0.0, 0.0, 0.0]"),
    ({"normals": [Vector3(x=math.nan)] * 3}, ErrorCode.NON_FINITE, "normal of contact 0"),
    ({"positions": [Point(x=math.inf)] * 3}, ErrorCode.NON_FINITE, "positions[0]"),
    ({"positions": [Point(x=1e300)] * 3}, ErrorCode.BAD_VALUE, "position of contact 0"),
    ({"friction": [0.5, -0.1, 0.5]}, ErrorCode.BAD_VALUE, "friction of contact 1 is -0.1"),
    ({"friction": [0.5, 0.5]}, ErrorCode.WRONG_SIZE, "friction has size 2, expected 0, 1 or 3"),
    ({"friction": [math.nan]}, ErrorCode.NON_FINITE, "friction of contact 0"),
    ({"torsional": [-1.0]}, ErrorCode.BAD_VALUE, "torsional of contact 0 is -1.0"),
    ({"models": ["sticky"]}, ErrorCode.BAD_VALUE, "frictionless, point, soft"),
    ({"origin": Point(y=math.nan)}, ErrorCode.NON_FINITE, "origin"),
    ({"fingers": ["thumb"] * 3}, ErrorCode.BAD_VALUE, "fingers[0] is 'thumb', expected one of f"),
    ({"fingers": ["finger_1"]}, ErrorCode.WRONG_SIZE, "fingers has size 1, expected 0 or 3"),
    ({"state": JointState(position=[0.0])}, ErrorCode.WRONG_SIZE, "state.position has size 1"),
    ({"state": JointState(name=["elbow"], position=[0.0])}, ErrorCode.UNKNOWN_JOINT, "elbow"),
    (
        {"state": JointState(position=[0.0] * 9), "frame_id": "world"},
        ErrorCode.FRAME_UNAVAILABLE,
        "'world': contacts of a hand are taken in the frame of its palm alone",
    ),
]


def flat(kind, count, friction=0.5, model="point", **more):
    """A request about contacts evenly spaced on a disc of radius 1."""
    angles = 2.0 * np.pi * np.arange(count) / count
    rim = np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1)
    return requested(kind, rim, model, friction, planar=True, **more)


@pytest.mark.parametrize(
    ("count", "friction", "quality"),
    [
        (2, 0.5, 0.5 / math.sqrt(2.25)),
        (3, 0.3, 0.3),
        (3, 0.5, 0.5),
        (3, 1.0, 0.935113),
        (4, 0.5, 0.5),
        (4, 1.0, 1.0),
    ],
)
def test_1_qualities_of_discs(analyze, count, friction, quality):
    answer = analyze(flat(AnalyzeGrasp, count, friction, length=1.0))
    assert (answer.error_code, answer.force_closed, answer.certified) == (0, True, True)
    assert answer.quality_lower <= quality + 1e-6
    assert answer.quality_upper >= quality - 1e-6
    assert (answer.force_components, answer.rank) == (2 * count, 3)
    G = rows(answer.grasp_matrix, 3)
    inner = rows(answer.internal_forces, 2 * count)
    assert np.abs(G @ inner).max() < 1e-12
    np.testing.assert_allclose(
        G[:, 1::2].T,
        [[0.0, 1.0, x] for x in np.cos(2.0 * np.pi * np.arange(count) / count)],
        atol=1e-12,
    )
    weakest = six(answer.weakest)
    assert (weakest[2:5] == 0.0).all()
    assert np.linalg.norm(weakest) == pytest.approx(1.0)


def test_forces_on_a_disc(hold):
    load = loaded((0.3, -1.0, 0.0), (0.0, 0.0, 0.2))
    answer = hold(flat(ContactForces, 3, wrench=load))
    assert answer.error_code == 0
    forces = np.array([[one.x, one.y, one.z] for one in answer.forces])
    assert (forces[:, 2] == 0.0).all()
    angles = 2.0 * np.pi * np.arange(3) / 3.0
    turned = np.cos(angles) * forces[:, 1] - np.sin(angles) * forces[:, 0]
    np.testing.assert_allclose(forces.sum(axis=0), [-0.3, 1.0, 0.0], atol=1e-9)
    assert turned.sum() == pytest.approx(-0.2, abs=1e-9)
    refused = hold(flat(ContactForces, 3, model="frictionless", wrench=load))
    assert refused.error_code == ErrorCode.LOAD_NOT_HELD
    separating = six(refused.separating_wrench)
    assert separating[5] * 0.2 < 0.0
    assert "the load needs 0.2" in refused.error_msg


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        ({"positions": [Point(z=0.1)] * 3}, "positions[0].z is 0.1, expected 0, since planar"),
        ({"normals": [Vector3(x=1.0, z=0.1)] * 3}, "normals[0].z is 0.1"),
        ({"origin": Point(z=2.0)}, "origin.z is 2.0"),
        ({"models": ["soft"]}, "model of contact 0 is 'soft'"),
        ({"state": JointState(position=[0.0] * 9)}, "contacts is 'in the plane'"),
    ],
)
def test_what_is_out_of_the_plane_is_refused(analyze, wrong, text):
    request = flat(AnalyzeGrasp, 3)
    for field, value in wrong.items():
        setattr(request, field, value)
    answer = analyze(request)
    assert (answer.error_code, text in answer.error_msg) == (109, True), answer.error_msg


def test_loads_out_of_the_plane_are_refused(hold):
    for load, text in (
        (loaded((0.0, 0.0, 1.0)), "wrench.force.z is 1.0, expected 0, since planar is true"),
        (loaded(torque=(0.0, 2.0, 0.0)), "wrench.torque.y is 2.0"),
    ):
        answer = hold(flat(ContactForces, 3, wrench=load))
        assert (answer.error_code, text in answer.error_msg) == (109, True), answer.error_msg


def test_wrong_contacts_have_a_code_and_a_text(ask):
    for kind, name in ((AnalyzeGrasp, "analyze_grasp"), (ContactForces, "contact_forces")):
        for wrong, code, text in WRONG_CONTACTS:
            request = requested(kind, EQUATOR)
            for field, value in wrong.items():
                setattr(request, field, value)
            answer = ask(kind, name, request)
            assert (answer.error_code, text in answer.error_msg) == (code, True), answer.error_msg


def test_other_wrong_requests_have_a_code_and_a_text(analyze, hold, solve):
    for answer, code, text in (
        (analyze(requested(AnalyzeGrasp, EQUATOR, length=-1.0)), 109, "length is -1.0"),
        (analyze(requested(AnalyzeGrasp, EQUATOR, length=math.nan)), 104, "length is nan"),
        (analyze(requested(AnalyzeGrasp, EQUATOR, length=1e-12)), 109, "a number from 1e-09 to 1e"),
        (analyze(requested(AnalyzeGrasp, EQUATOR, tolerance=2.0)), 109, "tolerance is 2.0"),
        (hold(requested(ContactForces, EQUATOR, smallest=2)), 109, "smallest is 2, expected LAR"),
        (
            hold(requested(ContactForces, EQUATOR, wrench=loaded((math.nan, 0, 0)))),
            104,
            "wrench.force",
        ),
        (hold(requested(ContactForces, EQUATOR, wrench=loaded((1e300, 0, 0)))), 109, "wrench"),
        (solve(SolveGrasp.Request()), 108, "positions has size 0"),
        (solve(touching(fingers=["finger_1"] * 3)), 109, "'finger_1'], expected each finger once"),
        (solve(touching(max_solutions=10_001)), 109, "max_solutions is 10001, expected 0 to 10000"),
        (solve(touching(seed=JointState(position=[math.nan] * 9))), 104, "seed"),
        (solve(touching(seed=JointState(position=[9.0] * 9))), 106, "finger_1_spread"),
    ):
        assert (answer.error_code, text in answer.error_msg) == (code, True), answer.error_msg
    turned = touching()
    turned.object_pose.pose.orientation.w = 0.5
    assert solve(turned).error_code == ErrorCode.BAD_QUATERNION
    elsewhere = touching()
    elsewhere.object_pose.header.frame_id = "camera"
    assert solve(elsewhere).error_code == ErrorCode.FRAME_UNAVAILABLE


def test_without_a_hand_contacts_are_analysed_and_fingers_are_not(graph):
    graph.start(GraspingNode)
    answer = graph.call(AnalyzeGrasp, "grasping/analyze_grasp", requested(AnalyzeGrasp, CUBE))
    assert answer.force_closed
    assert graph.ask(Trigger, "grasping/ready").success
    refused = graph.call(SolveGrasp, "grasping/solve_grasp", touching())
    assert refused.error_code == ErrorCode.BAD_VALUE
    assert "robot_description is '', expected a hand" in refused.error_msg


def test_frames_have_the_prefix(graph):
    graph.start(GraspingNode, robot_description="three_fingered", frame_prefix="left/")
    q, contacts = posture()
    request = of_hand(AnalyzeGrasp, contacts, q, frame_id="left/palm")
    answer = graph.call(AnalyzeGrasp, "grasping/analyze_grasp", request)
    assert (answer.error_code, answer.weakest.header.frame_id) == (0, "left/palm")


def test_what_is_no_hand_and_a_wrong_prefix_end_the_start(graph):
    with pytest.raises(UnknownRobotError, match="nobody"):
        graph.start(GraspingNode, robot_description="nobody")
    with pytest.raises(ParameterError, match="without a slash in front"):
        graph.start(GraspingNode, frame_prefix="/left")


def test_who_waited_too_long_for_others_is_told_and_others_are_served(graph):
    graph.start(GraspingNode, robot_description="three_fingered", max_queue_time=1e-9)
    request = requested(AnalyzeGrasp, EQUATOR)
    answer = graph.call(AnalyzeGrasp, "grasping/analyze_grasp", request)
    assert answer.error_code == ErrorCode.TIMED_OUT
    assert "for other requests, up to 1e-09 s are allowed" in answer.error_msg
    held = requested(ContactForces, EQUATOR, wrench=loaded((0.0, 0.0, -1.0)))
    assert graph.call(ContactForces, "grasping/contact_forces", held).error_code == 0


def test_without_the_conic_solver_the_answer_has_the_command(graph, monkeypatch):
    monkeypatch.setitem(sys.modules, "clarabel", None)
    graph.start(GraspingNode)
    request = requested(ContactForces, CUBE, wrench=loaded((1.0, 0.0, 0.0)))
    answer = graph.call(ContactForces, "grasping/contact_forces", request)
    assert answer.error_code == ErrorCode.NOT_INSTALLED
    assert "pip install 'robomech_ros[hands]'" in answer.error_msg


@pytest.mark.parametrize("busy", ["analysed", "contact_forces"])
def test_long_work_of_one_service_does_not_keep_the_other_waiting(graph, monkeypatch, busy):
    began, go_on = threading.Event(), threading.Event()
    own = getattr(grasping_node, busy)

    def long_work(*contacts, **options):
        began.set()
        assert go_on.wait(60.0)
        return own(*contacts, **options)

    monkeypatch.setattr(grasping_node, busy, long_work)
    graph.start(GraspingNode)
    calls = [
        (AnalyzeGrasp, "grasping/analyze_grasp", requested(AnalyzeGrasp, CUBE)),
        (ContactForces, "grasping/contact_forces", requested(ContactForces, CUBE, wrench=loaded())),
    ]
    first, second = calls if busy == "analysed" else calls[::-1]
    waiting = graph.start_call(*first)
    try:
        assert began.wait(60.0)
        assert graph.call(*second).error_code == ErrorCode.NONE
        assert not waiting.done()
    finally:
        go_on.set()
    assert graph.wait_for(waiting).error_code == ErrorCode.NONE
