"""Poses: composition, inverse, error, and what is refused."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomech_ros import spatial
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError


def random_poses(count, seed=1):
    rng = np.random.default_rng(seed)
    T = np.tile(np.eye(4), (count, 1, 1))
    T[:, :3, :3] = Rotation.random(count, rng=rng).as_matrix()
    T[:, :3, 3] = rng.normal(size=(count, 3))
    return T


def test_position_and_quaternion_make_the_pose_again():
    T = random_poses(500)
    again = spatial.pose_from_position_quaternion(*spatial.position_quaternion_from_pose(T))
    np.testing.assert_allclose(again, T, atol=1e-15)
    np.testing.assert_array_equal(spatial.pose_from_matrix(T[:, :3, :3], T[:, :3, 3]), T)


def test_inverse_and_composition():
    T, U = random_poses(100, 2), random_poses(100, 3)
    np.testing.assert_allclose(spatial.inverse_pose(T), np.linalg.inv(T), atol=1e-14)
    identity = spatial.compose_poses(T, U, spatial.inverse_pose(U), spatial.inverse_pose(T))
    np.testing.assert_allclose(identity, np.tile(np.eye(4), (100, 1, 1)), atol=1e-14)
    assert spatial.compose_poses().tolist() == np.eye(4).tolist()


def test_a_pose_that_is_mended_stays_as_it_was_given():
    T = random_poses(1)[0]
    T[:3, :3] += 1e-9
    T[3] += 1e-9
    given = T.copy()
    spatial.inverse_pose(T)
    spatial.compose_poses(T, T)
    np.testing.assert_array_equal(T, given)


def test_pose_error_takes_the_actual_pose_to_the_target():
    target, actual = random_poses(200, 4), random_poses(200, 5)
    error = spatial.pose_error(target, actual)
    turned = spatial.matrix_from_rotation_vector(error[:, :3]) @ actual[:, :3, :3]
    np.testing.assert_allclose(turned, target[:, :3, :3], atol=1e-14)
    np.testing.assert_allclose(actual[:, :3, 3] + error[:, 3:], target[:, :3, 3], atol=1e-15)
    assert spatial.pose_error(target[0], actual).shape == (200, 6)
    assert np.abs(spatial.pose_error(target, target)).max() < 1e-15


def test_tiny_rotations_are_not_lost_in_the_pose_error():
    actual = random_poses(1)[0]
    target = actual.copy()
    small = np.array([1e-9, -2e-9, 3e-9])
    target[:3, :3] = spatial.matrix_from_rotation_vector(small) @ actual[:3, :3]
    np.testing.assert_allclose(spatial.pose_error(target, actual)[:3], small, atol=3e-16)


def test_a_slightly_wrong_rotation_is_mended_and_a_wrong_one_refused():
    T = random_poses(1)[0]
    slightly = T.copy()
    slightly[:3, :3] *= 1 + 1e-8
    assert spatial.rotation_error(spatial.as_pose(slightly)[:3, :3]) < 1e-14
    slightly[:3, :3] *= 1.001
    with pytest.raises(BadValueError, match=r"orthonormal within 0\.002"):
        spatial.as_pose(slightly)


@pytest.mark.parametrize(
    ("change", "error", "text"),
    [
        (lambda T: T[:3], WrongSizeError, r"shape \(3, 4\)"),
        (lambda T: T * [[1], [1], [1], [2]], BadValueError, "last row"),
        (lambda T: T * [1, 1, -1, 1], BadValueError, "determinant not positive"),
        (lambda T: T + np.array([0, 0, 0, np.inf]), NonFiniteError, r"pose\[0, 3\] is inf"),
        (lambda T: T.astype(complex), BadValueError, "real numbers"),
    ],
)
def test_what_is_no_pose_is_refused(change, error, text):
    with pytest.raises(error, match=text):
        spatial.as_pose(change(random_poses(1)[0]))


@pytest.mark.parametrize("digits", [4, 5, 6, 7, 9])
def test_poses_with_few_digits_are_taken_as_the_nearest(digits):
    T = random_poses(500, digits)
    rounded = T.round(digits)
    rounded[:, 3, 3] += 0.5 * 10.0**-digits
    cleaned = spatial.as_pose(rounded)
    assert spatial.rotation_error(cleaned[:, :3, :3]).max() < 4e-15
    np.testing.assert_array_equal(cleaned[:, 3], np.tile([0.0, 0.0, 0.0, 1.0], (500, 1)))
    nearest = spatial.nearest_rotation(rounded[:, :3, :3])
    np.testing.assert_allclose(cleaned[:, :3, :3], nearest, atol=1e-15)
    for read in (
        spatial.position_quaternion_from_pose(rounded)[1],
        spatial.quaternion_from_matrix(rounded[:, :3, :3]),
    ):
        np.testing.assert_allclose(read, spatial.quaternion_from_matrix(nearest), atol=1e-15)
    product = spatial.compose_poses(rounded, spatial.inverse_pose(rounded))
    np.testing.assert_allclose(product, np.tile(np.eye(4), (500, 1, 1)), atol=1e-14)


@pytest.mark.parametrize(
    "function",
    [
        spatial.as_pose,
        spatial.inverse_pose,
        spatial.compose_poses,
        spatial.position_quaternion_from_pose,
        lambda T: spatial.pose_error(T, np.eye(4)),
    ],
)
def test_every_function_refuses_what_is_no_pose(function):
    stretched = np.diag([1.001, 1.0, 1.0, 1.0])
    with pytest.raises(BadValueError, match=r"rotation of .*within 0\.0002"):
        function(stretched)
    with pytest.raises(BadValueError, match="last row of"):
        function(np.diag([1.0, 1.0, 1.0, 1.001]))
