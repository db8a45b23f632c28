"""Hand-eye calibration: golden data, noise, outliers, what cannot be found and what is wrong."""

import numpy as np
import pytest
from hand_eye_cells import KINDS, samples
from scipy.stats import chi2

from robomech_ros import spatial
from robomech_ros.calibration import (
    MOUNTS,
    HandEyeResult,
    hand_eye,
    next_best_pose,
    relative_hand_eye,
    robot_world,
)
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError

CAMERA = np.radians(0.1), 0.5e-3


def test_the_golden_motions(golden):
    data = golden("handeye")
    A, B, X = (np.array(data[name]) for name in "ABX")
    np.testing.assert_allclose(relative_hand_eye(A, B), X, atol=data["tolerance"])
    # The same as absolute poses: the first sample is where both motions begin.
    robot = np.concatenate((np.eye(4)[None], A))
    seen = spatial.inverse_pose(np.concatenate((np.eye(4)[None], B)))
    found = hand_eye(robot, seen)
    np.testing.assert_allclose(found.sensor, X, atol=data["tolerance"])
    np.testing.assert_allclose(found.target, X, atol=data["tolerance"])


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("kind", KINDS)
def test_three_poses_without_noise(mount, kind):
    A, S, X, Z = samples(np.random.default_rng(2), 3, kind, mount=mount)
    found = hand_eye(A, S, mount=mount)
    np.testing.assert_allclose(found.sensor, X, atol=1e-10)
    np.testing.assert_allclose(found.target, Z, atol=1e-10)
    assert found.residuals.shape == (3, 2) and found.residuals.max() < 1e-10


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("n", [3, 4])
def test_a_few_noisy_samples_do_not_claim_to_be_exact(n, mount):
    rng = np.random.default_rng(6)
    inside = 0
    for _ in range(50):
        A, S, X, _ = samples(rng, n, camera=CAMERA, mount=mount)
        found = hand_eye(A, S, mount=mount)
        error = spatial.pose_error(found.sensor, X)
        inside += error @ np.linalg.solve(found.covariance, error) < chi2.ppf(0.95, 6)
        assert found.rotation_deviation > 1e-4 and found.position_deviation > 1e-5
    assert inside >= 45


def test_relative_motions_of_half_turns():
    X = spatial.pose_exponential([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    axes = np.random.default_rng(3).normal(size=(4, 3))
    B = spatial.pose_from_matrix(spatial.matrix_from_axis_angle(axes, np.pi), axes)
    found = relative_hand_eye(X @ B @ spatial.inverse_pose(X), B)
    np.testing.assert_allclose(found, X, atol=1e-10)


def test_robot_world():
    A, S, X, Z = samples(np.random.default_rng(4), 8)
    found = robot_world(A, spatial.inverse_pose(S))
    np.testing.assert_allclose(A @ found.sensor, found.target @ spatial.inverse_pose(S), atol=1e-10)
    np.testing.assert_allclose(found.sensor, X, atol=1e-10)
    np.testing.assert_allclose(found.target, Z, atol=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("robot", [(0.0, 0.0), CAMERA], ids=["camera", "camera and robot"])
def test_the_ellipsoid_of_95_percent_has_the_truth_in_95_percent(mount, robot):
    rng = np.random.default_rng(5)
    inside = 0
    for _ in range(500):
        A, S, X, _ = samples(rng, 20, camera=CAMERA, robot=robot, mount=mount)
        found = hand_eye(A, S, mount=mount)
        error = spatial.pose_error(found.sensor, X)
        inside += error @ np.linalg.solve(found.covariance, error) < chi2.ppf(0.95, 6)
    assert 0.93 <= inside / 500 <= 0.97


def test_the_noise_is_found():
    A, S, _, _ = samples(np.random.default_rng(6), 200, camera=CAMERA, robot=CAMERA)
    noise = hand_eye(A, S).noise
    assert noise.rotation == pytest.approx(np.sqrt(2.0) * CAMERA[0], rel=0.1)
    assert noise.position == pytest.approx(np.sqrt(2.0) * CAMERA[1], rel=0.1)
    assert noise.robot_share == pytest.approx(0.5, abs=0.15)


def test_known_noise_is_kept():
    A, S, X, _ = samples(np.random.default_rng(7), 6, camera=CAMERA)
    found = hand_eye(A, S, noise=[*CAMERA, 0.0, 0.0])
    assert (found.noise.rotation, found.noise.position) == pytest.approx(CAMERA)
    assert np.linalg.norm(spatial.pose_error(found.sensor, X)[:3]) < 5.0 * found.rotation_deviation


def test_a_fifth_of_gross_outliers_is_named():
    rng = np.random.default_rng(8)
    for _ in range(50):
        A, S, X, _ = samples(rng, 20, camera=CAMERA)
        wrong = np.sort(rng.choice(20, 4, replace=False))
        S[wrong] = S[wrong] @ spatial.pose_exponential(
            rng.normal(size=(4, 6)) * [1, 1, 1, 0.2, 0.2, 0.2]
        )
        found = hand_eye(A, S)
        assert found.outliers == tuple(wrong)
        assert np.linalg.norm(spatial.pose_error(found.sensor, X)[:3]) < np.radians(0.1)
        kept = hand_eye(A, S, robust=False)
        assert kept.inlier.all()


def test_wrong_positions_alone_are_named_too():
    A, S, _, _ = samples(np.random.default_rng(9), 15, camera=CAMERA)
    S[[2, 7, 11], :3, 3] += [0.05, -0.03, 0.04]
    assert hand_eye(A, S).outliers == (2, 7, 11)


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("camera", [(0.0, 0.0), CAMERA], ids=["exact", "noisy"])
def test_parallel_axes_are_refused_with_the_free_direction(mount, camera):
    rng = np.random.default_rng(10)
    e = np.array([0.6, 0.0, 0.8])
    turns = spatial.matrix_from_axis_angle(np.tile(e, (10, 1)), rng.uniform(-1.5, 1.5, 10))
    A = spatial.pose_from_matrix(turns, rng.normal(size=(10, 3)))
    _, S, X, Z = samples(rng, 10, camera=camera)
    S = spatial.inverse_pose((spatial.inverse_pose(A) if mount == MOUNTS[1] else A) @ X) @ Z
    frame = "base" if mount == MOUNTS[1] else "hand"
    text = rf"parallel to \[0.6, 0.0, 0.8\].* along \[0.6, 0.0, 0.8\] of the {frame} frame is free"
    with pytest.raises(BadValueError, match=text):
        hand_eye(A, S, mount=mount)


def test_parallel_axes_hidden_in_noise_of_both_are_refused_or_said_to_be_weak():
    rng = np.random.default_rng(11)
    refused = 0
    for _ in range(20):
        turns = spatial.matrix_from_axis_angle(
            np.tile([0.0, 0.0, 1.0], (20, 1)), rng.uniform(-1.5, 1.5, 20)
        )
        A = spatial.pose_from_matrix(turns, rng.normal(size=(20, 3)))
        _, _, X, Z = samples(rng, 3)
        S = spatial.inverse_pose(A @ X) @ Z
        try:
            found = hand_eye(_shaken(rng, A), _shaken(rng, S))
        except BadValueError:
            refused += 1
        else:
            np.testing.assert_allclose(np.abs(found.weak_directions[0]), [0, 0, 1], atol=0.05)
            assert found.position_deviation > 0.02
    assert refused


def _shaken(rng, poses):
    steps = rng.normal(size=(len(poses), 6)) * np.repeat(CAMERA, 3)
    return poses @ spatial.pose_exponential(steps)


def test_pure_translations_are_refused():
    rng = np.random.default_rng(12)
    A = np.tile(np.eye(4), (6, 1, 1))
    A[:, :3, 3] = rng.normal(size=(6, 3))
    with pytest.raises(BadValueError, match=r"pure translations.* free in all directions"):
        hand_eye(A, spatial.inverse_pose(A))


def test_weak_directions_are_those_of_nearly_parallel_axes():
    A, S, _, _ = samples(np.random.default_rng(13), 20, KINDS[2], camera=CAMERA)
    found = hand_eye(A, S)
    np.testing.assert_allclose(np.abs(found.weak_directions[:1]), [[0, 0, 1]], atol=0.1)
    A, S, _, _ = samples(np.random.default_rng(13), 20, camera=CAMERA)
    assert hand_eye(A, S).weak_directions.shape == (0, 3)


def test_an_exchanged_mount_and_inverted_poses_are_said():
    A, S, X, Z = samples(np.random.default_rng(14), 10, camera=CAMERA)
    back = spatial.inverse_pose
    for call in (
        lambda: hand_eye(A, S, mount="eye-to-hand"),
        lambda: hand_eye(back(A), S),
        lambda: hand_eye(A, back(S)),
    ):
        with pytest.raises(BadValueError, match=r"mount is .*one is inverted here: so the samples"):
            call()
    # With both inverted sensor and target change places, and no residual tells.
    both = hand_eye(back(A), back(S))
    np.testing.assert_allclose(both.sensor, Z, atol=5e-3)
    np.testing.assert_allclose(both.target, X, atol=5e-3)


def test_order_and_duplicates_do_not_change_a_byte():
    rng = np.random.default_rng(15)
    A, S, _, _ = samples(rng, 12, camera=CAMERA)
    first = hand_eye(A, S)
    order = np.append(rng.permutation(12), [3, 3, 5])
    again = hand_eye(A[order], S[order])
    for name in ("sensor", "target", "covariance", "weak_directions"):
        assert getattr(first, name).tobytes() == getattr(again, name).tobytes()
    assert first.residuals[order].tobytes() == again.residuals.tobytes()


@pytest.mark.parametrize("mount", MOUNTS)
def test_the_next_pose_brings_what_it_says(mount):
    rng = np.random.default_rng(16)
    A, S, X, Z = samples(rng, 6, camera=CAMERA, mount=mount)
    found = hand_eye(A, S, mount=mount, noise=[*CAMERA, 0.0, 0.0])
    proposed = next_best_pose(found)
    spatial.as_pose(proposed.pose)
    arm = spatial.inverse_pose(proposed.pose) if mount == MOUNTS[1] else proposed.pose
    seen = spatial.inverse_pose(arm @ X) @ Z
    more = hand_eye(
        np.append(A, proposed.pose[None], 0),
        np.append(S, seen[None], 0),
        mount=mount,
        noise=[*CAMERA, 0.0, 0.0],
    )
    np.testing.assert_allclose(more.covariance, proposed.covariance, rtol=0.05, atol=1e-8)
    assert proposed.gain > 1.1
    chosen = next_best_pose(found, A)
    assert chosen.gain < proposed.gain and (chosen.pose == A).all(axis=(1, 2)).any()


def test_bad_input():
    A, S, _, _ = samples(np.random.default_rng(17), 6)
    for few in (0, 2):
        with pytest.raises(WrongSizeError, match="samples that differ from each other"):
            hand_eye(A[:few], S[:few])
    with pytest.raises(WrongSizeError, match="has size 2, expected 3 or more"):
        hand_eye(A[[0, 1, 1, 0]], S[[0, 1, 1, 0]])
    with pytest.raises(WrongSizeError, match="one of each for each sample"):
        hand_eye(A, S[:5])
    with pytest.raises(NonFiniteError, match="sensor_poses"):
        hand_eye(A, np.where(S == 1.0, np.nan, S))
    with pytest.raises(BadValueError, match="rotation of robot_poses"):
        hand_eye(A * [[[2.0], [2.0], [2.0], [1.0]]], S)
    with pytest.raises(BadValueError, match="mount is 'beside', expected one of eye-in-hand"):
        hand_eye(A, S, mount="beside")
    with pytest.raises(BadValueError, match="robust"):
        hand_eye(A, S, robust="yes")
    with pytest.raises(BadValueError, match="noise is"):
        hand_eye(A, S, noise=[-1.0, 1.0, 0.0, 0.0])
    with pytest.raises(BadValueError, match="contradict each other"):
        hand_eye(A, samples(np.random.default_rng(18), 6)[1])
    with pytest.raises(BadValueError, match="a HandEyeResult"):
        next_best_pose(A)
    with pytest.raises(WrongSizeError, match="candidates"):
        next_best_pose(hand_eye(A, S), A[:0])
    with pytest.raises(WrongSizeError, match="motions"):
        relative_hand_eye(A[:1], S[:1])


def test_a_result_has_figures_to_read():
    A, S, _, _ = samples(np.random.default_rng(19), 10, camera=CAMERA)
    found = hand_eye(A, S)
    assert isinstance(found, HandEyeResult)
    np.testing.assert_array_equal(found.covariance, found.covariance.T)
    deviations = np.sqrt(np.diag(found.covariance))
    assert deviations[:3].max() <= found.rotation_deviation <= 2.0 * CAMERA[0]
    assert deviations[3:].max() <= found.position_deviation < 3.0 * CAMERA[1]
