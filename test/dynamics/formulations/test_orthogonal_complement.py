"""The natural orthogonal complement: constraints, their wrenches, rates, and a moving base."""

import numpy as np
import pinocchio
import pytest
from arms_with_bodies import golden_arm, pinocchio_of
from formulation_arms import GRAVITY, furnished, relative, states

from robomech_ros.dynamics.formulations.dynamics_by_complement import (
    forward_dynamics_by_cholesky,
    forward_dynamics_by_reflections,
    inverse_dynamics_by_orthogonal_complement,
)
from robomech_ros.dynamics.formulations.lagrange import mass_matrix_gradient
from robomech_ros.dynamics.formulations.orthogonal_complement import natural_orthogonal_complement
from robomech_ros.errors import WrongSizeError

KINDS = ("RRRRRR", "RPRPRR", "PPPRRR", "PRP")
TWIST, TWIST_RATE = (0.3, -0.5, 0.7, 1.0, 2.0, -1.5), (1.0, 0.4, -0.6, 0.5, -2.0, 3.0)


@pytest.fixture(params=KINDS)
def arm(request, random_chain):
    types = ["RP".index(kind) for kind in request.param]
    return furnished(random_chain(5, len(types), types), 2)


def test_constraints_vanish_for_the_twists_that_joints_and_base_allow(arm):
    q, qd, _ = states(arm, 20)
    model = natural_orthogonal_complement(arm, q, qd, base_twist=TWIST)
    np.testing.assert_allclose(model.K @ model.T, 0.0, atol=1e-13)
    np.testing.assert_allclose(model.K @ model.T_0, -model.K_0, atol=1e-13)
    twists = model.twists[..., None]
    np.testing.assert_allclose(model.K @ twists, -model.K_0 @ np.array(TWIST)[:, None], atol=1e-11)
    # Nothing else keeps them: the null space of K has as many dimensions as there are joints.
    assert (np.linalg.matrix_rank(model.K, tol=1e-9) == 5 * arm.n).all()


def test_constraint_wrenches_do_no_work_and_come_from_the_constraints(arm):
    q, qd, qdd = states(arm, 20)
    model = natural_orthogonal_complement(arm, q, qd, base_twist=TWIST, base_twist_rate=TWIST_RATE)
    applied = model.gravity_wrenches(GRAVITY) + model.tip_wrenches([1, 2, 3, 4, 5, 6])
    wrenches = model.constraint_wrenches(qdd, applied)
    size = np.abs(wrenches).max()
    assert size > 1.0
    np.testing.assert_allclose(model.generalised(wrenches), 0.0, atol=1e-12 * size)
    for K, w in zip(model.K, wrenches, strict=True):
        multipliers = np.linalg.lstsq(K.T, w, rcond=1e-9)[0]
        np.testing.assert_allclose(K.T @ multipliers, w, atol=1e-11 * size)


def test_drives_reach_their_own_joints_only(arm):
    q, qd, _ = states(arm, 5)
    model = natural_orthogonal_complement(arm, q, qd)
    units = np.swapaxes(model.T, -1, -2) @ model.A
    np.testing.assert_allclose(units, np.broadcast_to(np.eye(arm.n), units.shape), atol=1e-13)


def test_the_rate_of_the_shaping_matrix_is_its_derivative(arm):
    q, qd, _ = states(arm, 5)
    step = 1e-6
    ahead, behind = (natural_orthogonal_complement(arm, q + h * qd, qd).T for h in (step, -step))
    rate = natural_orthogonal_complement(arm, q, qd).T_dot
    np.testing.assert_allclose(rate, (ahead - behind) / (2 * step), atol=1e-7)


def test_the_inertias_rate_less_twice_the_coupling_is_skew(arm):
    q, qd, _ = states(arm, 20)
    model = natural_orthogonal_complement(arm, q, qd)
    rate = np.einsum("...ijk,...k->...ij", mass_matrix_gradient(arm, q), qd)
    difference = rate - 2.0 * model.coupling
    scale = np.abs(rate).max()
    np.testing.assert_allclose(difference, -np.swapaxes(difference, -1, -2), atol=1e-12 * scale)


def test_a_moving_base_agrees_with_a_free_one_of_pinocchio(arm):
    model = pinocchio_of(arm, GRAVITY, pinocchio.JointModelFreeFlyer())
    data = model.createData()
    omega, v = np.array(TWIST[:3]), np.array(TWIST[3:])
    # Its rates are those that an eye on the base sees.
    first = np.concatenate((np.array(TWIST_RATE[3:]) - np.cross(omega, v), TWIST_RATE[:3]))
    q, qd, qdd = states(arm, 20)
    motion = {"gravity": GRAVITY, "base_twist": TWIST, "base_twist_rate": TWIST_RATE}
    tau = inverse_dynamics_by_orthogonal_complement(arm, q, qd, qdd, **motion)
    for ours, one, rate, acceleration in zip(tau, q, qd, qdd, strict=True):
        place = np.concatenate((np.zeros(6), [1.0], one))
        rates = np.concatenate((v, omega, rate))
        theirs = pinocchio.rnea(model, data, place, rates, np.concatenate((first, acceleration)))
        assert relative(ours, theirs[6:]) < 1e-10
    for forward in (forward_dynamics_by_cholesky, forward_dynamics_by_reflections):
        assert relative(forward(arm, q, qd, tau, **motion), qdd) < 1e-10


def test_golden_matrices(golden):
    case = golden("dynamics_6r")
    model = natural_orthogonal_complement(golden_arm(case), case["q"], case["qd"])
    np.testing.assert_allclose(model.generalised_inertia, case["M"], rtol=0, atol=1e-10)
    np.testing.assert_allclose(model.coupling @ case["qd"], case["coriolis"], rtol=0, atol=1e-10)
    weight = -model.generalised(model.gravity_wrenches(case["gravity"]))
    np.testing.assert_allclose(weight, case["gravity_torque"], rtol=0, atol=1e-10)


def test_a_base_twist_of_another_size_is_refused(golden):
    arm = golden_arm(golden("dynamics_6r"))
    with pytest.raises(WrongSizeError, match="base_twist has shape"):
        natural_orthogonal_complement(arm, [0] * 6, [0] * 6, base_twist=[0, 0, 0])
    with pytest.raises(WrongSizeError, match="base_twist_rate has shape"):
        natural_orthogonal_complement(arm, [0] * 6, [0] * 6, base_twist_rate=np.zeros((2, 6)))
