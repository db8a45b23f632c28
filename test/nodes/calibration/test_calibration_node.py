"""The calibration node with given samples: its result in messages, on tf and in files."""

import json
import math
import os
from pathlib import Path

import numpy as np
import pytest
import yaml
from camera_stage import FRAMES, Stage, array_of
from geometry_msgs.msg import Pose, PoseArray, TransformStamped
from hand_eye_cells import samples
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray
from waiting import until

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import RemoveSample, SolveCalibration
from robomech_ros.calibration import hand_eye, next_best_pose
from robomech_ros.errors import BadValueError
from robomech_ros.nodes.calibration.files import FORMAT
from robomech_ros.nodes.calibration.node import CalibrationNode
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, stamped_transform
from robomech_ros.spatial import inverse_pose, pose_exponential, pose_from_position_quaternion

LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
EYE_TO_HAND = SolveCalibration.Request.EYE_TO_HAND
NOISE = (2e-3, 5e-4)


def matrix(message):
    """Return a Transform, or the pose of a PoseStamped, as a matrix."""
    p, q = message.translation, message.rotation
    return pose_from_position_quaternion([p.x, p.y, p.z], [q.x, q.y, q.z, q.w])


@pytest.mark.parametrize("mount", ["eye-in-hand", "eye-to-hand"])
def test_the_result_is_the_librarys_in_messages(stage, mount):
    robot, tracking, X, _ = samples(np.random.default_rng(3), 12, camera=NOISE, mount=mount)
    tracking[4] = tracking[4] @ pose_exponential([0.5, 0.0, 0.3, 0.2, 0.1, 0.0])
    assert stage.add(robot[:5], tracking[:5]).count == 5
    added = stage.add(robot[5:], tracking[5:])
    assert (added.error_code, added.first_index, added.count) == (0, 5, 12)
    answer = stage.do("solve", mount=EYE_TO_HAND if mount == "eye-to-hand" else 0)
    found = hand_eye(robot, tracking, mount=mount)
    np.testing.assert_allclose(matrix(answer.sensor.transform), found.sensor, atol=1e-9)
    np.testing.assert_allclose(matrix(answer.target.transform), found.target, atol=1e-9)
    np.testing.assert_allclose(matrix(answer.sensor.transform), X, atol=2e-2)
    names = [answer.sensor.header.frame_id, answer.sensor.child_frame_id]
    names += [answer.target.header.frame_id, answer.target.child_frame_id]
    ends = ["hand", "base"] if mount == "eye-in-hand" else ["base", "hand"]
    assert names == [ends[0], "camera", ends[1], "marker"]
    # Position first, as in PoseWithCovariance.
    covariance = np.reshape(answer.covariance, (6, 6))
    np.testing.assert_allclose(covariance[:3, :3], found.covariance[3:, 3:], rtol=1e-6)
    np.testing.assert_allclose(covariance[:3, 3:], found.covariance[3:, :3], rtol=1e-4, atol=1e-12)
    assert (list(answer.outliers), list(answer.inlier)) == ([4], [k != 4 for k in range(12)])
    np.testing.assert_allclose(answer.rotation_residuals, found.residuals[:, 0], atol=1e-9)
    np.testing.assert_allclose(answer.position_residuals, found.residuals[:, 1], atol=1e-9)
    best = next_best_pose(found)
    np.testing.assert_allclose(matrix_from_pose(answer.next_pose.pose), best.pose, atol=1e-9)
    assert answer.next_gain == pytest.approx(best.gain, rel=1e-6)
    for words in (f"camera in {ends[0]}: at ", f"{mount}, 11 of 12 samples", "samples 4"):
        assert words in answer.summary
    assert answer.position_deviation == pytest.approx(found.position_deviation, rel=1e-6)
    assert (answer.published, answer.next_pose.header.frame_id) == (True, "base")


def test_three_samples_do_not_verify_the_mount(stage):
    robot, tracking, *_ = samples(np.random.default_rng(3), 4)
    stage.add(robot[:3], tracking[:3])
    assert "three samples fit either mount" in stage.do("solve").summary
    stage.add(robot[3:], tracking[3:])
    assert "either mount" not in stage.do("solve").summary


def test_candidates_noise_and_outliers_are_the_callers(stage):
    robot, tracking, *_ = samples(np.random.default_rng(5), 10, camera=NOISE)
    tracking[2, :3, 3] += 0.2
    stage.add(robot, tracking)
    others, *_ = samples(np.random.default_rng(6), 30)
    answer = stage.do("solve", candidates=array_of(others, "base"), noise=[*NOISE, 0.0, 0.0])
    best = next_best_pose(hand_eye(robot, tracking, noise=[*NOISE, 0.0, 0.0]), others)
    assert np.array_equal(others[answer.next_index], best.pose)
    assert (answer.rotation_noise, answer.position_noise) == pytest.approx(NOISE)
    assert list(answer.outliers) == [2]
    kept = stage.do("solve", keep_outliers=True)
    assert (list(kept.outliers), all(kept.inlier)) == ([], True)
    assert kept.position_deviation > 3.0 * answer.position_deviation


def test_samples_are_listed_and_removed(stage):
    robot, tracking, *_ = samples(np.random.default_rng(7), 6, camera=NOISE)
    assert stage.do("list_samples").summary == "no samples"
    stage.add(robot, tracking)
    listed = stage.do("list_samples")
    assert (listed.robot.header.frame_id, listed.tracking.header.frame_id) == ("base", "camera")
    np.testing.assert_allclose(
        [matrix_from_pose(pose) for pose in listed.robot.poses], robot, atol=1e-12
    )
    assert (len(listed.tracking.poses), len(listed.inlier)) == (6, 0)
    solved = stage.do("solve")
    listed = stage.do("list_samples")
    assert list(listed.position_residuals) == list(solved.position_residuals)
    assert list(listed.rotation_residuals) == list(solved.rotation_residuals)
    assert listed.summary.splitlines()[3].startswith("3: hand at ")
    assert "off by" in listed.summary
    assert stage.do("remove_sample", index=2).count == 5
    left = stage.do("list_samples")
    np.testing.assert_allclose(matrix_from_pose(left.robot.poses[2]), robot[3], atol=1e-12)
    # What was solved is no longer of these samples.
    assert (len(left.inlier), "off by" in left.summary) == (0, False)
    assert stage.do("remove_sample", index=RemoveSample.Request.LAST).count == 4
    assert stage.do("remove_sample", index=RemoveSample.Request.ALL).count == 0


def unreadable(position=0.0, turn=1.0):
    pose = Pose()
    pose.position.x, pose.orientation.w = position, turn
    return PoseArray(poses=[pose])


def about(axis, count=6):
    """Poses of the hand turned about one axis, moved anyhow, and what the camera saw."""
    rng = np.random.default_rng(1)
    steps = np.zeros((count, 6))
    steps[:, :3] = np.outer(rng.uniform(-1.0, 1.0, count), axis)
    steps[:, 3:] = rng.uniform(-0.3, 0.3, (count, 3))
    X, Z = pose_exponential([[0.1, 0.2, 0.3, 0.0, 0.1, 0.2], [0.0, 2.0, 0.5, 0.8, 0.0, 0.1]])
    robot = pose_exponential(steps)
    return robot, inverse_pose(robot @ X) @ Z


@pytest.mark.parametrize(
    ("request_", "code", "words"),
    [
        ({"robot": unreadable(math.nan)}, 104, "robot.poses[0].position.x is nan"),
        ({"tracking": unreadable(math.inf)}, 104, "tracking.poses[0].position.x is inf"),
        ({"robot": unreadable(1e300)}, 109, "coordinate of robot.poses[0].position is 1e+300"),
        ({"robot": unreadable(turn=0.0)}, 103, "robot.poses[0].orientation: all zero"),
        ({"tracking": unreadable(turn=2.0)}, 103, "tracking.poses[0].orientation: its norm is 2"),
        ({"robot": array_of([])}, 108, "tracking.poses has size 1, expected 0"),
        ({"robot": array_of([np.eye(4)] * 21)}, 108, "robot.poses has size 21, expected at most"),
        ({"robot": array_of([np.eye(4)], "world")}, 105, "frame 'world': robot is taken in 'base'"),
        ({"tracking": array_of([np.eye(4)], "lens")}, 105, "known frames: camera"),
    ],
)  # fmt: skip
def test_samples_that_are_none_are_refused(graph, request_, code, words):
    stage = Stage(graph, max_samples=20)
    good = {"robot": array_of([np.eye(4)]), "tracking": array_of([np.eye(4)])}
    answer = stage.ask("add_samples", **{**good, **request_})
    assert (answer.error_code, answer.count) == (code, 0), answer.error_msg
    assert words in answer.error_msg
    # All or none.
    assert not stage.do("list_samples").robot.poses


def test_more_samples_than_there_is_room_for_are_refused(graph):
    stage = Stage(graph, max_samples=5)
    robot, tracking, *_ = samples(np.random.default_rng(2), 6)
    assert stage.add(robot[:4], tracking[:4]).error_code == 0
    answer = stage.add(robot[4:], tracking[4:])
    assert answer.error_code == ErrorCode.WRONG_SIZE
    assert "list of samples has size 6, expected at most 5, the parameter" in answer.error_msg


def in_two_units(robot, tracking):
    tracking[:, :3, 3] *= 1e3
    return robot, tracking


def test_a_robot_of_four_axes_gets_five_numbers_and_the_free_direction(stage):
    path = Path(__file__).resolve().parents[2] / "data" / "handeye_scara.json"
    data = json.loads(path.read_text("utf-8"))
    stage.add(np.array(data["T_base_hand"]), np.array(data["T_sensor_target"]))
    answer = stage.do("solve")
    assert answer.error_code == 0
    (free,) = answer.free_directions
    np.testing.assert_allclose([free.x, free.y, free.z], [0.0, 0.0, 1.0], atol=1e-6)
    assert answer.weak_directions[0] == free
    truth = np.array(data["true_T_hand_sensor"])
    found = matrix(answer.sensor.transform)
    np.testing.assert_allclose(found[:3, :3], truth[:3, :3], atol=1e-6)
    np.testing.assert_allclose(found[:3, 3], [*truth[:2, 3], 0.0], atol=1e-6)
    assert "not determined along 0.0000 0.0000 1.0000 of hand" in answer.summary


def eight():
    return samples(np.random.default_rng(1), 8)[:2]


REFUSED = {
    "none": (lambda: (np.zeros((0, 4, 4)),) * 2, {}, 108, "has size 0, expected 3 or more"),
    "too few": (lambda: samples(np.random.default_rng(1), 2)[:2], {}, 108, "has size 2"),
    "duplicates": (
        lambda: [poses[[0, 0, 1, 1]] for poses in samples(np.random.default_rng(1), 2)[:2]],
        {},
        108,
        "samples that differ from each other has size 2, expected 3 or more",
    ),
    "pure translations": (
        lambda: about([0.0, 0.0, 0.0]), {}, 207,
        "expected rotations about two axes that are not parallel",
    ),
    "the other mount": (
        eight, {"mount": EYE_TO_HAND}, 208,
        "mount is 'eye-to-hand', expected 'eye-in-hand', with which the samples fit",
    ),
    "inverted poses": (
        lambda: [inverse_pose(eight()[0]), eight()[1]], {}, 208,
        "if the mount is right, invert one list",
    ),
    "a sensor in mm": (
        lambda: in_two_units(*eight()), {}, 208,
        "unit of positions is 'probably m in robot_poses and mm in sensor_poses', expected m",
    ),
    "an unknown mount": (
        eight, {"mount": 7}, 109,
        "mount is 7, expected CONFIGURED (0), EYE_IN_HAND (1) or EYE_TO_HAND (2)",
    ),
    "noise of three numbers": (eight, {"noise": [1.0, 1.0, 1.0]}, 108, "noise has shape"),
    "noise that is no number": (
        eight, {"noise": [math.nan, 1.0, 1.0, 1.0]}, 104, "noise[0] is nan",
    ),
    "a candidate that is none": (
        eight, {"candidates": unreadable(turn=0.0)}, 103,
        "candidates.poses[0].orientation: all zero",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_solved_is_refused_with_the_reason(stage, case):
    make, fields, code, words = REFUSED[case]
    robot, tracking = make()
    assert stage.add(robot, tracking).error_code == 0
    answer = stage.ask("solve", **fields)
    assert answer.error_code == code, answer.error_msg
    assert words in answer.error_msg
    assert (answer.published, answer.summary) == (False, "")
    assert stage.ask("save").error_code == ErrorCode.BAD_VALUE


@pytest.mark.parametrize("index", [3, -1, -3])
def test_a_sample_that_is_not_there_is_not_removed(stage, index):
    answer = stage.ask("remove_sample", index=index)
    assert answer.error_code == ErrorCode.BAD_VALUE
    assert "there are no samples" in answer.error_msg
    robot, tracking, *_ = samples(np.random.default_rng(1), 3)
    stage.add(robot, tracking)
    if index != RemoveSample.Request.LAST:
        answer = stage.ask("remove_sample", index=index)
        assert f"index is {index}, expected 0 to 2" in answer.error_msg


def solved(stage, mount=0):
    kind = "eye-to-hand" if mount == EYE_TO_HAND else "eye-in-hand"
    robot, tracking, X, _ = samples(np.random.default_rng(9), 8, mount=kind)
    assert stage.add(robot, tracking).error_code == 0
    return stage.do("solve", mount=mount), X


def test_the_result_is_latched_on_tf_static(stage):
    answer, X = solved(stage)
    assert answer.published
    heard = stage.graph.receive(TFMessage, "/tf_static", LATCHED, lambda message: True)
    (transform,) = heard.transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("hand", "camera")
    np.testing.assert_allclose(matrix(transform.transform), X, atol=1e-9)
    # Solved again it replaces its own: that is no second parent.
    assert stage.do("solve").published


def wait_until_heard(stage, frame):
    """Wait until the node has a frame in its tree."""
    until(lambda: frame in stage.node._listener.tree)


def fixed(stage, *edges):
    publisher = stage.graph.client.create_publisher(TFMessage, "/tf_static", LATCHED)
    publisher.publish(TFMessage(transforms=list(edges)))
    return publisher


def test_the_uppermost_frame_of_a_camera_gets_the_parent(stage):
    """As drivers publish it: the frame that sees is below the camera's own."""
    inside = pose_exponential([0.3, -1.2, 0.4, 0.01, 0.02, 0.0])
    fixed(stage, stamped_transform(inside, "camera_link", "camera"))
    wait_until_heard(stage, "camera")
    answer, X = solved(stage)
    assert answer.published, answer.summary
    heard = stage.graph.receive(
        TFMessage, "/tf_static", LATCHED, lambda m: m.transforms[0].child_frame_id != "camera"
    )
    (transform,) = heard.transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("hand", "camera_link")
    np.testing.assert_allclose(matrix(transform.transform) @ inside, X, atol=1e-9)
    assert matrix(answer.sensor.transform) == pytest.approx(X, abs=1e-9)


def test_a_camera_that_others_have_placed_is_left_there(stage):
    edge = TransformStamped(child_frame_id="camera")
    edge.header.frame_id = "hand"
    fixed(stage, edge)
    wait_until_heard(stage, "camera")
    answer, _ = solved(stage)
    assert not answer.published
    assert "not on /tf_static: tf has the sensor's frame 'camera' below 'hand'" in answer.summary


def test_files_are_ours_and_easy_handeye2s(stage, tmp_path):
    answer, X = solved(stage, EYE_TO_HAND)
    files = stage.do("save", name="cell_1").files
    folder = tmp_path / "calibrations"
    assert files == [str(folder / f"cell_1.{end}") for end in ("yaml", "calib", "samples")]
    ours, calib, listed = (
        yaml.safe_load((folder / f"cell_1.{end}").read_text())
        for end in ("yaml", "calib", "samples")
    )
    assert (ours["calibration_type"], ours["sensor"]["parent"]) == ("eye_on_base", "base")
    np.testing.assert_allclose(
        pose_from_position_quaternion(ours["sensor"]["position"], ours["sensor"]["quaternion"]),
        X,
        atol=1e-9,
    )
    np.testing.assert_allclose(np.ravel(ours["covariance_x_y_z_rx_ry_rz"]), answer.covariance)
    assert [row["inlier"] for row in ours["samples"]] == [True] * 8
    # The fields of easy_handeye2's messages and no others: it refuses a file with more.
    parameters = {
        "name": "cell_1",
        "calibration_type": "eye_on_base",
        **FRAMES,
        "freehand_robot_movement": True,
        "move_group_namespace": "/",
        "move_group": "manipulator",
    }
    assert calib["parameters"] == listed["parameters"] == parameters
    assert (set(calib), set(listed)) == ({"parameters", "transform"}, {"parameters", "samples"})
    rotation = calib["transform"]["rotation"]
    message = answer.sensor.transform
    assert {axis: getattr(message.rotation, axis) for axis in "xyzw"} == rotation
    robot, *_ = samples(np.random.default_rng(9), 8, mount="eye-to-hand")
    first = listed["samples"][0]["robot"]["translation"]
    # Where the sensor stands, easy_handeye2's robot is the base in the hand.
    np.testing.assert_allclose([first[k] for k in "xyz"], inverse_pose(robot[0])[:3, 3], atol=1e-12)
    # Again under the configured name, and over what is there.
    assert stage.do("save").files[0].endswith("/calibration.yaml")
    assert stage.do("save").files[0].endswith("/calibration.yaml")
    assert len(list(folder.iterdir())) == 6


@pytest.mark.parametrize("name", ["../out", "/tmp/out", ".hidden", "a b", "a/b", "x" * 101])
def test_a_name_that_leaves_the_folder_is_refused(stage, tmp_path, name):
    solved(stage)
    answer = stage.ask("save", name=name)
    assert answer.error_code == ErrorCode.BAD_VALUE
    assert "a plain name" in answer.error_msg
    assert not (tmp_path / "calibrations").exists()


def test_what_is_no_regular_file_is_not_replaced(stage, tmp_path):
    solved(stage)
    folder = tmp_path / "calibrations"
    folder.mkdir()
    elsewhere = tmp_path / "elsewhere"
    elsewhere.write_text("mine")
    (folder / "linked.calib").symlink_to(elsewhere)
    (folder / "taken.yaml").mkdir()
    for name in ("linked", "taken"):
        answer = stage.ask("save", name=name)
        assert (answer.error_code, "a regular file" in answer.error_msg) == (109, True)
    assert elsewhere.read_text() == "mine"
    assert {path.name for path in folder.iterdir()} == {"linked.calib", "taken.yaml"}


def test_a_link_in_the_place_of_an_unfinished_file_is_not_followed(stage, tmp_path):
    solved(stage)
    folder = tmp_path / "calibrations"
    folder.mkdir()
    elsewhere = tmp_path / "elsewhere"
    elsewhere.write_text("mine")
    (folder / f".wrist.yaml.{os.getpid()}.part").symlink_to(elsewhere)
    assert stage.ask("save", name="wrist").error_code == 0
    assert elsewhere.read_text() == "mine"
    assert (folder / "wrist.yaml").is_file() and not (folder / "wrist.yaml").is_symlink()


def test_what_was_saved_is_on_tf_from_the_start(stage, graph, tmp_path):
    inside = pose_exponential([0.3, -1.2, 0.4, 0.01, 0.02, 0.0])
    fixed(stage, stamped_transform(inside, "camera_link", "camera"))
    wait_until_heard(stage, "camera")
    _, X = solved(stage)
    stage.do("save", name="wrist")
    folder = str(tmp_path / "calibrations")
    graph.start(CalibrationNode, namespace="later", **FRAMES, folder=folder, saved="wrist")
    told = []
    stage.graph.client.create_subscription(
        TFMessage, "/tf_static", lambda m: told.extend(m.transforms), LATCHED
    )
    # Each of the two nodes says it, and the driver its own.
    until(lambda: len(told) >= 3)
    edges = [edge for edge in told if edge.header.frame_id == "hand"]
    assert [edge.child_frame_id for edge in edges] == ["camera_link"] * 2
    for edge in edges:
        np.testing.assert_allclose(matrix(edge.transform) @ inside, X, atol=1e-9)


TOLD = f"{{format: '{FORMAT}', tf: {{parent: a, frame: %s, position: [0, 0, 0]%s}}}}"
# 30 mappings, each of which merges the last one three times: 3^29 entries.
BOMB = "m0: &m0 {x: 1}\n" + "".join(
    f"m{k}: &m{k} {{<<: [*m{k - 1}, *m{k - 1}, *m{k - 1}]}}\n" for k in range(1, 30)
)
DAMAGED = {
    "nothing": (None, "No such file or directory"),
    "another format": ("{format: 7}", "no file of the format"),
    "no mapping": ("[1, 2]", "no file of the format"),
    "no YAML": ("{", "while parsing"),
    "merge keys": (BOMB, "aliases .* are not allowed"),
    "not told": (f"{{format: '{FORMAT}', tf: null}}", "tf was not told of it"),
    "no frames": (TOLD % ("''", ""), "frames without names"),
    "no turn": (TOLD % ("b", ""), "'quaternion'"),
    "no rotation": (TOLD % ("b", ", quaternion: [0, 0, 0, 0]"), "quaternion"),
}  # fmt: skip


@pytest.mark.parametrize("case", DAMAGED)
def test_a_node_does_not_start_with_a_file_that_cannot_be_used(graph, tmp_path, case):
    text, words = DAMAGED[case]
    if text is not None:
        (tmp_path / "wrist.yaml").write_text(text)
    expected = f"the parameter saved is 'wrist', expected the name of .*{words}"
    with pytest.raises(BadValueError, match=expected):
        graph.start(CalibrationNode, **FRAMES, folder=str(tmp_path), saved="wrist")


@pytest.mark.parametrize(
    ("folder", "words"),
    [("", "the parameter folder is ''"), ("/proc/nowhere", "one that files can be written in")],
)
def test_a_folder_that_cannot_be_written_is_named(graph, folder, words):
    stage = Stage(graph, folder=folder)
    solved(stage)
    answer = stage.ask("save")
    assert (answer.error_code, words in answer.error_msg) == (109, True)


def test_frames_come_from_the_robot_where_none_are_given(graph):
    empty = dict.fromkeys(FRAMES, "")
    stage = Stage(graph, **{**empty, "robot_description": "puma560", "frame_prefix": "left/"})
    assert stage.graph.ask(Trigger, "calibration/ready").success
    listed = stage.do("list_samples")
    assert listed.robot.header.frame_id == "left/base_link"
    robot, tracking, *_ = samples(np.random.default_rng(9), 8)
    stage.add(robot, tracking)
    answer = stage.do("solve")
    assert (answer.sensor.header.frame_id, answer.published) == ("left/tool0", False)
    assert "the parameter tracking_base_frame" in answer.summary
    taken = stage.ask("take_sample")
    assert (taken.error_code, "tracking_base_frame is ''" in taken.error_msg) == (109, True)


def test_samples_and_their_result_are_seen_by_viewers(stage):
    heard = []
    stage.graph.client.create_subscription(
        MarkerArray, "calibration/markers", heard.append, LATCHED
    )
    robot, tracking, _, _ = samples(np.random.default_rng(3), 8, camera=NOISE)
    tracking[2] = tracking[2] @ pose_exponential([0.5, 0.0, 0.3, 0.2, 0.1, 0.0])
    stage.add(robot, tracking)
    until(lambda: heard and len(heard[-1].markers) > 8)
    balls = {one.ns: one for one in heard[-1].markers if one.type == Marker.SPHERE}
    assert set(balls) == {f"sample_{k}" for k in range(8)}
    stage.do("solve")
    found = hand_eye(robot, tracking)
    until(lambda: "uncertainty" in {one.ns for one in heard[-1].markers})
    drawn = {one.ns: one for one in heard[-1].markers}
    assert heard[-1].markers[0].action == Marker.DELETEALL
    assert drawn["uncertainty"].header.frame_id == "hand"
    np.testing.assert_allclose(
        matrix_from_pose(drawn["uncertainty"].pose)[:3, 3], found.sensor[:3, 3], atol=1e-9
    )
    assert drawn["left_out_2"].text == "2: left out"
    assert drawn["sample_2"].color.r > 3 * drawn["sample_2"].color.g
    stage.do("remove_sample", index=RemoveSample.Request.ALL)
    until(lambda: len(heard[-1].markers) == 1)
