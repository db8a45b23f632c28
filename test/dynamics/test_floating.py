"""A chain on a free base: against Pinocchio's free flyer, and against its own simulation."""

from dataclasses import replace

import numpy as np
import pinocchio
import pytest
from arms_with_bodies import pinocchio_of, with_bodies
from wrong_values import WRONG_VALUES, answered_or_refused, with_options

from robomech_ros.dynamics import (
    FloatingBase,
    FloatingChain,
    FloatingDynamics,
    follow_floating_path,
    move_floating_tip,
    simulate_floating,
    with_payload,
)
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import Body, chain_from_dh, load_robot
from robomech_ros.spatial import pose_error, pose_exponential, quaternion_from_matrix

ARMS = ("canadarm2", "ur5e", "planar3r")
# A spacecraft of nine tons.
BODY = Body(9e3, [0.1, -0.2, -2.0], [[9e4, 3e3, 6e3], [3e3, 7e4, -3e3], [6e3, -3e3, 6e4]])
POSE = pose_exponential([0.4, -0.9, 0.3, 1.0, 2.0, -0.5])
# Pinocchio has the linear part of twists and wrenches first.
LINEAR_FIRST = [3, 4, 5, 0, 1, 2]


@pytest.fixture(scope="module")
def arm():
    return FloatingChain(load_robot("canadarm2"), BODY)


def of_pinocchio(robot):
    """Return the model with a free flyer, data, and the places of our numbers in its vectors."""
    model = pinocchio_of(robot.chain, gravity=(0, 0, 0), root=pinocchio.JointModelFreeFlyer())
    inertia = pinocchio.Inertia(BODY.mass, np.array(BODY.com), np.array(BODY.inertia))
    model.appendBodyToJoint(1, inertia, pinocchio.SE3.Identity())
    return model, model.createData(), [*LINEAR_FIRST, *range(6, 6 + robot.n)]


def configuration(pose, q):
    return np.concatenate((pose[:3, 3], quaternion_from_matrix(pose[:3, :3]), q))


def state(robot, seed=3, size=1.0):
    rng = np.random.default_rng(seed)
    q = robot.chain.home() + rng.uniform(-0.5, 0.5, robot.n)
    return q, *(size * rng.uniform(-1.0, 1.0, (2, 6 + robot.n)))


@pytest.mark.parametrize("name", [*ARMS, "slides"])
def test_dynamics_and_momentum_are_those_of_pinocchios_free_flyer(name, random_chain):
    if name == "slides":
        chain = with_bodies(random_chain(5, 6, [0, 1, 0, 1, 0, 0]), 5)
    else:
        chain = load_robot(name)
    robot = FloatingChain(chain, BODY)
    q, u, du = state(robot)
    model, data, order = of_pinocchio(robot)
    at, v, a = configuration(POSE, q), u[order], du[order]
    M = np.triu(pinocchio.crba(model, data, at))
    M = M + np.triu(M, 1).T
    np.testing.assert_allclose(robot.mass_matrix(q), M[np.ix_(order, order)], atol=1e-9 * M.max())
    efforts = pinocchio.rnea(model, data, at, v, a)[order]
    scale = np.abs(efforts).max()
    np.testing.assert_allclose(robot.inverse(q, u, du), efforts, atol=1e-11 * scale)
    found = pinocchio.aba(model, data, at, v, efforts[order])[order]
    np.testing.assert_allclose(robot.forward(q, u, efforts), found, atol=1e-9)
    pinocchio.computeCentroidalMap(model, data, at)
    whole = (data.Ag @ v)[LINEAR_FIRST].reshape(2, 3) @ POSE[:3, :3]
    pinocchio.ccrba(model, data, at, v)
    inside = robot.momentum(q, u)
    np.testing.assert_allclose(inside, whole.ravel(), atol=1e-11 * np.abs(whole).max())
    np.testing.assert_allclose(data.hg.vector[:3], POSE[:3, :3] @ inside[3:], atol=1e-9)
    centre = POSE[:3, :3] @ robot.center_of_mass(q) + POSE[:3, 3]
    np.testing.assert_allclose(centre, data.com[0], atol=1e-12)
    energy = pinocchio.computeKineticEnergy(model, data, at, v)
    assert robot.kinetic_energy(q, u) == pytest.approx(energy, rel=1e-12)
    assert 0.5 * u @ robot.mass_matrix(q) @ u == pytest.approx(energy, rel=1e-12)


def test_loads_and_gravity_are_those_of_the_fixed_chain(arm):
    q, u, du = state(arm)
    pulled = {"gravity": [1.0, -2.0, -9.0], "tip_wrench": [5.0, 4.0, 3.0, 2.0, 1.0, 6.0]}
    efforts = arm.inverse(q, u, du, **pulled)
    np.testing.assert_allclose(arm.forward(q, u, efforts, **pulled), du, atol=1e-10)
    left = arm.inverse(q, 0 * u, 0 * du, **pulled)
    load = arm.tip_jacobian(q).T @ pulled["tip_wrench"]
    weight = arm.mass_matrix(q)[:, 3:6] @ pulled["gravity"]
    np.testing.assert_allclose(left, -load - weight, atol=1e-8)


def test_momentum_and_energy_stay_over_a_minute(arm):
    q, u, _ = state(arm, size=0.03)
    run = simulate_floating(arm, POSE, q, u, None, 60.0, times=np.linspace(0.0, 60.0, 13))
    assert run.reason == "finished"
    assert np.abs(run.momentum - run.momentum[0]).max() < 1e-10
    assert np.ptp(run.kinetic) < 1e-10 * run.kinetic[0]
    # Momentum, energy and mass centre again, by Pinocchio, from nothing but the states.
    model, data, order = of_pinocchio(arm)
    centres = []
    for pose, at, rates, energy in zip(run.poses, run.q, run.rates, run.kinetic, strict=True):
        q, v = configuration(pose, at), rates[order]
        pinocchio.ccrba(model, data, q, v)
        np.testing.assert_allclose(data.hg.vector[LINEAR_FIRST], run.momentum[0], atol=1e-10)
        assert pinocchio.computeKineticEnergy(model, data, q, v) == pytest.approx(energy, abs=1e-9)
        centres.append(data.com[0].copy())
    path = centres[0] + np.outer(run.t, run.momentum[0, 3:] / arm.mass)
    np.testing.assert_allclose(centres, path, atol=1e-10)


def test_a_simulation_follows_the_equations_of_pinocchio(arm):
    """Differences of simulated rates are accelerations, and work is what the drives put in."""
    q, u, _ = state(arm, size=0.1)
    push = np.array([40.0, -90.0, 70.0, 60.0, -30.0, 20.0, 10.0])
    h = 1e-3
    grid = [0.0, 1.0 - h, 1.0, 1.0 + h, 2.0]
    run = simulate_floating(arm, POSE, q, u, lambda t, q, u: push * np.cos(t), 2.0, times=grid)
    model, data, order = of_pinocchio(arm)
    efforts = np.concatenate((np.zeros(6), push * np.cos(1.0)))
    at = configuration(run.poses[2], run.q[2])
    expected = pinocchio.aba(model, data, at, run.rates[2][order], efforts)[order]
    differences = (run.rates[3] - run.rates[1]) / (2.0 * h)
    np.testing.assert_allclose(differences, expected, atol=1e-6 * np.abs(expected).max())
    turned = pose_error(run.poses[3], run.poses[1])[:3] / (2.0 * h)
    np.testing.assert_allclose(run.poses[2][:3, :3] @ run.rates[2][:3], turned, atol=1e-6)
    assert run.work[-1] == pytest.approx(run.kinetic[-1] - run.kinetic[0], rel=1e-9)
    torques, base = arm.torques(run.q[2], run.rates[2], expected[6:])
    np.testing.assert_allclose(torques, efforts[6:], atol=1e-8)
    np.testing.assert_allclose(base, expected[:6], atol=1e-11)


def test_the_generalised_jacobian_is_what_the_tip_of_a_simulation_does(arm):
    q, u, _ = state(arm, size=0.05)
    u = arm.rates(q, u[6:])
    h = 1e-3
    run = simulate_floating(arm, POSE, q, u, None, 2 * h, times=[0.0, h, 2 * h])
    twist = pose_error(run.tips[2], run.tips[0]) / (2.0 * h)
    R = run.poses[1][:3, :3]
    expected = arm.generalized_jacobian(run.q[1]) @ run.rates[1][6:]
    np.testing.assert_allclose(twist, (R @ expected.reshape(2, 3).T).T.ravel(), atol=1e-7)


@pytest.mark.parametrize(("still", "count"), [("pose", 1), ("orientation", 4)])
def test_reactionless_rates_leave_the_base_still(arm, still, count):
    q, _, _ = state(arm)
    basis = arm.reactionless(q, still)
    assert basis.shape == (7, count)
    for rates in basis.T:
        twist = arm.rates(q, rates)[:6]
        assert np.abs(twist if still == "pose" else twist[:3]).max() < 1e-12


def test_the_tip_is_held_and_led_straight_in_inertial_space(arm):
    q = arm.chain.home()
    # The base drifts and turns while the tip is held.
    start = arm.rates(q, np.zeros(7), momentum=[90.0, -60.0, 30.0, 60.0, -30.0, 60.0])
    held = move_floating_tip(arm, POSE, q, None, 30.0, rates=start)
    assert held.reason == "finished"
    assert np.abs(pose_error(held.tips, held.tips[:1])).max() < 1e-8
    assert np.linalg.norm(held.poses[-1][:3, 3] - held.poses[0][:3, 3]) > 0.01
    assert np.abs(held.momentum - held.momentum[0]).max() < 1e-10
    first = POSE @ forward_kinematics(arm.chain, q)
    goal = pose_exponential([0.1, 0.2, -0.1, 0.0, 0.0, 0.0]) @ first
    goal[:3, 3] = first[:3, 3] + [0.8, -0.6, 0.5]
    led = move_floating_tip(arm, POSE, q, goal, 60.0)
    assert led.reason == "finished"
    assert np.abs(pose_error(goal, led.tips[-1])).max() < 1e-9
    way, line = led.tips[:, :3, 3] - first[:3, 3], np.array([0.8, -0.6, 0.5])
    assert np.abs(np.cross(way, line / np.linalg.norm(line))).max() < 1e-8
    assert np.abs(led.momentum).max() < 1e-10
    assert pose_error(led.poses[-1], POSE)[3:] @ line < 0.0
    # Too far: the arm stretches out.
    goal[:3, 3] += [60.0, 0.0, 0.0]
    lost = move_floating_tip(arm, POSE, q, goal, 600.0)
    assert 0 < len(lost.t) < 101
    assert "singular" in lost.reason or "limit" in lost.reason


def test_a_servo_holds_the_tip_on_a_base_that_drifts(arm):
    """Rates at 20 Hz for 5 s, and the base that conserves its momentum."""
    q, step = arm.chain.home(), 0.05
    base = FloatingBase(arm, q, [90.0, -60.0, 30.0, 60.0, -30.0, 60.0], POSE)
    held = base.pose @ forward_kinematics(arm.chain, q)
    for _ in range(100):
        R = base.pose[:3, :3]
        inside = (base.momentum.reshape(2, 3) @ R).ravel()
        rates = arm.joint_rates(q, np.zeros(6), inside)
        q = q + step * rates
        base.move(q, rates, step)
    assert np.linalg.norm(base.pose[:3, 3] - POSE[:3, 3]) > 0.01
    tip = base.pose @ forward_kinematics(arm.chain, q)
    assert np.abs(pose_error(held, tip)).max() < 1e-4
    with pytest.raises(BadValueError, match="regular generalised Jacobian"):
        FloatingChain(load_robot("planar3r"), BODY).joint_rates(np.zeros(3), np.zeros(6))


def test_whatever_is_given_it_answers_or_refuses(arm):
    q, u = arm.chain.home(), np.zeros(13)
    calls = {
        **with_options(FloatingChain, chain=arm.chain),
        **with_options(arm.mass_matrix, q=q),
        **with_options(arm.momentum, q=q, rates=u),
        **with_options(arm.center_of_mass, q=q),
        **with_options(arm.kinetic_energy, q=q, rates=u),
        **with_options(arm.rates, q=q, qd=q),
        **with_options(arm.generalized_jacobian, q=q),
        **with_options(arm.joint_rates, q=q, twist=np.zeros(6)),
        **with_options(arm.reactionless, q=q),
        **with_options(arm.inverse, q=q, rates=u, accelerations=u),
        **with_options(arm.forward, q=q, rates=u, efforts=u),
        **with_options(arm.torques, q=q, rates=u, qdd=q),
    }
    for call in calls.values():
        answered_or_refused(call, [*WRONG_VALUES, q, u, 1e300 * u + 1e300, np.full(7, np.nan)])


def test_wrong_arguments_are_named(arm):
    q, u = arm.chain.home(), np.zeros(13)
    with pytest.raises(BadValueError, match="base"):
        FloatingChain(arm.chain, Body(0.0, [0, 0, 0], np.eye(3)))
    with pytest.raises(BadValueError, match="chain"):
        FloatingChain("ur5e")
    with pytest.raises(WrongSizeError, match="rates"):
        arm.momentum(q, u[:6])
    with pytest.raises(NonFiniteError, match="momentum"):
        arm.rates(q, q, momentum=[np.nan] * 6)
    with pytest.raises(BadValueError, match="still"):
        arm.reactionless(q, "tip")
    with pytest.raises(WrongSizeError, match="torque"):
        simulate_floating(arm, POSE, q, u, lambda t, q, u: [1.0], 1.0)
    with pytest.raises(BadValueError, match="duration"):
        simulate_floating(arm, POSE, q, u, None, -1.0)
    with pytest.raises(BadValueError, match="robot"):
        move_floating_tip(arm.chain, POSE, q, None, 1.0)
    with pytest.raises(BadValueError, match="torque"):
        simulate_floating(arm, POSE, q, u, lambda t, q, u: ["much"] * 7, 1.0)
    with pytest.raises(BadValueError, match="robot"):
        move_floating_tip(None, POSE, q, None, 1.0)
    for torque in (np.inf, 1e300, 1e80):
        end = simulate_floating(arm, POSE, q, u, lambda t, q, u, T=torque: np.full(7, T), 1.0)
        assert ("ran away" in end.reason or "failed" in end.reason) and len(end.t) == 1


def test_numbers_without_a_finite_result_are_named(arm):
    q, u = arm.chain.home(), np.zeros(13)
    for call, text in (
        (lambda: arm.rates(q, np.full(7, np.nan)), r"qd\[0\] is nan"),
        (lambda: arm.rates(q, np.full(7, 1e308)), r"largest of qd is 1e\+308"),
        (lambda: arm.rates(q, q, np.full(6, 1e308)), r"largest of momentum is 1e\+308"),
        (lambda: arm.inverse(q, u, u, gravity=np.full(3, 1e308)), "largest of gravity"),
        (lambda: arm.forward(q, u, u, tip_wrench=np.full(6, 1e308)), "largest of tip_wrench"),
        (lambda: arm.mass_matrix(np.full(7, np.nan)), r"q\[0\] is nan"),
    ):
        with pytest.raises((BadValueError, NonFiniteError), match=text):
            call()


def test_points_on_one_line_do_not_resist_a_turn_about_it():
    """Rounding leaves their inertia about the line above zero."""
    chain = chain_from_dh([0.3, 0.3], [0.0, 0.0], [0.0, 0.0])
    point = Body(1.0, [0.0, 0.0, 0.0], np.zeros((3, 3)))
    robot = FloatingChain(replace(chain, bodies=(point, point)))
    with pytest.raises(BadValueError, match="bodies that resist every motion of the base"):
        robot.rates([0.3, 0.3], [1.0, 1.0])
    with pytest.raises(BadValueError, match="number of joints is 2, expected 6 or more"):
        move_floating_tip(robot, POSE, [0.3, 0.3], None, 1.0)


def test_times_may_repeat_and_torques_cannot_change_the_state(arm):
    q, still = arm.chain.home(), np.zeros(13)

    def careless(t, values, rates):
        values[:], rates[:] = 9.0, 9.0
        return np.zeros(7)

    run = simulate_floating(arm, POSE, q, still, careless, 0.1, times=[0.0, 0.0, 0.1])
    np.testing.assert_array_equal(run.t, [0.0, 0.0, 0.1])
    np.testing.assert_allclose(run.q, [q, q, q], atol=1e-12)


def test_a_base_reacts_to_joints_as_the_simulation_has_it(arm):
    """Captured bodies add their momentum, as Pinocchio computes it from poses and twists alone."""
    q, _, _ = state(arm)
    goal = POSE @ forward_kinematics(arm.chain, q)
    goal[:3, 3] += [0.3, -0.2, 0.2]
    run = move_floating_tip(arm, POSE, q, goal, 20.0, times=np.linspace(0.0, 20.0, 401))
    base = FloatingBase(arm, q, pose=POSE)
    for values, rates in zip(run.q[1:], run.rates[1:], strict=True):
        base.move(values, rates[6:], 0.05)
    np.testing.assert_allclose(base.pose, run.poses[-1], atol=1e-9)
    np.testing.assert_allclose(base.rates, run.rates[-1], atol=1e-12)
    load, velocity = Body(700.0, [0.1, 0.2, 0.9], 90.0 * np.eye(3)), [0.1, -0.2, 0.05]
    base.capture(load, velocity)
    loaded = FloatingChain(with_payload(arm.chain, load), BODY)
    model, data, order = of_pinocchio(loaded)
    tip = base.pose @ forward_kinematics(arm.chain, run.q[-1])
    pinocchio.ccrba(model, data, configuration(base.pose, run.q[-1]), base.rates[order])
    away = tip[:3, :3] @ load.com + tip[:3, 3] - data.com[0]
    linear = 700.0 * np.array(velocity)
    expected = np.concatenate((np.cross(away, linear), linear))
    np.testing.assert_allclose(data.hg.vector[LINEAR_FIRST], expected, atol=1e-9)
    np.testing.assert_allclose(base.momentum, expected, atol=1e-9)
    # The released body keeps its momentum, and the base its own.
    before = base.rates.copy()
    base.capture(None)
    np.testing.assert_allclose(base.rates, before, atol=1e-15)
    assert base.robot is arm


def test_a_body_captured_by_a_drifting_base_leaves_the_momentum_about_the_origin_as_it_was(arm):
    q, _, _ = state(arm)
    base = FloatingBase(arm, q, [90.0, -60.0, 30.0, 600.0, -300.0, 900.0], POSE)
    base.move(q, np.zeros(7), 0.5)

    def centre():
        return base.pose[:3, :3] @ base.robot.center_of_mass(q) + base.pose[:3, 3]

    def about_origin():
        return base.momentum[:3] + np.cross(centre(), base.momentum[3:])

    before, linear = about_origin(), base.momentum[3:]
    base.capture(Body(700.0, [0.1, 0.2, 0.9], 90.0 * np.eye(3)))
    np.testing.assert_allclose(about_origin(), before, rtol=1e-9)
    np.testing.assert_allclose(base.momentum[3:], linear, rtol=1e-9)


def test_drives_of_a_free_base_have_the_efforts_of_the_free_flyer(arm):
    momentum = np.array([90.0, -60.0, 30.0, 60.0, -30.0, 60.0])
    system = FloatingDynamics(arm, momentum)
    q, u, du = (np.array([state(arm, seed, 0.1)[k] for seed in (3, 4)]) for k in range(3))
    qd, qdd = u[:, 6:], du[:, 6:]
    wrench = np.array([5.0, 4.0, 3.0, 2.0, 1.0, 6.0])
    tau = system.inverse(q, qd, qdd, gravity=[1.0, 2.0, -9.0], tip_wrench=wrench)
    np.testing.assert_allclose(system.forward(q, qd, tau, tip_wrench=wrench), qdd, atol=1e-12)
    torques, _ = arm.torques(q[0], arm.rates(q[0], qd[0], momentum), qdd[0])
    np.testing.assert_allclose(system.inverse(q, qd, qdd)[0], torques, atol=1e-8)
    inertial = np.einsum("kij,kj->ki", system.mass_matrix(q), qdd)
    still = system.without_momentum()
    np.testing.assert_allclose(still.inverse(q, 0.0 * qd, qdd), inertial, atol=1e-8)
    energies = [arm.kinetic_energy(at, arm.rates(at, v)) for at, v in zip(q, qd, strict=True)]
    np.testing.assert_allclose(still.kinetic_energy(q, qd), energies, rtol=1e-12)
    np.testing.assert_allclose(
        [0.5 * v @ M @ v for v, M in zip(qd, system.mass_matrix(q), strict=True)], energies
    )
    with pytest.raises(BadValueError, match="fixed base"):
        system.coriolis_matrix(q[0], qd[0])


@pytest.mark.slow
def test_wrong_arguments_of_a_free_base_are_named(arm):
    q = arm.chain.home()
    base, tip = FloatingBase(arm, q), POSE @ forward_kinematics(arm.chain, q)
    calls = {
        **with_options(FloatingBase, robot=arm, q=q),
        **with_options(FloatingDynamics, robot=arm),
        **with_options(
            follow_floating_path,
            robot=arm,
            pose=POSE,
            q=q,
            path=lambda s: (tip, np.zeros(6)),
            duration=0.1,
        ),
        **with_options(base.move, q=q, qd=q, seconds=0.0),
        **with_options(base.capture, body=Body(1.0, np.zeros(3), np.eye(3))),
    }
    for call in calls.values():
        answered_or_refused(call, [*WRONG_VALUES, q, 1e300 + q, np.full(7, np.nan)])
    for path in (lambda s: POSE, lambda s: (POSE, [1.0])):
        with pytest.raises((BadValueError, WrongSizeError), match="path"):
            follow_floating_path(arm, POSE, q, path, 1.0)
    with pytest.raises(NonFiniteError, match="momentum"):
        FloatingBase(arm, q, [np.nan] * 6)
    with pytest.raises(NonFiniteError, match="momentum"):
        FloatingDynamics(arm, [np.inf] * 6)
    with pytest.raises(BadValueError, match="seconds"):
        base.move(q, q, -1.0)
