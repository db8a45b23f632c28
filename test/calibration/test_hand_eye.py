"""Hand-eye calibration: golden data, noise, outliers, what cannot be found and what is wrong."""

import json
from pathlib import Path

import numpy as np
import pytest
from hand_eye_cells import KINDS, noisy, samples
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
from robomech_ros.errors import (
    BadValueError,
    InconsistentDataError,
    NonFiniteError,
    UnderdeterminedError,
    WrongSizeError,
)

CAMERA = np.radians(0.1), 0.5e-3
DATA = Path(__file__).resolve().parents[1] / "data"


@pytest.fixture
def handeye_data():
    """Read samples from the field: both lists of poses, and all of the file."""

    def read(name):
        data = json.loads((DATA / f"{name}.json").read_text("utf-8"))
        return np.array(data["T_base_hand"]), np.array(data["T_sensor_target"]), data

    return read


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
@pytest.mark.parametrize(
    ("mount", "robot"),
    [
        (MOUNTS[0], CAMERA),
        (MOUNTS[1], (0.0, 0.0)),
        pytest.param(MOUNTS[0], (0.0, 0.0), marks=pytest.mark.long),
        pytest.param(MOUNTS[1], CAMERA, marks=pytest.mark.long),
    ],
    ids=lambda value: value if isinstance(value, str) else f"robot-{value[0]:g}",
)
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


def degenerate(rng, n, kind, mount, *, robot=(0.0, 0.0), camera=(0.0, 0.0)):
    """Samples without turns or about one axis, the true pose of the sensor, and the axis."""
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    angles = rng.uniform(-1.5, 1.5, n) * (kind == "parallel axes")
    turns = spatial.matrix_from_axis_angle(np.tile(axis, (n, 1)), angles)
    A = spatial.pose_from_matrix(turns, rng.uniform(-0.5, 0.5, (n, 3)))
    _, _, X, Z = samples(rng, 3)
    S = spatial.inverse_pose((spatial.inverse_pose(A) if mount == MOUNTS[1] else A) @ X) @ Z
    return noisy(rng, A, *robot), noisy(rng, S, *camera), X, axis


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("given", [False, True], ids=["estimated", "given"])
@pytest.mark.parametrize("camera", [(0.0, 0.0), CAMERA], ids=["robot", "robot and camera"])
@pytest.mark.parametrize("rotation", [1e-5, 1e-4, 1e-3])
@pytest.mark.filterwarnings("error")
def test_noise_is_no_turn(rotation, camera, given, mount):
    robot = rotation, rotation
    noise = [*camera, *robot] if given else None
    rng = np.random.default_rng(10)
    for n in (4, 6, 12):
        for _ in range(3):
            A, S, _, _ = degenerate(rng, n, "translations", mount, robot=robot, camera=camera)
            with pytest.raises(UnderdeterminedError, match="pure translations") as caught:
                hand_eye(A, S, mount=mount, noise=noise)
            assert np.array_equal(caught.value.free, np.eye(3))
            A, S, X, axis = degenerate(rng, n, "parallel axes", mount, robot=robot, camera=camera)
            found = hand_eye(A, S, mount=mount, noise=noise)
            assert found.free_directions.shape == (1, 3)
            np.testing.assert_allclose(np.abs(found.free_directions[0] @ axis), 1.0, atol=1e-4)
            assert np.array_equal(found.weak_directions[0], found.free_directions[0])
            error = spatial.pose_error(found.sensor, X)
            assert error @ np.linalg.solve(found.covariance, error) < 3.0 * 12.59
            along = found.free_directions[0]
            assert abs(along @ found.sensor[:3, 3]) < 5e-3
            # All but the position along the axis is as good as the noise, of 4 samples, too.
            across = error[3:] - along * (along @ error[3:])
            assert max(np.abs(error[:3]).max(), np.abs(across).max()) < 0.03


@pytest.mark.parametrize("mount", MOUNTS)
@pytest.mark.parametrize("noise", [0.0, 1e-12, 1e-9])
def test_rounding_is_no_turn(noise, mount):
    """Samples from a simulation, exact or nearly, were accepted or said to have the wrong mount."""
    rng = np.random.default_rng(10)
    for n in [4, 6, 12] * 10:
        A, S, X, axis = degenerate(rng, n, "parallel axes", mount, robot=(noise, noise))
        found = hand_eye(A, S, mount=mount)
        np.testing.assert_allclose(np.abs(found.free_directions @ axis), [1.0], atol=1e-9)
        across = np.eye(3) - np.outer(axis, axis)
        error = spatial.pose_error(found.sensor, X)
        np.testing.assert_allclose(error[:3], 0.0, atol=1e-5)
        np.testing.assert_allclose(across @ error[3:], 0.0, atol=1e-5)
        A, S, _, _ = degenerate(rng, n, "translations", mount, robot=(noise, noise))
        with pytest.raises(UnderdeterminedError, match="pure translations"):
            hand_eye(A, S, mount=mount)


@pytest.mark.parametrize("mount", MOUNTS)
def test_five_of_six_numbers_are_found_about_parallel_axes(mount):
    rng = np.random.default_rng(11)
    inside = 0
    for _ in range(100):
        A, S, X, axis = degenerate(rng, 15, "parallel axes", mount, robot=CAMERA, camera=CAMERA)
        found = hand_eye(A, S, mount=mount)
        assert abs(found.free_directions[0] @ axis) > 0.9999
        error = spatial.pose_error(found.sensor, X)
        across = np.linalg.svd(found.free_directions)[2][1:]
        five = np.concatenate((error[:3], across @ error[3:]))
        to_five = np.zeros((5, 6))
        to_five[:3, :3], to_five[3:, 3:] = np.eye(3), across
        covariance = to_five @ found.covariance @ to_five.T
        inside += five @ np.linalg.solve(covariance, five) < chi2.ppf(0.95, 5)
        assert found.position_deviation > 1.0
    assert 88 <= inside <= 99


@pytest.mark.parametrize("noise", [0.0, 1e-3])
@pytest.mark.parametrize("along", [0.0, 0.3])
def test_turns_about_one_line_leave_the_turn_about_it_free(noise, along):
    """The rotation came back wrong by a radian, with a deviation of 3e-14 rad."""
    X, Z = spatial.pose_exponential(
        [[0.3, -0.2, 0.5, 0.1, 0.1, 0.2], [2.0, 0.3, -0.4, 0.6, 0.1, 0.2]]
    )
    for seed in range(10):
        rng = np.random.default_rng(seed)
        twists = np.zeros((12, 6))
        twists[:, 2], twists[:, 5] = rng.uniform(-2.5, 2.5, 12), along * rng.uniform(-1.0, 1.0, 12)
        A = spatial.pose_exponential(twists)
        S = spatial.inverse_pose(A @ X) @ Z
        S = S @ spatial.pose_exponential(noise * rng.normal(size=(12, 6)))
        with pytest.raises(
            UnderdeterminedError, match="robot's rotation axes is 'one common line'"
        ):
            hand_eye(A, S)


def test_a_robot_of_four_axes(handeye_data):
    A, S, data = handeye_data("handeye_scara")
    found, truth = hand_eye(A, S), np.array(data["true_T_hand_sensor"])
    np.testing.assert_allclose(found.free_directions, [[0.0, 0.0, 1.0]], atol=1e-6)
    np.testing.assert_allclose(found.sensor[:3, :3], truth[:3, :3], atol=1e-7)
    np.testing.assert_allclose(found.sensor[:3, 3], [*truth[:2, 3], 0.0], atol=1e-7)
    # A tilted pose determines the sixth.
    tilt = spatial.pose_exponential([0.3, 0.0, 0.0, 0.0, 0.0, 0.0])
    Z = A[0] @ truth @ S[0]
    A, S = (
        np.append(A, (A[0] @ tilt)[None], 0),
        np.append(S, (spatial.inverse_pose(A[0] @ tilt @ truth) @ Z)[None], 0),
    )
    found = hand_eye(A, S)
    assert found.free_directions.shape == (0, 3)
    np.testing.assert_allclose(found.sensor, truth, atol=1e-6)


def _shaken(rng, poses):
    steps = rng.normal(size=(len(poses), 6)) * np.repeat(CAMERA, 3)
    return poses @ spatial.pose_exponential(steps)


def test_pure_translations_are_refused():
    rng = np.random.default_rng(12)
    A = np.tile(np.eye(4), (6, 1, 1))
    A[:, :3, 3] = rng.normal(size=(6, 3))
    with pytest.raises(BadValueError, match=r"pure translations leave .* free in all directions"):
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
        with pytest.raises(
            BadValueError, match=r"mount is .* times better; if the mount is right, invert one list"
        ):
            call()
    # With both inverted sensor and target change places, and no residual tells.
    both = hand_eye(back(A), back(S))
    np.testing.assert_allclose(both.sensor, Z, atol=5e-3)
    np.testing.assert_allclose(both.target, X, atol=5e-3)


def views(rng, n, spread, mount):
    """Views of a target from nearly the same distance: samples and the true sensor's pose."""
    X = spatial.pose_exponential(np.append(0.5 * rng.normal(size=3), rng.uniform(-0.1, 0.1, 3)))
    other = spatial.pose_exponential(np.append(rng.normal(size=3), rng.uniform(-0.5, 0.5, 3)))
    around, tilt = rng.uniform(0.0, 2.0 * np.pi, n), 0.6 * np.sqrt(rng.uniform(0.0, 1.0, n))
    vectors = np.stack((tilt * np.cos(around), tilt * np.sin(around), np.zeros(n)), axis=1)
    T = spatial.pose_from_matrix(spatial.matrix_from_rotation_vector(vectors), np.zeros((n, 3)))
    away = 0.45 * (1.0 + spread * rng.uniform(-1.0, 1.0, n))
    T[:, :3, 3] = -away[:, None] * T[:, :3, 2] + 3e-3 * rng.normal(size=(n, 3))
    S = spatial.inverse_pose(T)
    if mount == MOUNTS[0]:
        A, sensor = other @ T @ spatial.inverse_pose(X), X
    else:
        A, sensor = other @ S @ spatial.inverse_pose(X), other
    return noisy(rng, A, 1e-4, 1e-4), noisy(rng, S, 1e-3, 3e-4), sensor


@pytest.mark.parametrize("spread", [0.02, 0.05, 0.1])
@pytest.mark.parametrize("mount", MOUNTS)
def test_views_from_one_distance_tell_mount_and_inversions(mount, spread):
    back, rng = spatial.inverse_pose, np.random.default_rng(14)
    other = MOUNTS[1 - MOUNTS.index(mount)]
    for n in [8, 10] * 5:
        A, S, X = views(rng, n, spread, mount)
        found = hand_eye(A, S, mount=mount)
        assert np.abs(spatial.pose_error(found.sensor, X)).max() < 0.03
        for robot, sensor, wrong in ((A, S, other), (back(A), S, mount), (A, back(S), mount)):
            with pytest.raises(InconsistentDataError, match=f"mount is '{wrong}', expected"):
                hand_eye(robot, sensor, mount=wrong)


def test_views_in_the_field_tell_the_mount(handeye_data):
    A, S, data = handeye_data("handeye_wrong_mount")
    found = hand_eye(A, S, mount=data["true_mount"])
    assert np.abs(spatial.pose_error(found.sensor, data["true_T_hand_sensor"])).max() < 2e-3
    for robot, sensor, mount in (
        (A, S, "eye-to-hand"),
        (spatial.inverse_pose(A), S, "eye-in-hand"),
        (A, spatial.inverse_pose(S), "eye-in-hand"),
    ):
        with pytest.raises(InconsistentDataError, match=f"mount is '{mount}', expected"):
            hand_eye(robot, sensor, mount=mount)


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
