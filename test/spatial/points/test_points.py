"""Angular velocity and acceleration from points: golden numbers, noise, and what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomech_ros import spatial
from robomech_ros.errors import (
    BadValueError,
    InconsistentDataError,
    UnderdeterminedError,
    WrongSizeError,
)

GOLDEN = json.loads(
    (Path(__file__).parents[2] / "data/golden/angular_velocity_from_points.json").read_text("utf-8")
)
POINTS, VELOCITIES, ACCELERATIONS = (
    np.array(GOLDEN[key]) for key in ("points", "velocities", "accelerations")
)


@pytest.mark.parametrize("method", ["robust", "basic"])
def test_the_golden_motion(method):
    omega = spatial.angular_velocity_from_points(POINTS, VELOCITIES, method=method)
    np.testing.assert_allclose(omega, GOLDEN["omega"], atol=1e-13)
    alpha = spatial.angular_acceleration_from_points(
        POINTS, VELOCITIES, ACCELERATIONS, method=method
    )
    np.testing.assert_allclose(alpha, GOLDEN["omega_dot"], atol=1e-12)
    assert spatial.rigidity(POINTS, VELOCITIES, ACCELERATIONS).rigid


def motion(count, m, seed=1):
    rng = np.random.default_rng(seed)
    p, drift, push = rng.normal(size=(count, m, 3)), *rng.normal(size=(2, count, 1, 3))
    w, dw = rng.normal(size=(2, count, 3))
    v = drift + np.cross(w[:, None], p)
    a = push + np.cross(dw[:, None], p) + np.cross(w[:, None], np.cross(w[:, None], p))
    return p, v, a, w, dw


@pytest.mark.parametrize("m", [3, 4, 7, 100])
def test_any_number_of_points_of_many_motions(m):
    p, v, a, w, dw = motion(50, m)
    np.testing.assert_allclose(spatial.angular_velocity_from_points(p, v), w, atol=1e-10)
    found = spatial.angular_acceleration_from_points(p, v, a)
    np.testing.assert_allclose(found, dw, atol=1e-9)
    shaped = spatial.angular_velocity_from_points(p.reshape(5, 10, m, 3), v.reshape(5, 10, m, 3))
    np.testing.assert_array_equal(shaped.reshape(50, 3), spatial.angular_velocity_from_points(p, v))


def test_points_that_are_no_rigid_body_are_found_with_the_pair_and_the_amount():
    p, v, a, _, _ = motion(1, 5)
    away = p[0, 3] - p[0, 1]
    v[0, 3] += 0.1 * away / np.linalg.norm(away)
    found = spatial.rigidity(p[0], v[0])
    assert not found.rigid
    assert set(found.pair.tolist()) == {1, 3}
    assert abs(found.stretching[1, 3]) == pytest.approx(0.1, abs=1e-12)
    assert spatial.rigidity(p[0], v[0], tolerance=0.2).rigid
    assert not spatial.rigidity(p[0], v[0], a[0]).rigid


def test_the_covariance_is_that_of_many_trials():
    rng = np.random.default_rng(3)
    p = rng.normal(size=(5, 3))
    noisy = 0.02 * rng.normal(size=(40_000, 5, 3))
    found = spatial.angular_velocity_from_points(np.broadcast_to(p, noisy.shape), noisy)
    expected = spatial.angular_velocity_covariance(p, 0.02)
    np.testing.assert_allclose(np.cov(found.T), expected, atol=0.03 * np.trace(expected))


@pytest.mark.parametrize(
    ("points", "error"), [([[1.0, 2.0], [3.0]], BadValueError), ([1.0, 2.0, 3.0], WrongSizeError)]
)
def test_the_covariance_of_what_are_no_points_is_refused(points, error):
    with pytest.raises(error, match="points"):
        spatial.angular_velocity_covariance(points, 0.02)


def tracks(rate, noise, seconds, seed=4):
    """Four points about 0.1 m apart on a body that turns and moves smoothly."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / rate)
    base = 0.1 * np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [-0.6, -0.6, -0.6]])
    vector = np.stack([0.9 * np.sin(1.5 * t), 0.7 * np.cos(1.1 * t), 0.5 * np.sin(0.8 * t + 1)], -1)
    rate_of = np.stack(
        [1.35 * np.cos(1.5 * t), -0.77 * np.sin(1.1 * t), 0.4 * np.cos(0.8 * t + 1)], -1
    )
    second = np.stack([-2.025 * np.sin(1.5 * t), -0.847 * np.cos(1.1 * t),
                       -0.32 * np.sin(0.8 * t + 1)], -1)  # fmt: skip
    omega, alpha = spatial.angular_motion(vector, "rotation-vector", rate_of, second)
    turned = Rotation.from_rotvec(vector).as_matrix()
    places = np.einsum("tij,mj->tmi", turned, base) + 0.2 * np.sin(t)[:, None, None]
    return t, places + noise * rng.normal(size=places.shape), omega, alpha


def test_noisy_tracks_give_the_angular_velocity_the_peers_lose():
    t, places, omega, _ = tracks(100.0, 1e-3, 20.0)
    found = spatial.motion_from_tracks(t, places)
    error = found.angular_velocity - omega
    assert np.sqrt(np.mean(np.sum(error**2, axis=-1))) < 0.1
    assert found.deviation == pytest.approx(1e-3, rel=0.05)
    inside = error[30:-30]
    normal = np.linalg.solve(
        np.linalg.cholesky(found.velocity_covariance[30:-30]), inside[..., None]
    )
    assert np.mean(normal**2) == pytest.approx(1.0, abs=0.15)


def test_exact_tracks_at_uneven_times_are_followed():
    t, places, omega, alpha = tracks(200.0, 0.0, 3.0)
    kept = np.sort(np.random.default_rng(5).permutation(len(t))[:400])
    found = spatial.motion_from_tracks(t[kept], places[kept], window=9, degree=6)
    np.testing.assert_allclose(found.angular_velocity, omega[kept], atol=1e-5)
    np.testing.assert_allclose(found.angular_acceleration[5:-5], alpha[kept][5:-5], atol=1e-3)


@pytest.mark.parametrize(
    ("change", "error", "text"),
    [
        (lambda p, v: (p[:2], v[:2]), WrongSizeError, "m at least 3"),
        (lambda p, v: (p, v[:3]), WrongSizeError, "as points"),
        (lambda p, v: (p * [1, 0, 0], v), UnderdeterminedError, "on one line"),
        (lambda p, v: (0.0 * p, v), UnderdeterminedError, "all the same"),
    ],
)
def test_points_that_determine_nothing_are_refused(change, error, text):
    p, v, _, _, _ = motion(1, 4)
    with pytest.raises(error, match=text):
        spatial.angular_velocity_from_points(*change(p[0], v[0]))


def test_where_the_basic_form_is_singular_the_robust_one_is_not():
    # tr(P) = 0 and P v = 0 for some v: D is singular for these labels in these axes.
    p = np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])
    p = p[[2, 1, 0]] * [1, 1, 1]
    p[:, :] = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    w = np.array([0.1, 0.2, 0.3])
    for order in ([0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]):
        found = spatial.angular_velocity_from_points(p[order], np.cross(w, p[order]))
        np.testing.assert_allclose(found, w, atol=1e-14)
    flat = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [1.0, -1.0, 0.0]])
    with pytest.raises(BadValueError, match="matrix D is regular"):
        spatial.angular_velocity_from_points(flat, np.cross(w, flat), method="basic")


def test_tracks_that_cannot_be_fitted_are_refused():
    t, places, _, _ = tracks(100.0, 0.0, 0.5)
    with pytest.raises(BadValueError, match=r"times\[1\] - times\[0\]"):
        spatial.motion_from_tracks(t[::-1], places)
    with pytest.raises(BadValueError, match="more than the degree"):
        spatial.motion_from_tracks(t, places, window=4)
    with pytest.raises(BadValueError, match="degree is 1"):
        spatial.motion_from_tracks(t, places, degree=1)
    with pytest.raises(WrongSizeError, match="points has shape"):
        spatial.motion_from_tracks(t, places[:-1])


def test_what_is_wrong_with_points_has_its_error_and_names_the_culprits():
    p, v, a, _, _ = motion(1, 5)
    wrong = v[0].copy()
    wrong[3] += 0.1 * (p[0, 3] - p[0, 1])
    with pytest.raises(InconsistentDataError, match=r"points [13] and [13] changes fastest"):
        spatial.require_rigid(p[0], wrong)
    with pytest.raises(InconsistentDataError, match=r"points in row 1 is .* m/s\^2"):
        spatial.require_rigid(
            np.stack((p[0],) * 2), np.stack((v[0],) * 2), np.stack((a[0], wrong)), tolerance=1e-6
        )
    assert spatial.require_rigid(p[0], wrong, tolerance=1.0).rigid
    line = np.outer([0.0, 1.0, 2.0, 4.0], [0.6, 0.0, 0.8])
    with pytest.raises(UnderdeterminedError, match=r"their line, \[0.6, 0.0, 0.8\]") as caught:
        spatial.angular_velocity_from_points(line, line)
    assert caught.value.free == ((0.6, 0.0, 0.8),)
    with pytest.raises(UnderdeterminedError, match="not all the same"):
        spatial.angular_acceleration_from_points(0.0 * line, line, line)


def test_tracks_of_points_that_are_no_rigid_body_are_refused():
    t, places, _, _ = tracks(100.0, 1e-3, 2.0)
    places[:, 2] += 0.05 * np.sin(3.0 * t)[:, None]
    with pytest.raises(
        InconsistentDataError, match=r"points (. and 2|2 and .) is .*, expected at most"
    ):
        spatial.motion_from_tracks(t, places)
    assert len(spatial.motion_from_tracks(t, places, tolerance=0.1).times) == len(t)
    with pytest.raises(BadValueError, match="tolerance is 0"):
        spatial.motion_from_tracks(t, places, tolerance=0.0)
