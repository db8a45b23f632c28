"""Pose paths followed by chains: where they end, by which joint, and why."""

from dataclasses import replace

import numpy as np
import pytest

from robomech_ros.cartesian import (
    PathStopLimits,
    follow_path,
    relative_jump,
    serial_arm,
    stop_on_condition,
    waypoint_fraction,
    waypoint_path,
)
from robomech_ros.errors import (
    BadValueError,
    NonFiniteError,
    SeedOutsideLimitsError,
    WrongSizeError,
)
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.outcomes import Code
from robomech_ros.robots import load_robot
from robomech_ros.trajectory import (
    Limits,
    PathTrackingStatus,
    straight_path,
    track_path,
    tracking_error,
)

PUMA = load_robot("puma560")
START = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
HERE = forward_kinematics(PUMA, START)
# Neither singular postures nor jumps end a path.
ANY = PathStopLimits(np.inf, 0.01, np.inf, np.inf)


def shifted(*steps, of=HERE):
    poses = np.tile(of, (len(steps), 1, 1))
    poses[:, :3, 3] += steps
    return poses


def test_the_whole_path_has_no_stop():
    waypoints = shifted([0.1, 0.0, 0.0], [0.1, 0.1, 0.05])
    path = waypoint_path(HERE, waypoints)
    found = follow_path(PUMA, path, START)
    assert found.stop is None and found.fraction == 1.0
    assert found.joints.length == path.length
    s = np.linspace(0.0, path.length, 200)
    assert np.abs(tracking_error(path, serial_arm(PUMA), found.joints, s)).max() < 2e-7
    assert waypoint_fraction(found, waypoints) == 1.0


def test_out_of_reach_ends_where_the_arm_does():
    waypoints = shifted([0.1, 0.0, 0.0], [2.0, 0.0, 0.0])
    path = waypoint_path(HERE, waypoints)
    found = follow_path(PUMA, path, START, bounds=ANY)
    stop = found.stop
    assert stop.kind in (PathTrackingStatus.LOST, PathTrackingStatus.SINGULAR)
    assert (stop.index, stop.joint) == (1, None)
    assert 0.1 < found.fraction < 0.9
    assert found.fraction == found.tracking.reached / path.length == found.joints.length / 2.0
    assert stop.text.startswith(
        f"before waypoints[1], at s = {found.joints.length:.6g} of 2 m: the elbow is straight"
    )
    # At its end the wrist centre is as far from the shoulder as it can be: the elbow is stretched.
    assert np.linalg.cond(jacobian(PUMA, found.joints.derivatives(found.joints.length)[0])) > 400
    part = waypoint_fraction(found, waypoints)
    assert part == pytest.approx(0.5 + 0.5 * (2.0 * found.fraction - 0.1) / 1.9, rel=1e-9)


def test_a_start_out_of_reach_does_not_begin():
    far = HERE.copy()
    far[:3, 3] += 5.0
    path = straight_path([far, *shifted([0.1, 0.0, 0.0], of=far)])
    found = follow_path(PUMA, path, START)
    assert found.joints is None and found.fraction == 0.0
    assert (found.stop.kind, found.stop.index) == (PathTrackingStatus.NO_START, 0)
    assert found.stop.kind.code == Code.IK_LOST


@pytest.mark.parametrize("near_limit", [0.05, 1e-3])
def test_a_joint_limit_ends_the_path_at_the_limit_with_its_name(near_limit):
    q = START.copy()
    q[0] = PUMA.upper[0] - near_limit
    end = forward_kinematics(PUMA, q + [0.3, 0, 0, 0, 0, 0])
    found = follow_path(PUMA, waypoint_path(forward_kinematics(PUMA, q), [end]), q, bounds=ANY)
    stop = found.stop
    assert (stop.kind, stop.joint, stop.index) == (PathTrackingStatus.LIMIT, "waist", 0)
    assert stop.kind.code == Code.LIMIT
    assert "joint 'waist' would leave its limits" in stop.text
    last = found.joints.derivatives(found.joints.length)[0]
    assert last[0] == pytest.approx(PUMA.upper[0], abs=1e-8)
    assert 0.0 < found.fraction < 1.0


@pytest.mark.parametrize("outside", [0.0, 5e-7])
def test_from_a_limit_one_way_leads_in_and_the_other_out(outside):
    """A start at the limit, or over it by the rounding of an encoder, may stay there."""
    q = START.copy()
    q[0] = PUMA.upper[0] + outside
    here = forward_kinematics(PUMA, q)
    for turn, fraction in ((-0.2, 1.0), (0.2, 0.0)):
        end = forward_kinematics(PUMA, q + [turn, 0, 0, 0, 0, 0])
        found = follow_path(PUMA, waypoint_path(here, [end]), q, bounds=ANY)
        assert found.fraction == pytest.approx(fraction, abs=1e-4), found.stop
        assert (found.stop is None) == (fraction == 1.0)
    assert found.stop.kind is PathTrackingStatus.LIMIT and found.stop.joint == "waist"


def test_a_limit_that_is_passed_for_an_instant_ends_the_path():
    """Between two of the places looked at: only the curve itself shows it."""
    path = waypoint_path(HERE, shifted([0.0, 0.3, 0.0], [0.0, 0.05, 0.0]))
    joints = follow_path(PUMA, path, START, bounds=ANY).joints
    s = np.linspace(0.0, joints.length, 200_001)
    rows = joints.derivatives(s)[0]
    # The path turns back at its corner: there joint values are largest or least.
    k = int(np.argmax(np.ptp(rows, axis=0)))
    corner = rows[:, k].max() if rows[:, k].max() > rows[0, k] + 1e-3 else rows[:, k].min()
    beyond = 2e-5 * np.sign(corner - rows[0, k])
    limits = {"lower": PUMA.lower.copy(), "upper": PUMA.upper.copy()}
    limits["upper" if beyond > 0.0 else "lower"][k] = corner - beyond
    tight = Limits(PUMA.joint_names, **limits)
    found = follow_path(PUMA, path, START, bounds=ANY, limits=tight)
    assert (found.stop.kind, found.stop.joint) == (PathTrackingStatus.LIMIT, PUMA.joint_names[k])
    assert 0.544 < found.fraction < 0.3 / 0.55
    kept = found.joints.derivatives(np.linspace(0.0, found.joints.length, 10_000))[0]
    assert (kept >= tight.lower - 1e-6).all() and (kept <= tight.upper + 1e-6).all()


def test_a_singularity_ends_the_path_where_the_condition_number_is():
    q = np.array([0.3, 0.4, -0.6, 0.0, 0.3, 0.0])
    end = forward_kinematics(PUMA, [0.3, 0.4, -0.6, 0.0, -0.3, 0.0])
    end[:3, 3] += [0.0, 0.004, 0.0]
    path = waypoint_path(forward_kinematics(PUMA, q), [end])
    bounds = PathStopLimits(100.0, 0.01, np.inf, np.inf)
    found = follow_path(PUMA, path, q, bounds=bounds)
    assert (found.stop.kind, found.stop.joint) == (PathTrackingStatus.SINGULAR, None)
    assert "the condition number rises over 100" in found.stop.text
    scale = np.linalg.norm(PUMA.packed[1 : PUMA.n, 10:], axis=1).sum()
    J = jacobian(PUMA, found.joints.derivatives(found.joints.length)[0])
    J[3:] /= scale
    assert np.linalg.cond(J) == pytest.approx(100.0, rel=1e-6)
    farther = follow_path(PUMA, path, q, bounds=ANY)
    assert farther.fraction > found.fraction


def test_jumps_of_each_kind_of_joint_end_the_path():
    path = waypoint_path(HERE, shifted([0.195, 0.0, 0.0]))
    whole = follow_path(PUMA, path, START, bounds=ANY).joints
    moves = np.abs(np.diff(whole.derivatives(np.linspace(0.0, whole.length, 21))[0], axis=0))
    k, joint = np.unravel_index(int(np.argmax(moves)), moves.shape)
    bounds = PathStopLimits(np.inf, 0.01, 0.999 * float(moves.max()), np.inf)
    found = follow_path(PUMA, path, START, bounds=bounds)
    assert found.stop.kind is PathTrackingStatus.JUMP
    assert found.stop.joint == PUMA.joint_names[joint]
    assert found.joints.length == pytest.approx(0.195 * k / 20, abs=1e-12)
    assert (
        follow_path(PUMA, path, START, bounds=PathStopLimits(np.inf, 0.01, 1.0, 1e-9)).stop is None
    )
    stanford, q = load_robot("stanford"), np.array([0.2, 1.1, 0.5, 0.4, 0.9, -0.3])
    here = forward_kinematics(stanford, q)
    out = waypoint_path(here, shifted(0.1 * here[:3, 3], of=here))
    found = follow_path(stanford, out, q, bounds=PathStopLimits(np.inf, 0.01, np.inf, 1e-4))
    assert found.stop.joint == stanford.joint_names[2]


def test_a_posture_that_is_only_reached_by_a_jump_ends_the_path_with_the_joint():
    """A line of UR5e up to a singularity of its wrist, beyond which another branch is nearest."""
    arm, q = load_robot("ur5e"), np.array([-0.0062, 0.0703, 0.6859, -0.2048, 0.5628, 0.5067])
    here = forward_kinematics(arm, q)
    path = waypoint_path(here, shifted([0.2592, -0.231, 0.1374], of=here))
    found = follow_path(arm, path, q, bounds=ANY)
    assert (found.stop.kind, found.stop.joint) == (PathTrackingStatus.JUMP, "wrist_2_joint")
    assert "joint 'wrist_2_joint' would have to jump by 2.8" in found.stop.text
    assert found.stop.kind.code == Code.JUMP and 0.2 < found.fraction < 0.3


def test_checks_of_the_caller_end_the_path():
    path = waypoint_path(HERE, shifted([0.2, 0.0, 0.0]))
    whole = follow_path(PUMA, path, START, bounds=ANY).joints
    bound = float(whole.derivatives(0.12)[0][1])
    sign = np.sign(bound - START[1])

    def broken(q):
        return "the shoulder is too far" if sign * (q[1] - bound) > 0.0 else ""

    found = follow_path(
        PUMA, path, START, bounds=replace(ANY, checks=[stop_on_condition(broken, 0.01)])
    )
    assert found.stop.kind is PathTrackingStatus.REJECTED
    assert found.stop.kind.code == Code.REJECTED
    assert found.stop.text.endswith(": the shoulder is too far")
    assert found.joints.length == pytest.approx(0.12, abs=1e-9)
    never = follow_path(
        PUMA, path, START, bounds=PathStopLimits(checks=[stop_on_condition(lambda q: "no", 0.01)])
    )
    assert never.joints is None and never.fraction == 0.0 and "no" in never.stop.text


def test_relative_jumps_are_counted_from_the_mean():
    q = np.array([0.3, 0.4, -0.6, 0.0, 0.3, 0.0])
    end = forward_kinematics(PUMA, [0.3, 0.4, -0.6, 0.0, -0.3, 0.0])
    end[:3, 3] += [0.0, 0.004, 0.0]
    path = waypoint_path(forward_kinematics(PUMA, q), [end])
    loose, tight = (
        replace(ANY, checks=[relative_jump(PUMA, 0.001, factor)]) for factor in (np.inf, 3.0)
    )
    free, found = (follow_path(PUMA, path, q, bounds=bounds) for bounds in (loose, tight))
    assert found.stop.kind is PathTrackingStatus.JUMP and found.fraction < free.fraction
    assert "over jump_threshold 3 times the mean" in found.stop.text


def test_the_stop_counts_waypoints_or_parts_of_the_path():
    waypoints = shifted([0.0, 0, 0], [0.05, 0, 0], [0.05, 0, 0], [0.05, 0.05, 0], [3.0, 0, 0])
    path = waypoint_path(HERE, waypoints)
    assert follow_path(PUMA, path, START).stop.index == 4
    assert follow_path(PUMA, replace(path, waypoints=None), START).stop.index == 2


def test_whatever_arm_tracking_keeps_the_limits_it_is_given():
    """An inverse that refuses seeds outside is asked inside, even beyond the limits."""
    q = START.copy()
    q[0] = PUMA.upper[0] - 0.05
    far = forward_kinematics(PUMA, q)
    far[:3, 3] *= 9.0
    beyond = forward_kinematics(PUMA, q + [0.3, 0, 0, 0, 0, 0])
    path = straight_path([forward_kinematics(PUMA, q), beyond, far])
    near = []

    def inverse(T, seed):
        near.append(seed)

    plain = serial_arm(PUMA)
    arm = type(plain)(plain.forward, inverse, plain.jacobian)
    found = track_path(path, arm, q, limits=PUMA)
    assert found.status is PathTrackingStatus.LIMIT and found.joint == 0
    assert found.fraction == found.path.length / path.length < 1.0
    assert near and all((PUMA.lower <= one).all() and (one <= PUMA.upper).all() for one in near)
    with pytest.raises(WrongSizeError, match="joints of limits"):
        track_path(path, arm, q, limits=Limits(["one"]))


def test_wrong_arguments_are_refused_by_name():
    path = waypoint_path(HERE, shifted([0.1, 0.0, 0.0]))
    outside = START + [9.0, 0, 0, 0, 0, 0]
    for call, error, text in (
        (lambda: follow_path(None, path, START), BadValueError, "chain"),
        (lambda: follow_path(PUMA, None, START), BadValueError, "a PosePath"),
        (lambda: follow_path(PUMA, path, START[:5]), WrongSizeError, "start"),
        (lambda: follow_path(PUMA, path, [START]), WrongSizeError, "start"),
        (lambda: follow_path(PUMA, path, START * np.nan), NonFiniteError, "start"),
        (lambda: follow_path(PUMA, path, outside), SeedOutsideLimitsError, "waist"),
        (lambda: PathStopLimits(checks=[None]), BadValueError, "checks .*a list of callables"),
        (lambda: PathStopLimits(condition=0.0), BadValueError, "condition is 0.0"),
        (lambda: PathStopLimits(step=np.inf), BadValueError, "step"),
        (lambda: PathStopLimits(revolute_jump=np.nan), BadValueError, "revolute_jump"),
        (lambda: PathStopLimits(prismatic_jump="x"), BadValueError, "prismatic_jump"),
        (lambda: stop_on_condition(None, 0.1), BadValueError, "a callable"),
        (lambda: stop_on_condition(lambda q: "", 0.0), BadValueError, "step"),
        (lambda: relative_jump(PUMA, 0.01, 0.0), BadValueError, "factor"),
    ):
        with pytest.raises(error, match=text):
            call()
