"""Conversions between messages and arrays, against the core's own conversions and scipy."""

import math

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Point, Pose, Quaternion
from rclpy.serialization import deserialize_message, serialize_message
from scipy.spatial.transform import Rotation
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from robomech_ros.errors import (
    BadQuaternionError,
    BadValueError,
    NonFiniteError,
    UnknownJointError,
    WrongSizeError,
)
from robomech_ros.nodes.common.messages import joint_messages, message_fields, pose_messages
from robomech_ros.spatial import quaternion_from_matrix

NAMES = ("a", "b", "c")


def state(names=(), positions=()):
    return JointState(name=list(names), position=list(positions))


@pytest.mark.parametrize(
    ("names", "positions"),
    [("abc", (1, 2, 3)), ("cab", (3, 1, 2)), ("", (1, 2, 3)), ("cxab", (3, 9, 1, 2))],
)
def test_positions_by_name(names, positions):
    given = state(names, [float(p) for p in positions])
    q = joint_messages.positions_by_name(given, NAMES, "seed", others=("x",))
    assert q.tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("names", "positions", "error", "text"),
    [
        ("ab", (1, 2), WrongSizeError, "missing: c"),
        ("abc", (1, 2), WrongSizeError, "seed.position has size 2, expected 3, one for every name"),
        ("", (1, 2), WrongSizeError, "seed.position has size 2, expected 3 for a, b, c"),
        ("abca", (1, 2, 3, 4), WrongSizeError, "'a' is repeated"),
        ("abcy", (1, 2, 3, 4), UnknownJointError, "unknown joint 'y'; available: a, b, c"),
        ("abc", (1, math.nan, 3), NonFiniteError, "seed of joint 'b' is nan"),
        ("cab", (math.inf, 2, 3), NonFiniteError, "seed of joint 'c' is inf"),
        ("", (1, 2, -math.inf), NonFiniteError, "seed of joint 'c' is -inf"),
    ],
)
def test_bad_joint_states(names, positions, error, text):
    given = state(names, [float(p) for p in positions])
    with pytest.raises(error, match=text.replace("(", r"\(")):
        joint_messages.positions_by_name(given, NAMES, "seed")


def test_a_long_name_that_comes_twice_is_shortened():
    """All of it came back: 100 kB in the answer to a request."""
    name = "x" * 100_000
    with pytest.raises(
        WrongSizeError, match=r"x\.\.\. \(100002 characters\) is repeated"
    ) as refused:
        joint_messages.positions_by_name(state([name, name], [1.0, 2.0]), NAMES, "seed")
    assert len(str(refused.value)) < 400


def rotations():
    rng = np.random.default_rng(7)
    some = Rotation.random(200, random_state=7).as_matrix()
    half_turns = [Rotation.from_rotvec(np.pi * axis).as_matrix() for axis in np.eye(3)]
    axes = rng.normal(size=(50, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    near_half = Rotation.from_rotvec((np.pi - 1e-9) * axes).as_matrix()
    return [np.eye(3), *half_turns, *near_half, *some]


@pytest.mark.parametrize("rotation", rotations())
def test_pose_there_and_back_as_the_core_does_it(rotation):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation, (1.0, -2.0, 3.0)
    pose = pose_messages.pose_from_matrix(T)
    o = pose.orientation
    expected = quaternion_from_matrix(rotation)
    np.testing.assert_allclose([o.x, o.y, o.z, o.w], expected, atol=2e-15)
    np.testing.assert_allclose(pose_messages.matrix_from_pose(pose), T, atol=1e-14)


def test_half_turn_has_one_sign_and_no_negative_zero():
    T = np.diag((-1.0, 1.0, -1.0, 1.0))
    o = pose_messages.pose_from_matrix(T).orientation
    assert [o.x, o.y, o.z, o.w] == [0.0, 1.0, 0.0, 0.0]
    assert not any(math.copysign(1.0, number) < 0 for number in (o.x, o.z, o.w))


def quaternion_pose(x, y, z, w):
    return Pose(orientation=Quaternion(x=x, y=y, z=z, w=w))


def test_quaternion_slightly_off_is_normalised():
    T = pose_messages.matrix_from_pose(quaternion_pose(0.0, 0.0, 0.7071, 0.7071))
    np.testing.assert_allclose(T[:3, :3], [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)


@pytest.mark.parametrize(
    ("numbers", "text"),
    [
        ((0.0, 0.0, 0.0, 0.0), "all zero"),
        ((0.0, 0.0, 0.0, 1.01), "its norm is 1.01"),
        ((1.0, 1.0, 1.0, 1.0), "its norm is 2"),
        ((1e200, 0.0, 0.0, 0.0), "its norm is inf"),
    ],
)
def test_bad_quaternions(numbers, text):
    with pytest.raises(BadQuaternionError, match=text):
        pose_messages.matrix_from_pose(quaternion_pose(*numbers), "target")


@pytest.mark.parametrize(("field", "value"), [("x", math.nan), ("y", math.inf), ("z", -math.inf)])
def test_positions_must_be_finite(field, value):
    pose = Pose(position=Point(**{field: value}), orientation=Quaternion(w=1.0))
    with pytest.raises(NonFiniteError, match=f"target.position.{field}"):
        pose_messages.matrix_from_pose(pose, "target")


def test_orientations_must_be_finite():
    with pytest.raises(NonFiniteError, match=r"target\.orientation\.y is nan"):
        pose_messages.matrix_from_pose(quaternion_pose(0.0, math.nan, 0.0, 1.0), "target")


def test_rows_of_poses():
    rows = [0.1, 0.2, 0.3, 0.0, 0.0, 0.7071, 0.7071] + [0.0] * 6 + [1.0]
    T = pose_messages.matrices_from_pose_rows(rows)
    assert T.shape == (2, 4, 4)
    np.testing.assert_allclose(T[0, :3, 3], (0.1, 0.2, 0.3))
    np.testing.assert_array_equal(T[1], np.eye(4))
    assert pose_messages.matrices_from_pose_rows([]).shape == (0, 4, 4)


@pytest.mark.parametrize(
    ("rows", "error", "text"),
    [
        ([0.0] * 6, WrongSizeError, "multiple of 7"),
        ([0.0] * 6 + [1.0] + [math.nan] * 7, NonFiniteError, r"poses\[1, 0\]"),
        ([0.0] * 6 + [1.0] + [0.0] * 7, BadQuaternionError, "row 1"),
    ],
)
def test_bad_rows_of_poses(rows, error, text):
    with pytest.raises(error, match=text):
        pose_messages.matrices_from_pose_rows(rows)


def test_linear_rows_first():
    J = np.arange(12.0).reshape(6, 2)
    assert pose_messages.linear_rows_first(J)[:, 0].tolist() == [6, 8, 10, 0, 2, 4]


@pytest.mark.parametrize(
    ("seconds", "sec", "nanosec"),
    [
        (0.0, 0, 0),
        (1.5, 1, 500_000_000),
        (0.9999999999, 1, 0),
        (1e-9, 0, 1),
        (100.1, 100, 100_000_000),
    ],
)
def test_durations(seconds, sec, nanosec):
    message = message_fields.duration_from_seconds(seconds)
    assert (message.sec, message.nanosec) == (sec, nanosec)
    assert message_fields.seconds_from_duration(message, "t") == pytest.approx(seconds, abs=1e-9)


def test_negative_durations_are_refused():
    with pytest.raises(BadValueError, match="timeout is -1"):
        message_fields.seconds_from_duration(Duration(sec=-1), "timeout")


def test_joint_trajectory():
    times, q = np.array([0.0, 0.25]), np.arange(6.0).reshape(2, 3)
    message = joint_messages.joint_trajectory(NAMES, times, q, 2 * q, 3 * q)
    assert message.joint_names == list(NAMES)
    assert message.points[1].time_from_start == Duration(nanosec=250_000_000)
    assert list(message.points[1].positions) == [3, 4, 5]
    assert list(message.points[1].velocities) == [6, 8, 10]
    assert list(message.points[1].accelerations) == [9, 12, 15]
    assert message.header.stamp.sec == 0
    assert message.points[-1] == message.points[1:][0] == list(message.points)[1]
    assert len(message.points) == 2
    with pytest.raises(IndexError):
        message.points[2]
    sent = deserialize_message(serialize_message(message), JointTrajectory)
    assert sent.points == list(message.points)
