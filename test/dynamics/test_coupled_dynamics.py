"""Dynamics where joints follow others: Pinocchio's of all joints, through the coupling."""

import numpy as np
import pytest

from robomech_ros.dynamics import (
    base_parameters,
    bias_torque,
    body_parameters,
    consistent_fit,
    coriolis_matrix,
    forward_dynamics,
    gravity_torque,
    identify,
    inverse_dynamics,
    inverse_dynamics_by_kane,
    inverse_dynamics_derivatives,
    kinetic_energy,
    mass_matrix,
    potential_energy,
    power_balance,
    simulate,
    with_payload,
)
from robomech_ros.errors import BadValueError
from robomech_ros.robots import Body
from test.coupled_robots import coupled, with_bodies

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


def test_the_formulations_of_the_book_are_refused_in_words(chain):
    with pytest.raises(BadValueError, match="followers"):
        inverse_dynamics_by_kane(chain, *np.zeros((3, chain.n)))
