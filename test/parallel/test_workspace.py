"""Positions and rotations of platforms, compared with inverse kinematics, pose by pose."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomech_ros.errors import RobomechError
from robomech_ros.parallel import (
    Delta,
    StewartGough,
    load_parallel,
    loop_singularity,
    platform_orientation_workspace,
    platform_position_workspace,
    pose_limits,
    singularity_distances,
)

HEXAPOD = load_parallel("hexapod")
CONED = StewartGough(
    HEXAPOD.base_points,
    HEXAPOD.platform_points,
    strokes=HEXAPOD.strokes,
    base_cones={"axes": [0.0, 0.0, 1.0], "angles": 1.1},
    platform_cones={"axes": [0.0, 0.0, -1.0], "angles": 1.1},
)
LIMITED = Delta(0.2, 0.05, 0.3, 0.8, limits=[-0.6, 1.2])
HOME = np.eye(4)
HOME[2, 3] = 0.6


def test_ten_thousand_poses_of_a_hexapod_are_judged_as_by_lengths_and_cones():
    rng = np.random.default_rng(1)
    poses = np.tile(HOME, (10_000, 1, 1))
    poses[:, :3, 3] += rng.uniform(-0.2, 0.2, size=(10_000, 3))
    turns = Rotation.from_rotvec(rng.normal(scale=0.2, size=(10_000, 3)))
    poses[:, :3, :3] = turns.as_matrix()
    found = pose_limits(CONED, poses)
    lengths = CONED.inverse(poses)
    over = CONED.excess(lengths)
    bent = CONED.cone_excess(poses)
    allowed = ~over.any(axis=1) & ~bent.any(axis=(1, 2))
    assert (found.inside == allowed).all() and 500 < allowed.sum() < 9_500
    assert ((found.cause == "") == allowed).all() and ((found.excess > 0.0) == ~allowed).all()
    kinds = {text.partition(": ")[2] for text in found.cause[~allowed]}
    assert kinds == {"too long", "too short", "base joint cone", "platform joint cone"}
    for k in np.flatnonzero(~allowed)[:200]:
        leg, _, kind = found.cause[k].partition(": ")
        leg = int(leg.removeprefix("leg ")) - 1
        length, (low, high) = lengths[k, leg], CONED.strokes[leg]
        amounts = {"too long": length - high, "too short": low - length}
        amounts |= {"base joint cone": bent[k, 0, leg], "platform joint cone": bent[k, 1, leg]}
        assert found.excess[k] == pytest.approx(amounts[kind], rel=1e-12)


@pytest.mark.parametrize("count", [1_000, pytest.param(10_000, marks=pytest.mark.long)])
def test_places_of_a_delta_are_judged_as_by_inverse_kinematics(count):
    rng = np.random.default_rng(2)
    places = rng.uniform([-0.8, -0.8, -1.1], [0.8, 0.8, 0.0], size=(count, 3))
    found, outward = pose_limits(LIMITED, places), pose_limits(LIMITED, places, branches="---")
    for place, inside, cause, own in zip(
        places, found.inside, found.cause, outward.inside, strict=True
    ):
        result = LIMITED.inverse(place)
        assert inside == (len(result) > 0) and (cause == "") == inside
        assert own == ("---" in result.branches)
    assert 0.02 * count < found.inside.sum() < 0.95 * count


def test_a_few_places_of_a_delta_are_judged_as_by_inverse_kinematics():
    rng = np.random.default_rng(3)
    places = rng.uniform([-0.8, -0.8, -1.1], [0.8, 0.8, 0.0], size=(400, 3))
    found = pose_limits(LIMITED, places, branches="-+-")
    for k, place in enumerate(places):
        result = LIMITED.inverse(place)
        assert found.inside[k] == ("-+-" in result.branches)
        if found.inside[k]:
            row = result.q[result.branches.index("-+-")]
            assert found.q[k] == pytest.approx(row, abs=1e-12)
        elif result.excess.any() and not len(result) and "reach" in found.cause[k]:
            assert found.excess[k] == pytest.approx(result.excess.max())
    assert {"joint limits", "out of reach"} <= {c.partition(": ")[2] for c in found.cause}


def check_ends(robot, space, mode=None, step=1e-6):
    """Poses just inside are allowed, and just outside excluded by what is said to end it."""
    for k, cause in enumerate(space.causes):
        for sign in (-1.0, 1.0):
            distance = space.distances[k] + sign * step
            T = space.centre.copy()
            if space.turns:
                turn = Rotation.from_rotvec(distance * space.directions[k]).as_matrix()
                T[:3, :3] = turn @ T[:3, :3]
            else:
                T[:3, 3] += distance * space.directions[k]
            found = pose_limits(robot, T, branches=mode)
            if sign < 0.0:
                assert found.inside, (k, found.cause)
            elif cause == "type 2 singularity":
                q = None if mode is None else found.q
                assert singularity_distances(robot, T, q, length=1.0)[1] < 1e-4
            elif cause:
                assert found.cause == cause and not found.inside


def test_places_of_a_hexapod_end_at_strokes_and_cones():
    space = platform_position_workspace(CONED, HOME, directions=100)
    assert space.directions.shape == (100, 3) and space.points.shape == (100, 3)
    assert np.linalg.norm(space.directions, axis=1) == pytest.approx(1.0)
    check_ends(CONED, space)
    shares = space.shares()
    assert sum(shares.values()) == pytest.approx(1.0) and "" not in shares
    assert any("too long" in cause for cause in shares)
    free = platform_position_workspace(HEXAPOD, HOME, directions=100)
    check_ends(HEXAPOD, free)
    assert any("too short" in cause for cause in free.shares())
    assert any("cone" in cause for cause in shares)
    # Straight up all legs end together, at a known height.
    up = platform_position_workspace(HEXAPOD, HOME, directions=[[0.0, 0.0, 3.0]])
    radial = HEXAPOD.base_points[0] - HEXAPOD.platform_points[0]
    height = np.sqrt(HEXAPOD.strokes[0, 1] ** 2 - radial @ radial)
    assert HOME[2, 3] + up.distances[0] == pytest.approx(height, abs=1e-6)


def test_turns_of_a_platform_end_where_legs_do_not_hold_it():
    free = StewartGough(HEXAPOD.base_points, HEXAPOD.platform_points)
    space = platform_orientation_workspace(free, HOME, directions=40)
    assert space.turns and (space.causes == "type 2 singularity").any()
    check_ends(free, space)
    limited = platform_orientation_workspace(HEXAPOD, HOME, directions=40)
    check_ends(HEXAPOD, limited)
    assert (limited.distances <= space.distances + 1e-9).all()


@pytest.mark.parametrize(
    ("name", "pose", "mode", "turns"),
    [
        ("delta", [0.0, 0.0, -0.9], "---", False),
        ("planar_3rpr", [3.0, 2.0, 0.4], None, False),
        ("planar_3rpr", [3.0, 2.0, 0.4], None, True),
        ("planar_3rrr", [0.5, 0.35, 0.2], "---", False),
        ("planar_3rrr", [0.5, 0.35, 0.2], "---", True),
        ("agile_eye", np.eye(3), None, True),
    ],
)
def test_robots_of_three_degrees_of_freedom(name, pose, mode, turns):
    robot = load_parallel(name)
    explore = platform_orientation_workspace if turns else platform_position_workspace
    space = explore(robot, pose, branches=mode, directions=12)
    if turns and name.startswith("planar"):
        assert space.directions.tolist() == [[0, 0, 1], [0, 0, -1]]
    check_ends(robot, space, mode)
    assert space.distances.max() > 0.0


def test_reach_of_a_delta_is_the_end_of_a_limb():
    robot = load_parallel("delta")
    down = platform_position_workspace(
        robot, [0.0, 0.0, -0.9], branches="---", directions=[[0.0, 0.0, -1.0]]
    )
    inward = robot.base_radius - robot.platform_radius
    lowest = np.sqrt((robot.arm + robot.forearm) ** 2 - inward**2)
    assert 0.9 + down.distances[0] == pytest.approx(lowest, abs=1e-9)
    assert "out of reach" in down.causes[0]
    place = down.points[0]
    place[2] += 1e-13
    assert singularity_distances(robot, place, robot.inverse(place).q[0])[0] < 1e-5
    assert loop_singularity(robot, [0, 0, -0.9], robot.inverse([0, 0, -0.9]).q[0]).type == 0


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: platform_position_workspace(HEXAPOD, np.eye(4)), "not leg .: base joint cone by"),
        (lambda: platform_position_workspace(load_parallel("agile_eye"), np.eye(4)), "to places"),
        (lambda: platform_orientation_workspace(LIMITED, [0, 0, -0.7]), "whose platform turns"),
        (lambda: platform_position_workspace(HEXAPOD, HOME, branches="---"), "no branches"),
        (lambda: platform_position_workspace(LIMITED, [0, 0, -0.7], branches="-"), "one of ---"),
        (lambda: platform_position_workspace(HEXAPOD, HOME, directions=0), "from 1 to"),
        (lambda: platform_position_workspace(HEXAPOD, HOME, directions=[[0, 0, 0]]), "none of th"),
        (lambda: platform_position_workspace(HEXAPOD, [HOME, HOME]), "pose has shape"),
        (
            lambda: platform_position_workspace(
                load_parallel("planar_3rpr"), [3, 2, 0.4], directions=[[0, 0, 1.0]]
            ),
            "in the plane",
        ),
    ],
)
def test_what_is_refused(call, said):
    with pytest.raises(RobomechError, match=said):
        call()
