"""Proved motions: against dense sampling by Pinocchio, thin plates, and every kind of motion."""

import math

import numpy as np
import pytest
from arms import (
    CELL,
    cell_scene,
    random_pose,
    random_postures,
    random_shape,
    six_joints,
    sliding,
    torus_mesh,
    without_self_contact,
)
from second_opinion import SecondOpinion

from robomech_ros.cartesian import follow_path
from robomech_ros.collision import Box, Capsule, Mesh, Plane, PlanningScene, Sphere
from robomech_ros.collision.robot_bodies import link_shapes
from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_robot
from robomech_ros.trajectory import (
    JointPath,
    Limits,
    PiecewisePolynomial,
    point_to_point,
    sampled_point_to_point,
    spline_through,
    straight_path,
    through_points,
)

in_cell = pytest.mark.skipif(CELL is None, reason="robots with meshes are not here")


def limits_of(chain):
    return Limits.of(Limits(chain.joint_names, velocity=2.0, acceleration=6.0, jerk=60.0))


def waypoints(points, limits):
    return points


def poly345(points, limits):
    return point_to_point(points[0], points[-1], limits=limits)


def ruckig(points, limits):
    return point_to_point(points[0], points[-1], limits=limits, profile="ruckig")


def spline(points, limits):
    return spline_through(points, limits=limits)


def quintic(points, limits):
    return spline_through(points, limits=limits, degree=5)


def time_optimal(points, limits):
    return through_points(points, limits=limits, profile="time_optimal")


def sampled(points, limits):
    return sampled_point_to_point(
        points[0], points[-1], limits=limits, profile="double_s", period=0.05, max_points=5000
    ).waypoints


KINDS = [waypoints, poly345, ruckig, spline, quintic, time_optimal, sampled]


def dense(motion, count=500):
    """Return parameters and joint values of a motion."""
    pieces = getattr(motion, "pieces", getattr(motion, "curve", motion))
    if isinstance(pieces, np.ndarray):
        at = np.linspace(0.0, len(pieces) - 1, count)
        rows = range(len(pieces))
        return at, np.stack([np.interp(at, rows, column) for column in pieces.T], axis=1)
    at = np.linspace(pieces.breaks[0], pieces.breaks[-1], count)
    return at, pieces.sample(at)[0]


def on_rail():
    return PlanningScene(sliding(), base="rail", tip="palm")


def judged(scene):
    return SecondOpinion(scene, link_shapes(scene.chain.description)[0])


def check(scene, judge, motion):
    """Compare a proof with dense samples; return what it says."""
    found = scene.check_motion(motion)
    at, samples = dense(motion)
    ends = min(scene.clearance(samples[0]).distance, scene.clearance(samples[-1]).distance)
    assert found.least <= ends + 1e-9
    if found.certified:
        assert found.free and math.isnan(found.parameter) and found.bodies == ("", "")
        assert judge.first_hit(samples) is None
        return "certified"
    there = dense(motion, 2)[0]
    assert there[0] <= found.parameter <= there[-1]
    pieces = getattr(motion, "pieces", getattr(motion, "curve", motion))
    if isinstance(pieces, np.ndarray):
        q = np.array([np.interp(found.parameter, range(len(pieces)), c) for c in pieces.T])
    else:
        q = pieces.sample(found.parameter)[0]
    distance = judge.distance_of(found.bodies, q)
    before = samples[at < found.parameter]
    assert judge.first_hit(before[:-1]) is None
    if found.free:
        assert abs(distance) < 1e-4
        return "not proved"
    assert distance <= 1e-6
    return "contact"


@pytest.mark.slow
# The long cases of three robots have 10,000 motions.
@pytest.mark.parametrize("scenes", [3, pytest.param(170, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", ["six", "sliding", pytest.param("panda", marks=in_cell)])
def test_no_motion_is_proved_that_sampling_finds_in_contact(name, scenes, record_property):
    random = np.random.default_rng(12)
    if name == "panda":
        empty = cell_scene("panda")
    else:
        empty = PlanningScene(six_joints()) if name == "six" else on_rail()
    counts, nearest = {"certified": 0, "contact": 0, "not proved": 0}, []
    for _ in range(scenes):
        scene = empty.copy()
        for k in range(4):
            scene.add(f"object_{k}", random_shape(random), random_pose(random, 1.0))
        judge, limits = judged(scene), limits_of(scene.chain)
        starts = random_postures(scene.chain, random, 600)
        starts = starts[scene.is_free(starts)]
        for k, q in enumerate(starts[: 3 * len(KINDS)]):
            steps = 0.35 * random.normal(size=(2, len(q)))
            points = np.vstack([q, q + np.cumsum(steps, axis=0)])
            points = np.clip(points, scene.chain.lower, scene.chain.upper)
            motion = KINDS[k % len(KINDS)](points, limits)
            verdict = check(scene, judge, motion)
            counts[verdict] += 1
            if verdict == "certified":
                nearest.append(scene.clearance(dense(motion)[1]).distance.min())
    assert counts["certified"] > 8 and counts["contact"] > 5
    assert counts["not proved"] <= max(1, scenes // 10)
    assert min(nearest) > 0.0
    record_property("motions", counts)
    record_property("least distance of samples of proved motions (m)", float(min(nearest)))


def test_whole_turns_of_joints():
    """Far motions: what is proved of them is less, but never wrong."""
    random, scene = np.random.default_rng(13), PlanningScene(six_joints())
    for k in range(2):
        scene.add(f"object_{k}", random_shape(random), random_pose(random, 1.0))
    judge, limits = judged(scene), limits_of(scene.chain)
    postures = random_postures(scene.chain, random, 300)
    postures = postures[scene.is_free(postures)][:42]
    for k, points in enumerate(postures.reshape(-1, 3, 6)):
        check(scene, judge, KINDS[k % len(KINDS)](points, limits))


@pytest.mark.parametrize("name", ["six", pytest.param("panda", marks=in_cell)])
def test_known_distances_between_links_change_nothing(name):
    """Scenes share bounds of them; those found with one clearance must hold with another."""
    first = cell_scene("panda") if name == "panda" else PlanningScene(six_joints())
    random = np.random.default_rng(15)
    starts = random_postures(first.chain, random, 60)
    certified = 0
    for q in starts:
        points = np.clip(
            q + 0.2 * random.normal(size=(3, len(q))), first.chain.lower, first.chain.upper
        )
        for clearance in (0.0, 0.03, 0.005):
            found = first.copy().check_motion(points, clearance=clearance)
            free = first.is_free(dense(points, 300)[1], clearance=clearance)
            assert not found.certified or free.all()
            certified += found.certified
    assert 40 < certified < 180


@pytest.mark.parametrize("postures", [60, pytest.param(3000, marks=pytest.mark.long)])
@pytest.mark.parametrize("kind", KINDS)
def test_a_plate_of_a_millimetre_is_never_passed(kind, postures, record_property):
    random, scene = np.random.default_rng(14), PlanningScene(six_joints())
    limits = limits_of(scene.chain)
    passed = 0
    for q in random_postures(scene.chain, random, postures):
        if not scene.is_free(q):
            continue
        step = random.normal(size=6)
        points = np.array([q - step, q, q + step])
        if np.any(points < scene.chain.lower) or np.any(points > scene.chain.upper):
            continue
        with_plate = scene.copy()
        pose = np.eye(4)
        pose[:3, :3] = random_pose(random, 1.0)[:3, :3]
        pose[:3, 3] = (scene.link_pose("hand", q) @ [0.0, 0.0, 0.06, 1.0])[:3]
        with_plate.add("plate", Box(0.03, 0.02, 0.001), pose)
        passed += 1
        found = with_plate.check_motion(kind(points, limits))
        if kind in (spline, quintic, time_optimal, waypoints, poly345, sampled):
            assert not found.certified and not found.free
        elif found.certified:
            assert judged(with_plate).first_hit(dense(kind(points, limits), 4000)[1]) is None
    assert passed > 3
    record_property("motions through plates", passed)


def test_joint_paths_and_polynomials():
    scene = PlanningScene(six_joints())
    q = np.array([0.2, 0.5, 1.0, 0.1, 0.8, 0.3])
    pose = forward_kinematics(scene.chain, q)
    after = pose.copy()
    after[1, 3] += 0.3
    path = follow_path(scene.chain, straight_path([pose, after]), q).joints
    assert isinstance(path, JointPath) and isinstance(path.pieces, PiecewisePolynomial)
    assert scene.check_motion(path).certified and scene.check_motion(path.pieces).certified
    between = pose.copy()
    between[1, 3] += 0.2
    scene.add("post", Capsule(0.01, 0.5), between)
    judge = judged(scene)
    assert check(scene, judge, path) == "contact" == check(scene, judge, path.pieces)
    found = scene.check_motion(path)
    # The parameter of a path is its coordinate.
    assert 0.0 < found.parameter < 0.2
    assert "post" in found.bodies


def test_the_parameter_of_waypoints_counts_them():
    scene = without_self_contact(on_rail())
    scene.add("ball", Sphere(0.05), [[1, 0, 0, 0.6], [0, 1, 0, 0], [0, 0, 1, 0.12], [0, 0, 0, 1]])
    points = np.zeros((4, 4))
    points[:, 0] = 0.0, 0.1, 0.2, 0.6
    points[:, 1] = np.pi / 2
    found = scene.check_motion(points)
    # The cart is 0.15 long to its front, and the ball begins at 0.55: contact at 0.4.
    assert not found.free and not found.certified
    assert found.parameter == pytest.approx(2.5, abs=1e-3)
    assert set(found.bodies) == {"cart", "ball"}
    assert scene.check_motion(points[:3]).certified
    clear = scene.check_motion(points[:3], clearance=0.15)
    assert clear.certified
    close = scene.check_motion(points[:3], clearance=0.25)
    assert not close.free and close.parameter == pytest.approx(1.5, abs=1e-3)


@pytest.mark.parametrize("kept", [0.0, 0.03])
def test_a_clearance_is_kept_everywhere(kept):
    random, scene = np.random.default_rng(15), PlanningScene(six_joints())
    for k in range(3):
        scene.add(f"object_{k}", random_shape(random), random_pose(random, 1.0))
    certified = 0
    for q in random_postures(scene.chain, random, 60):
        points = np.array([q, q + 0.2 * random.normal(size=6)])
        if scene.check_motion(points, clearance=kept).certified:
            certified += 1
            assert scene.is_free(dense(points, 200)[1], clearance=kept).all()
    assert certified > 5


def test_motions_that_touch_at_one_instant_are_not_proved():
    """A ball on a rail comes as near as a micrometre, or touches."""
    scene = on_rail()
    points = np.zeros((3, 4))
    points[:, 0] = 0.0, 0.25, 0.0
    points[:, 1] = np.pi / 2

    def at(gap):
        one = scene.copy()
        pose = np.eye(4)
        pose[:3, 3] = 0.4 + gap + 0.05, 0.0, 0.12
        one.add("ball", Sphere(0.05), pose)
        return one.check_motion(points)

    assert at(1e-3).certified and at(1e-4).certified
    assert not at(-1e-5).free and not at(-1e-4).free
    for gap in (0.0, 1e-9, 5e-7):
        assert not at(gap).certified


@pytest.mark.parametrize("above", [0.0, 1e-12, 3e-7, 9e-7, 1e-5])
def test_robots_that_stand_still(above):
    """One waypoint, or the same twice, with a clearance that is all but used up."""
    scene = PlanningScene(six_joints())
    scene.add("ball", Sphere(0.1), [[1, 0, 0, 1.1], [0, 1, 0, 0], [0, 0, 1, 0.5], [0, 0, 0, 1]])
    q = np.array([0.0, 0.9, 0.4, 0.0, 0.3, 0.0])
    scene = without_self_contact(scene)
    distance = scene.clearance(q).distance
    assert distance > 0.01
    for points in ([q], [q, q]):
        found = scene.check_motion(points, clearance=distance - above)
        assert found.certified == (above > 2e-6)
        if not found.certified:
            assert found.parameter in (0.0, 0.5)


def test_a_carried_ring_is_moved_over_a_post():
    """A mesh that is not convex may have something in its hole."""
    scene = without_self_contact(on_rail())
    scene.add("ring", Mesh(*torus_mesh(0.12, 0.02)))
    scene.attach(
        "ring",
        "palm",
        scene.bodies[:-1],
        pose=[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -0.25], [0, 0, 0, 1]],
    )
    high, low = np.array([0.0, 0.0, -0.1, 0.0]), np.array([0.0, 0.0, 0.2, 0.0])
    tip = forward_kinematics(scene.chain, low)[:3, 3]
    pose = np.eye(4)
    pose[:3, 3] = tip + [0.0, 0.0, -0.25]
    scene.add("post", Sphere(0.05), pose)
    q = low
    assert scene.clearance(q).distance > 0.0
    assert scene.is_free(q)
    assert scene.check_motion([high, low]).certified
    pose[0, 3] += 0.07
    scene.move("post", pose)
    assert not scene.is_free(q)
    assert not scene.check_motion([high, low]).free


def test_floors_and_robots_without_shapes():
    scene = PlanningScene(six_joints())
    scene.add("floor", Plane((0, 0, 1), -0.01))
    up, down = np.zeros(6), np.array([0.0, 1.9, 0.9, 0.0, 0.3, 0.0])
    assert check(scene, judged(scene), np.array([up, down])) == "contact"
    bare = PlanningScene(load_robot("puma560"))
    found = bare.check_motion(np.zeros((3, 6)))
    assert found.certified and found.least == math.inf


def test_wrong_motions():
    scene = PlanningScene(six_joints())
    for motion in (np.zeros((2, 5)), np.zeros((2, 7))):
        with pytest.raises(WrongSizeError):
            scene.check_motion(motion)
    for motion in (np.zeros((2, 2, 6)), np.zeros((0, 6)), np.zeros(6)):
        with pytest.raises((BadValueError, WrongSizeError)):
            scene.check_motion(motion)
    with pytest.raises(NonFiniteError):
        scene.check_motion([[0, 0, 0, 0, 0, math.nan], [0] * 6])
    for far in (1e12, 1e300):
        with pytest.raises(BadValueError, match="motion of joint 'j1'"):
            scene.check_motion([np.zeros(6), np.full(6, far)])
    other = point_to_point(np.zeros(4), np.ones(4), limits=limits_of(on_rail().chain))
    with pytest.raises(BadValueError, match="joints of the motion is 4, expected 6"):
        scene.check_motion(other)
    for kept in (-0.1, math.nan, math.inf, 11.0):
        with pytest.raises((BadValueError, NonFiniteError), match="clearance"):
            scene.check_motion(np.zeros((2, 6)), clearance=kept)
