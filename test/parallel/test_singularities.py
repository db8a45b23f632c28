"""Singular poses of parallel robots: types, directions, limbs, distances, the length."""

import numpy as np
import pytest

from robomech_ros.errors import RobomechError
from robomech_ros.parallel import (
    Planar3RPR,
    Planar3RRR,
    StewartGough,
    dexterity,
    drive_forces,
    load_parallel,
    loop_singularity,
    platform_length,
    platform_twist,
    singularity_distances,
    velocity_matrices,
)

CORNERS = np.array([[0.0, 1.0], [-0.9, -0.5], [0.8, -0.6]])


def consistent(robot, T, q, found):
    """Directions and forces of a report satisfy the equations that define them."""
    K, J, _ = velocity_matrices(robot, T, q)
    assert found.free_directions @ K.T == pytest.approx(0.0, abs=1e-6)
    assert found.internal_forces @ K == pytest.approx(0.0, abs=1e-6)
    assert found.self_motions @ J.T == pytest.approx(0.0, abs=1e-6)
    # A wrench that no drive forces balance does work in a free motion, and an idle one none in any
    # motion that is not lost.
    if len(found.free_directions):
        work = found.unresisted_wrenches @ found.free_directions.T
        assert np.linalg.matrix_rank(work) == len(work)
    ends = [k - 1 for k in found.limbs[0]]
    assert np.linalg.matrix_rank(np.vstack((found.idle_wrenches, K[ends]))) == len(
        found.lost_directions
    )
    assert found.condition_number == (1.0 / found.dexterity if found.dexterity else np.inf)


@pytest.mark.parametrize("name", ["hexapod", "delta", "agile_eye"])
def test_a_regular_pose(name):
    robot, T = load_parallel(name), np.eye(4)
    T[2, 3] = {"hexapod": 0.508, "delta": -0.9, "agile_eye": 0.0}[name]
    q = robot.inverse(T) if name == "hexapod" else robot.inverse(T).q[0]
    found = loop_singularity(robot, T, q)
    assert found.type == 0 and not found.singular and found.kinds == ()
    assert found.summary == "regular" and found.limbs == ((), ())
    assert found.distances == pytest.approx(singularity_distances(robot, T, q))
    assert 0.0 < found.dexterity <= 1.0 and found.dexterity == dexterity(robot, T, q)
    consistent(robot, T, q, found)


def test_a_stretched_limb_is_type_1_and_named():
    robot = Planar3RRR(2.0 * CORNERS, CORNERS, [0.8, 3.0, 3.0], [0.6, 3.0, 3.0])
    pose = [0.0, 2.4, 0.0]
    q = robot.inverse(pose).q[0]
    found = loop_singularity(robot, pose, q)
    assert found.type == 1 and found.kinds == ("type 1: limb 1",) and found.limbs[0] == (1,)
    assert "type 1: limb 1 at an end of the reach, 1 of the motions lost" in found.summary
    # The limb is stretched upwards: its corner cannot go on, at an arm of 1 m across nothing.
    lost = found.lost_directions[0]
    assert np.abs(lost) == pytest.approx([0, 0, 0, 0, found.length, 0], abs=1e-9)
    assert found.self_motions.tolist() == [[1.0, 0.0, 0.0]] and found.dexterity == 0.0
    consistent(robot, pose, q, found)


def test_equal_turned_triangles_are_type_2_with_a_free_turn():
    robot = Planar3RPR(2.0 * CORNERS, CORNERS)
    found = loop_singularity(robot, [0.0, 0.0, 0.0], length=1.0)
    assert found.type == 2 and found.limbs == ((), (1, 2, 3))
    assert np.abs(found.free_directions) == pytest.approx(np.eye(6)[2:3], abs=1e-12)
    assert found.distances[1] < 1e-12 and found.condition_number == np.inf
    assert np.isnan(platform_twist(robot, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0])[2:5]).all()
    assert np.isnan(drive_forces(robot, [0.0, 0.0, 0.0], [0, 0, 1.0, 0, 0, 0])).all()
    consistent(robot, [0.0, 0.0, 0.0], None, found)


def test_only_limbs_that_depend_on_each_other_are_named():
    # Legs 1 and 2 lie in one line.
    base = np.array([[0.0, 0.0], [4.0, 0.0], [1.0, 3.0]])
    robot = Planar3RPR(base, [[0.0, 0.0], [1.0, 0.0], [0.3, 1.0]])
    found = loop_singularity(robot, [1.0, 0.0, 0.0], length=1.0)
    assert found.type == 2 and found.limbs == ((), (1, 2))
    assert found.kinds == ("type 2: limbs 1, 2",)
    consistent(robot, [1.0, 0.0, 0.0], None, found)


def test_both_types_at_once_are_type_3():
    # Second links meet in one point, and the first limb is stretched.
    base = 2.0 * CORNERS
    links = np.linalg.norm(CORNERS, axis=1)
    robot = Planar3RRR(base, CORNERS, 0.5 * links, 0.5 * links)
    q = robot.inverse([0.0, 0.0, 0.0]).q[0]
    found = loop_singularity(robot, [0.0, 0.0, 0.0], q, length=1.0)
    assert found.type == 3 and found.limbs == ((1, 2, 3), (1, 2, 3))
    assert len(found.kinds) == 2 and len(found.free_directions) == 1
    consistent(robot, [0.0, 0.0, 0.0], q, found)


def test_arms_of_a_delta_at_the_end_of_their_reach():
    robot = load_parallel("delta")
    inward = robot.base_radius - robot.platform_radius
    # Straight below: arms and forearms in line.
    place = [0.0, 0.0, -np.sqrt((robot.arm + robot.forearm) ** 2 - inward**2)]
    q = robot.inverse(place).q[0]
    found = loop_singularity(robot, place, q)
    assert found.type == 1 and found.limbs[0] == (1, 2, 3) and len(found.lost_directions) == 3
    # Forearms in the plane of the platform do not hold its height.
    robot = type(robot)(1.3, 0.1, 0.3, 1.2)
    q = robot.inverse([0.0, 0.0, -0.3]).q
    q = next(one for one in q if np.allclose(one, np.pi / 2))
    found = loop_singularity(robot, [0.0, 0.0, -0.3], q)
    assert found.type == 2 and np.abs(found.free_directions[0]) == pytest.approx(
        [0, 0, 0, 0, 0, 1], abs=1e-9
    )


def test_the_agile_eye_where_its_axes_coincide():
    robot = load_parallel("agile_eye")
    found = [loop_singularity(robot, np.eye(4), q) for q in robot.inverse(np.eye(4)).q]
    assert max(one.dexterity for one in found) == pytest.approx(1.0)


def test_hunts_singularity_of_a_hexapod_turned_by_a_right_angle():
    # Fichter: turned by 90 degrees about the axis of symmetry.
    robot = load_parallel("sgp_3_3")
    T = np.eye(4)
    T[:3, :3] = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    T[2, 3] = 0.8
    found = loop_singularity(robot, T)
    assert found.type == 2 and found.limbs[1] == (1, 2, 3, 4, 5, 6)
    consistent(robot, T, None, found)
    T[:3, :3] = np.eye(3)
    assert loop_singularity(robot, T).type == 0


def test_an_architecturally_singular_platform_says_so_in_every_pose():
    angles = np.radians([-10, 10, 110, 130, 230, 250])
    ring = np.stack((np.cos(angles), np.sin(angles), 0.0 * angles), axis=1)
    robot, T = StewartGough(ring, 0.6 * ring), np.eye(4)
    T[:3, 3] = 0.1, 0.2, 0.9
    found = loop_singularity(robot, T)
    assert found.always and found.type == 2 and "architecturally singular" in found.summary
    consistent(robot, T, None, found)


def test_distances_do_not_depend_on_units():
    hexapod = load_parallel("hexapod")
    larger = StewartGough(1e3 * hexapod.base_points, 1e3 * hexapod.platform_points)
    T = np.eye(4)
    T[:3, 3] = 0.05, 0.02, 0.55
    scaled = T.copy()
    scaled[:3, 3] *= 1e3
    here = singularity_distances(hexapod, T, length=0.2)
    assert singularity_distances(larger, scaled, length=200.0) == pytest.approx(here)


@pytest.mark.slow
def test_the_characteristic_length_makes_the_condition_least():
    robot = load_parallel("hexapod")
    length = platform_length(robot)
    assert 0.05 < length < 0.5
    larger = StewartGough(
        3.0 * robot.base_points, 3.0 * robot.platform_points, strokes=3.0 * robot.strokes
    )
    assert platform_length(larger) == pytest.approx(3.0 * length)
    assert platform_length(load_parallel("delta")) == 1.0


def test_lengths_and_poses_that_are_refused():
    robot = load_parallel("hexapod")
    with pytest.raises(RobomechError, match="length"):
        singularity_distances(robot, np.eye(4), length=0.0)
    with pytest.raises(RobomechError, match="pose has shape"):
        loop_singularity(robot, np.tile(np.eye(4), (2, 1, 1)))
