"""Motions along paths of a platform: on the path, within all limits, in one assembly mode."""

import numpy as np
import pytest
from rated import moved, rated

from robomech_ros.cartesian import PathStopLimits, waypoint_path
from robomech_ros.errors import BadValueError, MissingLimitsError, NonFiniteError, WrongSizeError
from robomech_ros.parallel import follow_drives, load_parallel, plan_platform
from robomech_ros.spatial import matrix_from_rotation_vector, pose_error
from robomech_ros.trajectory import PATH_PROFILES, PathTrackingStatus

# Of each robot: turn and way of its platform (rad, m) from home, all of which it can follow.
MOVES = {
    "hexapod": ((0.1, -0.05, 0.08), (0.04, 0.03, 0.08)),
    "sgp_6_3": ((0.05, 0.02, 0.1), (0.02, 0.01, 0.05)),
    "delta": ((0.0, 0.0, 0.0), (0.1, 0.2, 0.1)),
    "planar_3rrr": ((0.0, 0.0, 0.5), (0.1, 0.0, 0.0)),
    "planar_3rpr": ((0.0, 0.0, 0.02), (0.5, 0.0, 0.0)),
    "agile_eye": ((0.1, 0.2, 0.5), (0.0, 0.0, 0.0)),
}


def planned(name, turn, way, **options):
    mechanism = load_parallel(name).mechanism
    home = mechanism.home()
    here = mechanism.pose(home)
    path = waypoint_path(here, [moved(here, turn, way)])
    options = {"limits": rated(mechanism), **options}
    return mechanism, path, plan_platform(mechanism, path, home, **options)


def test_a_path_ends_where_a_joint_leaves_its_cone():
    # Here each of its two axes stays within the angle of the cone, but not both together.
    robot = load_parallel("hexapod")
    mechanism = robot.mechanism
    here = mechanism.pose(mechanism.home())
    there = moved(here, way=(0.043, 0.092, 0.009))
    there[:3, :3] = matrix_from_rotation_vector([0.348, 0.253, -0.398]) @ here[:3, :3]
    path = waypoint_path(here, [there])
    plan = plan_platform(mechanism, path, mechanism.home())
    assert robot.cone_excess(there).max() > 0.1
    assert 0.2 < plan.fraction < 1.0
    assert plan.stop.kind is PathTrackingStatus.LIMIT and plan.stop.joint in mechanism.passive
    assert "would leave its limits" in plan.stop.text
    assert "0.123 rad outside its limits" in plan.stop.text
    joints = plan.followed.joints
    poses = mechanism.pose(joints.derivatives(np.linspace(0.0, joints.length, 200))[0])
    assert robot.cone_excess(poses).max() <= 1e-6


def drives_of(plan, times):
    """Positions and rates of the drives on the curve between samples, (3, m, drives)."""
    return list(plan.samples.curve.sample(times)[:3])


@pytest.mark.parametrize("name", MOVES)
@pytest.mark.parametrize("profile", PATH_PROFILES)
def test_the_curve_through_the_samples_keeps_path_and_limits(name, profile):
    mechanism, path, plan = planned(name, *MOVES[name], profile=profile)
    assert (plan.fraction, plan.stop) == (1.0, None)
    times = np.linspace(0.0, plan.trajectory.duration, 701)
    positions, velocities, accelerations = drives_of(plan, times)
    assert np.abs(velocities).max() <= 1.0 + 1e-9
    assert np.abs(accelerations).max() <= 5.0 * (1.0 + 1e-9)
    followed = follow_drives(mechanism, positions, plan.followed.start)
    assert followed.stop is None
    assert mechanism.loop_errors(followed.q).max() < 1e-10
    assert (followed.q >= mechanism.lower - 1e-9).all()
    assert (followed.q <= mechanism.upper + 1e-9).all()
    poses = mechanism.pose(followed.q)
    # The nearest place of the path: along it a length and an angle grow together.
    s = np.linspace(0.0, path.length, 20_001)
    there = path.sample(s).pose
    for pose in poses[::140]:
        apart = np.linalg.norm(pose_error(pose, there), axis=1)
        assert apart.min() <= path.length / 20_000.0 * 10.0
    ends = pose_error(path.sample(np.array([0.0, path.length])).pose, poses[[0, -1]])
    assert np.abs(ends).max() < 1e-7
    assert np.abs(velocities[[0, -1]]).max() < 1e-12


def test_all_poses_on_the_way_are_proved_to_be_one_assembly_mode():
    robot = load_parallel("hexapod")
    mechanism, _, plan = planned("hexapod", *MOVES["hexapod"])
    lengths = plan.samples.positions
    pose = mechanism.pose(plan.followed.start)
    for row in lengths[::8]:
        followed = robot.follow(row, pose)
        assert followed.certified
        pose = followed.pose
    last = robot.follow(lengths[-1], pose).pose
    assert np.abs(pose_error(plan.followed.path.waypoints[-1], last)).max() < 1e-7


def test_a_stroke_ends_the_path_and_leg_and_amount_are_named():
    mechanism, _, plan = planned("hexapod", (0.0, 0.0, 0.0), (0.0, 0.0, 0.8))
    assert plan.stop.kind is PathTrackingStatus.LIMIT
    assert plan.stop.joint in mechanism.actuated
    assert plan.stop.joint in plan.stop.text
    longest = load_parallel("hexapod").inverse(plan.followed.path.waypoints[0]).max()
    assert f"{longest - 0.95:.3g} m" in plan.stop.text
    assert plan.samples.positions.max() == pytest.approx(0.95, abs=1e-8)
    assert 0.4 < plan.fraction < 0.5


def test_the_limb_that_does_not_reach_is_named_with_the_amount():
    robot = load_parallel("delta")
    _, _, plan = planned("delta", (0.0, 0.0, 0.0), (0.0, 0.0, -0.9))
    assert plan.stop.kind is PathTrackingStatus.LOST
    missed = robot.inverse(plan.followed.path.waypoints[0]).excess.max()
    assert f"{missed:.3g} m" in plan.stop.text
    assert "limb" in plan.stop.text


@pytest.mark.parametrize("condition", [200.0, np.inf])
def test_no_platform_passes_a_singularity(condition):
    turn, way = (0.0, 0.0, 0.5), (2.0, 0.0, 0.0)
    bounds = PathStopLimits(condition=condition)
    _, path, plan = planned("planar_3rpr", turn, way, bounds=bounds)
    assert plan.stop.kind is PathTrackingStatus.SINGULAR
    assert "hardly hold the platform against a turn about z" in plan.stop.text
    # An oracle that knows no joints: the determinant of the legs' lines changes its sign beyond.
    robot, s = load_parallel("planar_3rpr"), path.length * np.linspace(0.0, 1.0, 2001)
    signs = np.sign([np.linalg.det(lines(robot, path.sample(one).pose)) for one in s])
    crossed = s[np.flatnonzero(signs != signs[0])[0]]
    reached = plan.followed.joints.length
    assert reached < crossed
    assert reached > 0.8 * crossed
    assert plan.samples is not None


def lines(robot, T):
    """Plücker coordinates of the legs in the plane."""
    points = robot.platform_points @ T[:2, :2].T + T[:2, 3]
    along = points - robot.base_points
    moment = points[:, 0] * along[:, 1] - points[:, 1] * along[:, 0]
    return np.column_stack([along, moment])


def test_the_waypoint_on_whose_way_it_stops_is_told():
    mechanism = load_parallel("hexapod").mechanism
    home = mechanism.home()
    here = mechanism.pose(home)
    poses = [moved(here, way=(0.0, 0.0, z)) for z in (0.05, 0.1, 0.8)]
    plan = plan_platform(mechanism, waypoint_path(here, poses), home, limits=rated(mechanism))
    assert plan.stop.index == 2
    assert "waypoints[2]" in plan.stop.text


def test_cones_of_passive_joints_end_a_path():
    mechanism = load_parallel("hexapod").mechanism
    joint = mechanism.joint_names.index("leg2_base_x")
    turn, way = MOVES["hexapod"]
    _, _, free = planned("hexapod", turn, way)
    end = free.followed.joints.derivatives(free.followed.joints.length)[0][joint]
    half = 0.5 * abs(end - mechanism.home()[joint])
    lower, upper = mechanism.lower.copy(), mechanism.upper.copy()
    lower[joint], upper[joint] = mechanism.home()[joint] - half, mechanism.home()[joint] + half
    _, _, plan = planned("hexapod", turn, way, limits=rated(mechanism, lower=lower, upper=upper))
    assert (plan.stop.kind, plan.stop.joint) == (PathTrackingStatus.LIMIT, "leg2_base_x")
    assert 0.0 < plan.fraction < 1.0


def test_rates_of_passive_joints_slow_a_motion_down():
    mechanism = load_parallel("delta").mechanism
    turn, way = MOVES["delta"]
    limits = rated(mechanism)
    _, _, free = planned("delta", turn, way)
    joint = mechanism.joint_names.index("leg2_elbow_tilt")
    velocity, acceleration = limits.velocity.copy(), limits.acceleration.copy()
    velocity[joint], acceleration[joint] = 0.1, 0.5
    held = rated(mechanism, velocity=velocity, acceleration=acceleration)
    _, _, plan = planned("delta", turn, way, limits=held)
    assert plan.trajectory.duration > free.trajectory.duration
    times = np.linspace(0.0, plan.trajectory.duration, 501)
    positions, velocities, accelerations = drives_of(plan, times)
    q = follow_drives(mechanism, positions, plan.followed.start).q
    qd, _ = mechanism.rates(q, velocities)
    qdd, _ = mechanism.accelerations(q, qd, accelerations)
    assert np.abs(qd[:, joint]).max() <= 0.1 * (1.0 + 1e-3)
    assert np.abs(qdd[:, joint]).max() <= 0.5 * (1.0 + 1e-3)


@pytest.mark.parametrize(
    ("name", "turn", "way", "text"),
    [
        ("delta", (0.0, 0.1, 0.0), (0.0, 0.0, 0.0), "a turn about y"),
        ("planar_3rrr", (0.0, 0.0, 0.0), (0.01, 0.0, 0.02), "a move along z"),
        ("agile_eye", (0.0, 0.1, 0.0), (0.0, 0.01, 0.0), "a move along y"),
    ],
)
def test_paths_outside_the_freedoms_of_the_platform_are_refused(name, turn, way, text):
    with pytest.raises(BadValueError, match=rf"'{name}' is '?{text}"):
        planned(name, turn, way)


def test_wrong_requests_say_what_is_wrong():
    mechanism = load_parallel("hexapod").mechanism
    home = mechanism.home()
    here = mechanism.pose(home)
    path = waypoint_path(here, [moved(here, way=(0.0, 0.0, 0.05))])
    apart = home.copy()
    apart[mechanism.joint_names.index("leg3_length")] += 1e-3
    for start, kind, text in (
        (apart, BadValueError, "limb 3"),
        (home[:6], WrongSizeError, "start"),
        (home * np.nan, NonFiniteError, "start"),
    ):
        with pytest.raises(kind, match=text):
            plan_platform(mechanism, path, start, limits=rated(mechanism))
    with pytest.raises(BadValueError, match="a PosePath"):
        plan_platform(mechanism, None, home, limits=rated(mechanism))
    with pytest.raises(BadValueError, match="a Mechanism"):
        plan_platform(load_parallel("hexapod"), path, home)
    slow = rated(mechanism, velocity=np.full(mechanism.n, np.inf))
    with pytest.raises(MissingLimitsError, match="leg1_length"):
        plan_platform(mechanism, path, home, limits=slow)
