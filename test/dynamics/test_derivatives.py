"""Derivatives of inverse and forward dynamics against complex steps and Pinocchio."""

import numpy as np
import pinocchio
import pytest
from arms_with_bodies import ROBOTS, assert_near, pinocchio_of, states, with_bodies

from robomech_ros.dynamics import (
    forward_dynamics_derivatives,
    inverse_dynamics_derivatives,
    mass_matrix,
)
from robomech_ros.robots import load_robot


def torques_of_any_numbers(chain, q, qd, qdd, gravity, wrench):
    """Newton's and Euler's equations about the mass centres, in base axes, complex or not."""
    R, p = np.eye(3, dtype=complex), np.zeros(3, dtype=complex)
    omega, alpha, a = np.zeros(3), np.zeros(3), -np.asarray(gravity)
    axes, points, moments, forces, centres = [], [], [], [], []
    for i, (row, body) in enumerate(zip(chain.packed[:-1], chain.bodies, strict=True)):
        arm = R @ row[10:]
        R = R @ row[1:10].reshape(3, 3)
        e = R[:, 2]
        if chain.types[i]:
            arm = arm + e * q[i]
        a = a + np.cross(alpha, arm) + np.cross(omega, np.cross(omega, arm))
        p = p + arm
        if chain.types[i]:
            a = a + 2 * np.cross(omega, e * qd[i]) + e * qdd[i]
        else:
            alpha = alpha + np.cross(omega, e * qd[i]) + e * qdd[i]
            omega = omega + e * qd[i]
            c, s = np.cos(q[i]), np.sin(q[i])
            R = R @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        r = R @ body.com
        inertia = R @ body.inertia @ R.T
        centre = a + np.cross(alpha, r) + np.cross(omega, np.cross(omega, r))
        axes.append(e)
        points.append(p)
        centres.append(p + r)
        forces.append(body.mass * centre)
        moments.append(inertia @ alpha + np.cross(omega, inertia @ omega))
    tip = p + R @ chain.packed[-1, 10:]
    tau = []
    for i in range(chain.n):
        f, n = -wrench[3:], -wrench[:3] - np.cross(tip - points[i], wrench[3:])
        for k in range(i, chain.n):
            f = f + forces[k]
            n = n + moments[k] + np.cross(centres[k] - points[i], forces[k])
        load = (f if chain.types[i] else n) @ axes[i]
        tau.append(load + chain.drives[i].reflected_inertia * qdd[i])
    return np.array(tau)


@pytest.mark.parametrize("seed", range(8))
def test_agree_with_complex_steps(random_chain, seed):
    chain = with_bodies(random_chain(seed, n=1 + seed % 7), seed)
    q, qd, qdd, tau = states(chain, 5, seed)
    rng = np.random.default_rng(seed)
    gravity, wrench = rng.normal(size=3) * 9, rng.normal(size=(5, 6)) * 9
    around = {"gravity": gravity, "tip_wrench": wrench}
    ours = inverse_dynamics_derivatives(chain, q, qd, qdd, **around)
    back = forward_dynamics_derivatives(chain, q, qd, tau, **around)
    step = 1e-30j
    for k in range(5):

        def columns(which, k=k, acceleration=qdd):
            given = [q[k], qd[k], acceleration[k]]
            made = []
            for unit in np.eye(chain.n):
                moved = list(given)
                moved[which] = given[which] + step * unit
                made.append(torques_of_any_numbers(chain, *moved, gravity, wrench[k]).imag / 1e-30)
            return np.array(made).T

        for matrix, which in ((ours.by_q, 0), (ours.by_qd, 1), (ours.by_qdd, 2)):
            exact = columns(which)
            assert np.abs(matrix[k] - exact).max() <= 1e-9 * max(np.abs(exact).max(), 1e-3)
        inverse = np.linalg.inv(mass_matrix(chain, q[k]))
        for matrix, which in ((back.by_q, 0), (back.by_qd, 1)):
            exact = -inverse @ columns(which, acceleration=back.qdd)
            assert np.abs(matrix[k] - exact).max() <= 1e-9 * max(np.abs(exact).max(), 1e-3)


@pytest.mark.parametrize("robot", ROBOTS)
def test_agree_with_pinocchio(robot):
    chain = load_robot(robot)
    model = pinocchio_of(chain)
    data = model.createData()
    q, qd, qdd, tau = states(chain)
    ours = inverse_dynamics_derivatives(chain, q, qd, qdd)
    theirs = [
        [np.array(part) for part in pinocchio.computeRNEADerivatives(model, data, *row)[:2]]
        for row in zip(q, qd, qdd, strict=True)
    ]
    assert_near(ours.by_q, np.array([pair[0] for pair in theirs]))
    assert_near(ours.by_qd, np.array([pair[1] for pair in theirs]))
    assert_near(ours.by_qdd, mass_matrix(chain, q))
    back = forward_dynamics_derivatives(chain, q[:50], qd[:50], tau[:50])
    for k in range(50):
        pinocchio.computeABADerivatives(model, data, q[k], qd[k], tau[k])
        for matrix, exact in (
            (back.by_q, data.ddq_dq),
            (back.by_qd, data.ddq_dv),
            (back.by_tau, data.Minv),
        ):
            whole = np.triu(exact) + np.triu(exact, 1).T if exact is data.Minv else exact
            assert_near(matrix[k : k + 1], whole[None], 1e-9)


def test_batches_are_their_rows():
    chain = load_robot("ur5e")
    q, qd, qdd = np.random.default_rng(1).uniform(-2, 2, (3, 2, 3, 6))
    wrench = np.arange(6.0)
    many = inverse_dynamics_derivatives(chain, q, qd, qdd, tip_wrench=wrench)
    one = inverse_dynamics_derivatives(chain, q[1, 2], qd[1, 2], qdd[1, 2], tip_wrench=wrench)
    for name in ("by_q", "by_qd", "by_qdd"):
        assert getattr(many, name).shape == (2, 3, 6, 6)
        np.testing.assert_array_equal(getattr(many, name)[1, 2], getattr(one, name))
    none = inverse_dynamics_derivatives(chain, *np.empty((3, 0, 6)))
    assert none.by_q.shape == (0, 6, 6)
