"""Groups of an SRDF in MoveIt's services: each answers with its own joints."""

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from moveit_msgs.msg import (
    Constraints,
    JointConstraint,
    MoveItErrorCodes,
    PositionIKRequest,
    RobotState,
)
from moveit_msgs.srv import GetCartesianPath, GetPositionIK
from std_msgs.msg import String
from two_armed import SRDF, URDF, joints_of

from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import stamped_pose
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.move_group.node import MoveGroupNode
from robomech_ros.robots import load_description, load_srdf

ROBOT = load_description(URDF)
SEMANTIC = load_srdf(SRDF, ROBOT)
NAMES = [joint.name for joint in ROBOT.joints if joint.moves]
OPTIONS = {"robot_description": URDF, "group": "left_arm", "state_timeout": 0.0}


def everywhere(**changes):
    """Return all joint positions: both arms at home, the torso turned, with some changes."""
    at = {**SEMANTIC.state("left_arm", "home"), **SEMANTIC.state("right_arm", "home")}
    return {"torso_joint": 0.7, "finger_joint": 0.01, "thumb_joint": -0.01, **at, **changes}


def state_of(positions):
    return RobotState(joint_state=joint_state(list(positions), np.array([*positions.values()])))


def by_name(state):
    return dict(zip(state.joint_state.name, state.joint_state.position, strict=True))


def pose_between(base, link, positions):
    poses = ROBOT.link_poses(positions)
    return np.linalg.inv(poses[base]) @ poses[link]


def compute_ik(graph, seed, pose, **fields):
    request = PositionIKRequest(robot_state=state_of(seed), pose_stamped=pose, **fields)
    kind = GetPositionIK
    return graph.ask(kind, "compute_ik", ik_request=request)


@pytest.fixture
def kinematics(graph):
    graph.start(MoveGroupNode, robot_description_semantic=SRDF, **OPTIONS)
    return graph


@pytest.mark.parametrize(
    ("group", "tip", "own"),
    [("left_arm", "left_tool", joints_of("left")), ("right_arm", "right_tool", joints_of("right"))],
)
def test_each_arm_answers_with_its_own_joints(kinematics, group, tip, own):
    wanted = everywhere(
        **{name: value + 0.1 for name, value in everywhere().items() if name in own}
    )
    # The configured base is that of the left arm, which "" stands for.
    pose = stamped_pose(pose_between("left_base", tip, wanted), "")
    response = compute_ik(kinematics, everywhere(), pose, group_name=group)
    assert response.error_code.val == MoveItErrorCodes.SUCCESS, response.error_code.message
    found = by_name(response.solution)
    assert set(found) == set(NAMES)
    for name in NAMES:
        expected = pytest.approx(wanted[name], abs=1e-7)
        assert found[name] == (expected if name in own else everywhere()[name])


def test_a_hand_is_reached_from_its_arm_which_stays(kinematics):
    wanted = everywhere(finger_joint=0.033)
    pose = stamped_pose(pose_between("left_base", "finger", wanted), "left_base")
    fields = {"group_name": "hand", "ik_link_name": "finger"}
    response = compute_ik(kinematics, everywhere(), pose, **fields)
    found = by_name(response.solution)
    assert found == pytest.approx(wanted, abs=1e-9)
    # Without its arm's place nobody knows where the hand is.
    partly = {name: value for name, value in wanted.items() if not name.startswith("left")}
    response = compute_ik(kinematics, partly, pose, **fields)
    assert response.error_code.val == MoveItErrorCodes.ROBOT_STATE_STALE
    assert "left_joint_1" in response.error_code.message


@pytest.mark.parametrize(
    ("fields", "code", "text"),
    [
        (
            {"group_name": "legs"},
            MoveItErrorCodes.INVALID_GROUP_NAME,
            "'left_arm' or 'right_arm' or 'hand' or 'both', or empty",
        ),
        ({"group_name": "manipulator"}, MoveItErrorCodes.INVALID_GROUP_NAME, "'left_arm' or"),
        ({"group_name": "both"}, MoveItErrorCodes.INVALID_LINK_NAME, "since it is no one chain"),
        (
            {"group_name": "left_arm", "ik_link_name": "right_tool"},
            MoveItErrorCodes.INVALID_LINK_NAME,
            "one that joints of group 'left_arm' move",
        ),
        (
            {"group_name": "left_arm", "ik_link_name": "finger"},
            MoveItErrorCodes.INVALID_LINK_NAME,
            "no joints but those of group 'left_arm' move: not finger_joint",
        ),
    ],
)
def test_what_a_group_cannot_do_is_refused(kinematics, fields, code, text):
    response = compute_ik(kinematics, everywhere(), PoseStamped(), **fields)
    assert response.error_code.val == code
    assert text in response.error_code.message


def both(graph, wanted, **fields):
    """Ask for both arms at once."""
    links = ["left_tool", "right_tool"]
    poses = [stamped_pose(pose_between("left_base", link, wanted), "left_base") for link in links]
    fields = {"ik_link_names": links, "pose_stamped_vector": poses, "group_name": "both"} | fields
    return compute_ik(graph, everywhere(), PoseStamped(), **fields)


def test_two_arms_are_solved_at_once(kinematics):
    arms = (*joints_of("left"), *joints_of("right"))
    wanted = everywhere(**{name: everywhere()[name] + 0.12 for name in arms})
    response = both(kinematics, wanted)
    assert response.error_code.val == MoveItErrorCodes.SUCCESS, response.error_code.message
    assert by_name(response.solution) == pytest.approx(wanted, abs=1e-7)


def test_constraints_hold_of_both_arms_together(kinematics):
    # The nearest solutions of both break the constraints; others, of each, do not.
    nearest = by_name(both(kinematics, everywhere()).solution)
    apart = [
        JointConstraint(
            joint_name=name, position=-nearest[name], tolerance_above=0.3, tolerance_below=0.3
        )
        for name in ("left_joint_5", "right_joint_5")
    ]
    response = both(kinematics, everywhere(), constraints=Constraints(joint_constraints=apart))
    assert response.error_code.val == MoveItErrorCodes.SUCCESS, response.error_code.message
    found = by_name(response.solution)
    for one in apart:
        assert abs(found[one.joint_name] - one.position) <= 0.3
    for link in ("left_tool", "right_tool"):
        reached, wanted = (pose_between("left_base", link, at) for at in (found, everywhere()))
        np.testing.assert_allclose(reached, wanted, atol=1e-7)


def test_one_arm_out_of_reach_is_named(kinematics):
    links = ("left_tool", "right_tool")
    poses = [stamped_pose(pose_between("left_base", link, everywhere()), "") for link in links]
    poses[1].pose.position.x = 9.0
    response = both(kinematics, everywhere(), pose_stamped_vector=poses)
    assert response.error_code.val == MoveItErrorCodes.NO_IK_SOLUTION
    assert response.error_code.message.startswith("link 'right_tool': ")


@pytest.mark.parametrize(
    ("links", "text"),
    [
        (["left_tool", "left_link_4"], "joint 'left_joint_1' moves both 'left_tool' and 'left_lin"),
        (["left_tool"], "1 link in ik_link_names, expected one per pose: 2"),
    ],
)
def test_links_with_a_joint_in_common_are_refused(kinematics, links, text):
    response = both(kinematics, everywhere(), ik_link_names=links)
    assert response.error_code.val == MoveItErrorCodes.INVALID_LINK_NAME
    assert text in response.error_code.message


def test_more_poses_than_joints_are_refused(kinematics):
    fields = {"ik_link_names": ["left_tool"] * 99, "pose_stamped_vector": [PoseStamped()] * 99}
    response = both(kinematics, everywhere(), **fields)
    assert "has 99 poses, expected at most one a joint: 15" in response.error_code.message


def test_groups_come_by_the_topic_too_and_by_their_links(graph):
    publisher = graph.client.create_publisher(String, "robot_description_semantic", LATCHED)
    entries = {"groups": ["left_arm:left_base:left_tool", "wrist:right_base:right_link_6"]}
    graph.start(MoveGroupNode, **entries, **OPTIONS)
    wanted = everywhere(right_joint_2=0.1)
    pose = stamped_pose(pose_between("right_base", "right_link_6", wanted), "right_base")
    response = compute_ik(graph, everywhere(), pose, group_name="wrist")
    assert by_name(response.solution) == pytest.approx(wanted, abs=1e-7)
    response = compute_ik(graph, everywhere(), pose, group_name="right_arm")
    assert response.error_code.val == MoveItErrorCodes.INVALID_GROUP_NAME
    publisher.publish(String(data=SRDF))
    pose = stamped_pose(pose_between("right_base", "right_tool", wanted), "right_base")
    for _ in range(1000):
        response = compute_ik(graph, everywhere(), pose, group_name="right_arm")
        if response.error_code.val != MoveItErrorCodes.INVALID_GROUP_NAME:
            break
    assert by_name(response.solution) == pytest.approx(wanted, abs=1e-7)


def test_a_node_waits_for_the_srdf_with_its_group(graph):
    node = graph.start(MoveGroupNode, **OPTIONS)
    assert "compute_ik" not in str(node.get_service_names_and_types())
    graph.client.create_publisher(String, "robot_description_semantic", LATCHED).publish(
        String(data=SRDF)
    )
    pose = stamped_pose(pose_between("left_base", "left_tool", everywhere()), "")
    response = compute_ik(graph, everywhere(), pose)
    assert by_name(response.solution) == pytest.approx(everywhere(), abs=1e-7)


def test_a_straight_line_of_one_arm_in_the_frame_of_the_other(graph):
    # Both arms move with the torso: the frame of one is fixed to the other.
    graph.start(MoveGroupNode, robot_description_semantic=SRDF, **OPTIONS)
    start, end = everywhere(), pose_between("left_base", "right_tool", everywhere())
    end[:3, 3] += (0.02, 0.01, -0.03)
    request = GetCartesianPath.Request(
        start_state=state_of(start),
        group_name="right_arm",
        waypoints=[stamped_pose(end, "").pose],
        max_step=0.005,
    )
    request.header.frame_id = "left_base"
    response = graph.call(GetCartesianPath, "compute_cartesian_path", request)
    assert response.error_code.val == MoveItErrorCodes.SUCCESS, response.error_code.message
    trajectory = response.solution.joint_trajectory
    assert tuple(trajectory.joint_names) == joints_of("right")
    last = dict(zip(trajectory.joint_names, trajectory.points[-1].positions, strict=True))
    reached = pose_between("left_base", "right_tool", start | last)
    np.testing.assert_allclose(reached, end, atol=1e-6)
