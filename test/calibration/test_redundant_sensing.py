"""Several sensors that see one motion: who agrees, and who is wrong."""

import numpy as np
import pytest

from robomech_ros import spatial
from robomech_ros.calibration import motion_agreement, relative_hand_eye
from robomech_ros.errors import BadValueError, WrongSizeError

NOISE = np.repeat([1e-3, 5e-4], 3)


def seen_by(rng, sensors, count, noise=0.0):
    """Motions (s, k, 4, 4) by sensors mounted anywhere, and the mountings."""
    mounts = spatial.pose_exponential(rng.normal(size=(sensors, 6)))
    moved = spatial.pose_exponential(rng.normal(size=(count, 6)))
    seen = spatial.inverse_pose(mounts)[:, None] @ moved @ mounts[:, None]
    return seen @ spatial.pose_exponential(noise * NOISE * rng.normal(size=(sensors, count, 6))), (
        mounts
    )


@pytest.mark.parametrize("sensors", [2, 3, 5, 6])
@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_sensors_that_agree_are_not_blamed(sensors, noise):
    rng = np.random.default_rng(1)
    for _ in range(20):
        found = motion_agreement(seen_by(rng, sensors, 8, noise)[0], None if noise == 0.0 else
                                 (0.02, 0.02))  # fmt: skip
        assert found.faulty == () and found.outliers == ()
        assert found.angle_errors.max() < (0.02 if noise else 1e-14)


@pytest.mark.parametrize("part", [slice(0, 3), slice(3, 6)], ids=["rotation", "position"])
def test_the_faulty_one_is_named_with_its_motion(part):
    rng = np.random.default_rng(2)
    for _ in range(20):
        motions, _ = seen_by(rng, 3, 10, 1.0)
        sensor, motion = int(rng.integers(3)), int(rng.integers(10))
        error = np.zeros(6)
        # About and along the axis of the screw: across it a wrong position changes nothing.
        error[part] = 0.2 * spatial.finite_screw(motions[sensor, motion]).axis
        motions[sensor, motion] = motions[sensor, motion] @ spatial.pose_exponential(error)
        found = motion_agreement(motions)
        assert (sensor, motion) in found.outliers
        assert found.faulty == (sensor,)
        kept = [k for k in range(10) if (sensor, k) not in found.outliers]
        others = [one for one in range(3) if one != sensor]
        mount = relative_hand_eye(motions[others[0], kept], motions[others[1], kept])
        assert np.isfinite(mount).all()


def test_half_turns_and_translations_are_compared_too():
    rng = np.random.default_rng(3)
    turns = np.concatenate((np.pi * np.eye(3), np.zeros((2, 3)), 1e-9 * np.eye(3)))
    moved = spatial.pose_from_matrix(
        spatial.matrix_from_rotation_vector(turns), rng.normal(size=(8, 3))
    )
    mounts = spatial.pose_exponential(rng.normal(size=(4, 6)))
    motions = spatial.inverse_pose(mounts)[:, None] @ moved @ mounts[:, None]
    assert motion_agreement(motions).faulty == ()
    motions[1, 0] = motions[1, 0] @ spatial.pose_exponential([0.01, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert motion_agreement(motions, (1e-6, 1e-6)).faulty == (1,)


def test_what_is_no_list_of_sensors_is_refused():
    motions, _ = seen_by(np.random.default_rng(4), 2, 3)
    with pytest.raises(WrongSizeError, match="s at least 2"):
        motion_agreement(motions[:1])
    with pytest.raises(WrongSizeError, match="s at least 2"):
        motion_agreement(motions[0])
    with pytest.raises(BadValueError, match="two positive numbers"):
        motion_agreement(motions, (0.1, 0.0))
    with pytest.raises(BadValueError, match="rotation of motions in row 1, 2"):
        motions[1, 2, 0, 0] += 0.1
        motion_agreement(motions)
