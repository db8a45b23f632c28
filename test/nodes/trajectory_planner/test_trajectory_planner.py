"""The trajectory planner: plans that keep what they promise, over real DDS."""

import copy
import dataclasses
from pathlib import Path

import nav_msgs.msg
import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from trajectories import waypoints
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import PlanJoint
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.messages.message_fields import (
    duration_from_seconds,
    seconds_from_duration,
)
from robomech_ros.nodes.common.messages.pose_messages import matrix_from_pose
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.robots import load_description, load_robot
from robomech_ros.trajectory import point_to_point, verify

PUMA = load_robot("puma560")
START = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
GOAL = np.array([-1.2, 0.8, -1.5, 1.5, -0.4, 2.7])
PROFILES = {
    name: getattr(PlanJoint.Request, name.upper())
    for name in ("poly345", "poly4567", "cycloidal", "cubic_spline", "ruckig", "time_optimal")
}
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def puma(shared):
    return shared(TrajectoryPlannerNode, robot_description="puma560")


@pytest.fixture
def own_puma(graph):
    """A node of one test alone."""
    graph.start(TrajectoryPlannerNode, robot_description="puma560")
    return graph


@pytest.fixture(params=sorted(PROFILES))
def profile(request):
    return request.param


def plan(graph, **fields):
    request = {
        "start": joint_state(PUMA.joint_names, START),
        "goal": joint_state(PUMA.joint_names, GOAL),
    } | fields
    return graph.call(PlanJoint, "trajectory_planner/plan_joint", PlanJoint.Request(**request))


def check(response, chain=PUMA, start=START, goal=GOAL):
    """Check what every plan promises; returns its waypoints."""
    assert (response.error_code, response.error_msg) == (ErrorCode.NONE, "")
    assert response.trajectory.joint_names == list(chain.joint_names)
    assert response.trajectory.header.frame_id == ""
    assert response.trajectory.header.stamp.sec == 0
    points = waypoints(response.trajectory)
    report = verify(points, chain, start=start, start_tolerance=0.0)
    assert report.ok, report.violation
    np.testing.assert_array_equal(points.positions[-1], goal)
    assert not points.velocities[-1].any()
    assert not points.accelerations[-1].any()
    assert response.duration == response.trajectory.points[-1].time_from_start
    for rate in ("velocity", "acceleration", "jerk"):
        ratio = np.array(getattr(response, f"peak_{rate}_ratio"))
        np.testing.assert_allclose(ratio, getattr(report, f"peak_{rate}_ratio"), rtol=1e-6)
        assert ratio.max() <= 1.0
    return points


def test_a_goal_may_be_a_posture_by_its_name(graph):
    joints = zip(PUMA.joint_names, GOAL, strict=True)
    places = "".join(f'<joint name="{name}" value="{at}"/>' for name, at in joints)
    semantic = f"""<robot name="puma560">
      <group name="arm"><chain base_link="base_link" tip_link="tool0"/></group>
      <group_state name="there" group="arm">{places}</group_state>
    </robot>"""
    graph.start(
        TrajectoryPlannerNode, robot_description="puma560", robot_description_semantic=semantic
    )
    home = JointState(name=["home"])
    check(plan(graph, goal=JointState(name=["there"])))
    check(plan(graph, goal=home), goal=PUMA.home())
    there = JointState(name=["there"])
    check(plan(graph, start=home, goal=there), start=PUMA.home())
    response = plan(graph, goal=JointState(name=["their"]))
    assert response.error_code == ErrorCode.BAD_VALUE
    assert response.error_msg == "posture is 'their', expected one of home, there"
    # The name of a joint is the name of a joint.
    response = plan(graph, goal=JointState(name=["waist"]))
    assert response.error_code == ErrorCode.WRONG_SIZE


def test_a_plan_is_as_fast_as_the_limits_allow(puma, profile):
    response = plan(puma, profile=PROFILES[profile])
    points = check(response)
    fastest = point_to_point(START, GOAL, limits=PUMA, profile=profile)
    assert points.times[-1] == pytest.approx(fastest.duration, rel=1e-4)
    np.testing.assert_allclose(points.positions, fastest.sample(points.times).position, atol=1e-4)
    assert np.diff(points.times).max() <= 0.01 + 1e-9
    peaks = (
        response.peak_velocity_ratio,
        response.peak_acceleration_ratio,
        response.peak_jerk_ratio,
    )
    assert max(map(max, peaks)) == pytest.approx(1.0, rel=1e-4)


def test_a_wanted_duration_and_a_wanted_period(puma, profile):
    response = plan(
        puma, profile=PROFILES[profile], duration=duration_from_seconds(7.25), sample_period=0.125
    )
    points = check(response)
    assert points.times[-1] == 7.25
    steps = np.diff(points.times)
    assert 0.1 < steps.max() <= 0.125 + 1e-9


GEN3 = load_robot("gen3")
FROM, TO = np.array([[sign, 0.3, 0.0, 1.5, 0.0, 1.2, 0.0] for sign in (3.0, -3.0)])


def plan_gen3(graph, **fields):
    ends = {"start": joint_state(GEN3.joint_names, FROM), "goal": joint_state(GEN3.joint_names, TO)}
    return plan(graph, profile=PROFILES["ruckig"], **(ends | fields))


def test_continuous_joints_take_the_short_way_and_the_answer_says_so(graph):
    graph.start(TrajectoryPlannerNode, robot_description="gen3")
    turn = np.eye(7)[0]
    response = plan_gen3(graph)
    points = check(response, GEN3, FROM, TO + 2.0 * np.pi * turn)
    assert list(response.turns) == [1, 0, 0, 0, 0, 0, 0]
    assert np.ptp(points.positions[:, 0]) == pytest.approx(2.0 * np.pi - 6.0, abs=1e-9)
    # Each via point is reached by the short way from the one before.
    via = [JointTrajectoryPoint(positions=(TO + x * turn).tolist()) for x in (1.0, 3.0, 5.0)]
    response = plan_gen3(graph, via=via)
    points = check(response, GEN3, FROM, TO + 4.0 * np.pi * turn)
    assert response.turns[0] == 2
    assert points.positions[:, 0].max() == pytest.approx(4.0 * np.pi - 3.0, abs=1e-6)
    # Several turns, where the request wants them.
    far = TO + 4.0 * np.pi * turn
    goal = joint_state(GEN3.joint_names, far)
    points = check(plan_gen3(graph, goal=goal, keep_turns=True), GEN3, FROM, far)
    assert np.ptp(points.positions[:, 0]) > 6.0
    response = plan_gen3(graph, goal=goal)
    check(response, GEN3, FROM, far - 2.0 * np.pi * turn)
    assert response.turns[0] == -1


def test_joints_with_limits_keep_their_turn(puma):
    goal = START + [0.0, 0.0, 0.0, 0.0, 0.0, 4.0]
    response = plan(puma, goal=joint_state(PUMA.joint_names, goal))
    check(response, goal=goal)
    assert list(response.turns) == [0] * 6


def test_a_displacement_that_just_reaches_the_acceleration_limit_is_planned(graph):
    chain = load_robot("ur5e")
    graph.start(TrajectoryPlannerNode, robot_description="ur5e")
    start = np.array([0.46, 0.39, 0.88, -0.88, 0.38, 0.84])
    goal = np.array([0.5228318530717959, *start[1:]])
    ends = {
        "start": joint_state(chain.joint_names, start),
        "goal": joint_state(chain.joint_names, goal),
    }
    response = plan(graph, profile=PROFILES["ruckig"], **ends)
    points = check(response, chain, start, goal)
    assert points.times[-1] == pytest.approx(0.4, rel=1e-4)


VIA = np.array([[0.2, 0.1, -0.3, 0.9, 0.4, 0.2], [-0.6, 0.5, -1.2, 1.1, 0.3, 1.9]])


@pytest.mark.parametrize("name", ["poly345", "poly4567", "cubic_spline", "ruckig", "time_optimal"])
def test_via_points_are_passed(puma, name):
    via = [JointTrajectoryPoint(positions=point.tolist()) for point in VIA]
    points = check(plan(puma, profile=PROFILES[name], via=via))
    dense = points.curve.sample(np.linspace(0.0, points.times[-1], 20_000)).position
    for passed in VIA:
        assert np.abs(dense - passed).max(axis=1).min() < 2e-3


def test_via_points_are_passed_when_they_say(puma):
    via = [
        JointTrajectoryPoint(positions=point.tolist(), time_from_start=Duration(sec=second))
        for point, second in zip(VIA, (4, 9), strict=True)
    ]
    response = plan(
        puma, profile=PROFILES["cubic_spline"], via=via, duration=duration_from_seconds(12.0)
    )
    points = check(response)
    assert points.times[-1] == 12.0
    np.testing.assert_allclose(points.curve.sample([4.0, 9.0]).position, VIA, atol=1e-8)


def start_long_plan(graph):
    """Ask for a plan that takes seconds."""
    rng = np.random.default_rng(4)
    places = rng.uniform(PUMA.lower / 2.0, PUMA.upper / 2.0, (40, 6))
    request = PlanJoint.Request(
        start=joint_state(PUMA.joint_names, START),
        goal=joint_state(PUMA.joint_names, GOAL),
        via=[JointTrajectoryPoint(positions=point.tolist()) for point in places],
        profile=PROFILES["time_optimal"],
    )
    return graph.start_call(PlanJoint, "trajectory_planner/plan_joint", request)


def test_others_are_served_while_a_long_plan_is_made(graph):
    node = graph.start(TrajectoryPlannerNode, robot_description="puma560")
    published = []
    node._plans._trajectories.publish = lambda message: published.append(copy.deepcopy(message))
    slow = start_long_plan(graph)
    quick = [plan(graph, duration=duration_from_seconds(seconds)) for seconds in (7.0, 8.0)]
    assert not slow.done()
    assert [response.duration.sec for response in quick] == [7, 8]
    long = graph.wait_for(slow)
    assert long.error_code == ErrorCode.NONE
    # Messages are used again, and still every plan is published as it was answered.
    plan(graph)
    assert published[:3] == [response.trajectory for response in (*quick, long)]


def test_who_waits_for_a_plan_is_told_that_the_planner_ends(graph):
    graph.start(TrajectoryPlannerNode, robot_description="puma560")
    waiting = [start_long_plan(graph) for _ in range(2)]
    check(plan(graph))
    graph._spinners[0].stop()
    for response in map(graph.wait_for, waiting):
        assert response.error_code == ErrorCode.REJECTED
        assert response.error_msg == "the trajectory planner shuts down"
        assert not response.trajectory.points


def test_scales_are_parts_of_the_limits(puma, profile):
    full = plan(puma, profile=PROFILES[profile])
    response = plan(
        puma,
        profile=PROFILES[profile],
        velocity_scale=0.5,
        acceleration_scale=0.25,
        jerk_scale=0.125,
    )
    check(response)
    assert max(response.peak_velocity_ratio) <= 0.5
    assert max(response.peak_acceleration_ratio) <= 0.25
    assert max(response.peak_jerk_ratio) <= 0.125
    seconds = [seconds_from_duration(answer.duration, "") for answer in (full, response)]
    assert seconds[1] == pytest.approx(2.0 * seconds[0], rel=1e-3)


def test_names_in_any_order_and_without_names(puma):
    expected = plan(puma)
    check(expected)
    order = [3, 0, 5, 1, 4, 2]
    shuffled = joint_state([PUMA.joint_names[k] for k in order], GOAL[order])
    assert plan(puma, goal=shuffled) == expected
    assert plan(puma, goal=JointState(position=GOAL.tolist())) == expected
    assert plan(puma, start=JointState(position=START.tolist())) == expected


def test_a_motion_of_no_length(puma, profile):
    response = plan(puma, goal=joint_state(PUMA.joint_names, START), profile=PROFILES[profile])
    points = check(response, goal=START)
    assert len(points.times) >= 2
    assert points.times[-1] <= 0.01


@pytest.fixture
def publish(graph):
    """Publish a joint state of the PUMA 560 again and again, with these fields."""

    def start(positions, velocities=()):
        publisher = graph.client.create_publisher(JointState, "joint_states", 10)
        message = joint_state(PUMA.joint_names[::-1], np.array(positions)[::-1])
        message.velocity = list(velocities)[::-1]
        graph.client.create_timer(0.01, lambda: publisher.publish(message))
        return message

    return start


def plan_from_present(graph):
    """Plan from the present state as soon as it is known."""

    def known(response):
        return response.error_code != ErrorCode.NO_STATE or "nothing received" not in str(response)

    return graph.call_until(PlanJoint, "trajectory_planner/plan_joint", from_present(), known)


def from_present():
    return PlanJoint.Request(goal=joint_state(PUMA.joint_names, GOAL))


def test_an_empty_start_is_the_present_state(graph, publish):
    graph.start(TrajectoryPlannerNode, robot_description="puma560", state_timeout=0.0)
    response = plan(graph, start=JointState())
    assert response.error_code == ErrorCode.NO_STATE
    assert "waist" in response.error_msg
    publish(START)
    check(plan_from_present(graph))


def test_the_first_state_is_waited_for_and_others_are_served_meanwhile(graph, publish):
    graph.start(TrajectoryPlannerNode, robot_description="puma560", state_timeout=30.0)
    waiting = graph.start_call(PlanJoint, "trajectory_planner/plan_joint", from_present())
    check(plan(graph))
    assert not waiting.done()
    publish(START)
    check(graph.wait_for(waiting))


def test_a_state_that_never_comes_is_not_waited_for_longer_than_told(graph):
    graph.start(TrajectoryPlannerNode, robot_description="puma560", state_timeout=0.3)
    response = plan(graph, start=JointState())
    assert response.error_code == ErrorCode.NO_STATE
    assert "nothing received on '/joint_states'" in response.error_msg


def test_a_robot_about_to_stand_is_waited_for(graph, publish):
    graph.start(TrajectoryPlannerNode, robot_description="puma560", state_timeout=30.0)
    state = publish(START, np.full(6, 0.2))
    waiting = graph.start_call(PlanJoint, "trajectory_planner/plan_joint", from_present())
    check(plan(graph))
    assert not waiting.done()
    state.velocity = [0.0] * 6
    check(graph.wait_for(waiting))


def test_a_present_state_in_motion_is_refused(own_puma, publish):
    velocity = np.array([0.0, 0.002, -0.4, 0.1, 0.0, 0.0])
    state = publish(START, velocity)
    response = plan_from_present(own_puma)
    assert response.error_code == ErrorCode.NO_STATE
    assert "the robot moves: joint 'elbow' at 0.4 rad/s, at rest is up to 0.01 rad/s" in str(
        response
    )
    assert not response.trajectory.points
    # A start that the request names is taken as it is; and at last the robot stands.
    check(plan(own_puma))
    state.velocity = [0.009] * 6
    service = "trajectory_planner/plan_joint"
    check(
        own_puma.call_until(
            PlanJoint, service, from_present(), lambda answer: not answer.error_code
        )
    )


def test_velocities_of_no_use_count_as_rest(own_puma, publish):
    state = publish(START)
    check(plan_from_present(own_puma))
    state.velocity = [np.nan] * 6
    check(plan(own_puma, start=JointState()))


def test_plans_and_paths_are_published_and_latched(own_puma, profile):
    response = plan(own_puma, profile=PROFILES[profile])
    published = own_puma.receive(
        JointTrajectory, "trajectory_planner/planned_trajectory", LATCHED, lambda _: True
    )
    assert published == response.trajectory
    path = own_puma.receive(
        nav_msgs.msg.Path, "trajectory_planner/planned_path", LATCHED, lambda _: True
    )
    assert path.header.frame_id == PUMA.base
    points = waypoints(response.trajectory)
    assert len(path.poses) == len(points.times)
    poses = np.array([matrix_from_pose(stamped.pose) for stamped in path.poses])
    np.testing.assert_allclose(poses, forward_kinematics(PUMA, points.positions), atol=1e-12)
    assert {stamped.header.frame_id for stamped in path.poses} == {PUMA.base}


def test_who_listens_late_gets_the_path_of_the_latest_plan(puma):
    for goals in ([GOAL, START + 0.1], [START + 0.2]):
        for goal in goals:
            check(plan(puma, goal=joint_state(PUMA.joint_names, goal)), goal=goal)
        # Published after its answer, and so before another one.
        assert plan(puma, goal=JointState()).error_code == ErrorCode.WRONG_SIZE
        path = puma.receive(
            nav_msgs.msg.Path, "trajectory_planner/planned_path", LATCHED, lambda _: True
        )
        end = matrix_from_pose(path.poses[-1].pose)
        np.testing.assert_allclose(end, forward_kinematics(PUMA, goals[-1]), atol=1e-9)


def test_the_same_request_twice_gives_the_same_answer(puma, profile):
    assert plan(puma, profile=PROFILES[profile]) == plan(puma, profile=PROFILES[profile])


@pytest.mark.parametrize("robot", ["ur5e", "panda", "stanford", "scara", "planar3r"])
def test_other_robots(graph, robot, profile):
    chain = load_robot(robot)
    graph.start(TrajectoryPlannerNode, robot_description=robot)
    middle = chain.midrange()
    start = np.clip(middle - 0.4, chain.lower, chain.upper)
    goal = np.clip(middle + 0.6, chain.lower, chain.upper)
    response = graph.call(
        PlanJoint,
        "trajectory_planner/plan_joint",
        PlanJoint.Request(
            start=joint_state(chain.joint_names, start),
            goal=joint_state(chain.joint_names, goal),
            profile=PROFILES[profile],
        ),
    )
    check(response, chain, start, goal)


def test_the_robot_may_come_from_the_latched_topic(graph):
    graph.start(TrajectoryPlannerNode)
    assert not graph.client.create_client(
        PlanJoint, "trajectory_planner/plan_joint"
    ).wait_for_service(0.1)
    publisher = graph.client.create_publisher(String, "robot_description", LATCHED)
    with open(load_description("ur5e").where, encoding="utf-8") as file:
        publisher.publish(String(data=file.read()))
    response = plan_ur5e(graph)
    # A URDF has no acceleration limits.
    assert response.error_code == ErrorCode.MISSING_LIMITS
    assert load_robot("ur5e").joint_names[0] in response.error_msg
    assert "parameter joint_limits may name a file" in response.error_msg


def plan_ur5e(graph, profile=PlanJoint.Request.RUCKIG):
    return graph.call(
        PlanJoint,
        "trajectory_planner/plan_joint",
        PlanJoint.Request(
            start=JointState(position=[0.0] * 6),
            goal=JointState(position=[1.0] * 6),
            profile=profile,
        ),
    )


MOVEIT = """
default_velocity_scaling_factor: 0.1
joint_limits:
"""
MOVEIT_JOINT = """
  {}:
    has_velocity_limits: true
    max_velocity: 1.5
    has_acceleration_limits: true
    max_acceleration: 2
    has_jerk_limits: true
    max_jerk: 20.0
"""


@pytest.mark.parametrize("form", ["moveit", "beside"])
def test_limits_that_a_urdf_lacks_come_from_a_file(graph, tmp_path, form):
    urdf = Path(load_description("ur5e").where)
    chain = load_robot("ur5e")
    file = tmp_path / "joint_limits.yaml"
    if form == "beside":
        file.write_bytes(urdf.with_suffix(".yaml").read_bytes())
    else:
        joints = "".join(MOVEIT_JOINT.format(name) for name in chain.joint_names)
        file.write_text(MOVEIT + joints, encoding="utf-8")
        fill = dict.fromkeys(("velocity", "acceleration", "jerk"), np.full(6, 1.0))
        values = {"velocity": 1.5, "acceleration": 2.0, "jerk": 20.0}
        chain = dataclasses.replace(chain, **{k: values[k] * fill[k] for k in values})
    graph.start(TrajectoryPlannerNode, joint_limits=str(file))
    publisher = graph.client.create_publisher(String, "robot_description", LATCHED)
    publisher.publish(String(data=urdf.read_text(encoding="utf-8")))
    points = check(plan_ur5e(graph), chain, np.zeros(6), np.ones(6))
    fastest = point_to_point(np.zeros(6), np.ones(6), limits=chain, profile="ruckig")
    assert points.times[-1] == pytest.approx(fastest.duration, rel=1e-4)


@pytest.mark.parametrize(("seconds", "profile"), [(101.0, "poly345"), (3600.0, "ruckig")])
def test_a_long_duration_makes_the_default_period_longer(puma, seconds, profile):
    duration = duration_from_seconds(seconds)
    points = check(plan(puma, duration=duration, profile=PROFILES[profile]))
    assert points.times[-1] == seconds
    assert 1000 < len(points.times) <= 10_000


def test_small_scales_make_the_default_period_longer(puma, profile):
    response = plan(puma, velocity_scale=0.005, profile=PROFILES[profile])
    points = check(response)
    assert points.times[-1] > 100.0
    assert max(response.peak_velocity_ratio) == pytest.approx(0.005, rel=1e-3)


def test_period_and_number_of_points_are_parameters(graph):
    graph.start(
        TrajectoryPlannerNode, robot_description="puma560", sample_period=0.1, max_points=50
    )
    points = check(plan(graph))
    assert 0.05 < np.diff(points.times).max() <= 0.1
    response = plan(graph, sample_period=0.01)
    assert response.error_code == ErrorCode.BAD_VALUE
    assert "may have 50 points" in response.error_msg


def test_a_margin_below_the_limits_is_kept_by_every_plan(graph):
    """RUCKIG at full speed takes a joint to its limit, where samples are over it by rounding."""
    graph.start(TrajectoryPlannerNode, robot_description="puma560", limit_margin=0.01)
    response = plan(graph, profile=PROFILES["ruckig"])
    check(response)
    assert max(response.peak_velocity_ratio) <= 0.99
    assert max(response.peak_acceleration_ratio) <= 0.99
    assert max(response.peak_jerk_ratio) <= 0.99
    assert max(*response.peak_velocity_ratio, *response.peak_jerk_ratio) > 0.98
