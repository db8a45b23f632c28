"""The Jacobian: golden values, Pinocchio, finite differences, and what is refused."""

import numpy as np
import pinocchio
import pytest

from robomech_ros.errors import NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.robots import list_robots, load_robot
from robomech_ros.spatial import rotation_vector_from_matrix

ROBOTS = pytest.mark.parametrize("robot", list_robots())


def by_differences(chain, q, step=1e-5):
    """Fourth-order central differences of the pose."""
    J = np.zeros((6, chain.n))
    rotation = forward_kinematics(chain, q)[:3, :3]
    for i in range(chain.n):
        for factor, weight in ((1, 8 / 12), (-1, -8 / 12), (2, -1 / 12), (-2, 1 / 12)):
            moved = q.copy()
            moved[i] += factor * step
            T = forward_kinematics(chain, moved)
            J[:3, i] += weight * rotation_vector_from_matrix(T[:3, :3] @ rotation.T) / step
            J[3:, i] += weight * T[:3, 3] / step
    return J


def test_golden_jacobian_of_the_fanuc_arc_mate(golden):
    case = golden("kinetostatics_fanuc")
    J = jacobian(load_robot("fanuc_arcmate"), case["theta"])
    np.testing.assert_allclose(J, case["J"], rtol=0, atol=case["tolerance"])
    np.testing.assert_allclose(J @ case["qd"], case["twist"], rtol=0, atol=1e-12)
    np.testing.assert_allclose(J.T @ case["wrench_moment_force"], case["tau"], rtol=0, atol=1e-11)
    assert abs(np.linalg.det(J)) == pytest.approx(0.24840493303536, abs=1e-13)


@ROBOTS
def test_agrees_with_pinocchio(robot, pinocchio_model):
    chain = load_robot(robot)
    model = pinocchio_model(robot)
    data = model.createData()
    tip = model.getFrameId(chain.tip)
    q = np.random.default_rng(3).uniform(-3, 3, (200, chain.n))
    for row, J in zip(q, jacobian(chain, q), strict=True):
        theirs = pinocchio.computeFrameJacobian(
            model, data, row, tip, pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        )
        # Theirs has the linear rows first.
        np.testing.assert_allclose(J, np.roll(theirs, 3, axis=0), rtol=0, atol=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_agrees_with_differences_of_the_pose(random_chain, seed):
    chain = random_chain(seed, n=1 + seed % 8)
    q = np.random.default_rng(seed).uniform(-2, 2, chain.n)
    np.testing.assert_allclose(jacobian(chain, q), by_differences(chain, q), atol=1e-8)


def test_batch_and_single_calls_have_the_same_bytes():
    chain = load_robot("stanford")
    q = np.random.default_rng(4).uniform(-1, 1, (2, 3, 6))
    matrices = jacobian(chain, q)
    assert matrices.shape == (2, 3, 6, 6)
    assert matrices[1, 2].tobytes() == jacobian(chain, q[1, 2]).tobytes()
    assert jacobian(chain, np.empty((0, 6))).shape == (0, 6, 6)
    assert jacobian(load_robot("panda"), np.zeros(7)).shape == (6, 7)
    assert jacobian(chain.with_tip("base_link"), []).shape == (6, 0)


def test_bad_joint_values_are_refused():
    chain = load_robot("stanford")
    with pytest.raises(WrongSizeError, match=r"q has shape \(5,\), expected \(6,\)"):
        jacobian(chain, np.zeros(5))
    with pytest.raises(NonFiniteError, match="q of joint 'joint_3' is inf"):
        jacobian(chain, [0, 0, np.inf, 0, 0, 0])
    with pytest.raises(NonFiniteError, match="'joint_1' in row 1, 0 is nan"):
        jacobian(chain, [[[0] * 6], [[np.nan] + [0] * 5]])
