"""The Jacobian's time derivative: golden values, Pinocchio, complex steps, and what is refused."""

import numpy as np
import pinocchio
import pytest

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinetostatics import (
    bias_acceleration,
    jacobian,
    jacobian_rate,
    joint_accelerations,
    point_jacobian,
)
from robomech_ros.robots import list_robots, load_robot


def test_golden_rate_and_twist_rate_of_the_fanuc_arc_mate(golden):
    case = golden("kinetostatics_fanuc")
    chain, q, qd = load_robot("fanuc_arcmate"), case["theta"], case["qd"]
    rate = jacobian_rate(chain, q, qd)
    np.testing.assert_allclose(rate, case["Jdot"], rtol=0, atol=1e-12)
    twist_rate = jacobian(chain, q) @ case["qdd"] + bias_acceleration(chain, q, qd)
    np.testing.assert_allclose(twist_rate, case["twist_rate"], rtol=0, atol=1e-12)
    found = joint_accelerations(chain, q, qd, case["twist_rate"])
    np.testing.assert_allclose(found, case["qdd"], rtol=0, atol=1e-11)


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


def complex_pose(chain, q):
    """The pose of the tip, axes and points of them, with complex numbers."""
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
    return T, axes, points


def complex_jacobian(chain, q):
    """The Jacobian from the definition, with complex numbers."""
    T, axes, points = complex_pose(chain, q)
    columns = [
        np.concatenate((0 * e, e)) if kind else np.concatenate((e, np.cross(e, T[:3, 3] - o)))
        for e, o, kind in zip(axes, points, chain.types, strict=True)
    ]
    return np.array(columns).T


@pytest.mark.parametrize("robot", list_robots())
def test_jacobian_and_its_rate_agree_with_complex_steps(robot):
    """The Jacobian with steps of the pose, its rate with steps of the Jacobian."""
    chain, rng = load_robot(robot), np.random.default_rng(6)
    for q, qd in rng.uniform(-3, 3, (10, 2, chain.n)):
        J = np.empty((6, chain.n))
        for i, step in enumerate(1e-30j * np.eye(chain.n)):
            T = complex_pose(chain, q + step)[0]
            rate = T.imag / 1e-30
            spin = rate[:3, :3] @ T.real[:3, :3].T
            J[:, i] = [spin[2, 1], spin[0, 2], spin[1, 0], *rate[:3, 3]]
        np.testing.assert_allclose(jacobian(chain, q), J, rtol=0, atol=1e-10)
        theirs = complex_jacobian(chain, q + 1e-30j * qd).imag / 1e-30
        np.testing.assert_allclose(jacobian_rate(chain, q, qd), theirs, rtol=0, atol=1e-10)


@pytest.mark.parametrize("seed", range(20))
def test_agrees_with_complex_steps(random_chain, seed):
    chain = random_chain(seed, n=1 + seed % 8)
    q, qd = np.random.default_rng(seed).uniform(-2, 2, (2, chain.n))
    theirs = complex_jacobian(chain, q + 1e-30j * qd).imag / 1e-30
    np.testing.assert_allclose(jacobian_rate(chain, q, qd), theirs, rtol=0, atol=1e-12)


@pytest.mark.parametrize("robot", list_robots())
def test_joint_accelerations_give_the_twist_rate_of_a_point(robot):
    chain, rng = load_robot(robot), np.random.default_rng(7)
    q, qd, qdd = rng.uniform(-1, 1, (3, 5, chain.n))
    q += 0.2
    point, step = (0.05, -0.1, 0.2), 1e-5
    J, bias = point_jacobian(chain, q, point), bias_acceleration(chain, q, qd, point=point)

    def twist(t):
        moved, rates = q + t * qd + 0.5 * t * t * qdd, qd + t * qdd
        return np.einsum("kij,kj->ki", point_jacobian(chain, moved, point), rates)

    twist_rate = np.einsum("kij,kj->ki", J, qdd) + bias
    differences = (8 * (twist(step) - twist(-step)) - twist(2 * step) + twist(-2 * step)) / (
        12 * step
    )
    np.testing.assert_allclose(twist_rate, differences, rtol=0, atol=1e-8)
    found = joint_accelerations(chain, q, qd, twist_rate, point=point)
    again = np.einsum("kij,kj->ki", J, found) + bias
    np.testing.assert_allclose(again, twist_rate, rtol=0, atol=1e-8)
    if chain.n <= 6:
        np.testing.assert_allclose(found, qdd, rtol=0, atol=1e-7)
    else:
        assert (np.linalg.norm(found, axis=1) <= np.linalg.norm(qdd, axis=1) + 1e-9).all()
    one = joint_accelerations(chain, q[0], qd[0], twist_rate[0], point=point)
    np.testing.assert_allclose(one, found[0], rtol=0, atol=1e-12)


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
    with pytest.raises(WrongSizeError, match=r"twist_rate .*\(6,\) or \(2, 6\), as q"):
        joint_accelerations(chain, np.zeros((2, 6)), np.zeros((2, 6)), np.zeros((3, 6)))
    with pytest.raises(NonFiniteError, match=r"twist_rate\[1\] is inf"):
        joint_accelerations(chain, np.zeros(6), np.zeros(6), [0, np.inf, 0, 0, 0, 0])
    with pytest.raises(BadValueError, match="largest of qd .*finite bias acceleration"):
        bias_acceleration(chain, np.ones(6), np.full(6, 1e200))
