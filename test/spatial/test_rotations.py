"""Rotations against scipy, and at the angles where formulas fail: 0, pi and gimbal lock."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomech_ros import spatial
from robomech_ros.errors import BadQuaternionError, BadValueError, NonFiniteError, WrongSizeError

RANDOM = Rotation.random(2000, rng=np.random.default_rng(1))
AXES = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (-1, 2, 0.5), (0, -1, 1e-9), (0, 0, -1)]
ANGLES = [0.0, 1e-300, 1e-12, 1e-8, 1e-4, 1.0, np.pi / 2, np.pi - 1e-8, np.pi - 1e-12, np.pi]


def unit(vector):
    return np.asarray(vector, dtype=float) / np.linalg.norm(vector)


def test_all_conversions_agree_with_scipy():
    matrix, quaternion = RANDOM.as_matrix(), RANDOM.as_quat(canonical=True)
    vector = RANDOM.as_rotvec()
    angle = np.linalg.norm(vector, axis=-1)
    axis = vector / angle[:, None]
    rpy = RANDOM.as_euler("xyz")
    close = {"rtol": 0, "atol": 2e-14}
    np.testing.assert_allclose(spatial.matrix_from_quaternion(quaternion), matrix, **close)
    np.testing.assert_allclose(spatial.matrix_from_axis_angle(axis, angle), matrix, **close)
    np.testing.assert_allclose(spatial.matrix_from_roll_pitch_yaw(rpy), matrix, **close)
    np.testing.assert_allclose(spatial.matrix_from_rotation_vector(vector), matrix, **close)
    for result in (
        spatial.quaternion_from_matrix(matrix),
        spatial.quaternion_from_axis_angle(axis, angle),
        spatial.quaternion_from_roll_pitch_yaw(rpy),
    ):
        np.testing.assert_allclose(result, quaternion, **close)
    close["atol"] = 1e-12
    for got_axis, got_angle in (
        spatial.axis_angle_from_matrix(matrix),
        spatial.axis_angle_from_quaternion(-quaternion),
        spatial.axis_angle_from_roll_pitch_yaw(rpy),
    ):
        np.testing.assert_allclose(got_axis * got_angle[:, None], vector, **close)
    np.testing.assert_allclose(spatial.rotation_vector_from_matrix(matrix), vector, **close)
    for result in (
        spatial.roll_pitch_yaw_from_matrix(matrix),
        spatial.roll_pitch_yaw_from_quaternion(quaternion),
        spatial.roll_pitch_yaw_from_axis_angle(axis, angle),
    ):
        np.testing.assert_allclose(result, rpy, **close)


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("angle", ANGLES)
def test_axis_and_angle_survive_the_way_through_a_matrix(axis, angle):
    matrix = spatial.matrix_from_axis_angle(axis, angle)
    np.testing.assert_allclose(
        matrix, Rotation.from_rotvec(unit(axis) * angle).as_matrix(), atol=3e-16
    )
    found_axis, found_angle = spatial.axis_angle_from_matrix(matrix)
    assert found_angle == pytest.approx(angle, rel=3e-15, abs=5e-16)
    assert np.linalg.norm(found_axis) == pytest.approx(1.0, abs=4e-16)
    if angle > 1e-200:
        np.testing.assert_allclose(found_axis, unit(axis), atol=1e-15)


def test_half_turn_is_exact():
    for axis in AXES:
        e = unit(axis)
        matrix = 2.0 * np.outer(e, e) - np.eye(3)
        found, angle = spatial.axis_angle_from_matrix(matrix)
        assert angle == np.pi
        assert found[np.argmax(found != 0.0)] > 0.0
        np.testing.assert_allclose(abs(found @ e), 1.0, atol=1e-15)


def test_identity_has_the_axis_z_and_no_negative_zero():
    axis, angle = spatial.axis_angle_from_matrix(np.eye(3))
    assert axis.tolist() == [0.0, 0.0, 1.0]
    assert angle == 0.0
    quaternion = spatial.quaternion_from_matrix(np.eye(3))
    assert quaternion.tobytes() == np.array([0.0, 0.0, 0.0, 1.0]).tobytes()
    assert spatial.matrix_from_rotation_vector(np.zeros(3)).tolist() == np.eye(3).tolist()


@pytest.mark.parametrize("pitch", [np.pi / 2, -np.pi / 2])
@pytest.mark.parametrize("offset", [0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-5])
def test_roll_pitch_yaw_give_the_matrix_back_at_gimbal_lock(pitch, offset):
    rng = np.random.default_rng(5)
    angles = rng.uniform(-3, 3, size=(200, 3))
    angles[:, 1] = pitch - np.sign(pitch) * offset
    matrix = spatial.matrix_from_roll_pitch_yaw(angles)
    again = spatial.matrix_from_roll_pitch_yaw(spatial.roll_pitch_yaw_from_matrix(matrix))
    np.testing.assert_allclose(again, matrix, rtol=0, atol=1e-15)


def test_yaw_is_zero_at_exact_gimbal_lock():
    matrix = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    assert spatial.roll_pitch_yaw_from_matrix(matrix).tolist() == [0.0, np.pi / 2, 0.0]


def test_quaternions_compose_and_invert_like_matrices():
    p, q = RANDOM[:1000], RANDOM[1000:]
    product = spatial.compose_quaternions(p.as_quat(), q.as_quat())
    np.testing.assert_allclose(product, (p * q).as_quat(canonical=True), atol=1e-15)
    inverse = spatial.inverse_quaternion(q.as_quat())
    np.testing.assert_allclose(inverse, q.inv().as_quat(canonical=True), atol=1e-15)


def test_angeles_chapter_2_goldens():
    permutation = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    axis, angle = spatial.axis_angle_from_matrix(permutation)
    np.testing.assert_allclose(axis, np.full(3, 1 / np.sqrt(3)), atol=1e-15)
    assert angle == pytest.approx(2 * np.pi / 3, abs=1e-15)
    np.testing.assert_allclose(spatial.axial_vector(permutation), [0.5, 0.5, 0.5])
    third = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
    assert spatial.axis_angle_from_matrix(third)[1] == pytest.approx(np.pi / 3, abs=1e-15)


def test_batch_axes_are_kept():
    matrices = RANDOM.as_matrix()[:24].reshape(2, 3, 4, 3, 3)
    assert spatial.quaternion_from_matrix(matrices).shape == (2, 3, 4, 4)
    assert spatial.roll_pitch_yaw_from_matrix(matrices).shape == (2, 3, 4, 3)
    axis, angle = spatial.axis_angle_from_matrix(matrices)
    assert (axis.shape, angle.shape) == ((2, 3, 4, 3), (2, 3, 4))
    one = spatial.quaternion_from_matrix(matrices[1, 2, 3])
    assert one.tobytes() == spatial.quaternion_from_matrix(matrices)[1, 2, 3].tobytes()
    assert spatial.matrix_from_axis_angle([0, 0, 1], [0.0, 1.0]).shape == (2, 3, 3)
    assert spatial.quaternion_from_matrix(np.empty((0, 3, 3))).shape == (0, 4)


def test_cross_product_matrix_and_axial_vector():
    rng = np.random.default_rng(3)
    a, x = rng.normal(size=(2, 50, 3))
    A = spatial.cross_product_matrix(a)
    np.testing.assert_allclose((A @ x[..., None])[..., 0], np.cross(a, x), atol=1e-15)
    np.testing.assert_array_equal(spatial.axial_vector(A), a)
    np.testing.assert_allclose(
        A @ A,
        a[:, :, None] * a[:, None, :] - np.sum(a * a, -1)[:, None, None] * np.eye(3),
        atol=1e-14,
    )


def test_nearest_rotation_is_the_polar_factor():
    rng = np.random.default_rng(4)
    matrix = RANDOM.as_matrix()[:100]
    noisy = matrix + 1e-4 * rng.normal(size=matrix.shape)
    near = spatial.nearest_rotation(noisy)
    assert spatial.rotation_error(near).max() < 1e-14
    assert np.abs(near - matrix).max() < 1e-3
    np.testing.assert_allclose(near, Rotation.from_matrix(noisy).as_matrix(), atol=1e-12)


@pytest.mark.parametrize(
    ("quaternion", "text"),
    [
        ([0, 0, 0, 0], "all zero, expected norm 1"),
        ([0, 0, 0, 2], "norm is 2, expected norm 1"),
        ([[0, 0, 0, 1], [1, 1, 0, 0]], "in row 1"),
    ],
)
def test_bad_quaternions_are_refused(quaternion, text):
    with pytest.raises(BadQuaternionError, match=text):
        spatial.matrix_from_quaternion(quaternion)


def from_quaternion(*numbers):
    return lambda: spatial.matrix_from_quaternion(numbers)


def from_matrix(matrix):
    return lambda: spatial.quaternion_from_matrix(matrix)


@pytest.mark.parametrize(
    ("call", "error", "text"),
    [
        (from_quaternion(0, 0, np.nan, 1), NonFiniteError, r"quaternion\[2\] is nan"),
        (from_quaternion(0, 0, 1), WrongSizeError, r"shape \(3,\), expected \(\.\.\., 4\)"),
        (from_quaternion("up"), BadValueError, "real numbers"),
        (from_quaternion([0], [0, 1]), BadValueError, "real numbers"),
        (from_matrix(np.diag([1, 1, -1])), BadValueError, "determinant not positive"),
        (from_matrix(1.01 * np.eye(3)), BadValueError, r"within 0\.0201"),
        (from_matrix(np.full((3, 3), 1e200)), BadValueError, "orthonormal|determinant"),
        (lambda: spatial.matrix_from_axis_angle([0, 0, 0], 1.0), BadValueError, "not zero"),
        (lambda: spatial.matrix_from_axis_angle([0, 0, 1], np.inf), NonFiniteError, "angle is inf"),
        (lambda: spatial.matrix_from_roll_pitch_yaw([0, 0]), WrongSizeError, "roll, pitch, yaw"),
        (lambda: spatial.axial_vector(np.eye(2)), WrongSizeError, "matrix"),
    ],
)
def test_bad_rotations_are_refused(call, error, text):
    with pytest.raises(error, match=text):
        call()
