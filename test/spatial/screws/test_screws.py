"""Screws, lines, twists and wrenches: golden numbers, Pinocchio, and what must not change."""

import json
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from robomech_ros import spatial
from robomech_ros.errors import BadValueError, WrongSizeError

GOLDEN = json.loads(
    (Path(__file__).parents[2] / "data" / "golden" / "screw.json").read_text(encoding="utf-8")
)


def hard_screw_vectors(count):
    """Rotation vectors of 0, of 1e-12 to 1e-3, as near to pi, and pi; velocities of any size."""
    rng = np.random.default_rng(1)
    axes = rng.normal(size=(count, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    small = 10.0 ** rng.uniform(-12.0, -3.0, count)
    angles = np.choose(
        rng.integers(0, 3, count), [small, np.pi - small, rng.uniform(0, np.pi, count)]
    )
    angles[:100], angles[100:200] = 0.0, np.pi
    return np.concatenate((axes * angles[:, None], rng.normal(size=(count, 3))), axis=-1)


XI = hard_screw_vectors(100_000)
POSES = spatial.pose_exponential(XI)


def test_poses_come_back_from_their_logarithms_and_screws():
    size = 1.0 + np.abs(POSES[:, :3, 3]).max(axis=-1)[:, None, None]
    again = spatial.pose_exponential(spatial.pose_logarithm(POSES))
    assert (np.abs(again - POSES) / size).max() < 2e-15
    screw = spatial.finite_screw(POSES)
    again = spatial.pose_from_screw(screw.axis, screw.point, screw.angle, screw.displacement)
    assert (np.abs(again - POSES) / size).max() < 2e-15
    inside = np.linalg.norm(XI[:, :3], axis=-1) < np.pi - 1e-9
    np.testing.assert_allclose(spatial.pose_logarithm(POSES)[inside], XI[inside], atol=2e-14)


def test_exponential_and_logarithm_are_those_of_pinocchio():
    for xi, T in zip(XI[::1999], POSES[::1999], strict=True):
        theirs = pinocchio.exp6(pinocchio.Motion(xi[3:], xi[:3]))
        np.testing.assert_allclose(T, theirs.homogeneous, atol=3e-15)
        back = pinocchio.log6(pinocchio.SE3(T)).vector
        ours = spatial.pose_logarithm(T)
        if np.pi - np.linalg.norm(xi[:3]) > 1e-6:
            np.testing.assert_allclose(ours, [*back[3:], *back[:3]], atol=1e-9)


def test_the_exponential_is_that_of_the_matrix():
    for xi in XI[5::9973]:
        generator = np.zeros((4, 4))
        generator[:3, :3], generator[:3, 3] = spatial.cross_product_matrix(xi[:3]), xi[3:]
        np.testing.assert_allclose(spatial.pose_exponential(xi), expm(generator), atol=1e-14)


def test_the_golden_screw():
    T = spatial.pose_from_matrix(
        Rotation.from_rotvec(2.0 * np.pi / 3.0 * np.ones(3) / np.sqrt(3.0)).as_matrix(), [0, 0, 0]
    )
    a, moved = np.array([0.2, 0.1, 0.0]), np.array([1.0, 0.5, -0.3])
    T[:3, 3] = a + moved - T[:3, :3] @ a
    screw = spatial.finite_screw(T)
    assert float(screw.displacement) == pytest.approx(0.692820323, abs=1e-9)
    assert float(screw.pitch) == pytest.approx(0.330797337, abs=1e-9)
    np.testing.assert_allclose(screw.point, [4 / 15, 4 / 15, -8 / 15], atol=1e-12)
    np.testing.assert_allclose(screw.axis, np.full(3, 1 / np.sqrt(3.0)), atol=1e-15)
    assert GOLDEN


def test_the_golden_instant_screw():
    screw = spatial.instant_screw([0.3, -0.2, 0.5, 1.0, 2.0, -0.5], [0.4, 0.1, -0.3])
    assert float(screw.pitch) == pytest.approx(-0.921052631579, abs=1e-12)
    np.testing.assert_allclose(screw.point, [-1.928947368, 1.784210526, 1.871052632], atol=1e-9)


def test_translations_and_rest_have_an_axis_and_an_infinite_pitch():
    T = np.eye(4)
    T[:3, 3] = 0.0, 3.0, 4.0
    screw = spatial.finite_screw([np.eye(4), T])
    assert screw.axis.tolist() == [[0.0, 0.0, 1.0], [0.0, 0.6, 0.8]]
    assert screw.displacement.tolist() == [0.0, 5.0] and np.isinf(screw.pitch).all()
    slide = spatial.instant_screw([0, 0, 0, 0, 0, 2.0])
    assert (slide.axis.tolist(), float(slide.pitch), float(slide.magnitude)) == (
        [0, 0, 1],
        np.inf,
        2,
    )
    couple = spatial.wrench_axis([0.0, 3.0, 0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 1.0])
    assert couple.axis.tolist() == [0.0, 1.0, 0.0] and couple.point.tolist() == [0.0, 0.0, 0.0]


def test_the_screw_of_a_pose_is_that_of_its_logarithm():
    xi = XI[300:1000]
    screw, instant = spatial.finite_screw(POSES[300:1000]), spatial.instant_screw(xi)
    turned = (np.linalg.norm(xi[:, :3], axis=-1) > 1e-3) & (
        np.linalg.norm(xi[:, :3], axis=-1) < np.pi - 1e-9
    )
    np.testing.assert_allclose(screw.axis[turned], instant.axis[turned], atol=1e-12)
    np.testing.assert_allclose(screw.point[turned], instant.point[turned], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(screw.pitch[turned], instant.pitch[turned], rtol=1e-9, atol=1e-12)


def test_power_stays_the_same_at_every_point():
    rng = np.random.default_rng(2)
    t, w = rng.normal(size=(2, 50, 6))
    a, p = rng.normal(size=(2, 50, 3))
    t_p, w_p = spatial.transfer_twist(t, a, p), spatial.transfer_wrench(w, a, p)
    np.testing.assert_allclose(np.sum(t_p * w_p, -1), np.sum(t * w, -1), atol=1e-12)
    U, V = spatial.twist_transfer_matrix(a, p), spatial.wrench_transfer_matrix(a, p)
    np.testing.assert_allclose((U @ t[..., None])[..., 0], t_p, atol=1e-14)
    np.testing.assert_allclose((V @ w[..., None])[..., 0], w_p, atol=1e-14)
    np.testing.assert_allclose(np.swapaxes(V, 1, 2) @ U, np.tile(np.eye(6), (50, 1, 1)), atol=1e-13)
    assert spatial.transfer_twist(t[0], a, p[0]).shape == (50, 6)


def test_the_axis_of_a_wrench_has_the_moment_along_the_force():
    rng = np.random.default_rng(3)
    w, a = rng.normal(size=(40, 6)), rng.normal(size=(40, 3))
    axis = spatial.wrench_axis(w, a)
    there = spatial.transfer_wrench(w, a, axis.point)
    np.testing.assert_allclose(there[:, :3], axis.pitch[:, None] * w[:, 3:], atol=1e-12)
    np.testing.assert_allclose(np.sum(axis.point * w[:, 3:], -1), 0.0, atol=1e-12)
    np.testing.assert_allclose(axis.magnitude, np.linalg.norm(w[:, 3:], axis=-1), rtol=1e-14)


def test_adjoints_are_those_of_pinocchio():
    for T in POSES[250:260]:
        theirs = pinocchio.SE3(T).toActionMatrix()
        order = [3, 4, 5, 0, 1, 2]
        np.testing.assert_allclose(
            spatial.pose_adjoint(T), theirs[np.ix_(order, order)], atol=1e-13
        )


@pytest.mark.parametrize("rotation", ["quaternion", "linear-invariants", "axis-angle"])
def test_pose_arrays_lead_back(rotation):
    T = POSES[300:900]
    array = spatial.pose_array_from_pose(T, rotation)
    assert array.shape == (600, 7)
    np.testing.assert_allclose(spatial.pose_from_pose_array(array, rotation), T, atol=1e-14)


def test_bad_poses_and_screws_are_refused():
    with pytest.raises(BadValueError, match="last row of pose"):
        spatial.pose_logarithm(2.0 * np.eye(4))
    with pytest.raises(BadValueError, match="determinant not positive"):
        spatial.finite_screw(np.diag([1.0, 1.0, -1.0, 1.0]))
    with pytest.raises(BadValueError, match="axis is .* not zero"):
        spatial.pose_from_screw([0, 0, 0], [0, 0, 0], 1.0, 0.0)
    with pytest.raises(WrongSizeError, match="screw vector has shape"):
        spatial.pose_exponential(np.zeros(5))
    with pytest.raises(BadValueError, match="rotation is 'matrix'"):
        spatial.pose_array_from_pose(np.eye(4), "matrix")
