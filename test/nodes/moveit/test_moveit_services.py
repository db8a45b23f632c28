"""compute_ik and compute_fk of MoveIt: real calls over DDS, every field honoured or refused."""

import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, Transform, Vector3
from moveit_msgs.msg import (
    AttachedCollisionObject,
    BoundingVolume,
    Constraints,
    JointConstraint,
    MoveItErrorCodes,
    OrientationConstraint,
    PositionConstraint,
    PositionIKRequest,
    RobotState,
    VisibilityConstraint,
)
from moveit_msgs.srv import GetPositionFK, GetPositionIK
from sensor_msgs.msg import JointState, MultiDOFJointState
from shape_msgs.msg import Mesh, SolidPrimitive
from std_msgs.msg import Header
from waiting import hide_package

from robomech_ros.errors import RobomechError
from robomech_ros.kinematics import forward_kinematics, inverse_kinematics
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, stamped_pose
from robomech_ros.nodes.move_group.node import MoveGroupNode
from robomech_ros.robots import load_description, load_robot
from robomech_ros.spatial import (
    inverse_pose,
    matrix_from_axis_angle,
    quaternion_from_matrix,
    rotation_vector_from_matrix,
)

PUMA = load_robot("puma560")
UR5E = load_robot("ur5e")
Q = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
FOREARM = load_description("ur5e").chain(None, "forearm_link")
UR_Q = np.array([0.3, -1.0, 1.2, 0.4, 0.9, -0.5])

# Of the definitions that MoveIt's own package has in Jazzy and Kilted (moveit_msgs 2.6.0).
HASHES = {
    "srv/GetPositionIK": "RIHS01_054ed6f6f71a09b01b5246c5d80beb4dacc6f444f58df039849c76292933e9e3",
    "srv/GetPositionFK": "RIHS01_2f16ec361a135d84b85a29385abeb9eeb025e39c09038bd6b2826645edc7edad",
    "srv/GetCartesianPath": (
        "RIHS01_b19f501df5d378141d918199894c3ad24533e76021a880b15dc5d62fec8d7b1a"
    ),
    "msg/MotionPlanRequest": (
        "RIHS01_f82ed20da5f8f93146999c1a3cfe34b56b97fc10333b40cac69782a1210888d7"
    ),
    "msg/PlanningScene": "RIHS01_0f58540ad5eab4b9ea827d53b763c793d8cabd202b3b301fcee25afa4ce1bd80",
    "msg/CollisionObject": (
        "RIHS01_74b0acd6d56be032bf4f764b2c2633f50588b5fb2bd71e97206c59052747cf7e"
    ),
    "msg/AttachedCollisionObject": (
        "RIHS01_7fdfe7951a33a857f20fc42c9ed410a38d06dd0c209ac774ecea746dc487dc41"
    ),
}

GRIPPER = """
  <link name="finger"/><link name="thumb"/>
  <joint name="grip" type="prismatic">
    <parent link="tool0"/><child link="finger"/><origin xyz="0 0.01 0.1"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.1"/>
  </joint>
  <joint name="thumb_joint" type="prismatic">
    <parent link="tool0"/><child link="thumb"/><origin xyz="0 -0.01 0.1"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.04" effort="10" velocity="0.1"/><mimic joint="grip"/>
  </joint>
"""


def with_gripper():
    text = Path(load_description("ur5e").where).read_text(encoding="utf-8")
    return text.replace("</robot>", GRIPPER + "</robot>")


@pytest.fixture
def puma(shared):
    return shared(MoveGroupNode, robot_description="puma560", state_timeout=0.0)


@pytest.fixture
def own_puma(graph):
    """A node of one test alone."""
    graph.start(MoveGroupNode, robot_description="puma560", state_timeout=0.0)
    return graph


@pytest.fixture
def gripped(shared):
    """A UR5e with two fingers, of which one follows the other."""
    options = {"robot_description": with_gripper(), "tip_link": "tool0", "state_timeout": 0.0}
    return shared(MoveGroupNode, **options)


def state(q, names=PUMA.joint_names, **fields):
    return RobotState(joint_state=joint_state(names, np.asarray(q, dtype=float)), **fields)


def target(q=Q, chain=PUMA, frame=""):
    return stamped_pose(forward_kinematics(chain, np.asarray(q)), frame)


def compute_ik(graph, **fields):
    return graph.ask(GetPositionIK, "compute_ik", ik_request=PositionIKRequest(**fields))


def compute_fk(graph, **fields):
    return graph.ask(GetPositionFK, "compute_fk", **fields)


def by_name(response):
    joints = response.solution.joint_state
    return dict(zip(joints.name, joints.position, strict=True))


def positions(response, names=PUMA.joint_names):
    assert response.error_code.val == MoveItErrorCodes.SUCCESS, response.error_code.message
    return np.array([by_name(response)[name] for name in names])


@pytest.mark.parametrize("name", HASHES)
def test_the_types_are_those_of_moveit(name):
    place = Path(sys.prefix, "share", "moveit_msgs", f"{name}.json")
    hashes = json.loads(place.read_text(encoding="utf-8"))["type_hashes"]
    assert {h["type_name"]: h["hash_string"] for h in hashes}[f"moveit_msgs/{name}"] == HASHES[name]


def test_ik_gives_the_solution_nearest_to_the_state_given(puma):
    seed = Q + 0.1
    for group in ("", "manipulator", PUMA.name):
        response = compute_ik(
            puma, group_name=group, robot_state=state(seed), pose_stamped=target()
        )
        np.testing.assert_allclose(positions(response), Q, atol=1e-9)
    assert response.error_code.message == ""
    assert response.error_code.source == "/move_group"
    assert response.solution.joint_state.name == list(PUMA.joint_names)
    assert response.solution.joint_state.header.frame_id == PUMA.base
    assert not response.solution.is_diff
    for seed in inverse_kinematics(PUMA, forward_kinematics(PUMA, Q)).q:
        response = compute_ik(puma, robot_state=state(seed), pose_stamped=target())
        np.testing.assert_allclose(positions(response), seed, atol=1e-9)


def test_same_request_same_answer(puma):
    first, second = (compute_ik(puma, pose_stamped=target()) for _ in range(2))
    assert first == second
    assert len(positions(first)) == 6


def test_a_state_beyond_the_limits_is_taken_as_a_hint(puma):
    response = compute_ik(puma, robot_state=state(PUMA.upper + 0.2), pose_stamped=target())
    expected = inverse_kinematics(PUMA, forward_kinematics(PUMA, Q), seed=PUMA.upper).q[0]
    np.testing.assert_allclose(positions(response), expected, atol=1e-9)


def test_without_a_state_the_present_one_is_meant(own_puma):
    publisher = own_puma.client.create_publisher(JointState, "joint_states", 10)
    present = joint_state(PUMA.joint_names, Q + 0.05)
    timer = own_puma.client.create_timer(0.01, lambda: publisher.publish(present))
    request = GetPositionFK.Request(fk_link_names=["tool0"])
    own_puma.call_until(GetPositionFK, "compute_fk", request, lambda answer: answer.pose_stamped)
    timer.cancel()
    for relative in (False, True):
        response = compute_ik(
            own_puma, robot_state=RobotState(is_diff=relative), pose_stamped=target()
        )
        np.testing.assert_allclose(positions(response), Q, atol=1e-9)
    part = state([0.31, -0.41], PUMA.joint_names[:2], is_diff=True)
    response = compute_ik(own_puma, robot_state=part, pose_stamped=target())
    np.testing.assert_allclose(positions(response), Q, atol=1e-9)
    fk = compute_fk(own_puma, fk_link_names=["tool0"], robot_state=part)
    mixed = np.array([0.31, -0.41, *(Q + 0.05)[2:]])
    reached = matrix_from_pose(fk.pose_stamped[0].pose)
    np.testing.assert_allclose(reached, forward_kinematics(PUMA, mixed), atol=1e-12)


def test_a_difference_needs_the_present_state(puma):
    part = state([0.31, -0.41], PUMA.joint_names[:2])
    assert compute_ik(puma, robot_state=part, pose_stamped=target()).error_code.val == 1
    part.is_diff = True
    for response in (
        compute_ik(puma, robot_state=part, pose_stamped=target()),
        compute_fk(puma, robot_state=part, fk_link_names=["tool0"]),
    ):
        assert response.error_code.val == MoveItErrorCodes.ROBOT_STATE_STALE
        assert PUMA.joint_names[2] in response.error_code.message


def test_the_answer_is_the_whole_robot(gripped):
    names = [*UR5E.joint_names, "grip", "thumb_joint"]
    seed = state([*(UR_Q + 0.1), 0.013, 0.013], names)
    wanted = target(UR_Q, UR5E, frame="base_link")
    response = compute_ik(gripped, robot_state=seed, pose_stamped=wanted)
    np.testing.assert_allclose(positions(response, UR5E.joint_names), UR_Q, atol=1e-8)
    assert sorted(by_name(response)) == sorted([*UR5E.joint_names, "grip"])
    assert by_name(response)["grip"] == 0.013
    # To a link before the wrist the joints after it keep their place.
    chain = load_description("ur5e").chain(None, "forearm_link")
    wanted = target(UR_Q[:3], chain)
    for fields in (
        {"ik_link_name": "forearm_link", "pose_stamped": wanted},
        {"ik_link_names": ["forearm_link"], "pose_stamped_vector": [wanted]},
    ):
        response = compute_ik(gripped, robot_state=seed, **fields)
        found = positions(response, names[:-1])
        np.testing.assert_allclose(found, [*UR_Q[:3], *(UR_Q + 0.1)[3:], 0.013], atol=1e-8)


def test_a_vector_of_one_pose_goes_before_the_single_pose(puma):
    response = compute_ik(
        puma, robot_state=state(Q), pose_stamped=target(-Q), pose_stamped_vector=[target()]
    )
    np.testing.assert_allclose(positions(response), Q, atol=1e-9)


def test_the_pose_may_be_in_a_frame_fixed_to_the_base(graph):
    graph.start(MoveGroupNode, robot_description="ur5e", base_link="base_link_inertia")
    above = load_description("ur5e").chain("base_link")
    seed = state(UR_Q + 0.1, UR5E.joint_names)
    wanted = target(UR_Q, above, "base_link")
    response = compute_ik(graph, robot_state=seed, pose_stamped=wanted)
    np.testing.assert_allclose(positions(response, UR5E.joint_names), UR_Q, atol=1e-8)
    links = ["tool0", "base_link", "base_link_inertia"]
    header, at_q = Header(frame_id="base_link"), state(UR_Q, UR5E.joint_names)
    fk = compute_fk(graph, header=header, fk_link_names=links, robot_state=at_q)
    assert (fk.error_code.val, fk.fk_link_names) == (MoveItErrorCodes.SUCCESS, links)
    reached = [matrix_from_pose(pose.pose) for pose in fk.pose_stamped]
    np.testing.assert_allclose(reached[0], forward_kinematics(above, UR_Q), atol=1e-12)
    np.testing.assert_allclose(reached[1], np.eye(4), atol=1e-12)
    assert {pose.header.frame_id for pose in fk.pose_stamped} == {"base_link"}


def test_the_nanoseconds_of_a_timeout_count(graph):
    chain = load_robot("panda")
    graph.start(MoveGroupNode, robot_description="panda", state_timeout=0.0)
    beyond = target(chain.midrange(), chain)
    beyond.pose.position.x += 5.0
    short = compute_ik(graph, pose_stamped=beyond, timeout=Duration(nanosec=100_000))
    assert short.error_code.val == MoveItErrorCodes.TIMED_OUT, short.error_code
    assert "0.0001 s" in short.error_code.message
    long = compute_ik(graph, pose_stamped=beyond, timeout=Duration(sec=20))
    assert long.error_code.val == MoveItErrorCodes.NO_IK_SOLUTION, long.error_code


def test_out_of_reach_says_by_how_much(puma):
    far = target()
    far.pose.position.x = 5.0
    response = compute_ik(puma, robot_state=state(Q), pose_stamped=far)
    assert response.error_code.val == MoveItErrorCodes.NO_IK_SOLUTION
    expected = inverse_kinematics(PUMA, matrix_from_pose(far.pose), seed=Q).reason
    assert response.error_code.message == expected
    assert response.solution == RobotState()


@pytest.fixture
def ur5e(shared):
    return shared(MoveGroupNode, robot_description="ur5e", state_timeout=0.0)


@pytest.fixture(scope="module")
def known():
    """All solutions to the pose of UR_Q, windings included, nearest to UR_Q first."""
    T = forward_kinematics(UR5E, UR_Q)
    return inverse_kinematics(UR5E, T, seed=UR_Q, include_windings=True).q


def nearest_with(graph, **constraints):
    return compute_ik(
        graph,
        robot_state=state(UR_Q, UR5E.joint_names),
        pose_stamped=target(UR_Q, UR5E),
        constraints=Constraints(**constraints),
    )


def test_a_joint_constraint_chooses_another_solution(ur5e, known):
    for i, joint in ((2, "elbow_joint"), (5, "wrist_3_joint")):
        values = known[:, i]
        other = next(value for value in values if abs(value - values[0]) > 0.5)
        constraint = JointConstraint(
            joint_name=joint, position=other + 0.01, tolerance_above=0.0, tolerance_below=0.02
        )
        response = nearest_with(ur5e, joint_constraints=[constraint])
        expected = known[np.abs(values - other) < 1e-6][0]
        np.testing.assert_allclose(positions(response, UR5E.joint_names), expected, atol=1e-8)
        constraint.position, constraint.tolerance_below = values.max() + 0.01, 0.001
        response = nearest_with(ur5e, joint_constraints=[constraint])
        assert response.error_code.val == MoveItErrorCodes.NO_IK_SOLUTION
        for part in (f"{len(known)} solutions tried, these are all", "joint_constraints[0]", joint):
            assert part in response.error_code.message


def forearm(q):
    """Pose of a link in the middle of the arm."""
    return forward_kinematics(FOREARM, q[:3])


def volume(kind, dimensions, center):
    shape = SolidPrimitive(type=kind, dimensions=dimensions)
    at = Pose(position=Point(x=center[0], y=center[1], z=center[2]))
    return BoundingVolume(primitives=[shape], primitive_poses=[at])


@pytest.mark.parametrize(
    ("kind", "dimensions"),
    [
        (SolidPrimitive.BOX, [0.02, 0.02, 0.02]),
        (SolidPrimitive.SPHERE, [0.01]),
        (SolidPrimitive.CYLINDER, [0.02, 0.01]),
    ],
)
def test_a_position_constraint_chooses_another_solution(ur5e, known, kind, dimensions):
    points = np.array([(forearm(q) @ [0.05, -0.1, 0.2, 1.0])[:3] for q in known])
    other = int(np.argmax(np.linalg.norm(points - points[0], axis=1)))
    same = np.linalg.norm(points - points[other], axis=1) < 1e-6
    assert not same[0]
    for frame in ("", "base_link"):
        constraint = PositionConstraint(
            header=Header(frame_id=frame),
            link_name="forearm_link",
            target_point_offset=Vector3(x=0.05, y=-0.1, z=0.2),
        )
        for beyond, code in ((-1e-4, 1), (1e-4, MoveItErrorCodes.NO_IK_SOLUTION)):
            center = points[other] + [0.0, 0.0, 0.01 + beyond]
            constraint.constraint_region = volume(kind, dimensions, center.tolist())
            response = nearest_with(ur5e, position_constraints=[constraint])
            assert response.error_code.val == code, response.error_code
            if code == MoveItErrorCodes.SUCCESS:
                found = positions(response, UR5E.joint_names)
                np.testing.assert_allclose(found, known[same][0], atol=1e-8)
        assert "position_constraints[0]" in response.error_code.message


def test_a_volume_may_move_with_a_link(ur5e, known):
    tools = [inverse_pose(forearm(q)) @ forward_kinematics(UR5E, q) for q in known]
    points = np.array([T[:3, 3] for T in tools])
    other = int(np.argmax(np.linalg.norm(points - points[0], axis=1)))
    constraint = PositionConstraint(
        header=Header(frame_id="forearm_link"),
        link_name="tool0",
        constraint_region=volume(SolidPrimitive.SPHERE, [1e-4], points[other].tolist()),
    )
    response = nearest_with(ur5e, position_constraints=[constraint])
    same = np.linalg.norm(points - points[other], axis=1) < 1e-6
    assert not same[0]
    found = positions(response, UR5E.joint_names)
    np.testing.assert_allclose(found, known[same][0], atol=1e-8)


@pytest.mark.parametrize("vector", [False, True])
def test_an_orientation_constraint_chooses_another_solution(ur5e, known, vector):
    turns = [forearm(q)[:3, :3] for q in known]
    other = next(i for i, R in enumerate(turns) if np.trace(turns[0].T @ R) < 2.0)
    # That solution is turned from what is wanted about x, y and z of the link, one after another.
    angles = np.array([0.3, 0.2, -0.4])
    about_x, about_y, about_z = matrix_from_axis_angle(np.eye(3), angles)
    wanted = turns[other] @ (about_x @ about_y @ about_z).T
    x, y, z, w = quaternion_from_matrix(wanted).tolist()
    # A rotation vector is measured in the axes of the frame, three angles in those of the link.
    turned = wanted @ rotation_vector_from_matrix(wanted.T @ turns[other]) if vector else angles
    needed = np.abs(turned)
    names = [f"absolute_{axis}_axis_tolerance" for axis in "xyz"]
    for spare, code in ((1e-6, 1), (-1e-6, MoveItErrorCodes.NO_IK_SOLUTION)):
        allowed = np.maximum(needed + spare, 0.0).tolist()
        constraint = OrientationConstraint(
            link_name="forearm_link",
            orientation=Quaternion(x=x, y=y, z=z, w=w),
            parameterization=int(vector),
            **dict(zip(names, allowed, strict=True)),
        )
        response = nearest_with(ur5e, orientation_constraints=[constraint])
        assert response.error_code.val == code, response.error_code
        if code == MoveItErrorCodes.SUCCESS:
            same = next(
                q for q, R in zip(known, turns, strict=True) if np.allclose(R, turns[other])
            )
            found = positions(response, UR5E.joint_names)
            np.testing.assert_allclose(found, same, atol=1e-8)
    assert "orientation_constraints[0]" in response.error_code.message


def test_a_constraint_on_another_branch_needs_its_state(gripped):
    constraint = JointConstraint(joint_name="grip", position=0.01, tolerance_above=0.005)
    fields = {
        "pose_stamped": target(UR_Q, UR5E),
        "constraints": Constraints(joint_constraints=[constraint]),
    }
    arm = state(UR_Q, UR5E.joint_names)
    unknown = compute_ik(gripped, robot_state=arm, **fields).error_code
    assert (unknown.val, "grip" in unknown.message) == (MoveItErrorCodes.ROBOT_STATE_STALE, True)
    for opening, code in ((0.012, 1), (0.03, MoveItErrorCodes.NO_IK_SOLUTION)):
        whole = state([*UR_Q, opening], [*UR5E.joint_names, "grip"])
        assert compute_ik(gripped, robot_state=whole, **fields).error_code.val == code


JOINT = PUMA.joint_names[0]


def constrained(**fields):
    return {"constraints": Constraints(**fields)}


def position(**fields):
    """A constraint on the position of the tool."""
    given = {"link_name": "tool0", **fields}
    return constrained(position_constraints=[PositionConstraint(**given)])


def region(kind, sizes):
    """A volume about the base in which the tool has to be."""
    return position(constraint_region=volume(kind, sizes, (0.0, 0.0, 0.0)))


def joint(**fields):
    """A constraint on the first joint."""
    given = {"joint_name": JOINT, **fields}
    return constrained(joint_constraints=[JointConstraint(**given)])


def orientation(**fields):
    """A constraint on the orientation of the tool."""
    given = {"link_name": "tool0", **fields}
    return constrained(orientation_constraints=[OrientationConstraint(**given)])


def moved(**fields):
    message = target()
    for name, value in fields.items():
        setattr(message.pose.position, name, value)
    return {"pose_stamped": message}


WRONG = MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS
STATE = MoveItErrorCodes.INVALID_ROBOT_STATE
LINK = MoveItErrorCodes.INVALID_LINK_NAME
REFUSALS = {
    "group": ({"group_name": "legs"}, MoveItErrorCodes.INVALID_GROUP_NAME, ["legs", "puma560"]),
    "carried": (
        {
            "robot_state": RobotState(
                attached_collision_objects=[AttachedCollisionObject(link_name="tool0")]
            )
        },
        STATE,
        ["attached_collision_objects", "attached in the planning scene"],
    ),
    "compound joint": (
        {
            "robot_state": RobotState(
                multi_dof_joint_state=MultiDOFJointState(
                    joint_names=["floating"], transforms=[Transform()]
                )
            )
        },
        STATE,
        ["multi_dof_joint_state", "floating"],
    ),
    "unknown joint": ({"robot_state": state([0.1], ["knee"])}, STATE, ["knee", JOINT]),
    "joint twice": ({"robot_state": state([0.1, 0.2], [JOINT] * 2)}, STATE, ["repeated", JOINT]),
    "unnamed": ({"robot_state": state(Q, [])}, STATE, ["joint_state.position"]),
    "not a number": ({"robot_state": state([math.nan], [JOINT])}, STATE, ["nan", JOINT]),
    "link": ({"ik_link_name": "nose"}, LINK, ["nose", "tool0"]),
    "base": ({"ik_link_name": PUMA.base}, LINK, [PUMA.base, "not moved"]),
    "names without poses": (
        {"ik_link_names": ["tool0", "tool0"]}, LINK, ["2 links", "one per pose: 1"],
    ),
    "two poses": (
        {"ik_link_names": ["tool0", "tool0"], "pose_stamped_vector": [target(), target()]},
        LINK,
        ["ik_link_names: joint 'waist' moves both 'tool0' and 'tool0'", "no joint in common"],
    ),
    "frame": (
        {"pose_stamped": target(frame="moon")},
        MoveItErrorCodes.FRAME_TRANSFORM_FAILURE,
        ["moon", PUMA.base],
    ),
    "a link that joints move, unknown where": (
        {"pose_stamped": target(frame="tool0")},
        MoveItErrorCodes.ROBOT_STATE_STALE,
        ["no present state", JOINT],
    ),
    "pose": (moved(y=math.inf), WRONG, ["position.y", "inf"]),
    "quaternion": (
        {"pose_stamped": PoseStamped(pose=Pose(orientation=Quaternion(w=0.0)))},
        WRONG,
        ["all zero"],
    ),
    "timeout": ({"timeout": Duration(sec=-1)}, MoveItErrorCodes.FAILURE, ["timeout", "-1"]),
    "visibility": (
        constrained(visibility_constraints=[VisibilityConstraint()]), WRONG, ["visibility"],
    ),
    "joint of a constraint": (joint(joint_name="knee"), WRONG, ["knee"]),
    "tolerance": (
        joint(tolerance_above=-1.0), WRONG, ["joint_constraints[0].tolerance_above", "-1.0"],
    ),
    "weight": (joint(weight=math.nan), WRONG, ["joint_constraints[0].weight"]),
    "link of a constraint": (orientation(link_name="nose"), LINK, ["nose"]),
    "frame of a constraint": (
        position(header=Header(frame_id="moon")),
        MoveItErrorCodes.FRAME_TRANSFORM_FAILURE,
        ["moon"],
    ),
    "kind of turn": (orientation(parameterization=7), WRONG, ["parameterization", "7"]),
    "no volume": (position(), WRONG, ["primitive_poses"]),
    "mesh": (position(constraint_region=BoundingVolume(meshes=[Mesh()])), WRONG, ["meshes"]),
    "cone": (region(SolidPrimitive.CONE, [1.0, 1.0]), WRONG, ["CYLINDER"]),
    "box of one size": (region(SolidPrimitive.BOX, [1.0]), WRONG, ["dimensions"]),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSALS)
def test_what_cannot_be_honoured_is_refused_by_name(puma, name):
    fields, code, words = REFUSALS[name]
    response = compute_ik(puma, **{"pose_stamped": target(), **fields})
    assert response.error_code.val == code, response.error_code
    for word in words:
        assert word in response.error_code.message
    assert response.solution == RobotState()
    assert compute_ik(puma, pose_stamped=target()).error_code.val == MoveItErrorCodes.SUCCESS


def test_fk_answers_for_the_links_it_knows(puma):
    links = [PUMA.links[2], "nose", "tool0", "tool0"]
    response = compute_fk(puma, fk_link_names=links, robot_state=state(Q))
    assert response.error_code.val == MoveItErrorCodes.INVALID_LINK_NAME
    assert "nose" in response.error_code.message
    assert response.fk_link_names == [links[0], "tool0", "tool0"]
    chains = [PUMA.with_tip(links[0]), PUMA, PUMA]
    for pose, chain in zip(response.pose_stamped, chains, strict=True):
        expected = forward_kinematics(chain, Q[: chain.n])
        np.testing.assert_allclose(matrix_from_pose(pose.pose), expected, atol=1e-14)
        assert pose.header.frame_id == PUMA.base
    known = compute_fk(puma, fk_link_names=links[2:], robot_state=state(Q))
    assert (known.error_code.val, known.error_code.message) == (MoveItErrorCodes.SUCCESS, "")


@pytest.mark.parametrize(
    ("fields", "code", "words"),
    [
        ({}, LINK, ["fk_link_names is empty"]),
        ({"fk_link_names": ["tool0"]}, MoveItErrorCodes.ROBOT_STATE_STALE, [JOINT]),
        ({"fk_link_names": ["tool0"] * 11}, MoveItErrorCodes.FAILURE, ["11", "max_links"]),
        (
            {"fk_link_names": ["tool0"], "header": Header(frame_id="moon")},
            MoveItErrorCodes.FRAME_TRANSFORM_FAILURE,
            ["moon"],
        ),
        ({"fk_link_names": ["tool0"], "robot_state": state([0.1], ["knee"])}, STATE, ["knee"]),
    ],
)
def test_fk_refuses_by_name(graph, fields, code, words):
    options = {"robot_description": "puma560", "state_timeout": 0.0, "max_links": 10}
    graph.start(MoveGroupNode, **options)
    response = compute_fk(graph, **fields)
    assert response.error_code.val == code, response.error_code
    for word in words:
        assert word in response.error_code.message
    assert not response.pose_stamped


def test_a_finger_that_follows_another_is_where_the_other_has_it(gripped):
    whole = state([*UR_Q, 0.01], [*UR5E.joint_names, "grip"])
    response = compute_fk(gripped, fk_link_names=["finger", "thumb"], robot_state=whole)
    assert response.error_code.val == MoveItErrorCodes.SUCCESS, response.error_code
    assert response.fk_link_names == ["finger", "thumb"]
    links = load_description(with_gripper()).link_poses(
        dict(zip(whole.joint_state.name, whole.joint_state.position, strict=True))
    )
    tool = forward_kinematics(UR5E, UR_Q)
    np.testing.assert_allclose(links["finger"][:3, 3], (tool @ [0.0, 0.02, 0.1, 1.0])[:3])
    for name, stamped in zip(response.fk_link_names, response.pose_stamped, strict=True):
        found = matrix_from_pose(stamped.pose, name)
        np.testing.assert_allclose(found, links[name], atol=1e-12)


def test_without_moveit_msgs_the_node_says_what_it_lacks(graph, monkeypatch):
    hide_package(monkeypatch, "moveit_msgs", "robomech_ros.nodes.moveit.")
    with pytest.raises(RobomechError, match="move_group needs moveit_msgs: `make setup` builds it"):
        graph.start(MoveGroupNode, robot_description="puma560")
