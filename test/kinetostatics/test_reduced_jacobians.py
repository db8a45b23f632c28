"""Rows of tasks, planar arms by section 5.7, the blocks of decoupled arms, points and frames."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError, UnknownLinkError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import (
    bias_acceleration,
    decoupled_jacobian,
    jacobian,
    joint_accelerations,
    joint_rates,
    joint_torques,
    planar_jacobian,
    planar_rows,
    point_jacobian,
    task_jacobian,
)
from robomech_ros.robots import chain_from_dh, list_robots, load_robot

POINT = (0.05, -0.1, 0.2)
E = np.array([[0.0, -1.0], [1.0, 0.0]])
DECOUPLED = ["irb120", "m1013", "puma560", "rv4fr", "stanford"]


@pytest.mark.parametrize("robot", list_robots())
def test_points_and_frames(robot):
    chain = load_robot(robot)
    q = np.random.default_rng(1).uniform(-2, 2, (2, 3, chain.n))
    at_point = point_jacobian(chain, q, POINT)
    here = point_jacobian(chain, q, POINT, chain.tip)
    for k in np.ndindex(2, 3):
        R, J = forward_kinematics(chain, q[k])[:3, :3], jacobian(chain, q[k])
        linear = J[3:] + np.cross(J[:3], R @ POINT, axis=0)
        np.testing.assert_allclose(at_point[k], [*J[:3], *linear], rtol=0, atol=1e-12)
        np.testing.assert_allclose(here[k], np.kron(np.eye(2), R.T) @ at_point[k], atol=1e-12)
        np.testing.assert_array_equal(at_point[k], point_jacobian(chain, q[k], POINT))
        by_rotation = point_jacobian(chain, q[k], POINT, R)
        np.testing.assert_allclose(here[k], by_rotation, rtol=0, atol=1e-13)


def test_rows_of_a_task():
    chain, q = load_robot("puma560"), np.random.default_rng(1).uniform(-2, 2, (4, 6))
    J = point_jacobian(chain, q, POINT, "tool0")
    given = {"point": POINT, "axes": "tool0"}
    spin_is_free = task_jacobian(chain, q, [1, 1, 1, 1, 1, 0], **given)
    np.testing.assert_array_equal(spin_is_free, J[:, [0, 1, 3, 4, 5]])
    height = task_jacobian(chain, q[0], (False, False, True, False, False, False), **given)
    np.testing.assert_array_equal(height, J[0, 5:])


@pytest.mark.parametrize(
    ("mask", "error", "message"),
    [
        ([False] * 6, BadValueError, "mask .*at least one True"),
        ([True] * 5, WrongSizeError, "mask has size 5, expected 6"),
        ([True, 2, True, True, True, True], BadValueError, r"mask\[1\] is 2, expected True or"),
        ("xyzrpy", BadValueError, "mask .*six of True or False"),
        (None, BadValueError, "mask is None"),
    ],
)
def test_masks_that_are_refused(mask, error, message):
    with pytest.raises(error, match=message):
        task_jacobian(load_robot("puma560"), np.zeros(6), mask)


def test_planar_three_link_arm_of_the_book():
    """Displacement, velocity, acceleration and statics by the formulae of section 5.7."""
    chain, rng = load_robot("planar3r"), np.random.default_rng(4)
    q, qd, qdd = rng.uniform(-2, 2, (3, 3))
    lengths, angles = chain.dh.a, np.cumsum(q)
    links = lengths[:, None] * np.stack((np.cos(angles), np.sin(angles)), axis=1)
    T = forward_kinematics(chain, q)
    np.testing.assert_allclose(T[:2, 3], links.sum(axis=0), rtol=0, atol=1e-14)
    np.testing.assert_allclose(T[:2, 0], [np.cos(q.sum()), np.sin(q.sum())], rtol=0, atol=1e-14)
    s = np.cumsum(links[::-1], axis=0)[::-1]
    J = np.vstack((np.ones(3), E @ s.T))
    np.testing.assert_allclose(planar_jacobian(chain, q), J, rtol=0, atol=1e-14)
    S = planar_rows(chain)
    twist = J @ qd
    np.testing.assert_allclose(joint_rates(chain, q, S.T @ twist), qd, rtol=0, atol=1e-12)
    spins = np.cumsum(qd)
    bias = np.array([0.0, *-(spins[:, None] ** 2 * links).sum(axis=0)])
    np.testing.assert_allclose(S @ bias_acceleration(chain, q, qd), bias, rtol=0, atol=1e-13)
    found = joint_accelerations(chain, q, qd, S.T @ (J @ qdd + bias))
    np.testing.assert_allclose(found, qdd, rtol=0, atol=1e-11)
    wrench = rng.normal(size=3)
    np.testing.assert_allclose(joint_torques(chain, q, S.T @ wrench), J.T @ wrench, atol=1e-13)


def test_planar_arms_anywhere():
    """With slides, an axis that is turned round, and a plane that is that of no base axes."""
    base = np.eye(4)
    base[:3, :3] = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    half = np.pi / 2
    alpha = [half, -half, np.pi]
    chain = chain_from_dh([0.1, 0.2, 0.3], [0.0, 0.1, 0.0], alpha, types="RPR", base=base)
    q = np.random.default_rng(5).uniform(-1, 1, (7, 3))
    J, S = planar_jacobian(chain, q), planar_rows(chain)
    np.testing.assert_allclose(S @ S.T, np.eye(3), rtol=0, atol=1e-14)
    np.testing.assert_allclose(S.T @ J, jacobian(chain, q), rtol=0, atol=1e-12)
    np.testing.assert_allclose(J[:, 0], [[1.0, 0.0, 1.0]] * 7, rtol=0, atol=1e-12)
    slides = chain_from_dh([0.0, 0.0], [0.1, 0.1], [half, 0.0], types="PP")
    np.testing.assert_allclose(planar_rows(slides)[0, :3], [1, 0, 0], rtol=0, atol=1e-15)


@pytest.mark.parametrize("robot", ["puma560", "scara", "panda"])
def test_arms_that_are_not_planar(robot):
    with pytest.raises(BadValueError, match="a planar one: joint '.*' moves links out of the pl"):
        planar_jacobian(load_robot(robot), np.zeros(load_robot(robot).n))


def test_one_slide_has_no_plane():
    slide = chain_from_dh([0.1], [0.1], [0.0], types="P")
    with pytest.raises(BadValueError, match="leave the plane open"):
        planar_rows(slide)
    with pytest.raises(BadValueError, match="a SerialChain"):
        planar_rows(None)


@pytest.mark.parametrize("robot", DECOUPLED)
def test_blocks_of_decoupled_arms(robot):
    chain = load_robot(robot)
    q = np.random.default_rng(6).uniform(-2, 2, (4, 5, 6))
    blocks = decoupled_jacobian(chain, q)
    J = point_jacobian(chain, q, blocks.centre)
    np.testing.assert_allclose(np.concatenate((blocks.A, blocks.B), axis=-2), J, atol=1e-11)
    product = -np.linalg.det(blocks.J12) * np.linalg.det(blocks.J21)
    np.testing.assert_allclose(np.linalg.det(jacobian(chain, q)), product, rtol=0, atol=1e-11)
    qd = np.random.default_rng(7).uniform(-1, 1, 6)
    twist = J[1, 2] @ qd
    arm = np.linalg.solve(blocks.J21[1, 2], twist[3:])
    wrist = np.linalg.solve(blocks.J12[1, 2], twist[:3] - blocks.J11[1, 2] @ arm)
    np.testing.assert_allclose([*arm, *wrist], qd, rtol=0, atol=1e-9)


@pytest.mark.parametrize("robot", ["ur5e", "panda", "general6r", "scara"])
def test_arms_without_a_spherical_wrist(robot):
    chain = load_robot(robot)
    with pytest.raises(BadValueError, match="three joints that move a point freely"):
        decoupled_jacobian(chain, np.zeros(chain.n))


def test_frames_that_do_not_exist():
    with pytest.raises(UnknownLinkError, match="unknown link 'wrist'; available: base_link"):
        point_jacobian(load_robot("puma560"), np.zeros(6), axes="wrist")
