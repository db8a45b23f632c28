"""The tip keeps to its line at any speed, and stands at the hard stop of a singularity."""

from pathlib import Path

import numpy as np
import pytest
from approaches import approach, deviation, length_of, random_start
from servo_drives import Drive, robot_of

import robomech_ros
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.servo.motion import Motion
from robomech_ros.servo.report import ServoCondition
from robomech_ros.servo.twist_resolver import TwistResolver

LIBRARY = sorted(
    {path.stem for path in (Path(robomech_ros.__file__).parents[1] / "config/robots").glob("*.*")}
)
# What interpolation leaves, and what may be lost where a wrist passes (m, rad).
STRAIGHT, TURNED = 1e-5, 1e-4
LINE, ORIENTATION = 1e-3, 6e-3
HARD_STOP = 90.0
ENDS = {ServoCondition.SINGULARITY, ServoCondition.JOINT_BOUND}
ELBOW_AHEAD = [0, -1.57, 1.57, -1.57, -1.57, 0]
WRIST_BEHIND = [0.0, 0.3, 0.2, 0.0, 0.8, 0.0]
UP = np.array([0.0, 0.0, 1.0])


def assert_on_its_line(done):
    drive, off, turned, stands = done
    assert off < LINE and turned < ORIENTATION
    last = drive.reports[-1]
    if stands:
        assert last.condition in ENDS, last
        assert last.scale == 0.0 and not drive.velocities[-1].any()
    if last.condition is ServoCondition.SINGULARITY:
        assert last.condition_number <= 1.2 * HARD_STOP
    drive.assert_limits()


@pytest.mark.parametrize("speed", [0.05, 0.2, 0.4, 1.0])
@pytest.mark.parametrize(
    ("robot", "q", "direction"),
    [("ur5e", ELBOW_AHEAD, UP), ("irb120", WRIST_BEHIND, np.array([1.0, 0.0, 0.0]))],
)
def test_to_the_end_of_the_workspace(robot, q, direction, speed):
    """From where the tip once left its line by up to 307 mm, and by 12 mm."""
    done = approach(robot, q, direction, speed)
    assert_on_its_line(done)
    assert done.off < STRAIGHT and done.turned < TURNED
    assert done.stands and done.drive.reports[-1].condition is ServoCondition.SINGULARITY
    assert done.drive.reports[-1].condition_number > 60.0
    v = np.array(done.drive.velocities)
    quick = np.where(np.abs(v) > 0.02, np.sign(v), 0.0)
    flips = [np.count_nonzero(np.diff(column[column != 0.0])) for column in quick.T]
    assert max(flips) <= 1


def run_approaches(robot, count, seed, period):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        q, direction = random_start(robot, rng)
        assert_on_its_line(approach(robot, q, direction, 0.05 * 20.0 ** rng.uniform(), period))


@pytest.mark.slow
@pytest.mark.parametrize("robot", LIBRARY)
def test_random_approaches(robot):
    run_approaches(robot, 2, 1, 0.01)


@pytest.mark.long
@pytest.mark.parametrize("robot", LIBRARY)
def test_more_random_approaches(robot):
    run_approaches(robot, 6, 2, 0.01)


@pytest.mark.long
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("robot", LIBRARY)
def test_a_thousand_random_approaches(robot):
    run_approaches(robot, 1000, 0, 0.02)


@pytest.mark.parametrize("robot", ["irb120", "rv4fr", "ur5e", "gen3"])
def test_no_period_examines_more_than_some_postures(robot, monkeypatch):
    """To join a line took up to 219 nodes, and 20 ms, in one period."""
    examined = []

    def counted(heading):
        def counting(*given):
            examined[-1] += 1
            return heading(*given)

        return counting

    monkeypatch.setattr(TwistResolver, "heading", counted(TwistResolver.heading))
    rng = np.random.default_rng(1)
    for _ in range(3):
        drive = Drive(robot, random_start(robot, rng)[0])
        for _ in range(10):
            twist = rng.normal(size=6) * np.repeat((0.5, 0.3), 3) * rng.uniform(0.1, 2.0)
            for _ in range(30):
                examined.append(0)
                drive.twist(twist, 0.01)
    # Ten of the way, two of the motion beside it, and those where ways begin.
    assert 10 <= max(examined) <= 15


def test_another_twist_in_motion_has_a_line_of_its_own():
    """It is reached in motion, and kept to its end."""
    drive = Drive("ur5e", ELBOW_AHEAD)
    drive.twist([0, 0, 0, 0.3, 0.1, 0], 0.6)
    twist = np.array([0, 0, 0, 0, 0, 0.2])
    drive.twist(twist, 1.2)
    reached = len(drive.positions)
    assert np.abs(drive.velocities[-1]).max() > 0.1
    drive.twist(5.0 * twist, 4.0)
    off, turned = deviation(drive, UP, reached)
    assert off < STRAIGHT and turned < TURNED
    assert drive.reports[-1].condition is ServoCondition.SINGULARITY
    assert not drive.velocities[-1].any()
    drive.assert_limits()


@pytest.mark.parametrize("speed", [0.2, 0.4, 1.0])
def test_a_hand_that_trembles_does_not_drive_through_a_singularity(speed):
    """No twist is held, so there is no line; the tip once left its way by 360 mm."""
    drive = Drive("ur5e", ELBOW_AHEAD)
    rng = np.random.default_rng(1)
    tremor = np.zeros(3)
    for _ in range(400):
        tremor = 0.9 * tremor + 0.02 * rng.normal(size=3)
        drive.twist(np.concatenate((np.zeros(3), speed * (UP + tremor))), 0.01)
    off, turned = deviation(drive, UP)
    assert off < 0.01 and turned < TURNED
    last = drive.reports[-1]
    assert last.condition is ServoCondition.SINGULARITY
    assert max(report.condition_number for report in drive.reports) < HARD_STOP
    assert np.abs(drive.velocities[-10:]).max() < 1e-3
    drive.assert_limits()


@pytest.mark.parametrize("robot", ["ur5e", "panda"])
def test_commands_of_other_sizes_go_on_along_the_same_line(robot):
    q = ELBOW_AHEAD if robot == "ur5e" else robot_of(robot).midrange()
    drive = Drive(robot, q)
    rng = np.random.default_rng(4)
    for _ in range(60):
        drive.twist([0, 0, 0, 0, 0, rng.uniform(0.05, 1.0)], 0.05)
    off, turned = deviation(drive, UP)
    assert off < STRAIGHT and turned < TURNED
    drive.assert_limits()


@pytest.mark.parametrize(
    ("robot", "seed"), [("irb120", 5), ("general7r", 3), ("gen3", 0), ("general7r", 2)]
)
def test_accelerations_do_not_step_between_one_plan_and_the_next(robot, seed):
    """The jerk was 1.06, 1.014, 1.012 and 1.009 times its limit when twists changed in motion."""
    rng = np.random.default_rng(seed)
    drive = Drive(robot, random_start(robot, rng)[0], length=length_of(robot))
    for _ in range(4):
        drive.twist(rng.normal(size=6) * np.repeat((0.5, 0.3), 3), 0.4)
    drive.assert_limits()


def test_without_a_command_it_brakes_on_the_line():
    drive = Drive("ur5e", ELBOW_AHEAD)
    drive.twist([0, 0, 0, 0, 0, 1.0], 0.5)
    assert np.abs(drive.velocities[-1]).max() > 0.5
    drive.wait(2.0)
    assert drive.servo.motion.at_rest and not drive.velocities[-1].any()
    off, turned = deviation(drive, UP)
    assert off < STRAIGHT and turned < TURNED
    drive.assert_limits()


def test_a_twist_in_axes_of_the_tip_is_a_screw():
    """Turning about its own axis and moving along it, the tip stays on the axis."""
    drive = Drive("ur5e", ELBOW_AHEAD)
    T = forward_kinematics(drive.chain, drive.q)
    drive.twist(
        [0, 0, 0.8, 0, 0, 0.2], 1.0, axes=lambda q: forward_kinematics(drive.chain, q)[:3, :3]
    )
    way = (forward_kinematics(drive.chain, drive.path()) - T)[:, :3, 3] @ T[:3, :3]
    assert way[-1, 2] > 0.1 and np.abs(way[:, :2]).max() < STRAIGHT
    end = T[:3, :3].T @ forward_kinematics(drive.chain, drive.q)[:3, :3]
    assert end[2, 2] == pytest.approx(1.0, abs=1e-9)
    drive.assert_limits()


@pytest.mark.parametrize("robot", ["puma560", "irb120"])
def test_a_wrist_passes_its_singularity(robot):
    """The tip loses no motion there; it remains within a millimetre of its line."""
    chain = robot_of(robot)
    q = np.array([0.3, 0.6, -0.7, 0.4, 0.3, 0.2])
    twist = 0.5 * jacobian(chain, q)[:, 4] * -1.0
    drive = Drive(robot, q)
    drive.twist(twist, 3.0)
    assert drive.q[4] < -0.3
    assert max(report.condition_number for report in drive.reports) > HARD_STOP
    drive.assert_limits()


def test_a_pass_does_not_end_halfway_beyond_the_hard_stop():
    """It once stood at a condition number of 111."""
    rng = np.random.default_rng(0)
    random_start("fanuc_arcmate", rng)
    done = approach("fanuc_arcmate", *random_start("fanuc_arcmate", rng), 0.4)
    assert_on_its_line(done)
    assert max(report.condition_number for report in done.drive.reports) > 1e3
    assert done.drive.reports[-1].joints == ("joint_5",)


@pytest.mark.parametrize("robot", ["puma560", "panda"])
def test_a_free_motion_goes_on_from_any_knot_that_leaves_a_plan(robot):
    drive = Drive(robot)
    limits, q = drive.servo.limits, drive.chain.midrange()
    v, a = 0.3 * limits.velocity, -0.5 * limits.acceleration
    motion = Motion.joining(limits, 0.01, (q, v), a)
    position, velocity = motion.knot
    np.testing.assert_allclose(position, q, atol=1e-12)
    np.testing.assert_allclose(velocity, v, atol=1e-12)
    if limits.smoothing(0.01) > 1:
        times, _, velocities = motion.samples()
        begun = (velocities[1] - velocities[0]) / times[1]
        assert np.abs(begun - a).max() < 0.3 * np.abs(a).max()
        assert Motion.joining(limits, 0.01, (q, v), 1.01 * limits.acceleration) is None
    near = limits.upper - 1e-3
    assert Motion.joining(limits, 0.01, (near, v), a) is None
    assert Motion.joining(limits, 0.01, (near, 0.0 * v), 0.0 * a).at_rest
