"""Linear maps, reflections, changes of frame, invariants and redundant sensing."""

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.spatial.transform import Rotation

from robomech_ros import spatial
from robomech_ros.errors import BadValueError, WrongSizeError

RNG = np.random.default_rng(1)
Q = Rotation.random(40, rng=RNG).as_matrix()
A = RNG.normal(size=(40, 3, 3))


def test_range_and_kernel_of_matrices_of_every_rank():
    stack = np.stack([RNG.normal(size=(4, r)) @ RNG.normal(size=(r, 5)) for r in range(5)])
    found = spatial.linear_map(stack)
    assert found.rank.tolist() == [0, 1, 2, 3, 4]
    for r, matrix in enumerate(stack):
        kernel = found.kernel_basis[r][:, r:]
        np.testing.assert_allclose(matrix @ kernel, 0.0, atol=1e-13)
        np.testing.assert_allclose(kernel.T @ kernel, np.eye(5 - r), atol=1e-14)
        assert null_space(matrix, rcond=1e-12).shape[1] == 5 - r
        assert not found.kernel_basis[r][:, :r].any() and not found.range_basis[r][:, r:].any()
        P = spatial.orthogonal_projection(matrix)
        np.testing.assert_allclose(P @ matrix, matrix, atol=1e-13)
        np.testing.assert_allclose(P @ P, P, atol=1e-14)


def test_projections_and_reflections():
    n = RNG.normal(size=(40, 3))
    line, plane, H = (
        spatial.projection_on_line(n),
        spatial.projection_on_plane(n),
        spatial.reflection(n),
    )
    one = np.tile(np.eye(3), (40, 1, 1))
    np.testing.assert_allclose(line + plane, one, atol=1e-15)
    np.testing.assert_allclose(plane @ n[..., None], 0.0, atol=1e-14)
    np.testing.assert_allclose(H @ H, one, atol=1e-14)
    np.testing.assert_allclose(np.linalg.det(H), -1.0, atol=1e-14)
    unit = n / np.linalg.norm(n, axis=-1, keepdims=True)
    unit *= np.where(unit[:, :1] < 0.0, -1.0, 1.0)
    np.testing.assert_allclose(spatial.reflection_normal(H), unit, atol=1e-14)
    with pytest.raises(BadValueError, match="off by"):
        spatial.reflection_normal(Q[0])
    with pytest.raises(BadValueError, match="off by 0.00"):
        spatial.reflection_normal(H[0] + 1e-3)


def test_two_reflections_are_a_rotation_by_twice_the_angle():
    first, second = RNG.normal(size=(2, 40, 3))
    first, second = (v / np.linalg.norm(v, axis=-1, keepdims=True) for v in (first, second))
    product = spatial.compose_reflections(second, first)
    half = np.arccos(np.sum(first * second, -1))
    expected = spatial.matrix_from_axis_angle(np.cross(first, second), 2.0 * half)
    np.testing.assert_allclose(product, expected, atol=1e-14)
    hard = spatial.matrix_from_axis_angle(first[:5], [0.0, 1e-9, np.pi - 1e-9, np.pi, 2.0])
    for rotations in (Q, hard):
        again = spatial.compose_reflections(*spatial.reflections_from_matrix(rotations))
        np.testing.assert_allclose(again, rotations, atol=2e-15)


def test_frames_and_homogeneous_coordinates():
    p = RNG.normal(size=(40, 3))
    T = spatial.pose_from_matrix(Q, RNG.normal(size=(40, 3)))
    four = (T @ spatial.homogeneous_coordinates(p)[..., None])[..., 0]
    seen = spatial.transform_points(T, p)
    np.testing.assert_allclose(seen, spatial.points_from_homogeneous(3.0 * four), atol=1e-14)
    difference = seen - spatial.transform_points(T, np.zeros(3))
    np.testing.assert_allclose(difference, spatial.transform_vectors(Q, p), atol=1e-14)
    with pytest.raises(BadValueError, match="last homogeneous"):
        spatial.points_from_homogeneous([1, 2, 3, 0])


def test_invariants_stay_and_tell_matrices_apart():
    seen = spatial.similarity_transform(A, Q)
    np.testing.assert_allclose(spatial.moments(seen), spatial.moments(A), atol=1e-12)
    vect, trace = spatial.linear_invariants(seen)
    own, same = spatial.linear_invariants(A)
    np.testing.assert_allclose(vect, spatial.transform_vectors(Q, own), atol=1e-14)
    np.testing.assert_allclose(trace, same, atol=1e-14)
    assert spatial.same_in_two_frames(A, seen).all()
    assert not spatial.same_in_two_frames(A, seen[::-1]).any()
    assert not spatial.same_in_two_frames(A, seen + 1e-6 * A).any()
    # The same moments, yet no rotation takes one to the other.
    assert not spatial.same_in_two_frames(A, np.swapaxes(A, 1, 2)).any()
    assert spatial.same_in_two_frames(Q, np.swapaxes(Q, 1, 2)).all()
    assert not spatial.same_in_two_frames(np.diag([1.0, 0.0], 1), np.zeros((3, 3)))
    with pytest.raises(WrongSizeError, match=r"\(\.\.\., n, n\)"):
        spatial.moments(np.zeros((2, 3)))


def seen_by(sensors, count, noise):
    """Rotations as sensors say, each mounted somehow: (s, k, 3, 3), and the mountings."""
    mounts = Rotation.random(sensors, rng=RNG).as_matrix()
    turns = Rotation.random(count, rng=RNG).as_matrix()
    rows = np.swapaxes(mounts, -1, -2)[:, None] @ turns @ mounts[:, None]
    return spatial.matrix_from_rotation_vector(
        noise * RNG.normal(size=(sensors, count, 3))
    ) @ rows, mounts


def test_the_sensor_that_is_wrong_is_named():
    rows, _ = seen_by(4, 6, 1e-4)
    assert spatial.sensor_agreement(rows, 2e-3).faulty == ()
    rows[2, 3] = rows[2, 3] @ spatial.matrix_from_rotation_vector([0.1, 0.0, 0.05])
    found = spatial.sensor_agreement(rows, 2e-3)
    assert found.faulty == (2,) and found.errors[2] > 2e-3 > found.errors[0]


@pytest.mark.parametrize("count", [2, 3, 10])
def test_the_frame_between_sensors(count):
    rows, mounts = seen_by(2, count, 0.0)
    X = spatial.frame_between_sensors(*rows)
    np.testing.assert_allclose(X, mounts[0].T @ mounts[1], atol=1e-13)


def test_half_turns_do_not_spoil_the_frame_between_sensors():
    mounts = Rotation.random(2, rng=RNG).as_matrix()
    axes = RNG.normal(size=(5, 3))
    turns = spatial.matrix_from_axis_angle(axes, [np.pi, np.pi, np.pi - 1e-9, np.pi, 1.0])
    rows = np.swapaxes(mounts, -1, -2)[:, None] @ turns @ mounts[:, None]
    np.testing.assert_allclose(
        spatial.frame_between_sensors(*rows), mounts[0].T @ mounts[1], atol=1e-13
    )
    with pytest.raises(BadValueError, match="not parallel"):
        same = spatial.matrix_from_axis_angle([0, 0, 1], [0.3, 0.8])
        spatial.frame_between_sensors(same, same)
