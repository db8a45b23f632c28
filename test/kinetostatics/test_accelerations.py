"""The Jacobian's time derivative: golden values, Pinocchio, complex steps, and what is refused."""

import numpy as np
import pinocchio
import pytest

from robomech_ros.errors import NonFiniteError, WrongSizeError
from robomech_ros.kinetostatics import bias_acceleration, jacobian, jacobian_rate
from robomech_ros.robots import list_robots, load_robot


def test_golden_rate_and_twist_rate_of_the_fanuc_arc_mate(golden):
    case = golden("kinetostatics_fanuc")
    chain, q, qd = load_robot("fanuc_arcmate"), case["theta"], case["qd"]
    rate = jacobian_rate(chain, q, qd)
    np.testing.assert_allclose(rate, case["Jdot"], rtol=0, atol=1e-12)
    twist_rate = jacobian(chain, q) @ case["qdd"] + bias_acceleration(chain, q, qd)
    np.testing.assert_allclose(twist_rate, case["twist_rate"], rtol=0, atol=1e-12)


@pytest.mark.parametrize("robot", list_robots())
def test_agrees_with_pinocchio(robot, pinocchio_model):
    chain, model = load_robot(robot), pinocchio_model(robot)
    data, tip = model.createData(), model.getFrameId(chain.tip)
    rng = np.random.default_rng(5)
    q, qd = rng.uniform(-3, 3, (2, 100, chain.n))
    for rows in zip(q, qd, jacobian_rate(chain, q, qd), strict=True):
        pinocchio.computeJointJacobiansTimeVariation(model, data, rows[0], rows[1])
        theirs = pinocchio.getFrameJacobianTimeVariation(
            model, data, tip, pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        )
        np.testing.assert_allclose(rows[2], np.roll(theirs, 3, axis=0), rtol=0, atol=1e-10)


def complex_jacobian(chain, q):
    """The Jacobian from the definition, with complex numbers."""
    T, axes, points = np.eye(4, dtype=complex), [], []
    for i, row in enumerate(chain.packed):
        C = np.eye(4, dtype=complex)
        C[:3, :3], C[:3, 3] = row[1:10].reshape(3, 3), row[10:]
        T = T @ C
        if i == chain.n:
            break
        axes.append(T[:3, 2])
        points.append(T[:3, 3])
        J = np.eye(4, dtype=complex)
        if chain.types[i]:
            J[2, 3] = q[i]
        else:
            c, s = np.cos(q[i]), np.sin(q[i])
            J[:2, :2] = [[c, -s], [s, c]]
        T = T @ J
    columns = [
        np.concatenate((0 * e, e)) if kind else np.concatenate((e, np.cross(e, T[:3, 3] - o)))
        for e, o, kind in zip(axes, points, chain.types, strict=True)
    ]
    return np.array(columns).T


@pytest.mark.parametrize("seed", range(20))
def test_agrees_with_complex_steps(random_chain, seed):
    chain = random_chain(seed, n=1 + seed % 8)
    q, qd = np.random.default_rng(seed).uniform(-2, 2, (2, chain.n))
    theirs = complex_jacobian(chain, q + 1e-30j * qd).imag / 1e-30
    np.testing.assert_allclose(jacobian_rate(chain, q, qd), theirs, rtol=0, atol=1e-12)


def test_batches_are_their_rows():
    chain = load_robot("panda")
    q, qd = np.random.default_rng(1).uniform(-2, 2, (2, 3, 4, chain.n))
    rates, bias = jacobian_rate(chain, q, qd), bias_acceleration(chain, q, qd)
    assert rates.shape == (3, 4, 6, chain.n) and bias.shape == (3, 4, 6)
    np.testing.assert_array_equal(rates[1, 2], jacobian_rate(chain, q[1, 2], qd[1, 2]))
    np.testing.assert_allclose(bias[1, 2], rates[1, 2] @ qd[1, 2], rtol=0, atol=1e-14)


def test_what_is_refused():
    chain = load_robot("puma560")
    with pytest.raises(WrongSizeError, match=r"qd .*\(6,\), that of q"):
        jacobian_rate(chain, np.zeros(6), np.zeros((2, 6)))
    with pytest.raises(NonFiniteError, match="qd of joint 'elbow'"):
        jacobian_rate(chain, np.zeros(6), [0, 0, np.nan, 0, 0, 0])
    with pytest.raises(NonFiniteError, match="q of joint 'elbow'"):
        bias_acceleration(chain, [0, 0, np.inf, 0, 0, 0], np.zeros(6))
