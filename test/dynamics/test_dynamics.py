"""Inverse and forward dynamics and their matrices: golden values, Pinocchio, and each other."""

import json
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from arms_with_bodies import ROBOTS, assert_near, golden_arm, pinocchio_of, states, with_bodies

from robomech_ros.dynamics import (
    bias_torque,
    coriolis_matrix,
    forward_dynamics,
    gravity_torque,
    inverse_dynamics,
    mass_matrix,
)
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import load_robot


def test_golden_planar_3r(golden):
    case, chain = golden("dynamics_planar3r"), load_robot("planar3r")
    q, qd, qdd = (np.array(case[key]) for key in ("q", "qd", "qdd"))
    down = {"gravity": [0, -9.81, 0]}
    np.testing.assert_allclose(mass_matrix(chain, q), case["M"], rtol=1e-12)
    np.testing.assert_allclose(gravity_torque(chain, q, **down), case["gravity_torque"], rtol=1e-12)
    np.testing.assert_allclose(inverse_dynamics(chain, q, qd, qdd, **down), case["tau"], rtol=1e-12)
    coriolis = coriolis_matrix(chain, q, qd) @ qd
    np.testing.assert_allclose(coriolis, case["coriolis"], rtol=1e-12)


def test_golden_6r(golden):
    case = golden("dynamics_6r")
    chain = golden_arm(case)
    q, qd, qdd = (np.array(case[key]) for key in ("q", "qd", "qdd"))
    close = {"rtol": 1e-10, "atol": 1e-12}
    np.testing.assert_allclose(mass_matrix(chain, q), case["M"], **close)
    np.testing.assert_allclose(gravity_torque(chain, q), case["gravity_torque"], **close)
    np.testing.assert_allclose(inverse_dynamics(chain, q, qd, qdd), case["tau"], **close)
    np.testing.assert_allclose(coriolis_matrix(chain, q, qd) @ qd, case["coriolis"], **close)


@pytest.mark.parametrize("robot", ROBOTS)
def test_agrees_with_pinocchio(robot):
    chain = load_robot(robot)
    model = pinocchio_of(chain)
    data = model.createData()
    q, qd, qdd, tau = states(chain)
    theirs = [pinocchio.rnea(model, data, *row) for row in zip(q, qd, qdd, strict=True)]
    assert_near(inverse_dynamics(chain, q, qd, qdd), np.array(theirs))
    theirs = [pinocchio.nonLinearEffects(model, data, *row) for row in zip(q, qd, strict=True)]
    assert_near(bias_torque(chain, q, qd), np.array(theirs))
    theirs = np.array([pinocchio.aba(model, data, *row) for row in zip(q, qd, tau, strict=True)])
    for method in ("articulated-body", "cholesky"):
        assert_near(forward_dynamics(chain, q, qd, tau, method=method), theirs)
    matrices = np.array([np.triu(pinocchio.crba(model, data, row)) for row in q])
    assert_near(mass_matrix(chain, q), matrices + np.swapaxes(np.triu(matrices, 1), -1, -2))
    theirs = [pinocchio.computeCoriolisMatrix(model, data, *row) for row in zip(q, qd, strict=True)]
    assert_near(coriolis_matrix(chain, q, qd), np.array(theirs))
    held = np.array([pinocchio.computeGeneralizedGravity(model, data, row) for row in q])
    # Nothing but rounding remains of the torques of an arm in a horizontal plane.
    error = np.abs(gravity_torque(chain, q) - held).max()
    assert error <= 1e-10 * max(1.0, np.abs(held).max())


def test_torques_are_those_of_the_sources():
    text = (Path(__file__).parents[1] / "data/source_torques.json").read_text(encoding="utf-8")
    for robot, torques in json.loads(text)["torques"].items():
        chain = load_robot(robot)
        i = np.outer([1.0, 2.0], np.arange(1, chain.n + 1))
        assert_near(
            inverse_dynamics(chain, np.sin(i), np.cos(i), np.sin(2.0 * i + 1.0)), torques, 1e-12
        )


@pytest.mark.parametrize("seed", range(14))
def test_random_arms_of_both_kinds_of_joints(random_chain, seed):
    chain = with_bodies(random_chain(seed, n=1 + seed % 7), seed)
    gravity = np.random.default_rng(seed).normal(size=3) * 9
    model = pinocchio_of(chain, gravity)
    data = model.createData()
    q, qd, qdd, tau = states(chain, 20, seed)
    wrench = np.random.default_rng(seed).normal(size=(20, 6)) * 30
    options = {"gravity": gravity, "tip_wrench": wrench}
    torque = inverse_dynamics(chain, q, qd, qdd, **options)
    for k in range(20):
        loads = loads_of(model, data, q[k], wrench[k], chain.tip)
        assert_near(
            torque[k : k + 1], pinocchio.rnea(model, data, q[k], qd[k], qdd[k], loads)[None]
        )
        for method in ("articulated-body", "cholesky"):
            ours = forward_dynamics(
                chain, q[k], qd[k], tau[k], gravity=gravity, tip_wrench=wrench[k], method=method
            )
            theirs = pinocchio.aba(model, data, q[k], qd[k], tau[k], loads)
            assert_near(ours[None], theirs[None])
    assert_near(forward_dynamics(chain, q, qd, torque, **options), qdd)


def loads_of(model, data, q, wrench, tip):
    """Bring the wrench on the tip, in base axes, to the frame of the last joint."""
    pinocchio.framesForwardKinematics(model, data, q)
    joint = model.njoints - 1
    at_tip = pinocchio.SE3(np.eye(3), data.oMf[model.getFrameId(tip)].translation)
    force = at_tip.act(pinocchio.Force(wrench[3:], wrench[:3]))
    loads = [pinocchio.Force.Zero() for _ in range(model.njoints)]
    loads[joint] = data.oMi[joint].actInv(force)
    return loads


@pytest.mark.parametrize("robot", ROBOTS)
def test_forward_dynamics_undoes_inverse_dynamics(robot):
    chain = load_robot(robot)
    q, qd, qdd, _ = states(chain)
    for method in ("articulated-body", "cholesky"):
        back = forward_dynamics(chain, q, qd, inverse_dynamics(chain, q, qd, qdd), method=method)
        assert_near(back, qdd, 1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_a_base_that_moves(random_chain, seed):
    chain = with_bodies(random_chain(seed, n=4), seed)
    model = pinocchio_of(chain, root=pinocchio.JointModelFreeFlyer())
    data = model.createData()
    q, qd, qdd, _ = states(chain, 20, seed)
    rng = np.random.default_rng(seed)
    for k in range(20):
        omega, v, alpha, a = rng.normal(size=(4, 3))
        # The base stands where the world is; its acceleration there has omega x v besides.
        placed = np.concatenate((np.zeros(6), [1.0], q[k]))
        rates = np.concatenate((v, omega, qd[k]))
        gains = np.concatenate((a - np.cross(omega, v), alpha, qdd[k]))
        theirs = pinocchio.rnea(model, data, placed, rates, gains)[6:]
        moving = {
            "base_twist": np.concatenate((omega, v)),
            "base_twist_rate": np.concatenate((alpha, a)),
        }
        ours = inverse_dynamics(chain, q[k], qd[k], qdd[k], **moving)
        assert_near(ours[None], theirs[None])
        for method in ("articulated-body", "cholesky"):
            back = forward_dynamics(chain, q[k], qd[k], ours, method=method, **moving)
            assert_near(back[None], qdd[k][None], 1e-9)


def test_a_wrench_on_the_tip_is_carried_by_the_transposed_jacobian(random_chain):
    chain = with_bodies(random_chain(3, n=7), 3)
    q, qd, _, _ = states(chain, 50)
    wrench = np.random.default_rng(1).normal(size=(50, 6))
    share = bias_torque(chain, q, qd) - bias_torque(chain, q, qd, tip_wrench=wrench)
    carried = np.einsum("kji,kj->ki", jacobian(chain, q), wrench)
    np.testing.assert_allclose(share, carried, rtol=0, atol=1e-9)
    one = gravity_torque(chain, q, tip_wrench=wrench[0])
    np.testing.assert_allclose(
        gravity_torque(chain, q) - one,
        np.einsum("kji,j->ki", jacobian(chain, q), wrench[0]),
        rtol=0,
        atol=1e-9,
    )


@pytest.mark.parametrize("seed", range(6))
def test_the_rate_of_the_mass_matrix_less_twice_the_coriolis_matrix_is_skew(random_chain, seed):
    # Slides in front, and a mass matrix that never changes, would make a test of nothing.
    chain = with_bodies(random_chain(seed, types=(0, 0, 1, 0, 1, 0)), seed)
    q, qd, _, _ = states(chain, 20, seed)
    step = 1e-6
    rate = (mass_matrix(chain, q + step * qd) - mass_matrix(chain, q - step * qd)) / (2 * step)
    C = coriolis_matrix(chain, q, qd)
    skew = rate - 2.0 * C
    # By difference quotients; exactly, the rate of M is C + C^T.
    assert np.abs(skew + np.swapaxes(skew, -1, -2)).max() < 1e-6 * np.abs(C).max()
    C_qd = np.einsum("kij,kj->ki", C, qd)
    np.testing.assert_allclose(
        C_qd, bias_torque(chain, q, qd, gravity=[0, 0, 0]), rtol=0, atol=1e-9 * np.abs(C_qd).max()
    )


def test_batches_are_their_rows():
    chain = load_robot("panda")
    q, qd, qdd = np.random.default_rng(1).uniform(-2, 2, (3, 2, 3, chain.n))
    for function, given, shape in (
        (inverse_dynamics, (q, qd, qdd), (2, 3, 7)),
        (forward_dynamics, (q, qd, qdd), (2, 3, 7)),
        (bias_torque, (q, qd), (2, 3, 7)),
        (gravity_torque, (q,), (2, 3, 7)),
        (mass_matrix, (q,), (2, 3, 7, 7)),
        (coriolis_matrix, (q, qd), (2, 3, 7, 7)),
    ):
        many = function(chain, *given)
        assert many.shape == shape
        np.testing.assert_array_equal(many[1, 2], function(chain, *(one[1, 2] for one in given)))
        none = function(chain, *(np.empty((0, 7)) for _ in given))
        assert none.shape == (0, *shape[2:])
