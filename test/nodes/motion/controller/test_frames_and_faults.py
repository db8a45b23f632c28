"""The frames that the simulated controller publishes, and the faults that it simulates."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from drivers import NAME
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

from robomech_interfaces.msg import ErrorCode
from robomech_ros.errors import RobomechError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinematics.joint_poses import JointPoses
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.robots import Joint, load_robot
from robomech_ros.spatial import matrix_from_axis_angle, matrix_from_quaternion, pose_from_matrix

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
MOVE = np.array([0.1, -0.05, 0.08, 0.0, 0.1, -0.1])
# Of the definitions that the real packages have; that of the action in Jazzy and Kilted.
HASHES = {
    "control_msgs/msg/JointTrajectoryControllerState": {
        "RIHS01_51d8dd89cc624cbe9daaeeb4d80d6de9b86168ffdc3be41fefc0953e3c26e480"
    },
    "control_msgs/srv/QueryTrajectoryState": {
        "RIHS01_4a0935dffef18bc5b9e101c9d03d84e681ecd4cebd724b8f11fde008751a325a"
    },
    "control_msgs/action/FollowJointTrajectory": {
        "RIHS01_738ebcb7a2d7cfa42f9f1001cc99ce3a4383d1cfe508015d9be8485e4b1c66f6",
        "RIHS01_ff29901b2693f5deb847e96084a1c2cdb26e70b7c847be21859b70a55fb29cf0",
    },
    "control_msgs/msg/SpeedScalingFactor": {
        "RIHS01_0c240f349f2b74e33e8741f83e0f196ddeb6585923663876ed3c1f51f0566037"
    },
    "control_msgs/action/GripperCommand": {
        "RIHS01_e17c0e644eccf14bea84a0a93e0977182872c2eb7873ca6694900059b46dbc84"
    },
    "control_msgs/action/ParallelGripperCommand": {
        "RIHS01_adfd3c1ebe8abc38ebcc0e454b6423d291d4010dd5697d14eca5b9be4726ae18"
    },
    "tf2_msgs/msg/TFMessage": {
        "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
    },
}


@pytest.mark.parametrize("name", HASHES)
def test_the_types_are_those_of_the_real_packages(name):
    place = Path(sys.prefix, "share", f"{name}.json")
    hashes = json.loads(place.read_text(encoding="utf-8"))["type_hashes"]
    assert {entry["type_name"]: entry["hash_string"] for entry in hashes}[name] in HASHES[name]


def transform(entry):
    pose = np.eye(4)
    place, turn = entry.transform.translation, entry.transform.rotation
    pose[:3, 3] = place.x, place.y, place.z
    pose[:3, :3] = matrix_from_quaternion([turn.x, turn.y, turn.z, turn.w])
    return pose


@pytest.mark.parametrize("robot", ["ur5e", "puma560"])
def test_frames_lead_to_the_tip(drive, robot):
    arm = drive(robot_description=robot)
    chain = load_robot(robot)
    goal = arm.position + MOVE
    assert arm.execute(arm.trajectory((0.3, MOVE)))[0] == GoalStatus.STATUS_SUCCEEDED
    arm.until_at(goal)
    fixed = arm.graph.receive(TFMessage, "/tf_static", LATCHED, lambda message: True)
    moving = arm.graph.receive(TFMessage, "/tf", 100, lambda message: True)
    frames = {entry.child_frame_id: entry for entry in [*fixed.transforms, *moving.transforms]}
    assert len(moving.transforms) == chain.n
    pose, link = np.eye(4), chain.tip
    while link != chain.base:
        pose = transform(frames[link]) @ pose
        link = frames[link].header.frame_id
    np.testing.assert_allclose(pose, forward_kinematics(chain, goal), atol=1e-12)
    stamp = moving.transforms[0].header.stamp
    assert 0 <= arm.graph.client.get_clock().now().nanoseconds / 1e9 - stamp.sec < 60.0


def test_poses_of_many_joints_at_once():
    random = np.random.default_rng(5)

    def pose():
        turn = matrix_from_axis_angle(random.standard_normal(3), random.uniform(-np.pi, np.pi))
        return pose_from_matrix(turn, random.standard_normal(3))

    def joint(kind):
        axis = random.standard_normal(3)
        axis /= np.linalg.norm(axis)
        return Joint("j", kind, "a", "b", origin=pose(), axis=axis, after=pose())

    kinds = [*("revolute", "prismatic", "continuous", "fixed") * 20]
    joints = [joint(kind) for kind in kinds]
    positions = random.uniform(-7.0, 7.0, len(joints))
    places, turns = JointPoses(joints).at(positions)
    wanted = np.array([joint.pose(at) for joint, at in zip(joints, positions, strict=True)])
    fixed = np.array(kinds) == "fixed"
    wanted[fixed] = [joint.pose(0.0) for joint in np.array(joints)[fixed]]
    np.testing.assert_allclose(places, wanted[:, :3, 3], atol=1e-13)
    np.testing.assert_allclose(matrix_from_quaternion(turns), wanted[:, :3, :3], atol=1e-13)


def test_no_frames_unless_wanted(graph):
    given = {"robot_description": "puma560", "publish_frames": "never"}
    node = graph.start(JointTrajectoryControllerNode, **given)
    assert {topic for topic, _ in node.get_topic_names_and_types()}.isdisjoint(
        {"/tf", "/tf_static"}
    )


def set_parameter(arm, name, **value):
    kinds = {"string_value": ParameterType.PARAMETER_STRING, "double_value": 3}
    (field,) = value
    change = Parameter(name=name, value=ParameterValue(type=kinds[field], **value))
    request = SetParameters.Request(parameters=[change])
    return arm.graph.call(SetParameters, f"{NAME}/set_parameters", request).results[0]


@pytest.mark.slow
def test_a_joint_gets_stuck_while_it_moves(drive):
    arm = drive(path_tolerance=0.05)
    start = arm.position
    handle = arm.send(arm.trajectory((8.0, 10 * MOVE)))
    arm.until_moving()
    assert set_parameter(arm, "fault_stuck_joints", string_value="waist, elbow").successful
    status, result = arm.result(handle)
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, ErrorCode.PATH_TOLERANCE)
    assert "joint 'waist' is 0.05" in result.error_msg
    arm.until(lambda: not arm.velocity.any())
    assert set_parameter(arm, "fault_stuck_joints", string_value="").successful
    assert arm.execute(arm.trajectory((2.0, 0.0), start=arm.position))[0] == 4
    assert np.abs(arm.position - start).max() > 0.05


def test_faults_that_cannot_be(graph, drive):
    for parameters, text in (
        ({"fault_stuck_joints": "waste"}, "'fault_stuck_joints' is 'waste'; .* waist, shoulder"),
        ({"fault_offset": [0.1]}, "'fault_offset' .* a list of 6 numbers"),
        ({"fault_dropped_commands": 1.5}, "'fault_dropped_commands' is 1.5"),
    ):
        with pytest.raises(RobomechError, match=text):
            graph.start(JointTrajectoryControllerNode, robot_description="puma560", **parameters)
    arm = drive()
    answer = set_parameter(arm, "fault_stuck_joints", string_value="waste")
    assert not answer.successful
    assert "names with commas between, of waist" in answer.reason
    assert arm.execute(arm.trajectory((0.3, MOVE)))[0] == GoalStatus.STATUS_SUCCEEDED


def test_parameters_are_checked_while_the_robot_moves(drive):
    arm = drive()
    handle = arm.send(arm.trajectory((1.0, MOVE)))
    arm.until_moving()
    for name, value, reason in (
        ("publish_rate", 500.0, "Trying to set a read-only parameter: publish_rate"),
        ("fault_delay", np.nan, "out of range"),
        ("fault_delay", 11.0, "out of range"),
        ("fault_noise", -1.0, "out of range"),
    ):
        answer = set_parameter(arm, name, double_value=value)
        assert not answer.successful
        assert reason in answer.reason
    assert arm.result(handle)[0] == GoalStatus.STATUS_SUCCEEDED
    assert np.abs(np.diff([state.position for state in arm.states], axis=0)).max() < 0.02


def test_noise_and_offset_are_published(drive):
    arm = drive(fault_noise=1e-4, fault_offset=[0.01, 0.0, 0.0, 0.0, 0.0, 0.0], fault_seed=1)
    arm.until(lambda: len(arm.states) > 100)
    seen = np.array([state.position for state in arm.states]) - arm.chain.home()
    assert seen.mean(axis=0)[0] == pytest.approx(0.01, abs=1e-4)
    assert seen.std(axis=0) == pytest.approx(np.full(6, 1e-4), rel=0.5)
