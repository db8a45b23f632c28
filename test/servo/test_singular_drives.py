"""Drives into, through and out of every kind of singularity."""

import numpy as np
import pytest
from scipy.optimize import brentq
from servo_drives import LENGTHS, Drive, robot_of

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian, singularity_report
from robomech_ros.servo.report import ServoCondition

HALT = ServoCondition.SINGULARITY
# Of drives that are many, twice as long as usual (s).
PERIOD = 0.02


def zero_of(robot, kind, q, joint, low, high):
    """The posture in which a factor of the determinant is zero, found along one joint."""
    chain, q = robot_of(robot), np.array(q, dtype=float)

    def factor(value):
        q[joint] = value
        return singularity_report(chain, q, length=LENGTHS[robot]).factors[kind]

    q[joint] = brentq(factor, low, high, xtol=1e-15)
    return q


# Robot, kind, posture, and the joint along which the factor of this kind changes its sign.
CASES = {
    "puma560-wrist": ("puma560", "wrist", [0.3, 0.6, -0.7, 0.4, 0.0, 0.2], 4, -0.5, 0.5),
    "puma560-elbow": ("puma560", "elbow", [0.3, 0.6, -1.5, 0.4, 0.8, 0.2], 2, -2.5, -0.8),
    "puma560-shoulder": ("puma560", "shoulder", [0.3, 1.5, -0.7, 0.4, 0.8, 0.2], 1, 0.5, 3.0),
    "ur5e-wrist": ("ur5e", "wrist", [0.3, -1.2, 1.5, 0.4, 0.0, 0.2], 4, -0.5, 0.5),
    "ur5e-elbow": ("ur5e", "elbow", [0.3, -1.2, 0.0, 0.4, 0.8, 0.2], 2, -0.5, 0.5),
    "ur5e-shoulder": ("ur5e", "shoulder", [0.3, -1.5, 0.7, 0.4, 0.8, 0.2], 1, -2.6, -0.6),
    "iiwa14-elbow": ("iiwa14", "elbow", [0.3, 0.5, 0.2, 0.0, 0.3, 0.8, 0.1], 3, -0.5, 0.5),
    "scara-elbow": ("scara", "elbow", [0.2, 0.0, 0.1, 0.3], 1, -0.5, 0.5),
}


@pytest.fixture(params=CASES, scope="module")
def case(request):
    robot, *given = CASES[request.param]
    return robot, zero_of(robot, *given), given[2]


def condition(drive):
    return drive.reports[-1].condition_number


def twists():
    for k in range(6):
        for sign in (1.0, -1.0):
            yield sign * np.eye(6)[k] * (0.5 if k < 3 else 0.2)


def test_from_exactly_there_every_axis_leads_out_one_way_or_the_other(case):
    """An axis that leads deeper stops or creeps, and the opposite direction leads out."""
    robot, q, _ = case
    outcomes = []
    for twist in twists():
        drive = Drive(robot, q, period=PERIOD)
        conditions = [report.condition for report in drive.twist(twist, 0.4)]
        moved = np.abs(drive.q - q).max()
        impossible = ServoCondition.IMPOSSIBLE in conditions
        outcomes.append(impossible or moved > 0.03)
        deeper = conditions[-1] in (HALT, ServoCondition.APPROACHING_SINGULARITY)
        assert moved > 0.03 or impossible or deeper, (twist, conditions[-1])
        drive.assert_limits()
    ways = np.array(outcomes).reshape(6, 2)
    assert ways.any(axis=1).all(), ways


def test_straight_in_and_out_again(case):
    """Along what is lost there, from a regular posture on either side of it."""
    robot, q, joint = case
    chain = robot_of(robot)
    lost = singularity_report(chain, q, length=LENGTHS[robot]).lost_directions
    u = lost[-1] / np.linalg.norm(lost[-1]) * 0.2
    for side in (0.5, -0.5):
        begin = np.clip(q + side * np.eye(chain.n)[joint], chain.lower + 0.02, chain.upper - 0.02)
        towards = jacobian(chain, begin) @ (q - begin)
        for twist in (u, -u, towards / np.linalg.norm(towards) * 0.3):
            drive = Drive(robot, begin, period=PERIOD)
            drive.twist(twist, 1.5)
            there = condition(drive)
            # What moved fast takes this long to turn round.
            drive.twist(-twist, 0.5)
            place = drive.q
            drive.twist(-twist, 0.3)
            moved = np.abs(drive.q - place).max()
            stopped = drive.reports[-1].condition is ServoCondition.JOINT_BOUND
            assert moved > 0.02 or stopped, (side, twist, there, drive.reports[-1])
            drive.assert_limits()


def flips(drive):
    """How often a joint that moves noticeably turns round."""
    v = np.array(drive.velocities)
    quick = np.where(np.abs(v) > 0.02, np.sign(v), 0.0)
    return max(np.count_nonzero(np.diff(column[column != 0.0])) for column in quick.T)


@pytest.mark.parametrize("robot", ["puma560", "ur5e"])
def test_at_the_boundary_of_the_workspace_it_slows_down_stands_and_does_not_chatter(robot):
    q = zero_of(*CASES[f"{robot}-elbow"])
    chain = robot_of(robot)
    begin = q + 0.6 * np.eye(6)[2]
    lost = singularity_report(chain, q, length=LENGTHS[robot]).lost_directions[-1]
    speeds = []
    for sign in (1.0, -1.0):
        drive = Drive(robot, begin)
        reports = drive.twist(sign * 0.2 * lost / np.linalg.norm(lost[3:]), 4.0)
        conditions = [report.condition for report in reports]
        if conditions[-1] is not HALT:
            continue
        speeds.append(np.abs(np.diff(drive.path(), axis=0)).max(axis=1))
        assert ServoCondition.APPROACHING_SINGULARITY in conditions
        assert conditions.count(HALT) > 20 and set(conditions[-20:]) == {HALT}
        assert speeds[-1][-10:].max() < 1e-12
        assert 60.0 < condition(drive) < 400.0
        assert flips(drive) <= 2
        tip = forward_kinematics(chain, drive.q)
        before = len(drive.reports)
        drive.twist(-sign * 0.2 * lost / np.linalg.norm(lost[3:]), 1.0)
        left = [report.condition for report in drive.reports[before:]]
        assert ServoCondition.APPROACHING_SINGULARITY not in left and HALT not in left
        way = np.linalg.norm(forward_kinematics(chain, drive.q)[:3, 3] - tip[:3, 3])
        assert way > 0.02
        drive.assert_limits()
    assert len(speeds) == 1


@pytest.mark.parametrize("robot", ["puma560", "ur5e", "panda", "scara"])
def test_random_twists(robot):
    """None of them leads anywhere that the next ones could not lead out of."""
    run_random_twists(robot, 5.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "minutes"),
    [
        ("puma560", 0.5),
        ("iiwa14", 0.3),
        pytest.param("puma560", 10.0, marks=pytest.mark.long),
        pytest.param("ur5e", 2.0, marks=pytest.mark.long),
        pytest.param("iiwa14", 2.0, marks=pytest.mark.long),
        pytest.param("scara", 1.0, marks=pytest.mark.long),
    ],
)
def test_random_twists_for_minutes(robot, minutes):
    run_random_twists(robot, 60.0 * minutes)


def run_random_twists(robot, seconds):
    drive = Drive(robot, robot_of(robot).home())
    rng = np.random.default_rng(3)
    stood = 0
    while drive.time < seconds:
        drive.plans.clear()
        begun = len(drive.positions)
        twist = rng.normal(size=6) * np.repeat((0.6, 0.2), 3) * rng.uniform(0.2, 3.0)
        for one in (twist, -twist):
            drive.twist(one, 0.4)
        moved = np.ptp(np.array(drive.positions[begun:]), axis=0).max()
        conditions = {report.condition for report in drive.reports[-80:]}
        stood += moved < 1e-3 and conditions <= {HALT, ServoCondition.APPROACHING_SINGULARITY}
        drive.assert_plans()
    drive.assert_limits(False)
    # There and back: one of the two ways leads out.
    assert stood == 0
