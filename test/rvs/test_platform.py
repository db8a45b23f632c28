"""Parallel robots on a page: dragged, driven, listed and judged, without a browser."""

import numpy as np
import pytest

from robomech_ros.errors import BadValueError
from robomech_ros.parallel import list_parallel, load_parallel, pose_limits, velocity_matrices
from robomech_ros.rvs.model.platforms.ghosts import PlatformGhosts, limb_points
from robomech_ros.rvs.model.platforms.lists import LISTS, platform_facts, platform_list
from robomech_ros.rvs.model.platforms.platform_view import PlatformView
from robomech_ros.rvs.model.platforms.reach import platform_reach
from robomech_ros.spatial import matrix_from_axis_angle, pose_exponential

ROBOTS = list_parallel()
# Of limbs of any kind: what is found is not proved to be all.
ANY = {"linapod", "tripod_3prs"}


def closed(platform):
    return platform.mechanism.loop_errors(platform.q).max() < 1e-9


@pytest.mark.parametrize("name", ROBOTS)
def test_the_platform_follows_a_drag_in_the_motions_that_it_has(name):
    platform = PlatformView(load_parallel(name))
    size, start = platform.mechanism.size, platform.tip
    step = np.array([0.02, 0.01, 0.03, 0.01 * size, -0.02 * size, 0.015 * size])
    platform.drag(start @ pose_exponential(step))
    assert platform.study.sentence.startswith(("Stopped", "Looking"))
    assert not platform.faulty_links
    assert closed(platform)
    if name != "tripod_3prs":
        # Its turns and motions depend on each other.
        np.testing.assert_allclose(platform.tip, platform.target, atol=1e-8)
    moved = np.abs(platform.tip - start).max(axis=None)
    assert moved > 1e-3


def test_a_leg_that_ends_the_drag_is_named_and_the_robot_stays():
    platform = PlatformView(load_parallel("hexapod"))
    before, far = platform.q, platform.tip
    far[:3, 3] += [0.25, 0.0, 0.2]
    platform.drag(far)
    np.testing.assert_array_equal(platform.q, before)
    excess = platform.robot.excess(platform.robot.inverse(far))
    worst = int(np.argmax(np.abs(excess))) + 1
    assert f"leg{worst}_length" in platform.study.sentence
    assert platform.faulty_links and all(
        one.startswith(f"leg{worst}_") for one in platform.faulty_links
    )
    platform.release()
    assert not platform.faulty_links
    np.testing.assert_allclose(platform.target, platform.tip)


@pytest.mark.parametrize("name", ROBOTS)
def test_a_drive_moves_alone_and_the_loops_stay_closed(name):
    platform = PlatformView(load_parallel(name))
    values = platform.values
    platform.set_joint(1, values[1] + 1e-2)
    expected = values.copy()
    expected[1] += 1e-2
    np.testing.assert_allclose(platform.values, expected, atol=1e-12)
    assert closed(platform)


@pytest.mark.parametrize("value", [0.5, 1.0, -3.0])
def test_a_drive_outside_its_stroke_is_refused_and_the_robot_stays(value):
    platform = PlatformView(load_parallel("hexapod"))
    before = platform.q
    with pytest.raises(BadValueError, match=r"leg1_length.*0\.6 to 0\.95 m"):
        platform.set_joint(0, value)
    np.testing.assert_array_equal(platform.q, before)
    with pytest.raises(BadValueError, match="finite"):
        platform.set_joint(0, np.nan)


def test_a_drive_that_the_robot_cannot_follow_is_refused():
    platform = PlatformView(load_parallel("planar_3rrr"))
    before = platform.q
    with pytest.raises(BadValueError, match="can follow"):
        for value in np.linspace(platform.values[0], platform.values[0] + 3.0, 40):
            platform.set_joint(0, value)
    assert closed(platform)
    assert np.isfinite(before).all()


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("kind", LISTS)
def test_modes_have_the_same_drives_and_branches_the_same_pose(name, kind):
    platform = PlatformView(load_parallel(name))
    found = platform_list(platform.robot, platform.q, kind)
    mechanism = platform.mechanism
    assert any(posture.is_here for posture in found.postures)
    for posture in found.postures:
        if kind == LISTS[0]:
            np.testing.assert_allclose(posture.q[mechanism.drive_index], platform.values)
        else:
            np.testing.assert_allclose(mechanism.pose(posture.q), platform.tip, atol=1e-7)
        assert mechanism.loop_errors(posture.q).max() < 1e-6
    assert str(len(found.postures)) in found.text
    assert found.complete is ("these are all" in found.text)
    assert found.complete or (kind == LISTS[0] and name in ANY)


def test_a_posture_keeps_its_number_while_the_robot_moves():
    platform = PlatformView(load_parallel("sgp_6_3"))
    first = platform_list(platform.robot, platform.q, LISTS[0])
    platform.know(first)
    platform.take(3)
    again = platform_list(platform.robot, platform.q, LISTS[0], first.postures)
    assert [posture.is_here for posture in again.postures].index(True) == 3
    for one, other in zip(first.postures, again.postures, strict=True):
        np.testing.assert_allclose(one.q, other.q, atol=1e-6)
    with pytest.raises(BadValueError, match="1 to 8"):
        platform.know(again)
        platform.take(8)


def test_numbers_and_arrows_are_those_of_the_library():
    robot = load_parallel("planar_3rrr")
    q = robot.mechanism.home()
    facts = platform_facts(robot, q)
    assert "dexterity" in dict(facts.lines) and not facts.report.singular
    assert facts.weakest[:2] == pytest.approx(0.0) and facts.weakest[5] == 0.0
    # Of all twists of its size it is the one that the limbs oppose least.
    K, _, _ = velocity_matrices(robot, robot.mechanism.pose(q), q[robot.mechanism.drive_index])
    assert np.linalg.norm(K @ facts.weakest) == pytest.approx(facts.report.distances[1])


@pytest.mark.parametrize("name", sorted(ANY))
def test_limbs_of_any_kind_are_judged_too(name):
    robot = load_parallel(name)
    q = robot.home()
    facts = platform_facts(robot, q)
    assert facts.mixed and not facts.report.singular
    K, _, _ = velocity_matrices(robot, robot.pose(q), q)
    assert np.linalg.norm(K @ facts.weakest) == pytest.approx(facts.report.distances[1])


@pytest.mark.parametrize("name", ROBOTS)
def test_ghosts_have_rods_between_the_joints_that_are_apart(name):
    mechanism = load_parallel(name).mechanism
    q = mechanism.home()
    ghosts = PlatformGhosts(mechanism, 0.3)
    pieces = ghosts.placed([q, q], [(1, 2, 3), (4, 5, 6)])
    assert len(pieces.positions) == len(pieces.colours) == 2 * ghosts.pieces
    points = limb_points(mechanism, q[None], 0.3)[0]
    gaps = np.linalg.norm(np.diff(points, axis=1), axis=-1)
    seen = pieces.scales[: ghosts.pieces, 0] > 1e-5
    assert seen.sum() >= (gaps > 1e-6 * mechanism.size).sum()
    assert np.isfinite(pieces.positions).all()


def test_the_gizmo_has_the_handles_of_the_motions():
    options = {name: PlatformView(load_parallel(name)).gizmo(0.1) for name in ROBOTS}
    assert options["hexapod"] == {"scale": 0.1, "disable_rotations": False}
    assert options["delta"] == {"scale": 0.1, "disable_rotations": True}
    assert options["agile_eye"]["disable_axes"] and options["agile_eye"]["disable_sliders"]
    assert options["planar_3rrr"] == {"scale": 0.1, "active_axes": (True, True, False)}


@pytest.mark.parametrize("name", ["hexapod", "planar_3rrr"])
def test_the_boundary_of_positions_is_where_the_limits_are(name):
    robot = load_parallel(name)
    q = robot.mechanism.home()
    found = platform_reach(robot, q)
    assert found.flat is (name == "planar_3rrr")
    assert sum(found.shares.values()) == pytest.approx(1.0)
    T = robot.mechanism.pose(q)
    for cause, part in found.parts.items():
        assert cause in found.colours
        for point in part[:3, 0]:
            outwards = (point - T[:3, 3]) / np.linalg.norm(point - T[:3, 3])
            for step, inside in ((-1e-6, True), (1e-6, False)):
                T_near = T.copy()
                T_near[:3, 3] = point + step * outwards
                assert bool(pose_limits(robot, T_near).inside) is inside


def test_the_boundary_of_positions_of_limbs_of_any_kind_is_where_the_limits_are():
    """The tripod goes up and down only: its boundary is two lines from where it is."""
    robot = load_parallel("tripod_3prs")
    T = robot.mechanism.pose(robot.mechanism.home())
    found = platform_reach(robot, robot.mechanism.home())
    ends = np.concatenate(list(found.parts.values()))
    assert found.flat and ends.shape == (2, 2, 3)
    np.testing.assert_allclose(ends[:, 1], [T[:3, 3]] * 2, rtol=0.0, atol=1e-12)
    for end in ends[:, 0]:
        way = end - T[:3, 3]
        np.testing.assert_allclose(way[:2], 0.0, rtol=0.0, atol=1e-9)
        for step, inside in ((-1e-5, True), (1e-5, False)):
            T_near = T.copy()
            T_near[:3, 3] = end + step * way / np.linalg.norm(way)
            assert bool(pose_limits(robot, T_near).inside) is inside


def turned(T, axis, angle):
    T_near = T.copy()
    T_near[:3, :3] = matrix_from_axis_angle(axis, angle) @ T[:3, :3]
    return T_near


@pytest.mark.parametrize("name", ["hexapod", "agile_eye"])
def test_the_boundary_of_turns_is_where_the_limits_are(name):
    robot = load_parallel(name)
    q = robot.mechanism.home()
    found = platform_reach(robot, q, turns=True)
    assert found.turns and not found.flat
    assert sum(found.shares.values()) == pytest.approx(1.0)
    assert 0.0 < found.least <= found.greatest <= np.pi
    T, looked = robot.mechanism.pose(q), 0
    for cause, part in found.parts.items():
        if ":" not in cause:
            continue
        for point in part[:3, 0]:
            way = point - T[:3, 3]
            length = np.linalg.norm(way)
            angle = length * np.pi / robot.mechanism.size
            for step, inside in ((-1e-6, True), (1e-6, False)):
                pose = turned(T, way / length, angle + step)
                assert bool(pose_limits(robot, pose).inside) is inside
                looked += 1
    assert looked or name == "agile_eye"


def test_turns_in_the_plane_are_drawn_as_an_arc():
    robot = load_parallel("planar_3rpr")
    q = robot.mechanism.home()
    found = platform_reach(robot, q, turns=True)
    T, size = robot.mechanism.pose(q), robot.mechanism.size
    points = np.concatenate(list(found.parts.values()))[:, 0] - T[:3, 3]
    radius = np.linalg.norm(points, axis=1)
    np.testing.assert_allclose(radius, radius[0], rtol=1e-9)
    assert found.flat and 0.1 * size < radius[0] < size
    here = np.arctan2(T[1, 0], T[0, 0])
    angles = np.unwrap(np.arctan2(points[:, 1], points[:, 0]) - here)
    assert np.abs(angles).max() == pytest.approx(found.greatest, abs=1e-6)


def test_a_platform_that_only_translates_has_no_boundary_of_turns():
    robot = load_parallel("delta")
    with pytest.raises(BadValueError, match="turns"):
        platform_reach(robot, robot.mechanism.home(), turns=True)


def test_a_platform_that_only_turns_has_no_boundary_of_positions():
    robot = load_parallel("agile_eye")
    with pytest.raises(BadValueError, match="moves to places"):
        platform_reach(robot, robot.mechanism.home())
