"""Arms that hold one tool together follow paths of it, all at once."""

from functools import partial

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import load_robot
from robomech_ros.spatial import pose_error
from robomech_ros.trajectory import (
    JoinedArms,
    Limits,
    PathTrackingStatus,
    SerialArm,
    straight_path,
    track_path,
)

PUMA, UR = load_robot("puma560"), load_robot("ur5e")
PUMA_START, UR_START = [0.1, -0.5, 0.4, 0.3, 0.8, 0.2], [0.3, -1.1, 1.4, -0.6, 1.1, 0.2]
BOTH = np.array([*PUMA_START, *UR_START])
HERE = forward_kinematics(PUMA, PUMA_START)
# Where the base of the second arm stands, so that both hold the tool.
BASE = HERE @ np.linalg.inv(forward_kinematics(UR, UR_START))
TURN = np.kron(np.eye(2), BASE[:3, :3])


def never(T, near):
    return None


FIRST = SerialArm(partial(forward_kinematics, PUMA), never, partial(jacobian, PUMA))
SECOND = SerialArm(
    lambda q: BASE @ forward_kinematics(UR, q), never, lambda q: TURN @ jacobian(UR, q)
)
ARMS = JoinedArms((FIRST, SECOND), (6, 6), never)


def line_to(*away):
    there = HERE.copy()
    there[:3, 3] += away
    return straight_path([HERE, there])


def test_all_arms_hold_the_tool_on_the_path():
    path = line_to(0.05, -0.1, 0.08)
    found = track_path(path, ARMS, BOTH)
    assert found.status is PathTrackingStatus.COMPLETE
    s = np.linspace(0.0, path.length, 41)
    q = found.path.derivatives(s)[0]
    for arm, own in ((FIRST, q[:, :6]), (SECOND, q[:, 6:])):
        poses = np.array([arm.forward(row) for row in own])
        assert np.abs(pose_error(path.sample(s).pose, poses)).max() < 1e-7


@pytest.mark.parametrize(("arm", "own"), [(FIRST, slice(0, 6)), (SECOND, slice(6, 12))])
def test_each_arm_moves_as_it_would_alone(arm, own):
    path = line_to(0.05, -0.1, 0.08)
    joined, alone = track_path(path, ARMS, BOTH), track_path(path, arm, BOTH[own])
    s = np.linspace(0.0, path.length, 41)
    away = joined.path.derivatives(s)[:2, :, own] - alone.path.derivatives(s)[:2]
    assert np.abs(away[0]).max() < 1e-6
    assert np.abs(away[1]).max() < 1e-4


def test_the_path_ends_where_the_first_arm_cannot_go_on():
    path = line_to(0.0, 0.0, -2.0)
    parts = [track_path(path, ARMS, BOTH), track_path(path, FIRST, PUMA_START)]
    parts.append(track_path(path, SECOND, UR_START))
    assert all(part.status is not PathTrackingStatus.COMPLETE for part in parts)
    assert parts[0].reached == pytest.approx(min(part.reached for part in parts[1:]), rel=1e-3)


def test_limits_are_those_of_all_joints():
    names = [f"joint_{k}" for k in range(12)]
    free = track_path(line_to(0.05, -0.1, 0.08), ARMS, BOTH).path.derivatives(0.05)[0]
    upper = np.full(12, 10.0)
    upper[8] = BOTH[8] + 0.5 * (free[8] - BOTH[8])
    lower = np.full(12, -10.0)
    if free[8] < BOTH[8]:
        lower[8], upper[8] = upper[8], 10.0
    limits = Limits(names, lower=lower, upper=upper)
    found = track_path(line_to(0.05, -0.1, 0.08), ARMS, BOTH, limits=limits)
    assert (found.status, found.joint) == (PathTrackingStatus.LIMIT, 8)
    assert "'joint_8'" in found.reason


@pytest.mark.parametrize(
    ("make", "kind", "text"),
    [
        (lambda: JoinedArms((), (), never), BadValueError, "at least one arm"),
        (lambda: JoinedArms((FIRST, None), (6, 6), never), BadValueError, "an arm with forward"),
        (lambda: JoinedArms((FIRST, SECOND), (6,), never), WrongSizeError, "joints"),
        (lambda: track_path(line_to(0.1, 0.0, 0.0), ARMS, BOTH[:7]), WrongSizeError, "near"),
    ],
)
def test_wrong_arms_are_refused(make, kind, text):
    with pytest.raises(kind, match=text):
        make()
