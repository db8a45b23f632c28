"""Samples from tf and from topics, while the robot stands; and why there is none."""

import time

import numpy as np
import pytest
from builtin_interfaces.msg import Duration, Time
from camera_stage import FRAMES, NANO, Stage
from geometry_msgs.msg import PoseStamped
from hand_eye_cells import samples
from waiting import hide_package

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import TakeSample
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.spatial import pose_exponential

TOPICS = {"robot_topic": "hand_pose", "tracking_topic": "marker_pose"}
PATIENT = Duration(sec=25)
SHORT = Duration(nanosec=NANO // 2)
SOURCES = pytest.mark.parametrize(
    "topics", [{}, TOPICS, {"tracking_topic": "marker_pose"}], ids=["tf", "topics", "both"]
)


@SOURCES
def test_samples_are_what_the_sources_say_and_lead_to_the_sensor(graph, topics):
    stage = Stage(graph, **topics)
    robot, tracking, X, _ = samples(np.random.default_rng(4), 5)
    for k, (hand, marker) in enumerate(zip(robot, tracking, strict=True)):
        stage.put(hand, marker)
        taken = stage.do("take_sample", timeout=PATIENT)
        assert (taken.index, taken.count) == (k, k + 1)
        assert taken.robot.header.frame_id == "base"
        assert taken.tracking.header.frame_id == "camera"
        # Asked for in the moment of the jump it waits until the hand stands where it is now.
        np.testing.assert_allclose(matrix_from_pose(taken.robot.pose), hand, atol=1e-9)
        np.testing.assert_allclose(matrix_from_pose(taken.tracking.pose), marker, atol=1e-9)
    answer = stage.do("solve")
    place = answer.sensor.transform.translation
    np.testing.assert_allclose([place.x, place.y, place.z], X[:3, 3], atol=1e-9)
    assert answer.sensor.child_frame_id == "camera"


def test_the_sensors_frame_is_that_of_the_topic_where_none_is_given(graph):
    stage = Stage(graph, tracking_base_frame="", **TOPICS)
    assert stage.do("take_sample", timeout=PATIENT).tracking.header.frame_id == "camera"


@SOURCES
def test_a_robot_that_moves_is_refused_with_how_far(graph, topics):
    stage = Stage(graph, **topics)
    stage.do("take_sample", timeout=PATIENT)
    stage.drift = np.array([0.0, 0.0, 0.0, 0.02, 0.0, 0.0])
    answer = stage.until("the robot moves: its hand moved 0.", timeout=SHORT)
    assert answer.error_code == ErrorCode.NO_STATE
    assert "at rest is up to 0.0005 m and 0.002 rad" in answer.error_msg
    # It waits for the robot to stand.
    asked = stage.graph.start_call(
        TakeSample, "calibration/take_sample", TakeSample.Request(timeout=PATIENT)
    )
    time.sleep(0.2)
    assert not asked.done()
    stage.drift = np.zeros(6)
    taken = stage.graph.wait_for(asked)
    assert taken.error_code == 0, taken.error_msg
    np.testing.assert_allclose(matrix_from_pose(taken.robot.pose), stage.hand, atol=1e-12)


def test_a_hand_that_turns_in_place_moves(stage):
    stage.do("take_sample", timeout=PATIENT)
    stage.drift = np.array([0.0, 0.0, 0.02, 0.0, 0.0, 0.0])
    answer = stage.until("moved 0 m and turned 0.", timeout=SHORT)
    assert answer.error_code == ErrorCode.NO_STATE


@SOURCES
def test_a_target_that_is_no_longer_seen_is_stale(graph, topics):
    stage = Stage(graph, **topics)
    stage.do("take_sample", timeout=PATIENT)
    stage.put(np.eye(4), None)
    answer = stage.ask("take_sample", timeout=SHORT)
    assert answer.error_code == ErrorCode.FRAME_UNAVAILABLE
    what = "pose on '/marker_pose'" if topics else "frame 'marker' in 'camera'"
    assert answer.error_msg.startswith(f"{what}: the last is from ")
    assert "before the time of the request; does the sensor see the target?" in answer.error_msg


def test_a_robot_that_is_no_longer_heard_is_stale(stage):
    stage.do("take_sample", timeout=PATIENT)
    stage.put(None, np.eye(4))
    answer = stage.ask("take_sample", timeout=SHORT)
    assert answer.error_code == ErrorCode.FRAME_UNAVAILABLE
    assert answer.error_msg.startswith("frame 'hand' in 'base': the last is from ")
    assert "before the time of the target's; do two clocks differ?" in answer.error_msg


def test_stamps_far_in_the_past_are_stale(stage):
    stage.late = 500 * NANO
    answer = stage.until("frame 'marker' in 'camera': the last is from 500 s before", timeout=SHORT)
    assert answer.error_code == ErrorCode.FRAME_UNAVAILABLE


@pytest.mark.parametrize(
    ("frame", "words"),
    [
        ("robot_base_frame", "frame 'hand' in 'moon': tf has no frame 'moon'"),
        ("robot_effector_frame", "frame 'moon' in 'base': tf has no frame 'moon'"),
        ("tracking_base_frame", "frame 'marker' in 'moon': tf has no frame 'moon'"),
        ("tracking_marker_frame", "frame 'moon' in 'camera': tf has no frame 'moon'"),
    ],
)
def test_frames_that_tf_does_not_have_are_named_with_those_it_has(graph, frame, words):
    stage = Stage(graph, **{frame: "moon"})
    known = "on '/tf' and '/tf_static'; known frames: base, camera, hand, marker"
    answer = stage.until(known, timeout=SHORT)
    assert (answer.error_code, words in answer.error_msg) == (ErrorCode.FRAME_UNAVAILABLE, True)


def test_frames_of_two_trees_are_told(graph):
    stage = Stage(graph, tracking_base_frame="base")
    words = "tf has two trees that are not connected: 'marker' hangs on 'camera'"
    assert stage.until(words, timeout=SHORT).error_code == ErrorCode.FRAME_UNAVAILABLE


BAD_POSES = {
    "no stamp": ({"stamp": False}, "its stamp is 0"),
    "another frame": ({"frame": "lens"}, "its frame is 'lens', expected 'camera'"),
    "not a number": ({"x": float("nan")}, "a number that is not finite"),
    "a bad quaternion": ({"w": 3.0}, "its quaternion has norm 3, expected 1"),
}


@pytest.mark.parametrize("case", BAD_POSES)
def test_poses_of_a_topic_that_cannot_be_used_are_told(graph, case):
    fields, words = BAD_POSES[case]
    stage = Stage(graph, tracking_topic="poses_of_others")
    stage.marker = None
    sender = stage.graph.client.create_publisher(PoseStamped, "poses_of_others", 10)

    def send():
        message = PoseStamped()
        message.header.frame_id = fields.get("frame", "camera")
        now = stage.graph.client.get_clock().now().to_msg()
        message.header.stamp = now if fields.get("stamp", True) else Time()
        message.pose.position.x = fields.get("x", 0.0)
        message.pose.orientation.w = fields.get("w", 1.0)
        sender.publish(message)

    stage.graph.client.create_timer(0.02, send)
    answer = stage.ask("take_sample", timeout=Duration(sec=2))
    assert answer.error_code == ErrorCode.FRAME_UNAVAILABLE
    assert "pose on '/poses_of_others': nothing received; rejected messages: " in answer.error_msg
    assert words in answer.error_msg


def test_nothing_is_heard_at_all(graph):
    stage = Stage(graph, **TOPICS, sample_timeout=0.1)
    stage.hand = stage.marker = None
    answer = stage.ask("take_sample")
    assert answer.error_code == ErrorCode.FRAME_UNAVAILABLE
    assert answer.error_msg == "pose on '/marker_pose': nothing received"
    answer = stage.ask("take_sample", timeout=Duration(sec=-1))
    assert (answer.error_code, "timeout is -1" in answer.error_msg) == (109, True)
    answer = stage.ask("take_sample", timeout=Duration(sec=61))
    assert (answer.error_code, answer.error_msg) == (109, "timeout is 61.0, expected at most 60 s")


def test_others_are_served_while_a_sample_is_waited_for(stage):
    stage.put(None, None)
    asked = stage.graph.start_call(
        TakeSample, "calibration/take_sample", TakeSample.Request(timeout=PATIENT)
    )
    assert stage.do("list_samples").summary == "no samples"
    assert not asked.done()
    stage.put(np.eye(4), np.eye(4))
    assert stage.graph.wait_for(asked).error_code == 0


def test_what_never_moves_is_always_up_to_date(graph):
    """A calibration bench: the hand is fixed to the base by /tf_static."""
    from test_calibration_node import fixed

    from robomech_ros.nodes.common.messages.pose_messages import stamped_transform

    stage = Stage(graph)
    stage.hand = None
    T = pose_exponential([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    fixed(stage, stamped_transform(T, "base", "hand"))
    taken = stage.do("take_sample", timeout=PATIENT)
    np.testing.assert_allclose(matrix_from_pose(taken.robot.pose), T, atol=1e-12)


def test_names_with_a_slash_are_those_of_tf(graph):
    stage = Stage(graph, **{name: f"/{frame}" for name, frame in FRAMES.items()})
    assert stage.do("take_sample", timeout=PATIENT).robot.header.frame_id == "base"


def test_without_tf2_msgs_topics_are_enough(graph, monkeypatch):
    hide_package(monkeypatch, "tf2_msgs")
    stage = Stage(graph, **TOPICS)
    robot, tracking, *_ = samples(np.random.default_rng(4), 3)
    assert stage.add(robot, tracking).error_code == 0
    assert stage.do("take_sample", timeout=PATIENT).count == 4
    stage.do("remove_sample", index=3)
    answer = stage.do("solve")
    assert not answer.published
    assert (
        "not on /tf_static: frames of tf are not received: the package tf2_msgs is not"
        in answer.summary
    )


def test_without_tf2_msgs_tf_is_refused(graph, monkeypatch):
    hide_package(monkeypatch, "tf2_msgs")
    answer = Stage(graph).ask("take_sample", timeout=SHORT)
    assert answer.error_code == ErrorCode.FRAME_UNAVAILABLE
    assert "the package tf2_msgs is not installed" in answer.error_msg
