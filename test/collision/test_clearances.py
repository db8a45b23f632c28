"""Clearances: against Pinocchio on the same shapes, in contact and apart."""

import coal
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
    with_meshes,
    without_self_contact,
)
from second_opinion import SecondOpinion

from robomech_ros.collision import Box, Cone, Cylinder, Mesh, Plane, PlanningScene, Sphere
from robomech_ros.collision.robot_bodies import link_shapes
from robomech_ros.collision.scene_objects import covered
from robomech_ros.robots import load_description, load_robot

in_cell = pytest.mark.skipif(CELL is None, reason="robots with meshes are not here")
ROBOTS = [
    "six",
    "sliding",
    "meshes",
    pytest.param("panda", marks=in_cell),
    pytest.param("ur5", marks=[in_cell, pytest.mark.long]),
]


@pytest.fixture(scope="module")
def make(tmp_path_factory):
    """Return a scene of a robot, made once."""
    made = {}

    def scene_of(name):
        if name not in made:
            if name in ("panda", "ur5"):
                made[name] = cell_scene(name)
            elif name == "meshes":
                made[name] = PlanningScene(with_meshes(tmp_path_factory.mktemp("meshes")))
            elif name == "six":
                made[name] = PlanningScene(six_joints())
            else:
                made[name] = PlanningScene(sliding(), base="cart", tip="palm")
        return made[name].copy()

    return scene_of


def shapes_of(scene):
    found, faults = link_shapes(scene.chain.description)
    assert not faults
    return found


def agree(scene, judge, postures):
    """Compare distances, names and points; return the differences apart, and those of depths."""
    batch = scene.clearance(postures)
    free = scene.is_free(postures)
    apart, deep = [], []
    for k, q in enumerate(postures):
        found = scene.clearance(q)
        expected, bodies = judge.clearance(q)
        # Depths of round bodies are known to a micrometre only.
        near = 1e-9 if expected > 0.0 else 2e-6
        difference = abs(found.distance - expected)
        assert difference <= near, (q, found.distance, expected)
        (apart if free[k] else deep).append(difference)
        if frozenset(found.bodies) != bodies:
            # Two pairs as near as each other.
            assert judge.distance_of(found.bodies, q) == pytest.approx(expected, abs=near)
        # Beside a flat face the nearest points may slide.
        for points in (found.points, batch.points[k]):
            between = np.linalg.norm(points[1] - points[0])
            assert between == pytest.approx(abs(found.distance), abs=1e-6)
        assert free[k] == scene.is_free(q) == (found.distance > 0.0)
        if found.distance > 1e-6:
            # The search for a plane between hulls decides the same, on both sides.
            assert scene.is_free(q, clearance=found.distance - 1e-7)
            assert not scene.is_free(q, clearance=found.distance + 1e-7)
        # A search of coal that begins elsewhere ends elsewhere within its tolerance.
        assert batch.distance[k] == pytest.approx(found.distance, abs=near)
        assert batch.bodies[k] == found.bodies
    return apart, deep


# The long cases of five robots have 100,000 postures.
@pytest.mark.parametrize("scenes", [2, pytest.param(334, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", ROBOTS)
def test_distances_are_those_of_pinocchio(make, name, scenes, record_property):
    random = np.random.default_rng(7)
    apart, deep = [], []
    for _ in range(scenes):
        scene = make(name)
        for k in range(12):
            scene.add(f"object_{k}", random_shape(random), random_pose(random, 1.1))
        judge = SecondOpinion(scene, shapes_of(scene))
        of_scene = agree(scene, judge, random_postures(scene.chain, random, 60))
        apart += of_scene[0]
        deep += of_scene[1]
    assert 5 < len(deep) < 60 * scenes - 1
    record_property("postures apart, in contact", (len(apart), len(deep)))
    record_property("largest difference of distances, of depths (m)", str((max(apart), max(deep))))


@pytest.mark.parametrize("name", ROBOTS)
def test_of_the_robot_alone(make, name):
    scene = make(name)
    judge = SecondOpinion(scene, shapes_of(scene))
    agree(scene, judge, random_postures(scene.chain, np.random.default_rng(1), 30))


@pytest.mark.parametrize("name", ["six", "sliding"])
def test_the_points_lie_on_both_bodies(make, name):
    scene, random = without_self_contact(make(name)), np.random.default_rng(2)
    scene.add("ball", Sphere(0.1), random_pose(random, 0.5))
    seen = 0
    for q in random_postures(scene.chain, random, 100):
        found = scene.clearance(q)
        if "ball" not in found.bodies or found.distance <= 0.0:
            continue
        seen += 1
        side = found.bodies.index("ball")
        from_middle = found.points[side] - scene.objects["ball"].pose[:3, 3]
        assert np.linalg.norm(from_middle) == pytest.approx(0.1, abs=1e-6)
        # A tiny ball at the other point touches that link.
        other = found.points[1 - side]
        probe = scene.copy()
        probe.remove("ball")
        pose = np.eye(4)
        pose[:3, 3] = other
        probe.add("probe", Sphere(1e-5), pose)
        assert abs(probe.clearance(q).distance) < 3e-5
    assert seen > 5


@pytest.mark.parametrize("name", ["six", "sliding"])
def test_a_clearance_is_asked_as_a_distance(make, name):
    scene, random = make(name), np.random.default_rng(3)
    for k in range(8):
        scene.add(f"object_{k}", random_shape(random), random_pose(random, 1.0))
    for q in random_postures(scene.chain, random, 100):
        distance = scene.clearance(q).distance
        for kept in (0.0, 0.01, 0.1, max(distance, 0.0)):
            assert scene.is_free(q, clearance=kept) == (distance > kept)


@pytest.mark.parametrize("shape", [Cylinder(0.1, 0.3), Cylinder(0.2, 0.05), Cone(0.1, 0.3)])
def test_spheres_inside_of_round_bodies_are_inside(shape):
    spheres, _ = covered(shape.body())
    x, y, z, radius = spheres[:, 4:].T
    up = 0.5 + z / shape.height
    slope = shape.radius / shape.height if isinstance(shape, Cone) else 0.0
    gap = (shape.radius - slope * up * shape.height - np.hypot(x, y)) / np.hypot(1.0, slope)
    assert len(spheres) > 3 and (radius <= gap + 1e-9).all()


def test_padding_makes_links_wider_against_objects_only():
    plain, padded = PlanningScene(six_joints()), PlanningScene(six_joints(), padding=0.02)
    random = np.random.default_rng(4)
    postures = random_postures(plain.chain, random, 60)
    np.testing.assert_allclose(
        plain.clearance(postures).distance, padded.clearance(postures).distance, atol=1e-12
    )
    plain, padded = without_self_contact(plain), without_self_contact(padded)
    for scene in (plain, padded):
        scene.add(
            "wall", Box(0.1, 2.0, 2.0), [[1, 0, 0, 0.6], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
        )
        scene.add("floor", Plane((0, 0, 1), -0.1))
    before, after = plain.clearance(postures), padded.clearance(postures)
    np.testing.assert_allclose(before.distance - 0.02, after.distance, atol=1e-9)
    assert (padded.is_free(postures) == (before.distance > 0.02)).all()


def test_fingers_stand_where_they_are_said_to(make):
    random = np.random.default_rng(5)
    for value in (0.0, 0.02, 0.04):
        scene = make("sliding")
        scene.set_other_joints({"left": value})
        for k in range(10):
            scene.add(f"object_{k}", random_shape(random), random_pose(random, 0.8))
        judge = SecondOpinion(scene, shapes_of(scene), {"left": value})
        agree(scene, judge, random_postures(scene.chain, random, 30))


def test_mimicking_fingers_of_the_chain():
    scene, random = (
        PlanningScene(sliding(), base="rail", tip="left_finger"),
        np.random.default_rng(6),
    )
    assert "left" in scene.chain.joint_names
    for k in range(10):
        scene.add(f"object_{k}", random_shape(random), random_pose(random, 0.8))
    judge = SecondOpinion(scene, shapes_of(scene))
    agree(scene, judge, random_postures(scene.chain, random, 60))


def test_a_chain_whose_base_is_a_link_further_up():
    """All poses are in the base of the chain, and joints before it are at rest or where said."""
    text, random = six_joints(), np.random.default_rng(8)
    description = load_description(text)
    scene = PlanningScene(description, base="upper", tip="tip")
    assert scene.chain.n == 4
    scene.set_other_joints({"j1": 0.4, "j2": -0.3})
    for k in range(10):
        scene.add(f"object_{k}", random_shape(random), random_pose(random, 0.8))
    judge = SecondOpinion(scene, shapes_of(scene), {"j1": 0.4, "j2": -0.3})
    agree(scene, judge, random_postures(scene.chain, random, 60))


def test_what_links_carry_moves_with_them(make):
    scene, random = make("six"), np.random.default_rng(9)
    for k in range(8):
        scene.add(f"object_{k}", random_shape(random), random_pose(random, 0.9))
    pose = np.eye(4)
    pose[:3, 3] = 0.0, 0.0, 0.2
    scene.add("tool", [(Box(0.1, 0.05, 0.2), np.eye(4)), (Sphere(0.06), pose)], pose)
    scene.attach("tool", "hand", ["bend"])
    judge = SecondOpinion(scene, shapes_of(scene))
    agree(scene, judge, random_postures(scene.chain, random, 80))
    assert any(
        "tool" in bodies
        for bodies in scene.clearance(random_postures(scene.chain, random, 60)).bodies
    )


def test_half_spaces(make):
    scene, random = make("six"), np.random.default_rng(10)
    scene.add("floor", Plane((0, 0, 2), -0.4))
    scene.add("side", Plane((1, 1, 0.2), -0.7), random_pose(random, 0.05))
    judge = SecondOpinion(scene, shapes_of(scene))
    agree(scene, judge, random_postures(scene.chain, random, 60))


def test_robots_without_shapes_have_no_clearance():
    scene = PlanningScene(load_robot("puma560"))
    assert not scene.has_geometry and scene.bodies == ()
    found = scene.clearance(np.zeros(6))
    assert found.distance == np.inf and found.bodies == ("", "") and np.isnan(found.points).all()
    assert scene.is_free(np.zeros(6)) and scene.is_free(np.zeros((3, 6))).all()


@pytest.mark.parametrize("name", ROBOTS[2:])
def test_the_parts_of_meshes_hold_all_of_them(make, name):
    """Random points of the triangles are inside of one of the convex parts."""
    random = np.random.default_rng(11)
    for _, shape, _ in shapes_of(make(name)):
        if not isinstance(shape, Mesh):
            continue
        parts = [body.geometry for body in shape.parts()]
        shares = random.dirichlet(np.ones(3), 40)
        corners = shape.vertices[shape.faces[random.integers(len(shape.faces), size=40)]]
        probe, still = coal.Sphere(1e-6), coal.Transform3s()
        for point in np.einsum("ij,ijk->ik", shares, corners):
            there = coal.Transform3s(np.eye(3), point)
            distances = [
                coal.distance(
                    part, still, probe, there, coal.DistanceRequest(), coal.DistanceResult()
                )
                for part in parts
            ]
            assert min(distances) < 1e-6
