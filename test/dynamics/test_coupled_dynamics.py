"""Dynamics where joints follow others: Pinocchio's of all joints, through the coupling."""

from dataclasses import replace

import numpy as np
import pytest

from robomech_ros.dynamics import (
    base_parameters,
    bias_torque,
    body_parameters,
    christoffel_symbols,
    consistent_fit,
    coriolis_matrix,
    forward_dynamics,
    forward_dynamics_by_cholesky,
    forward_dynamics_by_kane,
    forward_dynamics_by_lagrange,
    forward_dynamics_by_reflections,
    gravity_torque,
    identify,
    inverse_dynamics,
    inverse_dynamics_by_kane,
    inverse_dynamics_by_lagrange,
    inverse_dynamics_by_orthogonal_complement,
    inverse_dynamics_derivatives,
    kinetic_energy,
    mass_matrix,
    mass_matrix_gradient,
    natural_orthogonal_complement,
    newton_euler,
    partial_velocities,
    planar_orthogonal_complement,
    potential_energy,
    power_balance,
    simulate,
    with_payload,
)
from robomech_ros.robots import Body, Drive, load_description
from test.coupled_robots import DATA, coupled, lifter, with_bodies

pinocchio = pytest.importorskip("pinocchio")


@pytest.fixture(params=["palletizer", "coupled_finger", "hollow_wrist"])
def chain(request):
    return with_bodies(coupled(request.param))


def pinocchio_model(chain):
    """All joints of a chain, as if each moved by itself, with its bodies."""
    model, parent = pinocchio.Model(), 0
    whole = chain.uncoupled
    for k, (name, body) in enumerate(zip(whole.joint_names, whole.bodies, strict=True)):
        place = pinocchio.SE3(whole.transforms[k])
        parent = model.addJoint(parent, pinocchio.JointModelRZ(), place, name)
        inertia = pinocchio.Inertia(body.mass, body.com, body.inertia)
        model.appendBodyToJoint(parent, inertia, pinocchio.SE3.Identity())
    return model, model.createData()


def test_inverse_dynamics_and_mass_matrix_are_pinocchios(chain):
    model, data = pinocchio_model(chain)
    A, random = chain.coupling.matrix, np.random.default_rng(3)
    for q, qd, qdd in random.uniform(-1.0, 1.0, (10, 3, chain.n)):
        values = chain.joint_values(q)
        tau = A.T @ pinocchio.rnea(model, data, values, A @ qd, A @ qdd)
        np.testing.assert_allclose(inverse_dynamics(chain, q, qd, qdd), tau, atol=1e-11)
        M = np.triu(pinocchio.crba(model, data, values))
        M = A.T @ (M + np.triu(M, 1).T) @ A
        np.testing.assert_allclose(mass_matrix(chain, q), M, atol=1e-11)
        gravity = A.T @ pinocchio.computeGeneralizedGravity(model, data, values)
        np.testing.assert_allclose(gravity_torque(chain, q), gravity, atol=1e-11)
        bias = A.T @ pinocchio.nle(model, data, values, A @ qd)
        np.testing.assert_allclose(bias_torque(chain, q, qd), bias, atol=1e-11)
        for method in ("articulated-body", "cholesky"):
            found = forward_dynamics(chain, q, qd, tau, method=method)
            np.testing.assert_allclose(found, qdd, atol=1e-8)
        np.testing.assert_allclose(kinetic_energy(chain, q, qd), 0.5 * qd @ M @ qd, atol=1e-11)
        balance = power_balance(chain, q, qd, tau)
        np.testing.assert_allclose(balance.drives, balance.kinetic + balance.potential, atol=1e-8)
        np.testing.assert_allclose(coriolis_matrix(chain, q, qd) @ qd, bias - gravity, atol=1e-11)


def test_a_rotor_turns_with_its_drive_whatever_follows_it():
    text = (DATA / "coupled_finger.urdf").read_text(encoding="utf-8")
    text = text.replace('multiplier="0.8"', 'multiplier="3"')
    chain = with_bodies(load_description(text).chain())
    rotors = 0.1 * np.arange(1.0, chain.n + 1.0)
    driven = replace(chain, drives=tuple(Drive(rotor_inertia=one) for one in rotors))
    q = np.random.default_rng(8).uniform(0.0, 0.3, chain.n)
    added = mass_matrix(driven, q) - mass_matrix(chain, q)
    np.testing.assert_allclose(added, np.diag(rotors), atol=1e-12)


def test_derivatives_by_differences(chain):
    q, qd, qdd = np.random.default_rng(4).uniform(-1.0, 1.0, (3, chain.n))
    found, h = inverse_dynamics_derivatives(chain, q, qd, qdd), 1e-6 * np.eye(chain.n)
    for given, by in ((found.by_q, 0), (found.by_qd, 1), (found.by_qdd, 2)):
        columns = []
        for step in h:
            ahead, behind = [q, qd, qdd], [q, qd, qdd]
            ahead[by], behind[by] = ahead[by] + step, behind[by] - step
            change = inverse_dynamics(chain, *ahead) - inverse_dynamics(chain, *behind)
            columns.append(change / 2e-6)
        np.testing.assert_allclose(given, np.array(columns).T, atol=1e-6)
    slope = [(potential_energy(chain, q + s) - potential_energy(chain, q - s)) / 2e-6 for s in h]
    np.testing.assert_allclose(gravity_torque(chain, q), slope, atol=1e-6)


def test_bodies_are_identified_as_far_as_the_drives_show_them(chain):
    q, qd, qdd = np.random.default_rng(5).uniform(-1.0, 1.0, (3, 80, chain.n))
    friction = 0.3 * qd + 0.1 * np.sign(qd)
    found = identify(chain, q, qd, qdd, inverse_dynamics(chain, q, qd, qdd) + friction)
    known = base_parameters(chain).combination @ body_parameters(chain).ravel()
    np.testing.assert_allclose(found.base_values, known, atol=1e-7)
    np.testing.assert_allclose(found.viscous, 0.3, atol=1e-8)
    np.testing.assert_allclose(found.coulomb, 0.1, atol=1e-8)
    assert len(consistent_fit(found).chain.bodies) == len(chain.all_joint_names)


def test_a_payload_and_a_motion_that_keeps_its_energy(chain):
    loaded = with_payload(chain, Body(2.0, np.array([0.0, 0.1, 0.0]), 0.01 * np.eye(3)))
    q, qd = np.random.default_rng(6).uniform(-0.5, 0.5, (2, chain.n))
    motion = simulate(loaded, q, qd, lambda t, q, qd: np.zeros(chain.n), duration=0.2)
    ends = motion.q[[0, -1]], motion.qd[[0, -1]]
    energy = kinetic_energy(loaded, *ends) + potential_energy(loaded, ends[0])
    assert abs(energy[1] - energy[0]) < 1e-6 * max(1.0, abs(energy[0]))


def test_the_formulations_of_the_book_agree_with_pinocchio(chain):
    model, data = pinocchio_model(chain)
    rotors = 0.1 * np.arange(1.0, chain.n + 1.0)
    chain = replace(chain, drives=tuple(Drive(rotor_inertia=one) for one in rotors))
    A = chain.coupling.matrix
    states = np.random.default_rng(7).uniform(-1.0, 1.0, (4, 3, chain.n))
    tau = [
        A.T @ pinocchio.rnea(model, data, chain.joint_values(q), A @ qd, A @ qdd) + rotors * qdd
        for q, qd, qdd in states
    ]
    q, qd, qdd = states.swapaxes(0, 1)
    for inverse in (
        inverse_dynamics_by_kane,
        inverse_dynamics_by_lagrange,
        inverse_dynamics_by_orthogonal_complement,
        lambda *motion: newton_euler(*motion).torques,
    ):
        np.testing.assert_allclose(inverse(chain, q, qd, qdd), tau, atol=1e-11)
    for forward in (
        forward_dynamics_by_cholesky,
        forward_dynamics_by_kane,
        forward_dynamics_by_lagrange,
        forward_dynamics_by_reflections,
    ):
        np.testing.assert_allclose(forward(chain, q, qd, tau), qdd, atol=1e-8)


def test_the_wrenches_at_the_joints_are_those_of_all_joints(chain):
    q, qd, qdd = np.random.default_rng(8).uniform(-1.0, 1.0, (3, chain.n))
    rates, A = chain.joint_rates(qd), chain.coupling.matrix
    whole = newton_euler(chain.uncoupled, chain.joint_values(q), rates, A @ qdd)
    np.testing.assert_array_equal(
        newton_euler(chain, q, qd, qdd).joint_wrenches, whole.joint_wrenches
    )
    partial, each = (
        partial_velocities(chain, q),
        partial_velocities(chain.uncoupled, chain.joint_values(q)),
    )
    for name in ("angular", "linear"):
        velocity = np.einsum("ija,j->ia", getattr(partial, name), qd)
        np.testing.assert_allclose(
            velocity, np.einsum("ija,j->ia", getattr(each, name), rates), atol=1e-13
        )


def test_the_complement_holds_the_coupling_among_its_constraints():
    chain = with_bodies(lifter())
    q, qd, qdd, twist = np.random.default_rng(9).uniform(-1.0, 1.0, (4, 3))
    base = {"base_twist": [*twist, *qdd], "base_twist_rate": [*qd, *q]}
    model = natural_orthogonal_complement(chain, q, qd, **base)
    np.testing.assert_allclose(model.K @ model.T, 0.0, atol=1e-14)
    np.testing.assert_allclose(model.K @ model.twists, -model.K_0 @ base["base_twist"], atol=1e-13)
    # All but the three rates of the drives are constrained.
    assert np.linalg.matrix_rank(model.K) == 24 - 3
    np.testing.assert_allclose(model.T.T @ model.A, np.eye(3), atol=1e-14)
    holding = model.constraint_wrenches(qdd, model.gravity_wrenches([0, 0, -9.81]))
    np.testing.assert_allclose(model.T.T @ holding, 0.0, atol=1e-12)


def test_the_gradient_of_the_mass_matrix_by_differences(chain):
    q, qd = np.random.default_rng(10).uniform(-1.0, 1.0, (2, chain.n))
    steps = 1e-6 * np.eye(chain.n)
    slopes = [(mass_matrix(chain, q + h) - mass_matrix(chain, q - h)) / 2e-6 for h in steps]
    np.testing.assert_allclose(mass_matrix_gradient(chain, q), np.stack(slopes, -1), atol=1e-6)
    C = christoffel_symbols(chain, q) @ qd
    np.testing.assert_allclose(C @ qd, coriolis_matrix(chain, q, qd) @ qd, atol=1e-11)


def test_the_complement_of_a_planar_finger():
    finger = with_bodies(load_description(DATA / "coupled_finger.urdf").chain("knuckle", "tip"))
    q, qd = np.array([[0.3], [0.7]])
    model = planar_orthogonal_complement(finger, q, qd)
    assert model.T.shape == (6, 1)
    np.testing.assert_allclose(model.generalised_inertia, mass_matrix(finger, q), atol=1e-13)
    np.testing.assert_allclose(model.coupling, coriolis_matrix(finger, q, qd), atol=1e-13)
