"""Everything wrong that calibration can be given: each has its error, its code and its text."""

import pickle

import numpy as np
import pytest
from hand_eye_cells import samples

from robomech_ros import spatial
from robomech_ros.calibration import hand_eye, relative_hand_eye, robot_world
from robomech_ros.errors import (
    BadQuaternionError,
    BadValueError,
    InconsistentDataError,
    NonFiniteError,
    UnderdeterminedError,
    WrongSizeError,
)

CAMERA = np.radians(0.1), 0.5e-3
A, S, X, Z = samples(np.random.default_rng(1), 8, camera=CAMERA)
ABOUT_Z = spatial.pose_exponential([[0, 0, a, 0.1, 0.2 * a, 0.3] for a in (-1.0, 0.2, 0.9, 1.4)])
SLIDES = spatial.pose_exponential([[0, 0, 0, 0.1, 0.2 * a, a] for a in (-1.0, 0.2, 0.9, 1.4)])


def seen(poses):
    return spatial.inverse_pose(poses @ X) @ Z


def one_wrong(poses, change):
    wrong = poses.copy()
    change(wrong[5])
    return wrong


def scale(pose):
    pose[:3, :3] *= 1.01


def mirror(pose):
    pose[:3, 0] *= -1.0


def spoil(pose):
    pose[1, 3] = np.nan


CASES = {
    "scaled rotation": (
        lambda: hand_eye(one_wrong(A, scale), S),
        BadValueError,
        r"rotation of robot_poses in row 5 is .* orthonormal within 0\.0201",
    ),
    "improper rotation": (
        lambda: hand_eye(A, one_wrong(S, mirror)),
        BadValueError,
        "rotation of sensor_poses in row 5 is .* determinant not positive",
    ),
    "not a number": (
        lambda: hand_eye(A, one_wrong(S, spoil)),
        NonFiniteError,
        r"sensor_poses\[5, 1, 3\] is nan",
    ),
    "zero quaternion": (
        lambda: hand_eye(spatial.pose_from_position_quaternion(A[:, :3, 3], np.zeros((8, 4))), S),
        BadQuaternionError,
        "all zero in row 0, expected norm 1",
    ),
    "zero axis": (
        lambda: hand_eye(spatial.pose_from_screw(np.zeros((8, 3)), [0, 0, 0], 0.1, 0.0), S),
        BadValueError,
        "not zero",
    ),
    "too few": (
        lambda: hand_eye(A[:2], S[:2]),
        WrongSizeError,
        "samples that differ from each other has size 2, expected 3 or more",
    ),
    "duplicates only": (
        lambda: hand_eye(A[[0, 1, 0, 1]], S[[0, 1, 0, 1]]),
        WrongSizeError,
        "samples that differ from each other has size 2, expected 3 or more",
    ),
    "pure translations": (
        lambda: hand_eye(SLIDES, seen(SLIDES)),
        UnderdeterminedError,
        r"rotation of robot_poses \(rad, root mean square\) is 0\.0, .*pure translations leave the "
        "sensor's position in the hand frame free in all directions",
    ),
    "parallel axes of motions": (
        lambda: relative_hand_eye(ABOUT_Z, ABOUT_Z),
        UnderdeterminedError,
        r"parallel to \[0.0, 0.0, 1.0\].* of the first frame it is free",
    ),
    "translations as motions": (
        lambda: relative_hand_eye(SLIDES, SLIDES),
        UnderdeterminedError,
        "pure translations",
    ),
    "one motion": (lambda: relative_hand_eye(A[:1], S[:1]), WrongSizeError, "k >= 2"),
    "motions of other moments": (
        lambda: relative_hand_eye(A, spatial.pose_exponential(np.full((8, 6), 0.1))),
        InconsistentDataError,
        "difference of the angles of both sensors is .* turn by the same angle",
    ),
    "exchanged mount": (
        lambda: hand_eye(A, S, mount="eye-to-hand"),
        InconsistentDataError,
        "mount is 'eye-to-hand', expected 'eye-in-hand'",
    ),
    "inverted poses": (
        lambda: robot_world(A, S),
        InconsistentDataError,
        "if the mount is right, invert one list",
    ),
    "a sensor in mm": (
        lambda: hand_eye(A, in_mm(S)),
        InconsistentDataError,
        "'probably m in robot_poses and mm in sensor_poses', expected m in both: with positions of "
        "sensor_poses times 0.001 the samples fit .* times better",
    ),
    "a robot in mm": (
        lambda: hand_eye(in_mm(A), S),
        InconsistentDataError,
        "'probably mm in robot_poses and m in sensor_poses', expected m in both: with positions of "
        "sensor_poses times 1000 the samples fit .* times better",
    ),
    "samples of other moments": (
        lambda: hand_eye(A, np.roll(S, 3, axis=0)),
        InconsistentDataError,
        "contradict each other; take both poses of a sample at the same moment",
    ),
}


def in_mm(poses):
    result = poses.copy()
    result[:, :3, 3] *= 1e3
    return result


@pytest.mark.parametrize("mount", ["eye-in-hand", "eye-to-hand"])
@pytest.mark.parametrize("wrong", [0, 4])
def test_two_units_are_told_from_noise_and_outliers(mount, wrong):
    camera = np.radians(0.3), 1e-3
    for seed in range(20):
        rng = np.random.default_rng(seed)
        robot, sensor, *_ = samples(rng, 20, camera=camera, robot=camera, mount=mount)
        sensor[:wrong, :3, 3] += rng.normal(size=(wrong, 3))
        for given in ((robot, in_mm(sensor)), (in_mm(robot), sensor)):
            with pytest.raises(InconsistentDataError, match="unit of positions"):
                hand_eye(*given, mount=mount)
        # A wrong sample is no matter of units.
        assert hand_eye(robot, sensor, mount=mount).inlier.sum() >= 20 - wrong - 1


@pytest.mark.parametrize("case", CASES)
def test_each_has_its_error_and_its_text(case):
    call, error, text = CASES[case]
    with pytest.raises(error, match=text) as caught:
        call()
    assert type(caught.value) is error
    again = pickle.loads(pickle.dumps(caught.value))
    assert (type(again), str(again)) == (error, str(caught.value))


@pytest.mark.parametrize("count", [3, 4])
@pytest.mark.parametrize("turn", [1.0, 0.0], ids=["rotations", "positions"])
def test_inverted_motions_contradict_each_other(count, turn):
    # About axes at wide angles and, with turns alone, about axes in one plane: inverted turns about
    # these are the same turns in another frame, and only the positions tell.
    steps = np.zeros((count, 6))
    steps[:, :3] = np.array([[1, 0, 0], [0, 1, 0], [0, 0, turn], [1, 1, 1 * turn]])[:count] * 0.9
    steps[2, :3] += (1.0 - turn) * np.array([0.7, -0.4, 0.0])
    steps[:, 3:] = np.random.default_rng(5).normal(size=(count, 3))
    B = spatial.pose_exponential(steps)
    A = X @ B @ spatial.inverse_pose(X)
    np.testing.assert_allclose(relative_hand_eye(A, B), X, atol=1e-10)
    with pytest.raises(InconsistentDataError, match="none of them inverted"):
        relative_hand_eye(spatial.inverse_pose(A), B)
    if turn:
        with pytest.raises(InconsistentDataError, match="rotations of both sensors.* inverted"):
            spatial.frame_between_sensors(np.swapaxes(A[:, :3, :3], 1, 2), B[:, :3, :3])


def test_noisy_motions_do_not_contradict_each_other():
    rng = np.random.default_rng(6)
    for _ in range(50):
        B = spatial.pose_exponential(rng.normal(size=(3, 6)))
        A = (
            X
            @ B
            @ spatial.inverse_pose(X)
            @ spatial.pose_exponential(0.02 * rng.normal(size=(3, 6)))
        )
        assert np.isfinite(relative_hand_eye(A, B)).all()


def test_four_samples_of_other_moments_contradict_each_other():
    rng = np.random.default_rng(7)
    robot, sensor, X, _ = samples(rng, 4, camera=CAMERA)
    assert np.abs(spatial.pose_error(hand_eye(robot, sensor).sensor, X)).max() < 0.05
    with pytest.raises(InconsistentDataError):
        hand_eye(robot, np.roll(sensor, 1, axis=0))


def test_three_unrelated_samples_are_refused_or_have_large_residuals():
    """Many ended in a ValueError of numpy."""
    rng = np.random.default_rng(11)
    refused = 0
    for _ in range(50):
        robot, sensor, *_ = samples(rng, 3)
        try:
            found = hand_eye(robot, np.roll(sensor, 1, axis=0))
        except (InconsistentDataError, UnderdeterminedError):
            refused += 1
        else:
            assert found.residuals[:, 0].max() > 0.05
    assert refused > 5


def test_unrelated_samples_are_refused_even_if_outliers_are_kept():
    with pytest.raises(InconsistentDataError, match="contradict each other"):
        hand_eye(A, np.roll(S, 3, axis=0), robust=False)


def test_what_is_free_can_be_read():
    with pytest.raises(UnderdeterminedError) as caught:
        hand_eye(SLIDES, seen(SLIDES))
    assert np.array_equal(caught.value.free, np.eye(3))


def test_parallel_axes_that_noise_hides_from_the_direct_method_are_refused():
    rng = np.random.default_rng(3)
    noise = rng.normal(size=(4, 6)) * 2e-3
    with pytest.raises(UnderdeterminedError, match="all parallel to"):
        relative_hand_eye(ABOUT_Z @ spatial.pose_exponential(noise), ABOUT_Z)
    tilted = spatial.pose_exponential([[0.3, 0, 0.9, 0, 0, 0], [0, 0, 1, 0, 0, 0]])
    np.testing.assert_allclose(relative_hand_eye(tilted, tilted), np.eye(4), atol=1e-12)


def test_exact_samples_are_no_outliers():
    rng = np.random.default_rng(2)
    for count in (5, 6, 20):
        for _ in range(20):
            A, S, X, _ = samples(rng, count)
            found = hand_eye(A, S)
            assert found.outliers == ()
            np.testing.assert_allclose(found.sensor, X, atol=1e-10)
