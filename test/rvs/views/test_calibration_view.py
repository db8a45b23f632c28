"""A hand-eye calibration as it is drawn, on a page and in a file."""

import numpy as np
import pytest

from robomech_ros.calibration import hand_eye
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_description
from robomech_ros.rvs import view_calibration, write_calibration
from robomech_ros.rvs.model.calibration_view import (
    calibration_markers,
    drawing_factor,
    position_half_axes,
    sample_markers,
)
from robomech_ros.spatial import inverse_pose, pose_exponential

WRONG = 6


@pytest.fixture(scope="module", params=["eye-in-hand", "eye-to-hand"])
def calibrated(request):
    """A UR5e with a calibration of fourteen samples, of which one is wrong."""
    description = load_description("ur5e")
    chain = description.chain()
    rng = np.random.default_rng(3)
    q = np.array([0.3, -1.4, 1.5, -1.6, -1.5, 0.2]) + rng.uniform(-0.35, 0.35, (14, 6))
    hands = forward_kinematics(chain, q)
    sensor = pose_exponential([0.0, 0.0, 0.1, 0.03, 0.05, 0.08])
    target = pose_exponential([0.2, 0.1, 0.0, 0.6, 0.2, 0.0])
    seen = inverse_pose(hands @ sensor) @ target
    if request.param == "eye-to-hand":
        seen = inverse_pose(sensor) @ hands @ target
    seen = seen @ pose_exponential(rng.normal(size=(14, 6)) * [*[2e-3] * 3, *[5e-4] * 3])
    seen[WRONG] = seen[WRONG] @ pose_exponential([0.0, 0.0, 1.5, 0.0, 0.0, 0.0])
    result = hand_eye(hands, seen, mount=request.param)
    assert result.outliers == (WRONG,)
    return description, chain, result, seen


def test_samples_stand_where_the_hand_was_and_the_wrong_one_is_red(calibrated):
    _, _, result, seen = calibrated
    drawn = {one.name: one for one in calibration_markers(result, seen, "base", "hand")}
    for k, T in enumerate(result.robot_poses):
        ball = drawn[f"sample_{k}"]
        assert ball.link == "base"
        np.testing.assert_array_equal(ball.pose, T)
        red, green, _, _ = ball.colour
        assert (red > 3 * green) is (k == WRONG)
    assert [name for name in drawn if name.startswith("left_out")] == [f"left_out_{WRONG}"]


def test_the_ellipsoid_is_that_of_the_covariance_times_the_written_factor(calibrated):
    _, _, result, seen = calibrated
    drawn = {one.name: one for one in calibration_markers(result, seen, "base", "hand")}
    ball, label = drawn["uncertainty"], drawn["uncertainty_label"].text
    factor = float(label.rpartition("x ")[2])
    covariance = result.covariance[3:, 3:]
    # Every point of its surface is 95 % by the chi-square distribution of three numbers.
    half = np.array(ball.measures) / 2.0 / factor
    for k in range(3):
        x = half[k] * ball.pose[:3, k]
        assert x @ np.linalg.solve(covariance, x) == pytest.approx(7.8147, rel=1e-6)
    np.testing.assert_allclose(ball.pose[:3, 3], result.sensor[:3, 3])
    assert np.linalg.det(ball.pose[:3, :3]) == pytest.approx(1.0)
    longest = position_half_axes(result)[0][0]
    assert f"{1e3 * longest:.2g} mm" in label
    in_hand = result.mount == "eye-in-hand"
    assert (ball.link, drawn["target"].link) == (("hand", "base") if in_hand else ("base", "hand"))


def test_the_frustum_opens_to_where_the_target_was_seen(calibrated):
    _, _, result, seen = calibrated
    lines = next(one for one in calibration_markers(result, seen, "b", "h") if one.name == "sensor")
    local = (lines.points - result.sensor[:3, 3]) @ result.sensor[:3, :3]
    middle = local[1:8:2].mean(axis=0)
    towards = seen[:, :3, 3].mean(axis=0)
    k = np.argmax(np.abs(towards))
    assert middle[k] * towards[k] > 0.0
    np.testing.assert_allclose(np.delete(middle, k), 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("longest", "room", "factor"),
    [(1e-3, 0.06, 50), (1e-3, 0.0199, 10), (1e-3, 0.02, 20), (0.1, 0.06, 1), (0.0, 0.1, 1)],
)
def test_what_is_tiny_is_drawn_larger_by_a_round_number(longest, room, factor):
    assert drawing_factor(longest, room) == factor


def test_samples_without_a_result_are_grey_and_none_is_nothing(calibrated):
    _, _, result, seen = calibrated
    balls = [one for one in sample_markers(result.robot_poses, seen, "b") if one.kind == "sphere"]
    assert len(balls) == 14 and len({one.colour for one in balls}) == 1
    assert sample_markers(np.empty((0, 4, 4)), np.empty((0, 4, 4)), "b") == []


def test_a_page_shows_it_and_the_arm_stands_at_the_last_sample(calibrated):
    pytest.importorskip("viser")
    _, _, result, seen = calibrated
    with view_calibration("ur5e", result, seen, port=0) as page:
        layer = page._layers[-1]
        assert {node.name.rpartition("/")[2] for node in layer._nodes._nodes["calibration"]}
        np.testing.assert_allclose(page._arm.tip, result.robot_poses[-1], atol=1e-9)
        assert not page._switched()["gizmo"]


def test_a_file_shows_it_with_every_residual(calibrated, tmp_path):
    pytest.importorskip("viser")
    description, chain, result, seen = calibrated
    path = write_calibration(tmp_path / "found.html", description, chain, result, seen)
    text = path.read_text(encoding="utf-8")
    assert f"sample {WRONG}: left out" in text
    assert "sample 13:" in text and "half axes" in text


def test_poses_that_are_not_those_of_the_samples_are_refused(calibrated, tmp_path):
    description, chain, result, seen = calibrated
    with pytest.raises(WrongSizeError, match="14, 4, 4"):
        write_calibration(tmp_path / "no.html", description, chain, result, seen[:3])
    with pytest.raises(BadValueError):
        view_calibration("ur5e", result, 2.0 * seen, port=0)
