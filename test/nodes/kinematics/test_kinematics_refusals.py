"""The kinematics node: every bad request gets its code and text, and the node goes on serving."""

import math

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion
from sensor_msgs.msg import JointState

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import GetJacobian, SolveFK, SolveIK, SolveIKBatch
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose
from robomech_ros.nodes.kinematics import chain_manipulator
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.robots import load_robot

PUMA = load_robot("puma560")
Q = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
NAMES = list(PUMA.joint_names)


@pytest.fixture
def puma(shared):
    return shared(KinematicsNode, robot_description="puma560")


@pytest.fixture
def few(graph):
    """A node that handles few poses at once."""
    graph.start(KinematicsNode, robot_description="puma560", max_batch_size=10)
    return graph


def still_serves(graph):
    request = SolveFK.Request(states=[joint_state(NAMES, Q)])
    return graph.call(SolveFK, "kinematics/solve_fk", request).error_code == ErrorCode.NONE


def check(graph, response, code, words):
    assert (response.error_code, response.error_msg) != (0, "")
    assert response.error_code == code, response.error_msg
    for word in words:
        assert word in response.error_msg
    assert still_serves(graph)


def state(names, values):
    return JointState(name=names, position=[float(value) for value in values])


def pose(position=(0.4, 0.1, 0.3), quaternion=(0.0, 0.0, 0.0, 1.0), frame=""):
    message = PoseStamped(
        pose=Pose(
            position=Point(**dict(zip("xyz", position, strict=True))),
            orientation=Quaternion(**dict(zip("xyzw", quaternion, strict=True))),
        )
    )
    message.header.frame_id = frame
    return message


FAR_SEED = np.where(np.arange(6) == 2, PUMA.upper + 0.25, Q)

IK_REFUSALS = {
    "unknown tip": (
        {"tip_link": "tool9"},
        ErrorCode.UNKNOWN_LINK,
        ("unknown link 'tool9'", "did you mean 'tool0'", "link_3"),
    ),
    "a link that nothing moves": (
        {"tip_link": "base_link"},
        ErrorCode.BAD_VALUE,
        ("tip_link is 'base_link'", "nothing moves between it and 'base_link'"),
    ),
    "unknown frame": (
        {"target": pose(frame="camera")},
        ErrorCode.FRAME_UNAVAILABLE,
        ("frame 'camera': the robot has no such link", "known frames: base_link"),
    ),
    "a link that joints move, of a robot that is not heard of": (
        {"target": pose(frame="link_3")},
        ErrorCode.NO_STATE,
        ("no present state", "waist, shoulder", "joint_states"),
    ),
    "zero quaternion": (
        {"target": pose(quaternion=(0.0, 0.0, 0.0, 0.0))},
        ErrorCode.BAD_QUATERNION,
        ("target.orientation", "all zero"),
    ),
    "unnormalised quaternion": (
        {"target": pose(quaternion=(0.0, 0.0, 0.0, 2.0))},
        ErrorCode.BAD_QUATERNION,
        ("norm is 2", "expected norm 1 within 0.001"),
    ),
    "NaN in the quaternion": (
        {"target": pose(quaternion=(0.0, math.nan, 0.0, 1.0))},
        ErrorCode.NON_FINITE,
        ("target.orientation.y", "nan"),
    ),
    "infinite position": (
        {"target": pose(position=(0.1, math.inf, 0.0))},
        ErrorCode.NON_FINITE,
        ("target.position.y", "inf"),
    ),
    "unknown joint": (
        {"seed": state(["elbw", *NAMES[1:]], Q)},
        ErrorCode.UNKNOWN_JOINT,
        ("unknown joint 'elbw'", "did you mean 'elbow'", "waist"),
    ),
    "too few joints": (
        {"seed": state([], Q[:5])},
        ErrorCode.WRONG_SIZE,
        ("seed.position has size 5", "6 for waist"),
    ),
    "partial seed": (
        {"seed": state(NAMES[:4], Q[:4])},
        ErrorCode.WRONG_SIZE,
        ("missing: wrist_bend, wrist_swivel",),
    ),
    "names without positions": (
        {"seed": state(NAMES, [])},
        ErrorCode.WRONG_SIZE,
        ("seed.position has size 0", "one for every name"),
    ),
    "duplicate names": (
        {"seed": state(["waist", *NAMES[:5]], Q)},
        ErrorCode.WRONG_SIZE,
        ("'waist' is repeated",),
    ),
    "NaN in the seed": (
        {"seed": state(NAMES, [*Q[:5], math.nan])},
        ErrorCode.NON_FINITE,
        ("seed of joint 'wrist_swivel' is nan",),
    ),
    "seed outside limits": (
        {"seed": state(NAMES, FAR_SEED)},
        ErrorCode.SEED_OUTSIDE_LIMITS,
        ("seed of joint 'elbow'", f"{PUMA.upper[2]:.6g}"[:5], "by 0.25 rad"),
    ),
    "unknown mode": ({"mode": 7}, ErrorCode.BAD_VALUE, ("mode is 7", "NEAREST (1) or FIRST (2)")),
    "unknown metric": ({"metric": 2}, ErrorCode.BAD_VALUE, ("metric is 2", "L2")),
    "negative tolerance": (
        {"position_tolerance": -1e-3},
        ErrorCode.BAD_VALUE,
        ("position_tolerance is -0.001",),
    ),
    "NaN tolerance": (
        {"orientation_tolerance": math.nan},
        ErrorCode.NON_FINITE,
        ("orientation_tolerance is nan",),
    ),
    "negative timeout": ({"timeout": Duration(sec=-1)}, ErrorCode.BAD_VALUE, ("timeout is -1",)),
    "out of reach": ({"target": pose(position=(2.0, 0.0, 0.0))}, ErrorCode.OUT_OF_REACH, ("m",)),
}


def test_reach_says_by_how_much(puma):
    response = puma.ask(SolveIK, "kinematics/solve_ik", target=pose(position=(2.0, 0.0, 0.0)))
    assert response.error_code == ErrorCode.OUT_OF_REACH
    # Shoulder offset and forearm set the largest reach of the wrist; the tool adds nothing.
    gap = 2.0 - math.hypot(0.4318 + math.hypot(0.4318, 0.0203), 0.15005)
    assert f"{gap:.2f}"[:3] in response.error_msg


def test_limits_that_exclude_everything_are_named_with_the_excess(graph):
    graph.start(KinematicsNode, robot_description="puma560")
    q = np.array([0.849, -1.427, -2.846, -2.998, 1.942, 2.559])
    target = stamped_pose(forward_kinematics(PUMA, q), "")
    request = SolveIK.Request(target=target)
    response = graph.call(SolveIK, "kinematics/solve_ik", request)
    assert response.error_code == ErrorCode.LIMITS_EXCLUDE_ALL
    assert list(response.solutions) == []
    assert "shoulder" in response.blocking_joints
    assert min(response.blocking_excess) > 0.0
    for joint, excess in zip(response.blocking_joints, response.blocking_excess, strict=True):
        assert f"joint '{joint}' by {excess:.6g} rad" in response.error_msg
    # It says the truth: without limits there is a posture outside by just that.
    request.ignore_limits = True
    everything = graph.call(SolveIK, "kinematics/solve_ik", request)
    assert len(everything.solutions) == 8
    excess = {}
    for point in everything.solutions:
        values = np.maximum(PUMA.lower - point.positions, point.positions - PUMA.upper)
        outside = {name: value for name, value in zip(NAMES, values, strict=True) if value > 0.0}
        assert outside
        excess[tuple(outside)] = list(outside.values())
    assert excess[tuple(response.blocking_joints)] == pytest.approx(response.blocking_excess)
    assert still_serves(graph)


FK_REFUSALS = {
    "no state known": ({}, ErrorCode.NO_STATE, ("waist", "/joint_states")),
    "unknown link": (
        {"states": [state(NAMES, Q)], "links": ["tool0", "hand"]},
        ErrorCode.UNKNOWN_LINK,
        ("unknown link 'hand'", "tool0"),
    ),
    "empty state among others": (
        {"states": [state(NAMES, Q), JointState()]},
        ErrorCode.WRONG_SIZE,
        ("states[1]",),
    ),
    "NaN": (
        {"states": [state(NAMES, [*Q[:5], math.nan])]},
        ErrorCode.NON_FINITE,
        ("states[0] of joint 'wrist_swivel'",),
    ),
}


JACOBIAN_REFUSALS = {
    "a link that nothing moves": (
        {"state": state(NAMES, Q), "tip_link": "base_link"},
        ErrorCode.BAD_VALUE,
        ("tip_link is 'base_link'", "nothing moves between it and 'base_link'"),
    ),
    "no state known": ({}, ErrorCode.NO_STATE, ("waist",)),
    "unknown link": (
        {"state": state(NAMES, Q), "tip_link": "hand"},
        ErrorCode.UNKNOWN_LINK,
        ("'hand'",),
    ),
    "unknown frame": (
        {"state": state(NAMES, Q), "reference_frame": "camera"},
        ErrorCode.FRAME_UNAVAILABLE,
        ("frame 'camera'", "base_link", "tool0"),
    ),
    "infinite point": (
        {"state": state(NAMES, Q), "tool_point": Point(z=math.inf)},
        ErrorCode.NON_FINITE,
        ("tool_point",),
    ),
    "point too far away": (
        {"state": state(NAMES, Q), "tool_point": Point(x=1e155)},
        ErrorCode.BAD_VALUE,
        ("point is [1e+155, 0.0, 0.0]", "1e+06 m"),
    ),
    "wrong number of joints": (
        {"state": state([], [*Q, 0.0])},
        ErrorCode.WRONG_SIZE,
        ("state.position has size 7",),
    ),
}


UNIT = [0.4, 0.1, 0.3, 0.0, 0.0, 0.0, 1.0]
BATCH_REFUSALS = {
    "not a multiple of seven": ({"poses": UNIT[:6]}, ErrorCode.WRONG_SIZE, ("multiple of 7",)),
    "zero quaternion": (
        {"poses": UNIT + [0.0] * 7},
        ErrorCode.BAD_QUATERNION,
        ("all zero", "row 1"),
    ),
    "NaN": ({"poses": [math.nan, *UNIT[1:]]}, ErrorCode.NON_FINITE, ("poses[0, 0]",)),
    "seed of the wrong size": (
        {"poses": UNIT, "seed": [0.0] * 5},
        ErrorCode.WRONG_SIZE,
        ("seed.position has size 5",),
    ),
    "unknown mode": ({"poses": UNIT, "mode": 2}, ErrorCode.BAD_VALUE, ("mode is 2",)),
    "too many poses": ({"poses": UNIT * 11}, ErrorCode.WRONG_SIZE, ("11", "max_batch_size")),
}


# By service, with the list of its answer that stays empty.
REFUSALS = {
    "solve_ik": (SolveIK, IK_REFUSALS, "solutions"),
    "solve_fk": (SolveFK, FK_REFUSALS, "poses"),
    "get_jacobian": (GetJacobian, JACOBIAN_REFUSALS, "jacobian"),
    "solve_ik_batch": (SolveIKBatch, BATCH_REFUSALS, "counts"),
}


@pytest.mark.parametrize(
    ("service", "case"), [(service, case) for service in REFUSALS for case in REFUSALS[service][1]]
)
def test_a_bad_request_is_refused(few, service, case):
    kind, cases, empty = REFUSALS[service]
    fields, code, words = cases[case]
    good = {"target": pose()} if kind is SolveIK else {}
    response = few.ask(kind, f"kinematics/{service}", **(good | fields))
    assert list(getattr(response, empty)) == []
    check(few, response, code, words)


def test_solve_fk_refuses_more_poses_than_may_be(few):
    states = [JointState(position=[0.0] * 6)] * 6
    assert len(few.ask(SolveFK, "kinematics/solve_fk", states=states, links=["tool0"]).poses) == 6
    many = SolveFK.Request(states=states, links=["tool0", "base_link"])
    response = few.call(SolveFK, "kinematics/solve_fk", many)
    assert list(response.poses) == []
    check(few, response, ErrorCode.WRONG_SIZE, ("states times links has size 12", "max_batch_size"))


def test_timeout_is_kept(graph):
    graph.start(KinematicsNode, robot_description="panda")
    request = SolveIK.Request(target=pose(position=(0.3, 0.3, 1.15)))
    request.timeout.nanosec = 1
    response = graph.call(SolveIK, "kinematics/solve_ik", request)
    assert response.error_code in (ErrorCode.TIMED_OUT, ErrorCode.NONE)
    assert response.solve_time.sec == 0


def test_a_defect_is_answered_and_logged(puma, monkeypatch):
    def broken(*args, **options):
        raise ZeroDivisionError("a defect")

    monkeypatch.setattr(chain_manipulator, "inverse_kinematics", broken)
    response = puma.ask(SolveIK, "kinematics/solve_ik", target=pose())
    check(puma, response, ErrorCode.INTERNAL, ("ZeroDivisionError", "a defect"))


def test_a_client_that_disappears_harms_nobody(puma):
    client = puma.client.create_client(SolveIK, "kinematics/solve_ik")
    assert client.wait_for_service(30.0)
    for _ in range(20):
        client.call_async(SolveIK.Request(target=pose()))
    puma.client.destroy_client(client)
    assert still_serves(puma)
