"""Time-optimal motions of parallel robots within the efforts of their drives."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from tree_of_pinocchio import TreeOfPinocchio

from robomech_ros.cartesian import waypoint_path
from robomech_ros.dynamics import ChainDynamics, inverse_dynamics
from robomech_ros.errors import BadValueError, MissingLimitsError, WrongSizeError
from robomech_ros.parallel import ParallelDynamics, follow_drives, load_parallel, plan_platform
from robomech_ros.robots import Body, load_robot
from robomech_ros.spatial import matrix_from_rotation_vector
from robomech_ros.trajectory import Limits, PiecewisePolynomial, spline_through, torque_limited

# Of each robot: turn and way of its platform (rad, m) from home, and efforts of its drives (N m or
# N) that end its accelerations before their speeds do.
MOVES = {
    "hexapod": ((0.1, -0.05, 0.08), (0.04, 0.03, 0.08), 250.0),
    "delta": ((0.0, 0.0, 0.0), (0.1, 0.2, 0.1), 20.0),
    "planar_3rrr": ((0.0, 0.0, 0.5), (0.1, 0.0, 0.0), 4.0),
}


@cache
def followed(name):
    """The dynamics of a robot, and a path of all its joints along a line of its platform."""
    mechanism = load_parallel(name).mechanism
    turn, way, _ = MOVES[name]
    here = mechanism.pose(mechanism.home())
    there = here.copy()
    there[:3, :3] = here[:3, :3] @ matrix_from_rotation_vector(turn)
    there[:3, 3] += way
    plan = plan_platform(mechanism, waypoint_path(here, [there]), mechanism.home())
    assert plan.stop is None
    return ParallelDynamics(mechanism), plan.followed.joints.pieces


def speeds(robot, **others):
    """The velocity limits of a mechanism alone."""
    mechanism = robot.mechanism
    return Limits(mechanism.joint_names, **{"velocity": mechanism.velocity, **others})


def states(robot, motion, count):
    """All joints, found from the drives alone, and motions of the drives at instants."""
    at = motion.sample(np.linspace(0.0, motion.duration, count)[1:-1])
    way = follow_drives(robot.mechanism, at.position, robot.mechanism.home())
    assert way.stop is None
    return way.q, at.velocity, at.acceleration


def loads(robot, motion, effort, friction=False, count=4_000):
    """The largest effort, and the largest effort or speed, in parts of the limits at instants."""
    q, rates, gains = states(robot, motion, count)
    taken = robot.inverse(q, rates, gains)
    taken = taken + robot.friction(q, rates) if friction else taken
    parts = (np.abs(taken) / effort).max(axis=1)
    limits = robot.mechanism.velocity[robot.drives_at]
    return parts, np.maximum(parts, (np.abs(rates) / limits).max(axis=1))


@pytest.mark.parametrize("name", MOVES)
@pytest.mark.parametrize("friction", [False, True])
def test_a_drive_is_at_a_limit_nearly_all_the_time(name, friction):
    robot, path = followed(name)
    effort = np.full(len(robot.drives_at), MOVES[name][2])
    lost = robot.friction if friction else None
    motion = torque_limited(path, speeds(robot), robot, effort=effort, friction=lost)
    assert motion.pieces.joints == len(effort)
    parts, most = loads(robot, motion, effort, friction)
    assert 1.0 - 1e-4 < parts.max() <= 1.0 + 1e-6
    assert most.max() <= 1.0 + 1e-6
    assert np.quantile(most, 0.1) > 0.999
    ends = path.sample(path.breaks[[0, -1]]).position[:, robot.drives_at]
    reached = motion.sample([0.0, motion.duration])
    np.testing.assert_allclose(reached.position, ends, atol=1e-12)
    np.testing.assert_allclose(reached.velocity, 0.0, atol=1e-12)


@pytest.mark.parametrize("name", MOVES)
def test_multipliers_on_the_tree_of_pinocchio_find_the_same_efforts_at_their_limits(name):
    robot, path = followed(name)
    effort = np.full(len(robot.drives_at), MOVES[name][2])
    motion = torque_limited(path, speeds(robot), robot, effort=effort)
    tree, largest = TreeOfPinocchio(robot.mechanism), []
    for q, rates, gains in zip(*states(robot, motion, 202), strict=True):
        qd = robot.joint_rates(q, rates)
        qdd = robot.mechanism.accelerations(q, qd, gains)[0]
        largest.append((np.abs(tree.inverse(q, qd, qdd)) / effort).max())
    assert 0.999 < max(largest) <= 1.0 + 1e-6


@pytest.mark.parametrize("name", MOVES)
def test_tighter_efforts_and_payloads_take_longer(name):
    robot, path = followed(name)
    effort = np.full(len(robot.drives_at), MOVES[name][2])
    loaded = robot.with_payload(Body(2.0, [0.0, 0.0, 0.05], 1e-3 * np.eye(3)))
    base = torque_limited(path, speeds(robot), robot, effort=effort).duration
    assert torque_limited(path, speeds(robot), robot, effort=0.7 * effort).duration > 1.05 * base
    slower = torque_limited(path, speeds(robot), loaded, effort=effort)
    assert slower.duration > 1.01 * base
    assert loads(loaded, slower, effort)[0].max() <= 1.0 + 1e-6


def test_the_limits_of_a_mechanism_are_its_own():
    robot, path = followed("hexapod")
    mechanism = robot.mechanism
    motion = torque_limited(path, mechanism, robot)
    q, rates, gains = states(robot, motion, 2_000)
    assert (np.abs(robot.inverse(q, rates, gains)) <= 2000.0 * (1.0 + 1e-6)).all()
    assert (np.abs(gains) <= 5.0 * (1.0 + 1e-6)).all()
    weak = replace(speeds(robot), acceleration=np.where(np.arange(36) == 2, 0.5, np.inf))
    assert torque_limited(path, weak, robot, effort=np.full(6, 2000.0)).duration > motion.duration


def test_speeds_of_passive_joints_count():
    robot, path = followed("delta")
    effort, most = np.full(3, 20.0), robot.mechanism.velocity.copy()
    free = torque_limited(path, speeds(robot), robot, effort=effort)
    q, rates, _ = states(robot, free, 2_000)
    joint = robot.joint_names.index("leg1_elbow_swing")
    fastest = np.abs(robot.joint_rates(q, rates)[:, joint]).max()
    most[joint] = 0.5 * fastest
    motion = torque_limited(path, speeds(robot, velocity=most), robot, effort=effort)
    q, rates, _ = states(robot, motion, 2_000)
    found = np.abs(robot.joint_rates(q, rates)[:, joint]).max()
    assert 0.99 * most[joint] < found <= most[joint] * (1.0 + 1e-5)
    assert motion.pieces.joints == 3 and motion.duration > free.duration


@pytest.mark.slow
def test_corners_of_a_way_of_the_platform_are_passed_at_rest():
    robot, _ = followed("delta")
    mechanism = robot.mechanism
    here = mechanism.pose(mechanism.home())
    up, over = here.copy(), here.copy()
    up[2, 3] += 0.05
    over[:3, 3] += 0.1, 0.0, 0.05
    plan = plan_platform(mechanism, waypoint_path(here, [up, over]), mechanism.home())
    effort = np.full(3, 20.0)
    path = plan.followed.joints.pieces
    motion = torque_limited(path, speeds(robot), robot, effort=effort, friction=robot.friction)
    assert loads(robot, motion, effort, True)[0].max() <= 1.0 + 1e-6
    assert (motion.speeds[1:-1] == 0.0).any()


def test_a_chain_as_a_system_is_the_chain():
    chain = load_robot("ur5e")
    points = [[0.0, -1.0, 1.0, 0.0, 0.5, 0.0], [0.9, -0.5, 0.3, -0.7, -0.4, 0.8]]
    path = spline_through(points, times=[0.0, 1.0], ends="natural").pieces
    limits = Limits(chain.joint_names, velocity=chain.velocity)
    motions = [
        torque_limited(path, limits, dynamics, effort=0.6 * chain.effort)
        for dynamics in (lambda *state: inverse_dynamics(chain, *state), ChainDynamics(chain))
    ]
    np.testing.assert_allclose(motions[1].duration, motions[0].duration, rtol=1e-9)


def test_what_is_refused():
    robot, path = followed("planar_3rrr")
    effort = np.full(3, 4.0)
    with pytest.raises(MissingLimitsError, match=r"no effort limit for joints leg1_base"):
        torque_limited(path, speeds(robot), robot)
    with pytest.raises(MissingLimitsError, match="no velocity limit for joints leg1_base"):
        torque_limited(path, Limits(robot.joint_names), robot, effort=effort)
    with pytest.raises(WrongSizeError, match="effort"):
        torque_limited(path, speeds(robot), robot, effort=np.full(9, 4.0))
    with pytest.raises(WrongSizeError, match="joints of the path"):
        torque_limited(
            PiecewisePolynomial(path.breaks, path.coefficients[:, :, robot.drives_at]),
            speeds(robot),
            robot,
            effort=effort,
        )
    opened = path.coefficients.copy()
    opened[0, :, 1] += 1e-3
    expected = r"path.* has open loops: limb [23] ends .* closed loops"
    with pytest.raises(BadValueError, match=expected):
        torque_limited(
            PiecewisePolynomial(path.breaks, opened), speeds(robot), robot, effort=effort
        )
    with pytest.raises(BadValueError, match="friction"):
        torque_limited(path, speeds(robot), robot, effort=effort, friction=1.0)
    with pytest.raises(BadValueError, match="torque limits"):
        hexapod, line = followed("hexapod")
        torque_limited(line, speeds(hexapod), hexapod, effort=np.full(6, 20.0))
    with pytest.raises(BadValueError, match="inverse_dynamics"):
        torque_limited(path, speeds(robot), ParallelDynamics, effort=effort)
