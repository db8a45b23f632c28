"""Parallel robots that move freely: energy, closed loops, limits, and modes that end."""

import numpy as np
import pytest

from robomech_ros.dynamics import simulate
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.parallel import ParallelDynamics, load_parallel


def dynamics_of(name):
    robot = load_parallel(name)
    robot.parts = type(robot.parts)(robot.parts.bodies)
    return ParallelDynamics(robot.mechanism)


@pytest.fixture(scope="module")
def planar():
    return dynamics_of("planar_3rrr")


def closed(robot, motion, errors=1e-10):
    """Loops of all states, and rates that keep them closed."""
    assert robot.mechanism.loop_errors(motion.q).max() < errors * max(1.0, robot.mechanism.size)
    rates = robot.joint_rates(motion.q, motion.qd[:, robot.drives_at])
    np.testing.assert_allclose(motion.qd, rates, atol=1e-12 * (1.0 + np.abs(rates).max()))


def test_free_motion_keeps_the_energy_for_ten_seconds(planar):
    """No drive and no gravity: what is there is kinetic, and goes from body to body."""
    q = planar.mechanism.home()
    found = simulate(planar, q, [0.02, -0.01, 0.03], None, 10.0, rtol=1e-12, atol=1e-13)
    assert found.reason == "finished"
    assert found.t[-1] == 10.0
    assert np.ptp(found.q, axis=0).max() > 0.1
    assert found.drift < 1e-8 * found.kinetic[0]
    assert (found.work == 0.0).all()
    closed(planar, found)


@pytest.mark.parametrize(
    ("name", "seconds"),
    [
        ("hexapod", 2.0),
        ("delta", 10.0),
        ("agile_eye", 2.0),
        pytest.param("hexapod", 10.0, marks=pytest.mark.long),
        pytest.param("agile_eye", 10.0, marks=pytest.mark.long),
    ],
)
def test_on_springs_energy_goes_to_and_fro(name, seconds):
    """Springs at the drives, and gravity: the energy of all that is kept."""
    robot = dynamics_of(name)
    q = robot.mechanism.home()
    start, still = q[robot.drives_at], np.zeros(len(robot.drive_names))
    holding = robot.gravity(q)
    stiff = 400.0 * np.diag(robot.mass_matrix(q))
    pull = 0.02 * stiff * (-1.0) ** np.arange(len(stiff))
    pull[0] *= 2.0

    def springs(t, q, qd):
        return holding + pull - stiff * (q[robot.drives_at] - start)

    found = simulate(robot, q, still, springs, seconds, rtol=1e-12, atol=1e-13)
    assert found.reason == "finished"
    assert np.ptp(found.kinetic) > 0.0
    stretched = found.q[:, robot.drives_at] - start
    stored = 0.5 * (stretched**2) @ stiff - stretched @ (holding + pull)
    whole = found.kinetic + found.potential + stored
    size = np.ptp(found.kinetic) + np.ptp(found.potential)
    assert np.abs(whole - whole[0]).max() < 1e-8 * size
    assert found.drift < 1e-8 * size
    closed(robot, found)


def test_methods_agree_and_the_midpoint_rule_keeps_the_energy(planar):
    q, rates = planar.mechanism.home(), [0.1, -0.1, 0.2]
    exact = simulate(planar, q, rates, None, 0.5, times=[0.5])
    found = simulate(planar, q, rates, None, 0.5, times=[0.5], method="Radau", rtol=1e-9)
    np.testing.assert_allclose(found.q, exact.q, atol=1e-8)
    found = simulate(planar, q, rates, None, 0.5, method="midpoint", step=5e-3)
    np.testing.assert_allclose(found.q[-1], exact.q[-1], atol=1e-4)
    assert found.drift < 1e-6 * found.kinetic[0]
    closed(planar, found)


def test_friction_and_a_wrench_on_the_platform_are_in_the_balance():
    robot = ParallelDynamics(load_parallel("delta").mechanism)
    q, still = robot.mechanism.home(), np.zeros(3)
    holding = robot.gravity(q)

    def torque(t, q, qd):
        return holding + 3.0 * np.array([np.sin(3.0 * t), np.cos(2.0 * t), np.sin(t)])

    wrench = [0.0, 0.0, 0.0, 1.0, -2.0, 0.5]
    found = simulate(robot, q, still, torque, 1.0, tip_wrench=wrench, rest_rate=0.1, rtol=1e-12)
    assert found.reason == "finished"
    assert found.heat[-1] > 1e-3
    assert (np.diff(found.heat) >= -1e-12).all()
    assert found.drift < 1e-9
    closed(robot, found)


def test_a_mode_that_ends_is_told_and_the_last_state_is_good():
    """A hexapod that falls: without drives its legs hold nothing."""
    robot = dynamics_of("planar_3rrr")
    found = simulate(robot, robot.mechanism.home(), [3.0, 3.0, -3.0], None, 5.0)
    assert found.reason.startswith("the assembly mode is lost") or "singular" in found.reason
    assert 0.0 < found.t[-1] < 5.0
    assert np.isfinite(found.q).all()
    closed(robot, found)


def test_limits_of_drives_and_of_passive_joints():
    robot = dynamics_of("hexapod")
    q, still = robot.mechanism.home(), np.zeros(6)
    found = simulate(robot, q, still, None, 2.0, at_limits="end")
    assert "limit at" in found.reason
    joint = found.reason.split("'")[1]
    assert joint in robot.joint_names
    i = robot.joint_names.index(joint)
    edge = min(abs(found.q[-1, i] - robot.lower[i]), abs(found.q[-1, i] - robot.upper[i]))
    assert edge < 1e-9
    found = simulate(robot, q, still, None, 0.5, at_limits="bounce", restitution=1.0)
    assert found.drift < 1e-6 * np.ptp(found.potential)
    closed(robot, found)


def test_wrong_starts_are_named():
    robot = dynamics_of("hexapod")
    q, still = robot.mechanism.home(), np.zeros(6)
    with pytest.raises(WrongSizeError, match="q0"):
        simulate(robot, still, still, None, 1.0)
    with pytest.raises(WrongSizeError, match="qd0"):
        simulate(robot, q, q, None, 1.0)
    with pytest.raises(NonFiniteError, match="qd0 of joint 'leg2_length'"):
        simulate(robot, q, [0.0, np.nan, 0.0, 0.0, 0.0, 0.0], None, 1.0)
    with pytest.raises(WrongSizeError, match="torque"):
        simulate(robot, q, still, lambda t, q, qd: np.zeros(36), 1.0)
    away = q.copy()
    away[1] += 0.1
    with pytest.raises(BadValueError, match="q0 has open loops: limb . ends.*closed loops"):
        simulate(robot, away, still, None, 1.0)
    with pytest.raises(BadValueError, match="chain"):
        simulate(robot.mechanism, q, still, None, 1.0)
