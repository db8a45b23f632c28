"""The installed calibration: the demonstration, and the node called from outside."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix
from robomech_ros.spatial import inverse_pose, pose_exponential, pose_from_position_quaternion

FRAMES = {"robot_base_frame": "base", "robot_effector_frame": "hand"}
FRAMES |= {"tracking_base_frame": "camera", "tracking_marker_frame": "marker"}


def posed(T):
    """Return a pose as a request in YAML has it."""
    pose = pose_from_matrix(T)
    return {
        "position": {k: getattr(pose.position, k) for k in "xyz"},
        "orientation": {k: getattr(pose.orientation, k) for k in "xyzw"},
    }


def test_given_samples_are_solved_and_saved(suite, tmp_path):
    """Without a robot: its frames are all that is needed."""
    X, Z = pose_exponential([[0.1, 0.2, 0.3, 0.0, 0.1, 0.2], [0.0, 2.0, 0.5, 0.8, 0.0, 0.1]])
    robot = pose_exponential(np.random.default_rng(1).normal(size=(6, 6)))
    tracking = inverse_pose(robot @ X) @ Z
    parameters = {**FRAMES, "folder": str(tmp_path / "kept")}
    given = [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]
    with suite.node("calibration_node", *given):
        request = {
            "robot": {"poses": [posed(T) for T in robot]},
            "tracking": {"poses": [posed(T) for T in tracking]},
        }
        assert suite.call("calibration/solve", {})["error_code"] == 108
        assert suite.call("calibration/add_samples", request)["count"] == 6
        answer = suite.call("calibration/solve", {"mount": "EYE_IN_HAND"})
        assert answer["error_code"] == 0, answer["error_msg"]
        assert answer["summary"].startswith("camera in hand: at 0.0")
        files = suite.call("calibration/save", {"name": "wrist"})["files"]
    calib = yaml.safe_load(Path(files[1]).read_text(encoding="utf-8"))["transform"]
    place, turn = calib["translation"], calib["rotation"]
    found = pose_from_position_quaternion([place[k] for k in "xyz"], [turn[k] for k in "xyzw"])
    np.testing.assert_allclose(found, X, atol=1e-9)


@pytest.mark.timeout(600)
@pytest.mark.parametrize(
    "kind", ["eye_in_hand", pytest.param("eye_on_base", marks=pytest.mark.long)]
)
def test_the_demonstration_finds_the_camera_and_the_wrong_sample(suite, tmp_path, kind):
    options = ("--type", kind, "--samples", "8", "--output", str(tmp_path / "out"))
    done = suite.run("robomech", "calibrate-demo", *options, timeout=500)
    assert done.returncode == 0, done.stderr
    for words in ("left out: 6", "the truth is ", "everything worked", "it speaks on /tf"):
        assert words in done.stdout
    written = {"ur5e.yaml", "ur5e.calib", "ur5e.samples"}
    written |= {"ur5e_calibration.png", "ur5e_calibration.html"}
    assert {path.name for path in (tmp_path / "out").iterdir()} == written
    assert (tmp_path / "out" / "ur5e_calibration.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--samples", "3"), "--samples is 3, expected 8 to 40"),
        (("--position-noise", "nan"), "--position-noise is nan, expected 0 to 0.05"),
        (("--type", "beside"), "invalid choice: 'beside'"),
    ],
)
def test_options_of_the_demonstration_are_checked(suite, options, words):
    done = suite.run("robomech", "calibrate-demo", *options)
    assert (done.returncode, words in done.stderr) == (2, True)
