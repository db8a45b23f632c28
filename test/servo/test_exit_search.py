"""Twists from singular postures: the tip stays on its line, or stands, and the status says why."""

from pathlib import Path

import numpy as np
import pytest
from approaches import deviation, length_of
from servo_drives import Drive, robot_of

import robomech_ros
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.servo.report import ServoCondition

LIBRARY = sorted(
    {path.stem for path in (Path(robomech_ros.__file__).parents[1] / "config/robots").glob("*.*")}
)
# Arms of fewer joints follow a part of most twists, on no line.
WHOLE = [robot for robot in LIBRARY if robot_of(robot).n >= 6]
LINE, TURNED = 1e-3, 1e-3
HALT = ServoCondition.SINGULARITY
WRIST = np.array([0.3, 0.6, -0.7, 0.4, 0.0, 0.2])


def zeros(robot):
    chain = robot_of(robot)
    return np.clip(np.zeros(chain.n), chain.lower, chain.upper)


def translation(robot, q, direction, speed, seconds=1.5, period=0.01):
    drive = Drive(robot, q, length=length_of(robot), period=period)
    direction = np.asarray(direction) / np.linalg.norm(direction)
    drive.twist([0, 0, 0, *speed * direction], seconds)
    return drive, *deviation(drive, direction)


# Every fourth of eight directions is tried, and other ones for the next robot.
@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.long)])
@pytest.mark.parametrize("robot", WHOLE)
def test_from_zeros_the_tip_stays_on_its_line_or_stands(robot, every):
    """It once left its line by up to 65 mm (Stanford arm), and the status said nothing."""
    rng = np.random.default_rng(5)
    directions = [*np.eye(3), *-np.eye(3), *rng.normal(size=(2, 3))]
    speeds = rng.uniform(0.05, 0.6, len(directions))
    chosen = slice(WHOLE.index(robot) % every, None, every)
    for direction, speed in zip(directions[chosen], speeds[chosen], strict=True):
        drive, off, turned = translation(robot, zeros(robot), direction, speed, period=0.02)
        last = drive.reports[-1]
        assert off < LINE and turned < TURNED, (direction, off, turned, last)
        if np.abs(np.diff(drive.path()[-20:], axis=0)).max() < 1e-9:
            assert last.condition in (HALT, ServoCondition.JOINT_BOUND), (direction, last)
            assert last.condition is not HALT or "the tip cannot move" in last.text
        drive.assert_limits()


def test_who_stands_in_a_singular_posture_is_told_what_is_lost():
    drive, off, _ = translation("gen3", zeros("gen3"), [0, 0, 1], 0.2)
    last = drive.reports[-1]
    assert off < 1e-9 and last.condition is HALT and last.scale == 0.0
    assert last.text.endswith("where the tip cannot move along (0.00, 0.00, 1.00)")


@pytest.mark.parametrize(
    ("robot", "direction"),
    [
        ("gen3", [0, 0, -1]),
        ("ur5e", [1, 0, 0]),
        ("ur5e", [0, -1, 0]),
        ("xarm6", [0, 0, 1]),
        ("puma560", [0, 1, 0]),
        ("stanford", [1, 0, 0]),
        ("stanford", [-1, 0, 0]),
    ],
)
def test_a_line_that_inverse_kinematics_can_follow_leads_out(robot, direction):
    chain = robot_of(robot)
    goal = forward_kinematics(chain, zeros(robot))
    goal[:3, 3] += 0.01 * np.array(direction)
    found = inverse_kinematics(chain, goal, seed=zeros(robot))
    assert np.abs(found.q[0] - zeros(robot)).max() < 1.0
    drive, off, turned = translation(robot, zeros(robot), direction, 0.2)
    assert off < LINE and turned < TURNED
    way = forward_kinematics(chain, drive.q)[:3, 3] - forward_kinematics(chain, drive.start)[:3, 3]
    assert way @ direction > 0.02
    drive.assert_limits()


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["puma560", pytest.param("irb120", marks=pytest.mark.long)])
def test_out_of_a_wrist_singularity_lead_all_twists(robot):
    """The tip waits until the wrist has turned to where it can follow."""
    for k in range(6):
        for sign in (1.0, -1.0):
            drive = Drive(robot, WRIST)
            drive.twist(sign * np.eye(6)[k] * (0.5 if k < 3 else 0.3), 3.0)
            last = drive.reports[-1]
            bound = last.condition is ServoCondition.JOINT_BOUND
            assert bound or last.condition_number < 200.0, (k, sign, last)
            drive.assert_limits()


@pytest.mark.parametrize("robot", WHOLE)
def test_joint_commands_always_lead_out(robot):
    drive = Drive(robot, zeros(robot))
    inwards = np.sign(drive.chain.midrange() - zeros(robot)) + (drive.chain.midrange() == 0.0)
    reports = drive.joints(0.2 * inwards * drive.servo.limits.velocity, 0.5)
    assert HALT not in {report.condition for report in reports}
    assert np.abs(drive.q - zeros(robot)).min() > 1e-3
    drive.assert_limits()


@pytest.mark.parametrize(("robot", "way"), [("gen3", [0, 0, -1]), ("xarm6", [0, 0, 1])])
def test_a_hand_that_trembles_leads_out_of_a_singular_posture(robot, way):
    drive = Drive(robot, zeros(robot), length=length_of(robot))
    rng = np.random.default_rng(1)
    wanted = np.array([0, 0, 0, *way]) * 0.2
    for _ in range(200):
        drive.twist(wanted + 1e-3 * rng.normal(size=6), 0.01)
    assert deviation(drive, np.array(way))[0] < LINE
    assert drive.reports[-1].condition_number < 20.0
    drive.assert_limits()


@pytest.mark.parametrize("joint", range(6))
def test_from_the_end_of_a_range_a_line_leads_inwards(joint):
    """A joint exactly there was taken to be outside, and the line of the tip to lead nowhere."""
    chain = robot_of("irb120")
    q = np.array([0.3, 0.3, 0.2, 0.4, 0.8, 0.2])
    q[joint] = chain.upper[joint]
    twist = jacobian(chain, q) @ (-0.2 * np.eye(6)[joint] + 0.02)
    drive = Drive("irb120", q)
    drive.twist(twist, 0.5)
    assert drive.servo.motion.line is not None
    assert drive.q[joint] < chain.upper[joint] - 0.02
    drive.assert_limits()
