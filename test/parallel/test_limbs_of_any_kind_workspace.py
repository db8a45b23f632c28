"""Poses and workspaces of mechanisms, and rates of their matrices, against closed forms."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from robomech_ros.errors import RobomechError
from robomech_ros.parallel import (
    Mechanism,
    list_parallel,
    load_parallel,
    platform_acceleration,
    platform_orientation_workspace,
    platform_position_workspace,
    platform_twist,
    pose_limits,
    velocity_matrices,
    velocity_matrix_rates,
)
from robomech_ros.spatial import matrix_from_rotation_vector

LINAPOD, TRIPOD = load_parallel("linapod"), load_parallel("tripod_3prs")
ROBOTS = Path(__file__).parents[2] / "config" / "robots" / "parallel"


def mechanism_of(name):
    robot = load_parallel(name)
    return robot if isinstance(robot, Mechanism) else robot.mechanism


def home_pose(mechanism):
    return mechanism.pose(mechanism.home())


@pytest.mark.parametrize("name", list_parallel())
def test_rates_of_the_matrices_balance_the_accelerations(name):
    """K dt + dK t = J qdd + dJ qd, whose accelerations are found without the rates."""
    rng, mechanism = np.random.default_rng(1), mechanism_of(name)
    home, driven = mechanism.home(), mechanism.drive_index
    steps = 0.02 * rng.uniform(-1.0, 1.0, (2, len(driven))) / mechanism.loops.weights[driven]
    q = np.array([mechanism.close(home[driven] + step, home).q for step in steps])
    T, rates, gains = mechanism.pose(q), *rng.normal(size=(2, 2, len(driven)))
    t = platform_twist(mechanism, T, rates, q)
    dt = platform_acceleration(mechanism, T, rates, gains, q)
    K, J, motions = velocity_matrices(mechanism, T, q)
    dK, dJ, same = velocity_matrix_rates(mechanism, T, t, q)
    assert motions == same
    one, other = (
        (A @ x[..., None] + B @ y[..., None])[..., 0]
        for A, x, B, y in ((K, dt, dK, t), (J, gains, dJ, rates))
    )
    np.testing.assert_allclose(one, other, atol=1e-9 * np.abs(K @ dt[..., None]).max())
    robot = load_parallel(name)
    if not isinstance(robot, Mechanism):
        closed = velocity_matrix_rates(robot, T, t, q[:, driven])
        rows = velocity_matrices(robot, T, q[:, driven]).K
        signs = np.sign((rows * K).sum(axis=-1))
        np.testing.assert_allclose(signs[..., None] * dK, closed.K, atol=1e-9 * np.abs(dK).max())


def test_rates_at_rest_are_zero_and_those_of_singular_limbs_are_none():
    q = TRIPOD.home()
    still = velocity_matrix_rates(TRIPOD, TRIPOD.pose(q), np.zeros(6), q)
    assert not still.K.any() and not still.J.any()
    moving = velocity_matrix_rates(TRIPOD, TRIPOD.pose(q), [0.0, 0.0, 0.0, 0.0, 0.0, 0.1], q)
    np.testing.assert_allclose(moving.K, 0.0, atol=1e-10)
    with pytest.raises(RobomechError, match="limbs prevent"):
        velocity_matrix_rates(TRIPOD, TRIPOD.pose(q), [0.0, 0.0, 0.0, 1.0, 0.0, 0.0], q)


def linapod_margins(T):
    """Return the margins of slides and joint cones of the linapod (rad or m)."""
    document = yaml.safe_load((ROBOTS / "linapod.yaml").read_text())
    begin = np.array(document["platform"]["xyz"])
    left = []
    for limb in document["limbs"]:
        slide, foot, ball = limb["joints"]
        rod = np.array(ball["point"]) - foot["point"]
        end = T[:3, :3] @ (np.array(ball["point"]) - begin) + T[:3, 3]
        across = end[:2] - foot["point"][:2]
        below = rod @ rod - across @ across
        if below < 0.0:
            return np.array([-1.0])
        now = np.array([*across, np.sqrt(below)])
        place = end[2] - now[2]
        left += [place - slide["lower"], slide["upper"] - place]
        turned = T[:3, :3] @ rod
        for joint, other in ((foot, rod), (ball, turned)):
            left.append(joint["cone"] - np.arccos(now @ other / (rod @ rod)))
    return np.array(left)


@pytest.mark.slow
def test_poses_of_rods_on_rails_are_judged_as_by_lines_between_points():
    rng, home = np.random.default_rng(2), home_pose(LINAPOD)
    poses = np.tile(home, (200, 1, 1))
    poses[:, :3, :3] = matrix_from_rotation_vector(rng.uniform(-0.6, 0.6, (200, 3)))
    poses[:, :3, 3] += rng.uniform(-0.3, 0.3, (200, 3))
    margins = np.array([linapod_margins(T).min() for T in poses])
    found = pose_limits(LINAPOD, poses)
    np.testing.assert_array_equal(found.inside, margins >= 0.0)
    assert 20 < found.inside.sum() < 180
    held = LINAPOD.pose(found.q[found.inside])
    np.testing.assert_allclose(held, poses[found.inside], atol=1e-9)
    assert np.isnan(found.q[~found.inside]).all()
    out = ~found.inside
    assert (np.char.find(found.cause[out], "limb ") == 0).all() and (found.excess[out] > 0.0).all()
    assert not found.cause[found.inside].any() and not found.excess[found.inside].any()


def test_a_mechanism_of_legs_is_judged_as_the_platform_on_legs():
    robot, rng = load_parallel("hexapod"), np.random.default_rng(4)
    mechanism, home = robot.mechanism, home_pose(robot.mechanism)
    poses = np.tile(home, (60, 1, 1))
    poses[:, :3, 3] += rng.uniform(-0.3, 0.3, (60, 3))
    one, other = pose_limits(robot, poses), pose_limits(mechanism, poses)
    np.testing.assert_array_equal(one.inside, other.inside)
    kept = one.inside
    np.testing.assert_allclose(other.q[kept][:, mechanism.drive_index], one.q[kept], atol=1e-9)
    for explore in (platform_position_workspace, platform_orientation_workspace):
        by_legs = explore(robot, home, directions=6)
        found = explore(mechanism, home, directions=6)
        np.testing.assert_allclose(found.distances, by_legs.distances, atol=1e-8)


@pytest.mark.parametrize("turns", [False, True])
def test_the_workspace_of_rods_on_rails_ends_where_a_limb_ends_it(turns):
    explore = platform_orientation_workspace if turns else platform_position_workspace
    space = explore(LINAPOD, home_pose(LINAPOD), directions=9)
    assert (space.distances > 0.2).all() and space.turns is turns
    for T, axis, cause in zip(space.poses, space.directions, space.causes, strict=True):
        assert abs(linapod_margins(T).min()) < 1e-8
        beyond = T.copy()
        if turns:
            beyond[:3, :3] = matrix_from_rotation_vector(1e-6 * axis) @ T[:3, :3]
        else:
            beyond[:3, 3] += 1e-6 * axis
        excluded = pose_limits(LINAPOD, beyond)
        assert not excluded.inside
        assert cause.startswith("limb ") and ": limits of leg" in cause
        # Of limbs that end it together, any one.
        assert excluded.excess < 1e-5


def test_a_tripod_goes_up_and_down_as_far_as_its_rails():
    space = platform_position_workspace(TRIPOD, home_pose(TRIPOD))
    np.testing.assert_allclose(space.directions, [[0, 0, 1], [0, 0, -1]], atol=1e-9)
    np.testing.assert_allclose(space.distances, 0.25, atol=1e-9)
    assert all(cause.endswith("_slide") for cause in space.causes)


def test_branches_of_limbs_are_followed_to_the_limit_of_a_drive():
    """A drive that would have to turn on past half a turn ends the way; it does not start anew."""
    robot = load_parallel("planar_3rrr")
    mechanism = robot.mechanism
    home = home_pose(mechanism)
    found = platform_orientation_workspace(mechanism, home)
    endless = platform_orientation_workspace(robot, home, branches="+++")
    assert endless.distances[0] > found.distances[0] + 1.0
    assert found.causes.tolist() == ["limb 2: limits of leg2_base", "type 2 singularity"]
    drives = robot.inverse(found.poses[0])
    row = drives.q[drives.branches.index("+++")]
    assert abs(row[1]) == pytest.approx(np.pi, abs=1e-9)
    np.testing.assert_allclose(found.distances[1], endless.distances[1], atol=1e-9)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda T: platform_orientation_workspace(TRIPOD, T), "'tripod_3prs'.*turns without"),
        (
            lambda T: platform_position_workspace(TRIPOD, T, directions=[[1.0, 0.0, 0.0]]),
            "along .*1.0",
        ),
        (lambda T: platform_position_workspace(TRIPOD, T, branches="+"), "nearest posture"),
        (lambda T: pose_limits(TRIPOD, T, branches="1"), "nearest posture"),
        (lambda T: pose_limits(TRIPOD, [1.0, 2.0]), "pose has shape"),
        (
            lambda T: platform_position_workspace(TRIPOD, T + np.diag([1.0], 3)),
            "not limb . by|not limb .: ",
        ),
        (
            lambda T: platform_position_workspace(mechanism_of("agile_eye"), np.eye(4)),
            "moves to places without turning",
        ),
    ],
)
def test_what_is_refused(call, said):
    with pytest.raises(RobomechError, match=said):
        call(home_pose(TRIPOD))
