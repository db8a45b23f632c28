"""The trajectory planner: every bad request with its code and text, and the node still serving."""

import math

import numpy as np
import pytest
from builtin_interfaces.msg import Duration
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectoryPoint

from robomech_interfaces.msg import ErrorCode
from robomech_interfaces.srv import PlanJoint
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.parameters import ParameterError
from robomech_ros.nodes.trajectory_planner.node import TrajectoryPlannerNode
from robomech_ros.robots import load_robot

PUMA = load_robot("puma560")
START = np.array([0.3, -0.4, 0.2, 0.5, 0.6, -0.7])
GOAL = np.array([-1.2, 0.8, -1.5, 1.5, -0.4, 2.7])
NAMES = list(PUMA.joint_names)
RUCKIG = PlanJoint.Request.RUCKIG

UNLIMITED_URDF = """<robot name="bare">
  <link name="base"/><link name="arm"/><link name="tip"/>
  <joint name="lift" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
  <joint name="swing" type="continuous"><parent link="arm"/><child link="tip"/>
    <axis xyz="1 0 0"/><origin xyz="0.5 0 0"/></joint>
</robot>"""


def request(**fields):
    values = {"start": joint_state(NAMES, START), "goal": joint_state(NAMES, GOAL)} | fields
    return PlanJoint.Request(**values)


def plan(graph, message):
    return graph.call(PlanJoint, "trajectory_planner/plan_joint", message)


def named(names, values):
    return JointState(name=list(names), position=list(values))


def replaced(values, k, value):
    changed = values.copy()
    changed[k] = value
    return joint_state(NAMES, changed)


def at(seconds):
    return JointTrajectoryPoint(positions=[0.1] * 6, time_from_start=Duration(sec=seconds))


CASES = {
    "goal without joints": (
        {"goal": JointState()},
        ErrorCode.WRONG_SIZE,
        ["goal.position", "size 0", "waist"],
    ),
    "goal with too few positions": (
        {"goal": JointState(position=[0.0] * 5)},
        ErrorCode.WRONG_SIZE,
        ["goal.position", "size 5", "expected 6"],
    ),
    "goal with more names than positions": (
        {"goal": named(NAMES, [0.0] * 5)},
        ErrorCode.WRONG_SIZE,
        ["goal.position", "one for every name"],
    ),
    "goal that names a joint twice": (
        {"goal": named([*NAMES[:5], NAMES[0]], [0.0] * 6)},
        ErrorCode.WRONG_SIZE,
        ["goal.name", "'waist' is repeated"],
    ),
    "goal that lacks a joint": (
        {"goal": named(NAMES[1:], [0.0] * 5)},
        ErrorCode.WRONG_SIZE,
        ["goal.name", "missing: waist"],
    ),
    "goal with an unknown joint": (
        {"goal": named([*NAMES[:5], "wrist_swivle"], [0.0] * 6)},
        ErrorCode.UNKNOWN_JOINT,
        ["wrist_swivle", "did you mean 'wrist_swivel'"],
    ),
    "goal that is not a number": (
        {"goal": replaced(GOAL, 2, math.nan)},
        ErrorCode.NON_FINITE,
        ["goal of joint 'elbow'", "nan"],
    ),
    "goal that is infinite": (
        {"goal": replaced(GOAL, 2, math.inf)},
        ErrorCode.NON_FINITE,
        ["goal of joint 'elbow'", "inf"],
    ),
    "start with too many positions": (
        {"start": JointState(position=[0.0] * 7)},
        ErrorCode.WRONG_SIZE,
        ["start.position", "size 7", "expected 6"],
    ),
    "start that is not a number": (
        {"start": replaced(START, 0, math.nan)},
        ErrorCode.NON_FINITE,
        ["start of joint 'waist'", "nan"],
    ),
    "start with an unknown joint": (
        {"start": named([*NAMES[:5], "seventh"], [0.0] * 6)},
        ErrorCode.UNKNOWN_JOINT,
        ["seventh"],
    ),
    "no start and no present state": (
        {"start": JointState()},
        ErrorCode.NO_STATE,
        ["waist", "joint_states"],
    ),
    "start outside its limits": (
        {"start": replaced(START, 1, -1.0)},
        ErrorCode.SEED_OUTSIDE_LIMITS,
        ["start of joint 'shoulder' is -1 rad,", "by 0.215 rad"],
    ),
    "goal outside its limits": (
        {"goal": replaced(GOAL, 2, 1.0)},
        ErrorCode.LIMIT,
        ["goal position of joint 'elbow' is 1 rad,", "limit 0.785398163 rad", "by 0.215 rad"],
    ),
    "via points of a profile that takes none": (
        {"via": [JointTrajectoryPoint(positions=[0.0] * 6)], "profile": 2},
        ErrorCode.BAD_VALUE,
        ["via is '1 point'", "none for CYCLOIDAL; POLY345, POLY4567, CUBIC_SPLINE, RUCKIG"],
    ),
    "too many via points": (
        {"via": [JointTrajectoryPoint(positions=[0.1] * 6)] * 3},
        ErrorCode.BAD_VALUE,
        ["via is '3 points'", "at most 2 points for POLY345", "RUCKIG, TIME_OPTIMAL take more"],
    ),
    "via points beyond number": (
        {"via": [JointTrajectoryPoint(positions=[0.1] * 6)] * 201, "profile": 4},
        ErrorCode.WRONG_SIZE,
        ["via", "201", "at most 200, the parameter max_waypoints"],
    ),
    "via point of another size": (
        {"via": [JointTrajectoryPoint(positions=[0.0] * 5)]},
        ErrorCode.WRONG_SIZE,
        ["via[0].positions", "5", "6"],
    ),
    "via point that is no number": (
        {"via": [JointTrajectoryPoint(positions=[math.nan] * 6)]},
        ErrorCode.NON_FINITE,
        ["via[0].positions"],
    ),
    "via point outside the limits": (
        {"via": [JointTrajectoryPoint(positions=[0.0, 0.0, 9.0, 0.0, 0.0, 0.0])]},
        ErrorCode.LIMIT,
        ["via[0].positions", "elbow", "9"],
    ),
    "via point with velocities": (
        {"via": [JointTrajectoryPoint(positions=[0.0] * 6, velocities=[0.0] * 6)]},
        ErrorCode.BAD_VALUE,
        ["via[0].velocities", "none"],
    ),
    "instant of a via point without a duration": (
        {"via": [JointTrajectoryPoint(positions=[0.0] * 6, time_from_start=Duration(sec=1))]},
        ErrorCode.BAD_VALUE,
        ["via[0].time_from_start", "duration"],
    ),
    "instants of via points that do not increase": (
        {"via": [at(2), at(1)], "profile": 3, "duration": Duration(sec=9)},
        ErrorCode.BAD_VALUE,
        ["via[1].time_from_start is 1.0", "more than 2 s and less than the duration, 9 s"],
    ),
    "instant of one of two via points": (
        {"via": [at(0), at(1)], "profile": 3, "duration": Duration(sec=9)},
        ErrorCode.BAD_VALUE,
        ["via[0].time_from_start is 0.0", "more than 0 s", "or 0 at all via points"],
    ),
    "instant of a via point after the end": (
        {"via": [at(10)], "duration": Duration(sec=9)},
        ErrorCode.BAD_VALUE,
        ["via[0].time_from_start is 10.0", "less than the duration, 9 s"],
    ),
    "instant of a via point for ruckig": (
        {"via": [at(1)], "duration": Duration(sec=9), "profile": RUCKIG},
        ErrorCode.BAD_VALUE,
        ["via[0].time_from_start is 1.0", "0: RUCKIG finds the instants itself"],
    ),
    "goal beyond all sense": (
        {"goal": replaced(GOAL, 5, 1e300)},
        ErrorCode.LIMIT,
        ["goal position of joint 'wrist_swivel'", "1e+300"],
    ),
    "negative duration": (
        {"duration": Duration(sec=-1)},
        ErrorCode.BAD_VALUE,
        ["duration is -1.0"],
    ),
    "duration too short": (
        {"duration": Duration(nanosec=100_000_000)},
        ErrorCode.LIMIT,
        ["duration of 0.1 s is too short", "velocity limit of joint", "shortest possible"],
    ),
    "duration too short for ruckig": (
        {"duration": Duration(nanosec=100_000_000), "profile": RUCKIG},
        ErrorCode.LIMIT,
        ["duration of 0.1 s is too short", "limit of joint", "shortest possible"],
    ),
    "duration too long": (
        {"duration": Duration(sec=3601)},
        ErrorCode.BAD_VALUE,
        ["duration is 3601.0, expected at most 3600 s, the parameter max_duration"],
    ),
    "scale too small for any duration": (
        {"velocity_scale": 1e-6},
        ErrorCode.BAD_VALUE,
        ["shortest duration within the scaled limits is 1593750.0", "at most 3600 s"],
    ),
    "scale below the least one": (
        {"jerk_scale": 1e-7},
        ErrorCode.BAD_VALUE,
        ["jerk_scale is 1e-07", "at least 1e-06 and at most 1"],
    ),
    "negative scale": (
        {"velocity_scale": -0.5},
        ErrorCode.BAD_VALUE,
        ["velocity_scale is -0.5", "at least 1e-06 and at most 1"],
    ),
    "scale above one": (
        {"acceleration_scale": 1.5, "profile": RUCKIG},
        ErrorCode.BAD_VALUE,
        ["acceleration_scale is 1.5", "at least 1e-06 and at most 1"],
    ),
    "scale that is not a number": (
        {"jerk_scale": math.nan},
        ErrorCode.NON_FINITE,
        ["jerk_scale is nan"],
    ),
    "negative period": ({"sample_period": -0.01}, ErrorCode.BAD_VALUE, ["sample_period is -0.01"]),
    "period of nothing": (
        {"sample_period": 1e-9},
        ErrorCode.BAD_VALUE,
        ["sample_period is 1e-09", "at least 0.0001 s"],
    ),
    "infinite period": ({"sample_period": math.inf}, ErrorCode.NON_FINITE, ["sample_period"]),
    "too many points": (
        {"velocity_scale": 0.01, "sample_period": 0.01},
        ErrorCode.BAD_VALUE,
        ["sample_period is 0.01", "at least", "may have 10000 points"],
    ),
} | {
    f"profile {number}": (
        {"profile": number},
        ErrorCode.BAD_VALUE,
        [f"{number}", "one of POLY345 (0), POLY4567 (1), ", "TIME_OPTIMAL (5)"],
    )
    for number in (6, 255)
}


def test_every_bad_request_is_refused_and_the_node_goes_on_serving(graph):
    graph.start(TrajectoryPlannerNode, robot_description="puma560")
    good = plan(graph, request())
    assert good.error_code == ErrorCode.NONE
    for name, (fields, code, parts) in CASES.items():
        response = plan(graph, request(**fields))
        assert response.error_code == code, (name, response.error_code, response.error_msg)
        for part in parts:
            assert part in response.error_msg, (name, response.error_msg)
        assert not response.trajectory.points, name
    assert plan(graph, request()) == good


def test_refused_requests_publish_nothing(graph):
    node = graph.start(TrajectoryPlannerNode, robot_description="puma560")
    published = []
    node._plans._trajectories.publish = published.append
    assert plan(graph, request(goal=JointState())).error_code == ErrorCode.WRONG_SIZE
    assert plan(graph, request()).error_code == ErrorCode.NONE
    assert plan(graph, request(profile=9)).error_code == ErrorCode.BAD_VALUE
    assert len(published) == 1


def test_positions_beyond_all_sense_are_named_where_there_is_no_limit(graph):
    graph.start(TrajectoryPlannerNode, robot_description=UNLIMITED_URDF)
    good, bad = [0.0, 0.0], [0.0, -1e300]
    for what, fields in {
        "start": {"start": JointState(position=bad), "goal": JointState(position=good)},
        "goal": {"start": JointState(position=good), "goal": JointState(position=bad)},
        "via[0].positions": {
            "start": JointState(position=good),
            "goal": JointState(position=good),
            "via": [JointTrajectoryPoint(positions=bad)],
        },
    }.items():
        response = plan(graph, PlanJoint.Request(**fields))
        assert response.error_code == ErrorCode.BAD_VALUE
        text = f"{what} of joint 'swing' is -1e+300, expected a magnitude of at most 1e+06"
        assert response.error_msg == text


def test_missing_limits_are_named(graph):
    graph.start(TrajectoryPlannerNode, robot_description=UNLIMITED_URDF)
    move = {"start": JointState(position=[0.0, 0.0]), "goal": JointState(position=[0.5, 0.5])}
    for profile in (PlanJoint.Request.POLY345, RUCKIG):
        response = plan(graph, PlanJoint.Request(**move, profile=profile))
        assert response.error_code == ErrorCode.MISSING_LIMITS
        assert response.error_msg == (
            "no velocity limit for joint swing; the planner's parameter joint_limits may name a "
            "file that gives it"
        )


@pytest.mark.parametrize("assumed", [False, True])
def test_accelerations_that_nobody_gives_are_assumed_only_where_the_parameter_says_so(
    graph, assumed, capfd
):
    urdf = UNLIMITED_URDF.replace('"0.5 0 0"/>', '"0.5 0 0"/><limit velocity="2" effort="1"/>')
    graph.start(TrajectoryPlannerNode, robot_description=urdf, assume_limits=assumed)
    move = {"start": JointState(position=[0.0, 0.0]), "goal": JointState(position=[0.5, 0.5])}
    for profile in (PlanJoint.Request.POLY345, RUCKIG):
        response = plan(graph, PlanJoint.Request(**move, profile=profile))
        assert response.error_code == (0 if assumed else ErrorCode.MISSING_LIMITS)
        if assumed:
            assert max(response.peak_acceleration_ratio) <= 1.0 + 1e-9
            points = response.trajectory.points
            assert max(abs(point.accelerations[0]) for point in points) <= 4.0 + 1e-9
    said = capfd.readouterr().err
    assert said.count("--joint-limits") == said.count("max_acceleration: 4.0") == assumed
    assert said.count("swing: {has_acceleration_limits: true, max_acceleration: 8.0") == assumed


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("sample_period", 0.0),
        ("sample_period", 100.0),
        ("max_points", 1),
        ("joint_limits", "no.yaml"),
    ],
)
def test_parameters_out_of_range_are_refused_at_start(graph, name, value):
    with pytest.raises(ParameterError, match=f"parameter '{name}' is {value!r}; allowed is"):
        graph.start(TrajectoryPlannerNode, robot_description="puma560", **{name: value})


def test_an_unknown_robot_is_refused_at_start(graph):
    with pytest.raises(ValueError, match="no_such_robot"):
        graph.start(TrajectoryPlannerNode, robot_description="no_such_robot")
