"""compute_cartesian_path of MoveIt: real calls over DDS, every field honoured or refused."""

import itertools
import math

import numpy as np
import pytest
from geometry_msgs.msg import Pose, PoseStamped, Quaternion
from moveit_msgs.msg import (
    AttachedCollisionObject,
    Constraints,
    JointConstraint,
    MoveItErrorCodes,
    OrientationConstraint,
    RobotState,
    VisibilityConstraint,
)
from moveit_msgs.srv import GetCartesianPath, GetPositionFK
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from trajectories import waypoints as points_of
from trajectory_msgs.msg import JointTrajectory

from robomech_interfaces.srv import PlanCartesian, PlanJoint
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.kinetostatics import jacobian
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose, stamped_pose
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.move_group.node import MoveGroupNode
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.robots import load_description, load_robot
from robomech_ros.spatial import inverse_pose
from robomech_ros.trajectory import Limits, verify

PUMA = load_robot("puma560")
Q = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
HERE = forward_kinematics(PUMA, Q)
SUCCESS = MoveItErrorCodes.SUCCESS
STEPS = np.array([[0.06, 0.0, 0.0], [0.06, 0.05, 0.03]])


@pytest.fixture
def puma(graph):
    graph.start(MoveGroupNode, robot_description="puma560", state_timeout=0.0)
    return graph


def state(q=Q, names=PUMA.joint_names, **fields):
    return RobotState(joint_state=joint_state(names, np.asarray(q, dtype=float)), **fields)


def chain_of_some_joints():
    """The chain to a link before the wrist."""
    robot = load_description("puma560")
    chains = [robot.chain(PUMA.base, joint.child) for joint in robot.joints if joint.moves]
    return next(chain for chain in chains if chain.n == 3)


def shifted(*steps, of=HERE):
    poses = []
    for step in steps:
        pose = of.copy()
        pose[:3, 3] += step
        poses.append(stamped_pose(pose, "").pose)
    return poses


def compute(graph, **fields):
    good = {"start_state": state(), "waypoints": shifted(STEPS[0]), "max_step": 0.01}
    return graph.ask(GetCartesianPath, "compute_cartesian_path", **good | fields)


def test_others_are_served_while_a_long_path_is_planned(puma):
    steps = 0.05 * np.sin(np.outer(np.arange(1, 7), [1.0, 1.7, 2.3]))
    request = GetCartesianPath.Request(
        start_state=state(), waypoints=shifted(*steps), max_step=0.01
    )
    service = "compute_cartesian_path"
    slow = puma.start_call(GetCartesianPath, service, request)
    quick = puma.ask(GetPositionFK, "compute_fk", fk_link_names=["tool0"], robot_state=state())
    assert not slow.done()
    assert quick.error_code.val == SUCCESS, quick.error_code
    checked(puma.wait_for(slow))


def checked(response, code=SUCCESS, chain=PUMA, start=Q, limits=None):
    """Check what every path promises; returns its points, and dense poses of the tip."""
    assert response.error_code.val == code, response.error_code
    message = response.solution.joint_trajectory
    assert list(message.joint_names) == list(chain.joint_names)
    points = points_of(message)
    report = verify(points, limits or chain, start=start, start_tolerance=1e-9)
    assert report.ok, report.violation
    dense = points.curve.sample(np.linspace(0.0, points.times[-1], 2000)).position
    return points, forward_kinematics(chain, dense)


def test_straight_lines_from_waypoint_to_waypoint(puma):
    for group in ("manipulator", PUMA.name):
        checked(compute(puma, group_name=group, waypoints=shifted([0.01, 0.0, 0.0])))
    response = compute(puma, waypoints=shifted(*STEPS))
    points, poses = checked(response)
    assert response.fraction == 1.0
    assert response.error_code.message == "" and response.error_code.source == "/move_group"
    np.testing.assert_allclose(response.start_state.joint_state.position, Q)
    assert not response.start_state.is_diff
    assert response.solution.joint_trajectory.header.frame_id == PUMA.base
    legs = HERE[:3, 3] + np.vstack([np.zeros(3), STEPS])
    off = []
    for a, b in itertools.pairwise(legs):
        along = np.clip((poses[:, :3, 3] - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        off.append(np.linalg.norm(poses[:, :3, 3] - a - along[:, None] * (b - a), axis=1))
    assert np.min(off, axis=0).max() < 1e-6
    np.testing.assert_allclose(poses[-1][:3, 3], legs[-1], atol=1e-7)
    moves = np.linalg.norm(
        np.diff(forward_kinematics(PUMA, points.positions)[:, :3, 3], axis=0), axis=1
    )
    assert moves.max() <= 0.01


def test_nothing_is_published_that_an_executor_would_take(puma):
    """A client of MoveIt's service executes the response itself; neither is a part of a path."""
    heard = []
    puma.start(TrajectoryPlannerNode, robot_description="puma560", state_timeout=0.0)
    topic = "trajectory_planner/planned_trajectory"
    puma.client.create_subscription(JointTrajectory, topic, heard.append, LATCHED)
    checked(compute(puma, waypoints=shifted([0.01, 0.0, 0.0])))
    start = joint_state(PUMA.joint_names, Q)
    part = PlanCartesian.Request(start=start)
    part.waypoints = [PoseStamped(pose=pose) for pose in shifted([2.0, 0.0, 0.0])]
    response = puma.call(PlanCartesian, "trajectory_planner/plan_cartesian", part)
    assert response.error_code and response.trajectory.points
    whole = PlanJoint.Request(start=start, goal=joint_state(PUMA.joint_names, Q + 0.01))
    expected = puma.call(PlanJoint, "trajectory_planner/plan_joint", whole).trajectory
    puma.receive(JointTrajectory, topic, LATCHED, lambda _: True)
    assert heard == [expected]


def test_with_position_only_ik_the_orientation_is_free(graph):
    options = {"robot_description": "puma560", "state_timeout": 0.0, "position_only_ik": True}
    graph.start(MoveGroupNode, **options)
    # The waypoint turns the link by half a turn within 6 cm.
    turned = HERE.copy()
    turned[:3, :3] = HERE[:3, :3] @ np.diag([-1.0, -1.0, 1.0])
    turned[:3, 3] += STEPS[0]
    response = compute(graph, waypoints=[stamped_pose(turned, "").pose])
    _, poses = checked(response)
    assert response.fraction == 1.0
    np.testing.assert_allclose(poses[-1, :3, 3], turned[:3, 3], atol=1e-6)
    assert np.trace(poses[-1, :3, :3].T @ HERE[:3, :3]) > 2.0


def test_points_are_no_farther_apart_than_max_step(puma):
    points, _ = checked(compute(puma, max_step=0.002))
    places = forward_kinematics(PUMA, points.positions)[:, :3, 3]
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() <= 0.002
    few = compute(puma, max_step=1e-5)
    assert few.error_code.val == MoveItErrorCodes.FAILURE
    assert "max_step is 1e-05" in few.error_code.message and "max_points" in few.error_code.message


def test_scales_and_speeds(puma):
    full, _ = checked(compute(puma))
    half = {"max_velocity_scaling_factor": 0.5, "max_acceleration_scaling_factor": 0.1}
    scaled = Limits.of(PUMA).scaled(velocity=0.5, acceleration=0.1)
    slow, _ = checked(compute(puma, **half), limits=scaled)
    assert slow.times[-1] > 1.2 * full.times[-1]
    for link in ("", PUMA.tip):
        response = compute(puma, max_cartesian_speed=0.05, cartesian_speed_limited_link=link)
        points, poses = checked(response)
        moves = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1)
        assert 0.049 < moves.max() * 1999 / points.times[-1] < 0.05001
    elbow = chain_of_some_joints()
    response = compute(puma, max_cartesian_speed=0.02, cartesian_speed_limited_link=elbow.tip)
    points, _ = checked(response)
    dense = points.curve.sample(np.linspace(0.0, points.times[-1], 2000))
    twists = np.einsum("mij,mj->mi", jacobian(elbow, dense.position[:, :3]), dense.velocity[:, :3])
    assert 0.019 < np.linalg.norm(twists[:, 3:], axis=1).max() < 0.02001
    unlimited, _ = checked(compute(puma, max_cartesian_speed=-1.0))
    assert unlimited.times[-1] == full.times[-1]


def test_frames(puma):
    expected = shifted(STEPS[0])
    plain, _ = checked(compute(puma))
    base, _ = checked(compute(puma, header=Header(frame_id=PUMA.base)))
    np.testing.assert_array_equal(plain.positions, base.positions)
    # A link that moves counts where it is at the start.
    elbow = chain_of_some_joints()
    frame = inverse_pose(forward_kinematics(elbow, Q[: elbow.n]))
    seen = [stamped_pose(frame @ matrix_from_pose(pose, ""), "").pose for pose in expected]
    moved, _ = checked(compute(puma, header=Header(frame_id=elbow.tip), waypoints=seen))
    np.testing.assert_allclose(moved.positions[-1], plain.positions[-1], atol=1e-7)
    # In the frame of the link itself each waypoint counts from the one before.
    halfway = np.eye(4)
    halfway[:3, 3] = HERE[:3, :3].T @ (0.5 * STEPS[0])
    steps = [stamped_pose(halfway, "").pose] * 2
    own, _ = checked(compute(puma, header=Header(frame_id=PUMA.tip), waypoints=steps))
    np.testing.assert_allclose(own.positions[-1], plain.positions[-1], atol=1e-7)


def test_fraction_counts_waypoints_and_a_part_is_no_success(puma):
    """The way to each waypoint counts the same, as in MoveIt; the code says that it is a part."""
    response = compute(puma, waypoints=shifted([0.02, 0.0, 0.0], [2.0, 0.0, 0.0]))
    points, poses = checked(response, MoveItErrorCodes.NO_IK_SOLUTION)
    reached = np.linalg.norm(poses[-1][:3, 3] - HERE[:3, 3]) - 0.02
    assert response.fraction == pytest.approx(0.5 + 0.5 * reached / 1.98, abs=1e-3)
    assert "% of the waypoints: before waypoints[" in response.error_code.message
    assert points.times[-1] > 0.0


def test_absolute_jump_thresholds_work(puma):
    response = compute(puma, revolute_jump_threshold=1e-3)
    assert response.error_code.val == MoveItErrorCodes.PLANNING_FAILED
    assert "over the threshold of a jump, 0.001" in response.error_code.message
    assert response.fraction < 0.1
    for fields in ({"revolute_jump_threshold": 0.5}, {"prismatic_jump_threshold": 1e-6}):
        checked(compute(puma, **fields))


def test_the_relative_jump_threshold_works(puma):
    """It counts in means of the moves between points, ten of which at least are looked at."""
    way = {"waypoints": shifted(STEPS[0])}
    for step in (0.005, 0.5):
        strict = compute(puma, **way, jump_threshold=1.005, max_step=step)
        assert strict.error_code.val == MoveItErrorCodes.PLANNING_FAILED
        assert "over jump_threshold 1.005 times the mean" in strict.error_code.message
        assert strict.fraction < 1.0
    checked(compute(puma, **way, jump_threshold=3.0))


def test_constraints_hold_along_the_path(puma):
    limit = JointConstraint(
        joint_name=PUMA.joint_names[0],
        position=Q[0],
        tolerance_above=0.02,
        tolerance_below=0.02,
        weight=1.0,
    )
    response = compute(puma, path_constraints=Constraints(joint_constraints=[limit]))
    points, _ = checked(response, MoveItErrorCodes.PLANNING_FAILED)
    assert "path_constraints.joint_constraints[0]: joint" in response.error_code.message
    assert np.abs(points.positions[:, 0] - Q[0]).max() == pytest.approx(0.02, abs=1e-4)
    limit.position = Q[0] + 1.0
    response = compute(puma, path_constraints=Constraints(joint_constraints=[limit]))
    assert response.error_code.val == MoveItErrorCodes.START_STATE_VIOLATES_PATH_CONSTRAINTS
    assert response.fraction == 0.0 and not response.solution.joint_trajectory.points
    upright = OrientationConstraint(
        header=Header(frame_id=PUMA.base),
        link_name=PUMA.tip,
        orientation=shifted([0, 0, 0])[0].orientation,
        absolute_x_axis_tolerance=1e-3,
        absolute_y_axis_tolerance=1e-3,
        absolute_z_axis_tolerance=1e-3,
        weight=1.0,
    )
    checked(compute(puma, path_constraints=Constraints(orientation_constraints=[upright])))


def test_the_start_again_is_a_path_of_no_length(puma):
    response = compute(puma, waypoints=shifted([0.0, 0.0, 0.0]))
    points, _ = checked(response)
    assert response.fraction == 1.0 and points.times[-1] < 0.01


def test_a_link_before_the_tip_moves_its_own_joints_only(puma):
    chain = chain_of_some_joints()
    q = Q[: chain.n]
    pose = forward_kinematics(chain, q)
    response = compute(puma, link_name=chain.tip, waypoints=[stamped_pose(pose, "").pose])
    assert response.error_code.val == SUCCESS, response.error_code
    message = response.solution.joint_trajectory
    assert list(message.joint_names) == list(PUMA.joint_names)
    np.testing.assert_allclose(message.points[-1].positions, Q)


def test_joints_that_are_not_given_are_where_they_are(graph):
    graph.start(MoveGroupNode, robot_description="puma560", state_timeout=30.0)
    publisher = graph.client.create_publisher(JointState, "joint_states", 10)
    present = joint_state(PUMA.joint_names, Q)
    graph.client.create_timer(0.01, lambda: publisher.publish(present))
    start = RobotState(joint_state=joint_state([PUMA.joint_names[0]], Q[:1]), is_diff=True)
    checked(compute(graph, start_state=start))
    checked(compute(graph, start_state=RobotState()))


WRONG = MoveItErrorCodes.INVALID_GOAL_CONSTRAINTS
STATE = MoveItErrorCodes.START_STATE_INVALID
FAILURE = MoveItErrorCodes.FAILURE
moving = state()
moving.joint_state.velocity = [0.0, 0.3, 0.0, 0.0, 0.0, 0.0]
REFUSALS = {
    "group": ({"group_name": "legs"}, MoveItErrorCodes.INVALID_GROUP_NAME, ["legs"]),
    "carried": (
        {"start_state": RobotState(attached_collision_objects=[AttachedCollisionObject()])},
        STATE,
        ["start_state.attached_collision_objects", "attached in the planning scene"],
    ),
    "no state": (
        {"start_state": RobotState()},
        MoveItErrorCodes.ROBOT_STATE_STALE,
        [PUMA.joint_names[0]],
    ),
    "moving": ({"start_state": moving}, STATE, ["velocity", "0.3", "starts at rest"]),
    "unknown joint": ({"start_state": state([0.1], ["knee"])}, STATE, ["knee"]),
    "outside": ({"start_state": state([9.0, *Q[1:]])}, STATE, ["9", "outside its limits"]),
    "link": ({"link_name": "nose"}, MoveItErrorCodes.INVALID_LINK_NAME, ["nose"]),
    "limited link": (
        {"cartesian_speed_limited_link": "nose", "max_cartesian_speed": 0.1},
        MoveItErrorCodes.INVALID_LINK_NAME,
        ["nose"],
    ),
    "frame": (
        {"header": Header(frame_id="moon")},
        MoveItErrorCodes.FRAME_TRANSFORM_FAILURE,
        ["moon"],
    ),
    "no waypoints": ({"waypoints": []}, WRONG, ["waypoints"]),
    "too many": (
        {"waypoints": shifted(*[[0.001 * k, 0, 0] for k in range(201)])},
        WRONG,
        ["201", "max_waypoints"],
    ),
    "quaternion": ({"waypoints": [Pose(orientation=Quaternion(w=0.0))]}, WRONG, ["waypoints[0]"]),
    "no step": ({"max_step": 0.0}, FAILURE, ["max_step is 0.0", "at least 1e-05"]),
    "step": ({"max_step": math.nan}, FAILURE, ["max_step is nan"]),
    "jump": ({"jump_threshold": 0.5}, FAILURE, ["jump_threshold is 0.5", "more than 1"]),
    "negative jump": ({"jump_threshold": -1.0}, FAILURE, ["jump_threshold is -1.0"]),
    "revolute": ({"revolute_jump_threshold": -0.1}, FAILURE, ["revolute_jump_threshold is -0.1"]),
    "prismatic": (
        {"prismatic_jump_threshold": math.inf},
        FAILURE,
        ["prismatic_jump_threshold is inf"],
    ),
    "velocity": (
        {"max_velocity_scaling_factor": 1.5},
        FAILURE,
        ["max_velocity_scaling_factor is 1.5"],
    ),
    "acceleration": (
        {"max_acceleration_scaling_factor": -0.5},
        FAILURE,
        ["max_acceleration_scaling_factor is -0.5"],
    ),
    "speed": ({"max_cartesian_speed": 1e-9}, FAILURE, ["max_cartesian_speed is 1e-09"]),
    "visibility": (
        {"path_constraints": Constraints(visibility_constraints=[VisibilityConstraint()])},
        WRONG,
        ["path_constraints.visibility_constraints"],
    ),
    "joint of a constraint": (
        {"path_constraints": Constraints(joint_constraints=[JointConstraint(joint_name="knee")])},
        WRONG,
        ["knee"],
    ),
}


def test_every_bad_request_is_refused_by_name_and_the_node_goes_on_serving(puma):
    for name, (fields, code, words) in REFUSALS.items():
        response = compute(puma, **fields)
        assert response.error_code.val == code, (name, response.error_code)
        for word in words:
            assert word in response.error_code.message, (name, response.error_code.message)
        assert not response.solution.joint_trajectory.points and response.fraction == 0.0, name
    checked(compute(puma))
