"""Half turns about axes at right angles, which several sensors' rotations fit equally well."""

import numpy as np
import pytest

from robomech_ros import spatial
from robomech_ros.calibration import hand_eye, relative_hand_eye
from robomech_ros.errors import UnderdeterminedError

# Numbers of the axes, of three at right angles; 3 is between the first two.
MOTIONS = {"two": [0, 1], "three": [0, 1, 2], "twice": [0, 0, 1], "slanted": [0, 3],
           "five": [0, 1, 2, 0, 1]}  # fmt: skip


def half_turns(rng, which):
    """Motions of the sensor, and where it is in the hand."""
    axes = spatial.matrix_from_rotation_vector(rng.normal(size=3)).T
    axes = np.concatenate((axes, axes[:1] + axes[1:2]))[which]
    turns = spatial.matrix_from_axis_angle(axes, np.pi)
    B = spatial.pose_from_matrix(turns, rng.normal(size=(len(which), 3)))
    return B, spatial.pose_exponential(rng.normal(size=6))


def shaken(rng, poses, noise):
    return poses @ spatial.pose_exponential(noise * rng.normal(size=(len(poses), 6)))


@pytest.mark.parametrize("noise", [0.0, 1e-3])
@pytest.mark.parametrize("which", MOTIONS)
def test_positions_tell_which_of_the_rotations_is_right(which, noise):
    rng = np.random.default_rng(1)
    within = max(30.0 * noise, 1e-9)
    for _ in range(20):
        B, X = half_turns(rng, MOTIONS[which])
        A = X @ B @ spatial.inverse_pose(X)
        found = relative_hand_eye(shaken(rng, A, noise), B)
        assert np.abs(spatial.pose_error(found, X)).max() < within
        W, Z = spatial.pose_exponential(rng.normal(size=(2, 6)))
        robot = W @ np.concatenate((np.eye(4)[None], A))
        sensor = spatial.inverse_pose(robot @ X) @ Z
        result = hand_eye(robot, shaken(rng, sensor, noise))
        assert np.abs(spatial.pose_error(result.sensor, X)).max() < within
        assert noise or result.outliers == ()


def test_where_nothing_tells_it_is_said():
    turns = spatial.matrix_from_axis_angle(np.eye(3), np.pi)
    text = "half turns at right angles to each other"
    with pytest.raises(UnderdeterminedError, match=text):
        spatial.frame_between_sensors(turns, turns)
    about_the_origin = spatial.pose_from_matrix(turns, np.zeros((3, 3)))
    with pytest.raises(UnderdeterminedError, match=text):
        relative_hand_eye(about_the_origin, about_the_origin)
    poses = np.concatenate((np.eye(4)[None], about_the_origin))
    with pytest.raises(UnderdeterminedError, match=text):
        hand_eye(poses, poses)
    # One more, that is turned otherwise, settles it.
    more = spatial.pose_exponential([0.3, 0.1, -0.2, 0.0, 0.0, 0.0])[None]
    poses = np.concatenate((poses, more))
    found = hand_eye(poses, spatial.inverse_pose(poses))
    np.testing.assert_allclose(found.sensor, np.eye(4), atol=1e-9)


def test_noise_at_half_turns_does_not_flip_the_axes_of_the_direct_method():
    rng = np.random.default_rng(2)
    for _ in range(20):
        axes = rng.normal(size=(6, 3))
        turns = spatial.matrix_from_axis_angle(axes, np.pi - rng.uniform(0.0, 1e-3, 6))
        B = spatial.pose_from_matrix(turns, rng.normal(size=(6, 3)))
        X = spatial.pose_exponential(rng.normal(size=6))
        A = shaken(rng, X @ B @ spatial.inverse_pose(X), 2e-3)
        found = relative_hand_eye(A, B)
        assert np.abs(spatial.pose_error(found, X)).max() < 0.03
