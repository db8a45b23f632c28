"""Frames with a prefix, so that several robots share one tf: in all answers, and in requests."""

import numpy as np
import pytest
from geometry_msgs.msg import Inertia, InertiaStamped, TwistStamped, Vector3, WrenchStamped
from moveit_msgs.srv import GetCartesianPath, GetPositionFK
from nav_msgs.msg import Path
from trajectory_msgs.msg import JointTrajectoryPoint
from visualization_msgs.msg import MarkerArray

from robomech_interfaces.msg import ErrorCode, ServoStatus
from robomech_interfaces.srv import (
    AnalyzeSingularity,
    InverseDynamics,
    PlanCartesian,
    SetPayload,
    SolveFK,
    SolveIK,
)
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, stamped_pose
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.common.robot.robot_description import LATCHED, RobotModel, RobotSettings
from robomech_ros.nodes.dynamics.node import DynamicsNode
from robomech_ros.nodes.joint_trajectory_controller.node import JointTrajectoryControllerNode
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.move_group.node import MoveGroupNode
from robomech_ros.nodes.servo.node import ServoNode
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.robots import load_description, load_robot

UR5E = load_robot("ur5e")
Q = np.array([0.3, -1.0, 1.2, 0.4, 0.9, -0.5])
TIP = forward_kinematics(UR5E, Q)
BASE = f"left/{UR5E.base}"
STATE = joint_state(UR5E.joint_names, Q)


@pytest.fixture
def left(graph):
    """Start a node of the left one of two robots, in its namespace."""

    def start(node, **parameters):
        given = {"robot_description": "ur5e", "frame_prefix": "left/", **parameters}
        return graph.start(node, namespace="left", **given)

    return start


def test_a_prefix_is_put_in_front_and_taken_off():
    model = RobotModel(load_description("ur5e"), RobotSettings(frame_prefix="left/"))
    assert (model.base_frame, model.frame_of("tool0")) == (BASE, "left/tool0")
    assert (model.link_of("left/tool0"), model.link_of("tool0")) == ("tool0", "tool0")
    for other in ("right/tool0", "world", "left/", ""):
        assert model.link_of(other) == other
    assert (model.full_frame(""), model.full_frame("tool0")) == (BASE, "left/tool0")
    assert (model.full_frame("left/tool0"), model.full_frame("world")) == ("left/tool0", "world")
    assert model.chain_to("left/wrist_1_link") is model.chain_to("wrist_1_link")
    with pytest.raises(ParameterError, match="'frame_prefix' is '/left/'; allowed is a text"):
        RobotModel(load_description("ur5e"), RobotSettings(frame_prefix="/left/"))


def test_a_link_that_itself_begins_with_the_prefix_keeps_its_name():
    text = """<robot name="r"><link name="left_a"/><link name="left_left_a"/><link name="b"/>
      <joint name="j" type="continuous"><parent link="left_a"/><child link="left_left_a"/></joint>
      <joint name="k" type="continuous"><parent link="left_left_a"/><child link="b"/></joint>
    </robot>"""
    model = RobotModel(load_description(text), RobotSettings(frame_prefix="left_"))
    assert (model.link_of("left_a"), model.link_of("left_left_a")) == ("left_a", "left_left_a")
    assert model.link_of("left_b") == "b"


def test_the_kinematics_node_answers_in_frames_with_the_prefix(left, graph):
    left(KinematicsNode)
    request = SolveFK.Request(states=[STATE], links=["", "left/forearm_link", "forearm_link"])
    poses = graph.call(SolveFK, "left/kinematics/solve_fk", request).poses
    assert [pose.header.frame_id for pose in poses] == [BASE] * 3
    assert poses[1] == poses[2]
    for frame, link in ((BASE, "tool0"), (UR5E.base, "left/tool0"), ("left/base", "")):
        in_frame = TIP if "/base_link" in f"/{frame}" else np.diag([-1.0, -1.0, 1.0, 1.0]) @ TIP
        request = SolveIK.Request(target=stamped_pose(in_frame, frame), tip_link=link, seed=STATE)
        answer = graph.call(SolveIK, "left/kinematics/solve_ik", request)
        assert answer.error_code == 0, answer.error_msg
        np.testing.assert_allclose(answer.solutions[0].positions, Q, atol=1e-9)
    request = SolveIK.Request(target=stamped_pose(TIP, "right/base_link"))
    answer = graph.call(SolveIK, "left/kinematics/solve_ik", request)
    assert answer.error_code == ErrorCode.FRAME_UNAVAILABLE
    assert "'right/base_link'" in answer.error_msg and BASE in answer.error_msg


def test_directions_and_markers_are_in_frames_with_the_prefix(left, graph):
    left(KinematicsNode)
    stretched = joint_state(UR5E.joint_names, np.array([0.3, -1.0, 0.0, 0.4, 0.9, -0.5]))
    for asked, named in (("", BASE), ("tool0", "left/tool0"), ("left/tool0", "left/tool0")):
        request = AnalyzeSingularity.Request(state=stretched, reference_frame=asked)
        answer = graph.call(AnalyzeSingularity, "left/kinematics/analyze_singularity", request)
        assert answer.error_code == 0, answer.error_msg
        assert {twist.header.frame_id for twist in answer.lost_directions} == {named}
    shown = graph.receive(MarkerArray, "left/kinematics/markers", LATCHED, lambda m: m.markers)
    assert {marker.header.frame_id for marker in shown.markers} == {BASE}


def test_moveit_services_answer_in_frames_with_the_prefix(left, graph):
    left(MoveGroupNode)
    request = GetPositionFK.Request(fk_link_names=["left/tool0", "tool0"])
    request.robot_state.joint_state = STATE
    for frame in ("", BASE, UR5E.base):
        request.header.frame_id = frame
        answer = graph.call(GetPositionFK, "left/compute_fk", request)
        assert answer.error_code.val == 1, answer.error_code.message
        assert [pose.header.frame_id for pose in answer.pose_stamped] == [BASE] * 2
        assert answer.pose_stamped[0].pose == answer.pose_stamped[1].pose
        np.testing.assert_allclose(matrix_from_pose(answer.pose_stamped[0].pose), TIP, atol=1e-12)
    # In the frame of the moving link each waypoint counts from the last, also with a prefix.
    request = GetCartesianPath.Request(max_step=0.01, link_name="left/tool0")
    request.start_state.joint_state = STATE
    ahead = np.eye(4)
    ahead[2, 3] = 0.02
    request.waypoints = [stamped_pose(ahead, "").pose] * 2
    request.header.frame_id = "left/tool0"
    answer = graph.call(GetCartesianPath, "left/compute_cartesian_path", request)
    assert answer.fraction == 1.0, answer.error_code.message
    path = answer.solution.joint_trajectory
    assert path.header.frame_id == BASE
    reached = forward_kinematics(UR5E, np.array(path.points[-1].positions))
    np.testing.assert_allclose(reached[:3, 3], TIP[:3, 3] + 0.04 * TIP[:3, 2], atol=1e-6)


def test_plans_take_and_show_frames_with_the_prefix(left, graph):
    left(TrajectoryPlannerNode)
    pose = TIP.copy()
    pose[2, 3] -= 0.05
    request = PlanCartesian.Request(start=STATE, waypoints=[stamped_pose(pose, BASE)])
    answer = graph.call(PlanCartesian, "left/trajectory_planner/plan_cartesian", request)
    assert answer.error_code == 0, answer.error_msg
    path = graph.receive(Path, "left/trajectory_planner/planned_path", LATCHED, lambda m: True)
    assert {pose.header.frame_id for pose in path.poses} | {path.header.frame_id} == {BASE}


def test_wrenches_and_loads_take_frames_with_the_prefix(left, graph):
    left(DynamicsNode)
    efforts = []
    for frame in ("tool0", "left/tool0"):
        wrench = WrenchStamped()
        wrench.header.frame_id = frame
        wrench.wrench.force = Vector3(x=3.0)
        points = [JointTrajectoryPoint(positions=Q)]
        request = InverseDynamics.Request(joint_names=STATE.name, tip_wrench=wrench, points=points)
        answer = graph.call(InverseDynamics, "left/dynamics/inverse_dynamics", request)
        assert answer.error_code == 0, answer.error_msg
        efforts.append(list(answer.effort))
        load = InertiaStamped(inertia=Inertia(m=1.0, ixx=0.1, iyy=0.1, izz=0.1))
        load.header.frame_id = frame
        assert graph.ask(SetPayload, "left/dynamics/set_payload", payload=load).error_code == 0
        assert graph.ask(SetPayload, "left/dynamics/set_payload").error_code == 0
    assert efforts[0] == efforts[1]


def test_the_servo_takes_frames_with_the_prefix(left, graph):
    left(JointTrajectoryControllerNode, initial_positions=[*Q])
    left(ServoNode)
    publisher = graph.client.create_publisher(TwistStamped, "left/servo/delta_twist_cmds", 10)
    codes = {}
    for frame in ("left/tool0", "right/tool0"):
        message = TwistStamped()
        message.header.frame_id = frame
        message.twist.linear.z = 0.02
        timer = graph.client.create_timer(0.02, lambda message=message: publisher.publish(message))
        wanted = {ServoStatus.NO_WARNING} if frame.startswith("left") else {ServoStatus.INVALID}
        codes[frame] = graph.receive(
            ServoStatus, "left/servo/status", 10, lambda m, wanted=wanted: m.code in wanted
        )
        graph.client.destroy_timer(timer)
    assert "'right/tool0'" in codes["right/tool0"].message
