"""Delta, planar and spherical robots: golden data, branches, modes, limits, singular poses."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robomech_ros.errors import BadValueError
from robomech_ros.outcomes import Code
from robomech_ros.parallel import Delta, Planar3RPR, Planar3RRR, Spherical3RRR, load_parallel

RIGHT = np.pi / 2


def pose_of(robot, rng):
    """A pose that the kind of robot can have, for some of them out of reach."""
    T = np.eye(4)
    if isinstance(robot, Delta):
        T[:3, 3] = rng.uniform([-0.5, -0.5, -1.2], [0.5, 0.5, -0.7])
    elif isinstance(robot, Spherical3RRR):
        T[:3, :3] = Rotation.random(random_state=rng).as_matrix()
    else:
        T[:3, :3] = Rotation.from_rotvec([0, 0, rng.uniform(-1.0, 1.0)]).as_matrix()
        T[:2, 3] = [0.5, 0.3] + 0.1 * rng.normal(size=2)
    return T


@pytest.mark.parametrize("name", ["delta", "planar_3rrr", "agile_eye"])
def test_every_branch_leads_back_to_the_pose(name):
    robot, rng = load_parallel(name), np.random.default_rng(1)
    reached = 0
    while reached < 50:
        T = pose_of(robot, rng)
        found = robot.inverse(T)
        if found.status == Code.OUT_OF_REACH:
            assert len(found) == 0 and found.excess.max() > 0.0 and "limb" in found.reason
            continue
        reached += 1
        assert len(found) == 8 and len(set(found.branches)) == 8
        for q in found.q:
            modes = robot.direct(q, T)
            assert modes.complete and modes.errors.max() < 1e-12
            assert np.abs(modes.poses[0] - T).max() < 1e-8
        seed = found.q[3] + 1e-3
        assert np.abs(robot.inverse(T, seed=seed).q[0] - found.q[3]).max() < 1e-12


def test_planar_golden(golden):
    data = golden("planar_3rpr")
    for robot in (Planar3RPR(data["A"], data["B"]), load_parallel("planar_3rpr")):
        found = robot.direct(data["rho"])
        assert len(found) == data["n_real"] and found.complete
        for one in data["solutions"]:
            near = robot.direct(data["rho"], [one["x"], one["y"], one["phi"]]).poses[0]
            assert np.abs(near[:2, 3] - [one["x"], one["y"]]).max() < data["tolerance"]
            assert abs(np.arctan2(near[1, 0], near[0, 0]) - one["phi"]) < data["tolerance"]
            assert np.abs(robot.inverse(near) - data["rho"]).max() < 1e-12


def test_spherical_golden(golden):
    data = golden("spherical_3rrr")
    base = np.roll(np.array(data["W"]), 1, axis=0)
    robot = Spherical3RRR(base, data["W"], data["V"])
    found = robot.direct([0.0, 0.0, 0.0])
    assert len(found) == data["n_real"] == 8 and found.complete
    for R in data["solutions"]:
        apart = np.abs(found.poses[:, :3, :3] - R).max(axis=(1, 2))
        assert apart.min() < data["tolerance"]
        back = robot.inverse(np.array(R))
        # Where the drives are at zero, as here, all limbs are on one of their branches.
        assert np.abs(back.q).max(axis=1).min() < 1e-7


def test_delta_rows():
    robot = load_parallel("delta")
    found = robot.inverse([0.0, 0.0, -0.9])
    assert np.abs(np.degrees(found.q[0]) + 20.5473).max() < 1e-4
    assert np.abs(np.degrees(found.q[-1]) + 144.2884).max() < 1e-4
    found = robot.inverse([0.3, 0.5, -1.1])
    assert len(found) == 8
    rows = np.degrees(found.q)
    expected = ((47.5041, -168.7055), (-11.5685, 152.5244), (21.3784, 172.0614))
    for column, pair in zip(rows.T, expected, strict=True):
        assert {round(value, 4) for value in column} == set(pair)
    modes = robot.direct([0.0, 0.0, 0.0])
    assert np.abs(modes.poses[:, 2, 3] - [-1.064452, 1.064452]).max() < 1e-6
    modes = robot.direct(np.radians([10.0, 20.0, 30.0]))
    expected = [[0.108135, -0.180348, -1.243541], [-0.069861, 0.120100, 0.894509]]
    assert np.abs(modes.poses[:, :3, 3] - expected).max() < 1e-6


@pytest.mark.parametrize("kind", ["rpr", "rrr", "spherical"])
def test_random_geometries_have_the_known_pose_among_their_modes(kind):
    rng = np.random.default_rng(2)
    for _ in range(200):
        if kind == "spherical":
            base, middle, top = rng.normal(size=(3, 3, 3))
            T = np.eye(4)
            T[:3, :3] = Rotation.random(random_state=rng).as_matrix()
            middle /= np.linalg.norm(middle, axis=1)[:, None]
            top /= np.linalg.norm(top, axis=1)[:, None]
            distal = np.arccos(np.sum(middle * (top @ T[:3, :3].T), axis=1))
            robot = Spherical3RRR(base, middle, top, distal)
            found = robot.direct([0.0, 0.0, 0.0], T)
        else:
            a, b = rng.normal(size=(2, 3, 2))
            T = np.eye(4)
            T[:3, :3] = Rotation.from_rotvec([0, 0, rng.uniform(-3, 3)]).as_matrix()
            T[:2, 3] = rng.normal(size=2)
            if kind == "rpr":
                robot = Planar3RPR(a, b)
                found = robot.direct(robot.inverse(T), T)
            else:
                robot = Planar3RRR(a, b, 2.0, [3.0, 4.0, 5.0])
                q = robot.inverse(T).q
                if not len(q):
                    continue
                found = robot.direct(q[0], T)
        assert found.complete and len(found) in (2, 4, 6, 8)
        assert np.abs(found.poses[0] - T).max() < 1e-7


def test_modes_that_meet_in_a_singular_planar_pose():
    robot = Planar3RPR([[0, 0], [2, 0], [0, 2]], [[0, 0], [1, 0], [0.3, 1.2]])
    # All legs through one point of the plane: the platform can turn about it a little.
    T = np.eye(4)
    T[:2, 3] = 0.4, 0.3
    centre = np.array([3.0, 1.5])
    ways = centre - (T[:2, 3] + robot.platform_points)
    base = T[:2, 3] + robot.platform_points - ways * [[0.3], [0.5], [0.4]]
    robot = Planar3RPR(base, robot.platform_points)
    found = robot.direct(robot.inverse(T), T)
    assert found.complete and found.multiplicity[0] == 2 and "singular" in found.reason
    assert np.abs(found.poses[0] - T).max() < 1e-6


def test_a_planar_platform_that_can_move_is_told():
    triangle = [[0, 0], [1, 0], [0.3, 0.8]]
    found = Planar3RPR(triangle, triangle).direct([0.5, 0.5, 0.5])
    assert not found.complete and found.status == Code.SINGULAR_CONTINUUM
    assert "can move" in found.reason


def test_a_leg_without_length_is_refused():
    robot = Planar3RPR([[0, 0], [1, 0], [0.3, 0.8]], [[0, 0], [0.4, 0], [0.2, 0.3]])
    with pytest.raises(BadValueError, match="length of leg 2 is 0.0, expected more than 0 m"):
        robot.direct([0.5, 0.0, 0.5])


def test_delta_in_special_places():
    robot = Delta(0.2, 0.05, 0.4, 1.0)
    stretched = robot.direct([RIGHT, RIGHT, -RIGHT])
    assert stretched.complete and len(stretched) == 2
    apart = Delta(1.0, 0.05, 0.6, 0.9).direct([0.0, 0.0, 0.0])
    assert apart.complete and len(apart) == 0 and apart.status == Code.OUT_OF_REACH
    assert "forearms are too short by 0.65 m" in apart.reason
    circle = Delta(0.2, 0.2, 0.4, 1.0).direct([RIGHT, RIGHT, RIGHT])
    assert not circle.complete and circle.status == Code.SINGULAR_CONTINUUM


def test_limits_exclude_branches_and_say_by_how_much():
    whole = load_parallel("delta")
    sizes = whole.base_radius, whole.platform_radius, whole.arm, whole.forearm
    robot = Delta(*sizes, limits=[-1.0, 1.5])
    found = robot.inverse([0.3, 0.5, -1.1])
    assert found.branches == ("---",) and found.status == Code.NONE
    none = Delta(*sizes, limits=[1.0, 1.5]).inverse([0.3, 0.5, -1.1])
    assert none.status == Code.LIMITS_EXCLUDE_ALL and len(none) == 0
    assert none.excess.max() == pytest.approx(np.radians(152.5244) - 1.5, abs=1e-5)
    assert "limb 2" in none.reason
