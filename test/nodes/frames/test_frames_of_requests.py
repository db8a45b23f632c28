"""Requests in frames above the base, on the arm and in other trees, over real tf messages."""

import threading
import time

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped, WrenchStamped
from moveit_msgs.msg import (
    BoundingVolume,
    Constraints,
    MoveItErrorCodes,
    PositionConstraint,
    PositionIKRequest,
)
from moveit_msgs.srv import GetCartesianPath, GetPositionFK, GetPositionIK
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from shape_msgs.msg import SolidPrimitive
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage
from trajectory_msgs.msg import JointTrajectoryPoint
from waiting import hide_package, until

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import (
    GetJacobian,
    InverseDynamics,
    PlanCartesian,
    QueryWorkspace,
    SolveIK,
)
from robomech_ros.dynamics import inverse_dynamics
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import (
    matrix_from_pose,
    pose_from_matrix,
    stamped_pose,
)
from robomech_ros.nodes.dynamics.node import DynamicsNode
from robomech_ros.nodes.kinematics.node import KinematicsNode
from robomech_ros.nodes.move_group.node import MoveGroupNode
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.robots import load_robot
from robomech_ros.spatial import inverse_pose, matrix_from_axis_angle, pose_from_matrix as posed

PUMA = load_robot("puma560")
NAMES = list(PUMA.joint_names)
Q = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
BESIDE = Q + np.array([0.4, 0.1, -0.2, 0.1, 0.2, 0.1])
GOAL = forward_kinematics(PUMA, Q + 0.05)
# The base in the world, and a camera in the hand.
WORLD_BASE = posed(matrix_from_axis_angle([0.0, 0.6, 0.8], 0.9), [1.0, -2.0, 0.5])
HAND_CAMERA = posed(matrix_from_axis_angle([1.0, 0.0, 0.0], -0.4), [0.02, 0.05, 0.1])
STATIC = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
NANO = 1_000_000_000


def transform(parent, child, T, stamp=0):
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = parent
    message.header.stamp = instant(stamp)
    pose = pose_from_matrix(T)
    place = pose.position
    message.transform.translation.x = place.x
    message.transform.translation.y, message.transform.translation.z = place.y, place.z
    message.transform.rotation = pose.orientation
    return message


def instant(nanoseconds):
    return Time(sec=nanoseconds // NANO, nanosec=nanoseconds % NANO)


class Broadcaster:
    """Somebody on /tf and /tf_static, and a robot on joint_states."""

    def __init__(self, graph):
        self.graph, client = graph, graph.client
        self._moving = client.create_publisher(TFMessage, "/tf", BEST_EFFORT)
        self._joints = client.create_publisher(JointState, "joint_states", 10)
        self._static = []

    def now(self):
        return self.graph.client.get_clock().now().nanoseconds

    def fix(self, *transforms):
        publisher = self.graph.client.create_publisher(TFMessage, "/tf_static", STATIC)
        publisher.publish(TFMessage(transforms=list(transforms)))
        self._static.append(publisher)

    def move(self, *transforms):
        until(self._moving.get_subscription_count)
        self._moving.publish(TFMessage(transforms=list(transforms)))

    def joints(self, q, names=NAMES):
        until(self._joints.get_subscription_count)
        self._joints.publish(joint_state(names, np.array(q)))


@pytest.fixture
def kinematics(graph):
    graph.start(KinematicsNode, robot_description="puma560")
    tf = Broadcaster(graph)
    tf.fix(transform("world", "base_link", WORLD_BASE))
    return tf


def solve(tf, T, frame, stamp=0):
    target = stamped_pose(T, frame)
    target.header.stamp = instant(stamp)
    return tf.graph.ask(SolveIK, "kinematics/solve_ik", target=target)


def assert_solved(response, T=GOAL):
    assert response.error_code == 0, response.error_msg
    for point in response.solutions:
        np.testing.assert_allclose(forward_kinematics(PUMA, point.positions), T, atol=1e-8)


def test_a_goal_in_the_world_above_the_base(kinematics):
    assert_solved(solve(kinematics, WORLD_BASE @ GOAL, "world"))
    # What does not change holds at every instant.
    assert_solved(solve(kinematics, WORLD_BASE @ GOAL, "world", kinematics.now() + 5 * NANO))


def test_a_goal_seen_by_a_camera_on_the_moving_arm(kinematics):
    kinematics.fix(
        transform("tool0", "mount", HAND_CAMERA), transform("mount", "camera", np.eye(4))
    )
    for q in (Q, BESIDE):
        kinematics.joints(q)
        camera = forward_kinematics(PUMA, q) @ HAND_CAMERA
        seen = inverse_pose(camera) @ GOAL
        until(lambda seen=seen: _is_goal(solve(kinematics, seen, "camera")))


def test_a_goal_in_a_link_of_the_arm_itself(kinematics):
    unknown = solve(kinematics, np.eye(4), "tool0")
    assert unknown.error_code == ErrorCode.NO_STATE
    kinematics.joints(Q)
    ahead = posed(np.eye(3), [0.0, 0.0, 0.02])
    assert_solved(solve(kinematics, ahead, "tool0"), forward_kinematics(PUMA, Q) @ ahead)
    # No stamp and a base that tf does not know: the link where the joints are.
    assert_solved(
        solve(kinematics, ahead, "tool0", kinematics.now()), forward_kinematics(PUMA, Q) @ ahead
    )


def test_the_past_is_that_of_tf_and_the_future_is_waited_for(kinematics):
    start = kinematics.now() - 2 * NANO

    def table(part):
        return posed(matrix_from_axis_angle([0.0, 0.0, 1.0], 0.8 * part), [part, 0.0, 0.0])

    for k in range(11):
        kinematics.move(transform("world", "table", table(k / 10), start + k * NANO // 10))
    for part in (0.33, 0.75):
        there = inverse_pose(table(part)) @ WORLD_BASE @ GOAL
        assert_solved(solve(kinematics, there, "table", start + round(part * NANO)))
    late = solve(kinematics, np.eye(4), "table", start - NANO)
    assert late.error_code == ErrorCode.FRAME_UNAVAILABLE
    assert "1 s older than what is kept of 'table' in 'world'" in late.error_msg
    # Now comes news of it, while the request waits.
    there = inverse_pose(table(1.0)) @ WORLD_BASE @ GOAL
    stamp = start + 11 * NANO // 10
    timer = threading.Timer(
        0.2, lambda: kinematics.move(transform("world", "table", table(1.0), stamp))
    )
    timer.start()
    assert_solved(solve(kinematics, there, "table", stamp))
    timer.join()
    early = solve(kinematics, there, "table", stamp + NANO // 2)
    assert early.error_code == ErrorCode.FRAME_UNAVAILABLE
    assert "0.5 s newer than what tf last said of 'table' in 'world'" in early.error_msg


def test_two_robots_with_prefixes_in_one_tree(graph):
    graph.start(KinematicsNode, robot_description="puma560", frame_prefix="left/")
    tf = Broadcaster(graph)
    beside = posed(np.eye(3), [0.0, 0.9, 0.0])
    hand = forward_kinematics(PUMA, BESIDE)
    tf.fix(transform("world", "left/base_link", WORLD_BASE))
    tf.fix(transform("left/base_link", "right/base_link", beside))
    tf.fix(transform("right/base_link", "right/tool0", hand), transform("world", "tool0", hand))
    tf.joints(Q)
    # The own hand with and without the prefix, though tf has another tool0, and that of the other.
    own = forward_kinematics(PUMA, Q)
    for frame, frame_in_base in (
        ("world", inverse_pose(WORLD_BASE)),
        ("left/tool0", own),
        ("tool0", own),
        ("right/tool0", beside @ hand),
    ):
        assert_solved(solve(tf, inverse_pose(frame_in_base) @ GOAL, frame))


def test_old_news_say_how_old_they_are(kinematics):
    kinematics.move(transform("world", "table", np.eye(4), kinematics.now() - 20 * NANO))
    response = solve(kinematics, np.eye(4), "table")
    assert response.error_code == ErrorCode.FRAME_UNAVAILABLE
    for words in (
        "frame 'table'",
        "last said of 'table' is 2",
        "s old",
        "10 s",
        "max_transform_age",
    ):
        assert words in response.error_msg


def test_news_from_far_ahead_are_of_another_clock(kinematics):
    kinematics.move(transform("world", "table", np.eye(4), kinematics.now() + 20 * NANO))
    response = solve(kinematics, np.eye(4), "table")
    assert response.error_code == ErrorCode.FRAME_UNAVAILABLE
    for words in ("last said of 'table' is ", " s ahead of the time here", "10 s: two clocks"):
        assert words in response.error_msg
    kinematics.move(transform("world", "table", WORLD_BASE, kinematics.now() + 5 * NANO))
    assert_solved(solve(kinematics, GOAL, "table"))


def test_what_was_wrong_and_has_been_put_right_is_not_said(kinematics):
    kinematics.move(transform("world", "table", np.full((4, 4), np.nan)))
    assert "rejected messages" in solve(kinematics, np.eye(4), "moon").error_msg
    kinematics.move(transform("world", "table", np.eye(4), kinematics.now()))
    assert "rejected messages" not in solve(kinematics, np.eye(4), "moon").error_msg


def test_frames_that_are_not_connected_and_unknown_ones(kinematics):
    kinematics.fix(transform("room", "shelf", np.eye(4)))
    kinematics.move(*(transform(a, b, np.eye(4), 1) for a, b in (("a", "b"), ("b", "a"))))
    kinematics.move(transform("world", "bad", np.full((4, 4), np.nan)))
    for frame, words in (
        ("shelf", ("does not connect it", "hangs on 'room'", "'base_link' hangs on 'world'")),
        ("a", ("goes round in a circle: a, b, a",)),
        ("moon", ("no such link", "tf has no frame 'moon' on '/tf' and '/tf_static'", "'bad'")),
    ):
        response = solve(kinematics, np.eye(4), frame)
        assert response.error_code == ErrorCode.FRAME_UNAVAILABLE
        for word in (f"frame '{frame}'", *words, "known frames: base_link", "shelf, world"):
            assert word in response.error_msg
    assert_solved(solve(kinematics, GOAL, ""))


def test_a_frame_that_is_nowhere_in_tf_is_answered_long_before_the_timeout(graph):
    """It took all of the timeout."""
    graph.start(KinematicsNode, robot_description="puma560", state_timeout=60.0)
    tf = Broadcaster(graph)
    tf.fix(transform("world", "base_link", WORLD_BASE))
    assert_solved(solve(tf, WORLD_BASE @ GOAL, "world"))
    begun = time.monotonic()
    response = solve(tf, np.eye(4), "wrold")
    assert time.monotonic() - begun < 30.0
    assert response.error_code == ErrorCode.FRAME_UNAVAILABLE
    assert "tf has no frame 'wrold'" in response.error_msg
    assert "known frames: base_link" in response.error_msg and "world" in response.error_msg


def test_links_on_a_circle_do_not_keep_others_from_being_found(kinematics):
    """Another sender has the hand and a stray frame hang on each other: world was not found."""
    hand = (("tool0", "stray"), ("stray", "tool0"))
    kinematics.move(*(transform(a, b, np.eye(4), 1) for a, b in hand))
    assert "goes round in a circle" in solve(kinematics, np.eye(4), "stray").error_msg
    assert_solved(solve(kinematics, WORLD_BASE @ GOAL, "world"))
    kinematics.fix(transform("room", "shelf", np.eye(4)))
    assert "hangs on 'room'" in solve(kinematics, np.eye(4), "shelf").error_msg


def test_a_base_on_a_circle_is_said(kinematics):
    kinematics.fix(transform("room", "shelf", np.eye(4)))
    kinematics.move(transform("base_link", "world", np.eye(4), kinematics.now()))
    assert "'base_link' is on a circle" in solve(kinematics, np.eye(4), "shelf").error_msg
    assert_solved(solve(kinematics, GOAL, ""))


def test_messages_that_flood_the_node_do_not_stop_it(kinematics):
    crowd = [transform("world", f"f{k}", np.eye(4), 1) for k in range(1500)]
    for _ in range(100):
        kinematics.move(*crowd)
    huge = [transform("w" * 1000, "f" * 1000, np.eye(4), 1) for _ in range(1000)]
    kinematics.move(*huge)
    assert solve(kinematics, np.eye(4), "no such").error_code == ErrorCode.FRAME_UNAVAILABLE
    assert_solved(solve(kinematics, WORLD_BASE @ GOAL, "world"))


def test_bytes_that_are_no_message_are_passed_over(kinematics):
    client = kinematics.graph.client
    for topic in ("/tf", "/tf_static"):
        publisher = client.create_publisher(TFMessage, topic, STATIC)
        until(publisher.get_subscription_count)
        for data in (b"", b"\x00\x01\x00\x00\xff\xff\xff\x7f" + b"x" * 40, b"\xff" * 64):
            publisher.publish(data)
    response = solve(kinematics, np.eye(4), "no such")
    assert response.error_code == ErrorCode.FRAME_UNAVAILABLE
    assert "bytes are no message of the type TFMessage, on '/tf" in response.error_msg
    assert_solved(solve(kinematics, WORLD_BASE @ GOAL, "world"))


def test_jacobians_and_workspace_in_the_world(kinematics):
    state = joint_state(NAMES, Q)
    request = GetJacobian.Request(state=state, reference_frame="world")
    found = kinematics.graph.call(GetJacobian, "kinematics/get_jacobian", request)
    assert found.error_code == 0, found.error_msg
    J = jacobian(PUMA, Q)
    turn = WORLD_BASE[:3, :3]
    np.testing.assert_allclose(
        np.reshape(found.jacobian, (6, 6)), np.vstack((turn @ J[3:], turn @ J[:3])), atol=1e-12
    )
    poses = [stamped_pose(WORLD_BASE @ GOAL, "world"), stamped_pose(GOAL, "world")]
    answer = kinematics.graph.ask(QueryWorkspace, "kinematics/query_workspace", poses=poses)
    assert list(answer.reachable) == [True, False], answer.error_msg


def test_moveit_s_services_in_the_world_and_a_camera(kinematics):
    kinematics.graph.start(MoveGroupNode, robot_description="puma560")
    kinematics.fix(transform("tool0", "camera", HAND_CAMERA))
    kinematics.joints(Q)
    call = kinematics.graph.call
    in_camera = inverse_pose(forward_kinematics(PUMA, Q) @ HAND_CAMERA) @ GOAL
    for frame, T in (("world", WORLD_BASE @ GOAL), ("camera", in_camera)):
        asked = PositionIKRequest(pose_stamped=stamped_pose(T, frame))
        found = call(GetPositionIK, "compute_ik", GetPositionIK.Request(ik_request=asked))
        assert found.error_code.val == MoveItErrorCodes.SUCCESS, found.error_code
        q = found.solution.joint_state.position
        np.testing.assert_allclose(forward_kinematics(PUMA, q), GOAL, atol=1e-8)
    request = GetPositionFK.Request(header=Header(frame_id="world"), fk_link_names=["tool0"])
    request.robot_state.joint_state = joint_state(NAMES, Q)
    found = call(GetPositionFK, "compute_fk", request)
    wanted = WORLD_BASE @ forward_kinematics(PUMA, Q)
    np.testing.assert_allclose(matrix_from_pose(found.pose_stamped[0].pose), wanted, atol=1e-12)
    # Within a ball in the world about the goal, and then about a place that is elsewhere.
    for centre, code in ((WORLD_BASE @ GOAL, 1), (GOAL, MoveItErrorCodes.NO_IK_SOLUTION)):
        ball = SolidPrimitive(type=SolidPrimitive.SPHERE, dimensions=[0.01])
        region = BoundingVolume(primitives=[ball], primitive_poses=[pose_from_matrix(centre)])
        within = PositionConstraint(link_name="tool0", constraint_region=region)
        within.header.frame_id = "world"
        asked = PositionIKRequest(pose_stamped=stamped_pose(GOAL, ""))
        asked.constraints = Constraints(position_constraints=[within])
        found = call(GetPositionIK, "compute_ik", GetPositionIK.Request(ik_request=asked))
        assert found.error_code.val == code, found.error_code


def test_paths_in_the_world_and_from_a_camera_at_the_start(graph):
    graph.start(MoveGroupNode, robot_description="puma560")
    graph.start(TrajectoryPlannerNode, robot_description="puma560")
    tf = Broadcaster(graph)
    tf.fix(transform("world", "base_link", WORLD_BASE), transform("tool0", "camera", HAND_CAMERA))
    start = forward_kinematics(PUMA, Q)
    end = start.copy()
    end[:3, 3] += (0.03, 0.02, 0.04)
    by_camera = inverse_pose(start @ HAND_CAMERA) @ end
    for frame, T in (("world", WORLD_BASE @ end), ("camera", by_camera)):
        waypoints = [stamped_pose(T, frame)]
        request = PlanCartesian.Request(start=joint_state(NAMES, Q), waypoints=waypoints)
        found = graph.call(PlanCartesian, "trajectory_planner/plan_cartesian", request)
        assert found.error_code == 0, found.error_msg
        last = found.trajectory.points[-1].positions
        np.testing.assert_allclose(forward_kinematics(PUMA, last), end, atol=1e-7)
        request = GetCartesianPath.Request(waypoints=[pose_from_matrix(T)], max_step=0.01)
        request.header.frame_id = frame
        request.start_state.joint_state = joint_state(NAMES, Q)
        found = graph.call(GetCartesianPath, "compute_cartesian_path", request)
        assert found.fraction == 1.0, found.error_code
        last = found.solution.joint_trajectory.points[-1].positions
        np.testing.assert_allclose(forward_kinematics(PUMA, last), end, atol=1e-7)


def test_a_force_in_the_world(graph):
    graph.start(DynamicsNode, robot_description="puma560")
    tf = Broadcaster(graph)
    tf.fix(transform("world", "base_link", WORLD_BASE), transform("tool0", "camera", HAND_CAMERA))
    force = np.array([3.0, -5.0, 7.0])
    rows = np.array([Q, BESIDE])
    cameras = forward_kinematics(PUMA, rows) @ HAND_CAMERA
    for frame, axes in (("world", [inverse_pose(WORLD_BASE)] * 2), ("camera", cameras)):
        wrench = WrenchStamped()
        wrench.header.frame_id = frame
        wrench.wrench.force.x, wrench.wrench.force.y, wrench.wrench.force.z = force
        points = [JointTrajectoryPoint(positions=q) for q in rows]
        request = InverseDynamics.Request(points=points, tip_wrench=wrench)
        found = graph.call(InverseDynamics, "dynamics/inverse_dynamics", request)
        assert found.error_code == 0, found.error_msg
        zero = np.zeros(6)
        wanted = [
            inverse_dynamics(
                PUMA, q, zero, zero, tip_wrench=np.concatenate((zero[:3], T[:3, :3] @ force))
            )
            for q, T in zip(rows, axes, strict=True)
        ]
        np.testing.assert_allclose(np.reshape(found.effort, (2, 6)), wanted, atol=1e-9)


def test_without_tf2_msgs_it_is_said(graph, monkeypatch):
    hide_package(monkeypatch, "tf2_msgs")
    graph.start(KinematicsNode, robot_description="puma560")
    response = graph.ask(SolveIK, "kinematics/solve_ik", target=stamped_pose(GOAL, "world"))
    assert response.error_code == ErrorCode.FRAME_UNAVAILABLE
    assert "the package tf2_msgs is not installed; known frames: base_link" in response.error_msg


VIRTUAL = """<robot name="puma560">
  <virtual_joint name="v" type="{}" parent_frame="world" child_link="base_link"/>
</robot>"""
LIFT = posed(np.eye(3), [0.0, 0.0, 0.4])


def test_the_frame_in_which_a_virtual_joint_fixes_the_base_is_known(graph):
    srdf = VIRTUAL.format("fixed")
    graph.start(KinematicsNode, robot_description="puma560", robot_description_semantic=srdf)
    tf = Broadcaster(graph)
    for frame in ("world", "/world"):
        assert_solved(solve(tf, GOAL, frame))
    # What hangs on it in tf is known, too, although tf has no base.
    tf.fix(transform("world", "table", LIFT))
    request = SolveIK.Request(target=stamped_pose(inverse_pose(LIFT) @ GOAL, "table"))
    answer = graph.call_until(
        SolveIK, "kinematics/solve_ik", request, lambda answer: answer.error_code == 0
    )
    assert_solved(answer)
    # Who publishes where the base is goes before the SRDF.
    tf.fix(transform("world", "base_link", WORLD_BASE))
    request = SolveIK.Request(target=stamped_pose(WORLD_BASE @ GOAL, "world"))
    answer = graph.call_until(
        SolveIK, "kinematics/solve_ik", request, lambda answer: _is_goal(answer)
    )
    assert_solved(answer)


def _is_goal(answer):
    found = [forward_kinematics(PUMA, point.positions) for point in answer.solutions]
    return bool(found) and np.abs(np.subtract(found, GOAL)).max() < 1e-8


def test_a_base_that_floats_in_a_frame_needs_tf(graph):
    srdf = VIRTUAL.format("floating")
    graph.start(KinematicsNode, robot_description="puma560", robot_description_semantic=srdf)
    answer = solve(Broadcaster(graph), GOAL, "world")
    assert answer.error_code == ErrorCode.FRAME_UNAVAILABLE
    assert "world" not in answer.error_msg.partition("known frames: ")[2]
