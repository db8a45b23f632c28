"""Energy, momentum, power and friction, and the linearity in the bodies' parameters."""

import dataclasses

import numpy as np
import pinocchio
import pytest
from arms_with_bodies import ROBOTS, assert_near, pinocchio_of, states, with_bodies

from robomech_ros.dynamics import (
    base_parameters,
    body_parameters,
    center_of_mass,
    dissipated_power,
    dissipation,
    friction_torque,
    gravity_torque,
    inverse_dynamics,
    kinetic_energy,
    mass_matrix,
    momentum,
    potential_energy,
    power_balance,
    torque_regressor,
)
from robomech_ros.errors import NonFiniteError, WrongSizeError
from robomech_ros.robots import Drive, load_robot


@pytest.mark.parametrize("robot", ROBOTS)
def test_energies_and_momentum(robot):
    chain = load_robot(robot)
    model = pinocchio_of(chain)
    data = model.createData()
    q, qd, _, _ = states(chain, 50)
    M = mass_matrix(chain, q)
    assert_near(kinetic_energy(chain, q, qd), 0.5 * np.einsum("ki,kij,kj->k", qd, M, qd), 1e-12)
    for k in range(50):
        centre = pinocchio.centerOfMass(model, data, q[k])
        about = pinocchio.computeCentroidalMomentum(model, data, q[k], qd[k])
        angular = about.angular + np.cross(centre, about.linear)
        ours = momentum(chain, q[k], qd[k])
        np.testing.assert_allclose(center_of_mass(chain, q[k]), centre, atol=1e-13)
        np.testing.assert_allclose(ours, np.concatenate((angular, about.linear)), atol=1e-11)
        potential = pinocchio.computePotentialEnergy(model, data, q[k])
        assert potential_energy(chain, q[k]) == pytest.approx(potential, rel=1e-14, abs=1e-11)


def test_gravity_is_the_gradient_of_the_potential_energy(random_chain):
    chain = with_bodies(random_chain(4), 4)
    q, step = np.linspace(-1, 1, 6), 1e-6
    gradient = [
        (potential_energy(chain, q + step * unit) - potential_energy(chain, q - step * unit))
        / (2 * step)
        for unit in np.eye(6)
    ]
    np.testing.assert_allclose(gravity_torque(chain, q), gradient, rtol=1e-7, atol=1e-7)


@pytest.mark.parametrize("robot", ROBOTS)
def test_power_is_balanced(robot):
    chain = load_robot(robot)
    q, qd, _, tau = states(chain, 100)
    wrench = np.random.default_rng(2).normal(size=(100, 6))
    power = power_balance(chain, q, qd, tau, tip_wrench=wrench)
    sources, sinks = power.drives + power.tip, power.kinetic + power.potential + power.friction
    parts = np.abs([power.drives, power.tip, power.kinetic, power.potential, power.friction])
    np.testing.assert_allclose(sources, sinks, rtol=0, atol=1e-12 * parts.max())
    np.testing.assert_allclose(power.friction, dissipated_power(chain, qd), rtol=1e-12, atol=1e-12)
    assert (power.friction >= 0).all()


def test_friction_is_the_derivative_of_the_dissipation():
    chain = load_robot("planar3r")
    drives = (Drive(0.5, 2.0), Drive(0.1, 1.0, 3.0, 0.2), Drive(static=0.5, stribeck_velocity=0.1))
    chain = dataclasses.replace(chain, drives=drives)
    step = 1e-7
    for qd in ([0.3, -0.1, 0.05], [-2.0, 0.4, -0.2]):
        qd = np.array(qd)
        gradient = [
            (dissipation(chain, qd + step * unit) - dissipation(chain, qd - step * unit))
            / (2 * step)
            for unit in np.eye(3)
        ]
        np.testing.assert_allclose(friction_torque(chain, qd), gradient, rtol=1e-7, atol=1e-8)
    np.testing.assert_array_equal(friction_torque(chain, np.zeros(3)), np.zeros(3))
    np.testing.assert_allclose(friction_torque(chain, [1.0, 1e200, 1.0])[0], 2.5)
    slow = friction_torque(chain, [1e-9, -1e-9, 1e-9])
    np.testing.assert_allclose(slow, [2.0, -3.0, 0.5], rtol=1e-6)
    with pytest.raises(NonFiniteError, match="qd of joint 'joint_2'"):
        friction_torque(chain, [0, np.nan, 0])
    with pytest.raises(WrongSizeError, match="qd"):
        dissipation(chain, [0, 0])


@pytest.mark.parametrize("seed", range(7))
def test_torques_are_linear_in_the_parameters(random_chain, seed):
    chain = with_bodies(random_chain(seed, n=1 + seed), seed)
    q, qd, qdd, _ = states(chain, 20, seed)
    rng = np.random.default_rng(seed)
    around = {
        "gravity": rng.normal(size=3),
        "base_twist": rng.normal(size=6),
        "base_twist_rate": rng.normal(size=(20, 6)),
    }
    Y = torque_regressor(chain, q, qd, qdd, **around)
    assert Y.shape == (20, chain.n, 10 * chain.n)
    rotors = np.array([drive.reflected_inertia for drive in chain.drives]) * qdd
    torque = inverse_dynamics(chain, q, qd, qdd, **around)
    assert_near(Y @ body_parameters(chain).ravel() + rotors, torque)
    np.testing.assert_array_equal(
        torque_regressor(chain, q[3], qd[3], qdd[3], gravity=[0, 0, -1]),
        torque_regressor(chain, q, qd, qdd, gravity=[0, 0, -1])[3],
    )


@pytest.mark.parametrize(
    ("robot", "rank"),
    # Seven for each revolute joint, but one for a first that is vertical (Mayeda, Yoshida, Osuka,
    # IEEE Trans. Robotics and Automation 6, 1990; of the Panda Gaz and others count 43); an arm in
    # a horizontal plane shows two first moments and a moment of each link but the first.
    [("puma560", 36), ("ur5e", 36), ("panda", 43), ("planar3r", 7)],
)
def test_base_parameters(robot, rank):
    chain = load_robot(robot)
    base = base_parameters(chain)
    assert base.rank == rank
    q, qd, qdd, _ = states(chain, 50)
    Y = torque_regressor(chain, q, qd, qdd)
    p = body_parameters(chain).ravel()
    kept = Y[..., base.columns] @ (base.combination @ p)
    np.testing.assert_allclose(kept, Y @ p, rtol=0, atol=1e-9 * np.abs(Y @ p).max())
    np.testing.assert_array_equal(base.combination[:, base.columns], np.eye(rank))
