"""Euler-Lagrange: exact derivatives of the mass matrix, energies, and the dissipation function."""

import numpy as np
import pytest
from formulation_arms import GRAVITY, furnished, golden_planar, relative, states

from robomech_ros.dynamics.formulations.lagrange import (
    christoffel_symbols,
    inverse_dynamics_by_lagrange,
    mass_matrix_gradient,
)
from robomech_ros.dynamics.formulations.orthogonal_complement import natural_orthogonal_complement
from robomech_ros.dynamics.friction import dissipation, friction_torque


@pytest.fixture(params=("RRRRRR", "RPRPRR", "PRP"))
def arm(request, random_chain):
    types = ["RP".index(kind) for kind in request.param]
    return furnished(random_chain(6, len(types), types), 1, drives=True)


def test_the_gradient_is_that_of_the_generalised_inertia(arm):
    q, qd, _ = states(arm, 4)
    step = 1e-6
    gradient = mass_matrix_gradient(arm, q)
    for k in range(arm.n):
        h = step * np.eye(arm.n)[k]
        ahead, behind = (
            natural_orthogonal_complement(arm, q + sign * h, qd).generalised_inertia
            for sign in (1, -1)
        )
        np.testing.assert_allclose(gradient[..., k], (ahead - behind) / (2 * step), atol=1e-6)


def test_christoffel_symbols_are_symmetric_and_give_the_gradient_back(arm):
    q, _, _ = states(arm, 4)
    symbols, gradient = christoffel_symbols(arm, q), mass_matrix_gradient(arm, q)
    np.testing.assert_allclose(symbols, np.swapaxes(symbols, -1, -2), atol=1e-12)
    # c_ijk + c_jik = dI_ij / dq_k
    np.testing.assert_allclose(symbols + np.swapaxes(symbols, -3, -2), gradient, atol=1e-11)


def test_power_is_the_rate_of_the_energies(arm):
    q, qd, qdd = states(arm, 10)
    tau = inverse_dynamics_by_lagrange(arm, q, qd, qdd, gravity=GRAVITY)
    h = 1e-5

    def energy(t):
        place, rate = q + t * qd + 0.5 * t * t * qdd, qd + t * qdd
        model = natural_orthogonal_complement(arm, place, rate)
        kinetic = np.einsum("...i,...ij,...j", rate, model.generalised_inertia, rate) / 2
        return kinetic - model.bodies.centres @ GRAVITY @ model.bodies.masses

    power = (energy(h) - energy(-h)) / (2 * h)
    np.testing.assert_allclose((tau * qd).sum(axis=-1), power, rtol=1e-7, atol=1e-5)


def test_friction_is_the_gradient_of_the_dissipation(arm):
    _, qd, _ = states(arm, 50)
    h, gradient = 1e-6, friction_torque(arm, qd)
    for k in range(arm.n):
        step = h * np.eye(arm.n)[k]
        ahead, behind = (dissipation(arm, qd + sign * step) for sign in (1, -1))
        np.testing.assert_allclose(gradient[..., k], (ahead - behind) / (2 * h), atol=1e-6)
    assert not friction_torque(arm, np.zeros(arm.n)).any()


def test_planar_arm_in_closed_form(golden):
    """The mass matrix of section 7.6.1 in terms of c2, c3 and c23."""
    case = golden("dynamics_planar3r")
    (l1, l2, _), (d1, d2, d3), (m1, m2, m3), (i1, i2, i3) = (
        case["params"][key] for key in ("l", "lc", "m", "I")
    )
    arm = golden_planar(case)
    q, qd, qdd = states(arm, 50)
    _, q2, q3 = q.T
    c2, c3, c23 = np.cos(q2), np.cos(q3), np.cos(q2 + q3)
    third = i3 + m3 * d3**2
    second = i2 + m2 * d2**2 + m3 * l2**2
    m33 = third + 0 * c2
    m23 = third + m3 * l2 * d3 * c3
    m22 = third + second + 2 * m3 * l2 * d3 * c3
    m13 = m23 + m3 * l1 * d3 * c23
    m12 = m22 + (m2 * d2 + m3 * l2) * l1 * c2 + m3 * l1 * d3 * c23
    first = i1 + m1 * d1**2 + (m2 + m3) * l1**2
    m11 = first + m22 + 2 * (m2 * d2 + m3 * l2) * l1 * c2 + 2 * m3 * l1 * d3 * c23
    rows = np.array([[m11, m12, m13], [m12, m22, m23], [m13, m23, m33]])
    expected = np.einsum("ijk,kj->ki", rows, qdd)
    tau = inverse_dynamics_by_lagrange(arm, q, 0 * qd, qdd, gravity=[0, 0, 0])
    assert relative(tau, expected) < 1e-13
