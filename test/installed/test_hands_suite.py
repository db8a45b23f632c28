"""A hand that is brought up, and asked across processes."""

import math
from collections import Counter

import numpy as np
import pytest
from geometry_msgs.msg import Point
from sensor_msgs.msg import JointState

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import SolveGrasp

PAIR = {
    "positions": [{"x": 0.04}, {"x": -0.04}],
    "normals": [{"x": -1.0}, {"x": 1.0}],
    "friction": [0.5],
    "wrench": {"force": {"z": -2.0}},
}


@pytest.fixture(scope="module")
def hand(shared_bringup):
    """A hand for all tests of this module: its services keep nothing of a request."""
    return shared_bringup("--robot", "three_fingered")


def test_a_hand_is_brought_up_and_asked(hand):
    suite = hand.suite
    soft = {**PAIR, "models": ["soft"], "torsional": [0.01]}
    held = suite.call("grasping/contact_forces", soft)
    assert held["error_code"] == 0, held["error_msg"]
    assert abs(held["total"] - 4.0) < 1e-6
    twisted = {**PAIR, "wrench": {"torque": {"x": 0.1}}}
    refused = suite.call("grasping/contact_forces", twisted)
    assert refused["error_code"] == 209
    assert refused["separating_wrench"]["wrench"]["torque"]["x"] < 0.0
    contacts = {name: soft[name] for name in soft if name != "wrench"}
    assert suite.call("grasping/analyze_grasp", contacts)["force_closed"] is True
    rim = [{"x": 0.04}, {"x": -0.02, "y": 0.0346}, {"x": -0.02, "y": -0.0346}]
    pose = {"position": {"z": 0.08}, "orientation": {"w": 1.0}}
    found = suite.call("grasping/solve_grasp", {"object_pose": {"pose": pose}, "positions": rim})
    assert (found["error_code"], found["complete"]) == (0, True)
    assert len(found["solutions"]) == found["counts"][0] ** 3


HOSTILE = [math.nan, math.inf, -math.inf, 1e308, -1e308, 5e-324, 0.0, 1e12, -1.0, 0.08]
NAMES = ["", "finger_1", "finger_9", "x" * 10_000, "finger_1\n", "\u2603", "/"]


def number(rng):
    return float(rng.choice(HOSTILE))


def odd_pose(rng, request):
    where = request.object_pose.pose.position
    where.x, where.z = number(rng), number(rng)


def odd_turn(rng, request):
    turn = request.object_pose.pose.orientation
    turn.x, turn.y, turn.z, turn.w = (number(rng) for _ in range(4))


def odd_frame(rng, request):
    request.object_pose.header.frame_id = str(rng.choice(NAMES[2:]))


def odd_points(rng, request):
    count = int(rng.integers(0, 25))
    request.positions = [Point(x=number(rng), y=number(rng), z=number(rng)) for _ in range(count)]


def too_many(rng, request):
    request.positions = [Point()] * 100_000
    request.fingers = ["finger_1"] * int(rng.integers(0, 1000))


def odd_fingers(rng, request):
    request.fingers = [str(name) for name in rng.choice(NAMES, 3)]


def odd_seed(rng, request):
    request.seed = JointState(position=[number(rng) for _ in range(9)])


def odd_names(rng, request):
    request.seed = JointState(name=[str(name) for name in rng.choice(NAMES, 9)], position=[0.4] * 9)


def nothing(rng, request):
    request.positions = []


ATTACKS = [
    odd_pose, odd_turn, odd_frame, odd_points, too_many, odd_fingers, odd_seed, odd_names, nothing
]  # fmt: skip


def test_300_hostile_requests_are_answered_and_good_ones_served_after(hand):
    """None is left without an answer, none ends the node, none is an internal error."""
    rng, codes, outsider = np.random.default_rng(5), Counter(), hand.outsider
    rim = [Point(x=0.04 * math.cos(a), y=0.04 * math.sin(a)) for a in (0.0, 2.1, 4.2)]

    def good():
        request = SolveGrasp.Request(positions=rim)
        request.object_pose.pose.position.z = 0.08
        request.object_pose.pose.orientation.w = 1.0
        return request

    before = outsider.call(SolveGrasp, "grasping/solve_grasp", good())
    for k in range(300):
        request = good()
        ATTACKS[k % len(ATTACKS)](rng, request)
        answer = outsider.call(SolveGrasp, "grasping/solve_grasp", request)
        codes[answer.error_code] += 1
        assert answer.error_code < 900, answer.error_msg
        assert bool(answer.error_code) == bool(answer.error_msg)
        assert all(np.isfinite(point.positions).all() for point in answer.solutions)
    after = outsider.call(SolveGrasp, "grasping/solve_grasp", good())
    assert (before.error_code, before.solutions) == (0, after.solutions)
    refused = {
        ErrorCode.BAD_QUATERNION,
        ErrorCode.NON_FINITE,
        ErrorCode.FRAME_UNAVAILABLE,
        ErrorCode.WRONG_SIZE,
        ErrorCode.BAD_VALUE,
    }
    assert refused <= set(codes)
