"""The world around an arm: its solids, the nearest pair, struck out postures, and plans."""

import math

import numpy as np
import pytest
from shaped_arm import shaped_ur5e

from robomech_ros.collision import Box, Capsule, Cone, Cylinder, Mesh, Plane, PlanningScene, Sphere
from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import load_description, load_robot
from robomech_ros.rvs.model.arms.arm import ArmView
from robomech_ros.rvs.model.bodies.object_solids import middle_of, parts_of
from robomech_ros.rvs.model.bodies.solids import box
from robomech_ros.rvs.model.motions.planning import JOINTS, plan_between
from robomech_ros.rvs.model.world import (
    AROUND,
    AROUND_TO_POSE,
    WorldView,
    judge_motion,
    plan_around,
    scene_for,
)
from robomech_ros.rvs.page.tables import posture_table
from robomech_ros.rvs.page.units import RADIANS
from robomech_ros.spatial import pose_from_position_quaternion

CHAIN = load_description(shaped_ur5e(acceleration=8.0)).chain()
HERE = np.array([0.6, -1.2, 1.6, -1.9, -1.5708, 0.0])
THERE = np.array([-1.0, *HERE[1:]])
TILTED = pose_from_position_quaternion([0.1, -0.2, 0.3], [0.2, 0.4, 0.4, 0.8])


def at(*position):
    """A pose without rotation."""
    pose = np.eye(4)
    pose[:3, 3] = position
    return pose


@pytest.fixture
def scene():
    """A UR5e with shapes, and a wall that it does not reach over at the start."""
    made = PlanningScene(CHAIN)
    made.add("wall", Box(0.4, 0.02, 0.6), at(0.65, 0.0, 0.3))
    return made


def apart(link, other):
    """Return the distance (m) of a link and the wall at the start, by Pinocchio's models."""
    import coal
    import pinocchio

    model = pinocchio.buildModelFromXML(shaped_ur5e())
    shapes = pinocchio.buildGeomFromUrdfString(
        model, shaped_ur5e(), pinocchio.GeometryType.COLLISION
    )
    data, placed = model.createData(), shapes.createData()
    pinocchio.updateGeometryPlacements(model, data, shapes, placed, HERE)
    wall = coal.Box(0.4, 0.02, 0.6), coal.Transform3s(np.eye(3), np.array([0.65, 0.0, 0.3]))
    found = []
    for number, one in enumerate(shapes.geometryObjects):
        if model.frames[one.parentFrame].name == link:
            where = placed.oMg[number]
            shape = one.geometry, coal.Transform3s(where.rotation, where.translation)
            request = coal.DistanceRequest()
            request.gjk_tolerance = 1e-10
            found.append(coal.distance(*shape, *wall, request, coal.DistanceResult()))
    return min(found)


def volume(solid):
    """Return the volume (m^3) inside triangles; negative if they are seen from inside."""
    a, b, c = (solid.vertices[solid.faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


TRIANGLES = box(0.2, 0.3, 0.4)


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        (Box(0.2, 0.3, 0.4), 0.024),
        (Sphere(0.2), 4.0 / 3.0 * math.pi * 0.2**3),
        (Cylinder(0.1, 0.5), math.pi * 0.1**2 * 0.5),
        (Capsule(0.1, 0.5), math.pi * 0.1**2 * 0.5 + 4.0 / 3.0 * math.pi * 0.1**3),
        (Cone(0.1, 0.6), math.pi * 0.1**2 * 0.6 / 3.0),
        (Mesh(TRIANGLES.vertices, TRIANGLES.faces), 0.024),
    ],
)
def test_a_solid_is_its_shape_seen_from_outside(scene, shape, expected):
    scene.add("one", [(shape, TILTED)])
    (part,) = parts_of(scene.objects["one"], 1.0)
    # Round bodies are drawn with 24 sides.
    assert 0.96 * expected < volume(part.solid) < expected * (1.0 + 1e-9)
    low, high = part.solid.vertices.min(axis=0), part.solid.vertices.max(axis=0)
    geometry = shape.body().geometry
    geometry.computeLocalAABB()
    np.testing.assert_allclose(low, geometry.aabb_local.min_, atol=1e-9)
    np.testing.assert_allclose(high, geometry.aabb_local.max_, atol=1e-9)
    np.testing.assert_array_equal(part.pose, TILTED)
    centre = middle_of([part]) - TILTED[:3, 3]
    assert np.abs(centre).max() < 0.05 and not part.endless


def test_the_tip_of_a_cone_is_up(scene):
    scene.add("cone", Cone(0.1, 0.6))
    (part,) = parts_of(scene.objects["cone"], 1.0)
    top = part.solid.vertices[part.solid.vertices[:, 2] > 0.299]
    np.testing.assert_allclose(top, [[0.0, 0.0, 0.3]] * len(top), atol=1e-12)


def test_a_plane_ends_just_below_itself(scene):
    normal = np.array([0.6, 0.0, 0.8])
    scene.add("slope", Plane(normal, -0.4))
    (part,) = parts_of(scene.objects["slope"], 2.0)
    heights = part.solid.vertices @ normal + 0.4
    assert part.endless and -0.01 < heights.min() < heights.max() < 0.0
    assert np.ptp(part.solid.vertices[:, 1]) == pytest.approx(2.0)


def test_what_is_said_is_the_clearance_of_the_scene_as_objects_move(scene):
    world = WorldView(scene)
    # Links that are always near each other do not hide the wall.
    found, own = world.nearest(HERE), scene.clearance(HERE)
    assert "wall" in found.bodies and "wall" not in own.bodies and found.distance > own.distance
    pairs = [(name, "wall") for name in scene.bodies if name != "wall"]
    assert found.distance == pytest.approx(min(apart(*pair) for pair in pairs), abs=1e-9)
    assert world.touching(HERE) == () and world.contact(HERE) == ""
    assert f"{found.distance:.3g} m apart" in world.nearest_text(HERE)
    tip, version = forward_kinematics(CHAIN, HERE)[:3, 3], world.version
    world.move("wall", at(*tip))
    assert world.version == version + 1
    assert "wall" in world.touching(HERE) and "'wall'" in world.contact(HERE)
    assert world.nearest(HERE).distance == scene.clearance(HERE).distance < 0.0


def test_an_object_that_cannot_be_moved_stays(scene):
    world = WorldView(scene)
    scene.add("tool", Sphere(0.01))
    scene.attach("tool", "tool0")
    assert world.movable == ("wall",)
    for name, pose in (("tool", np.eye(4)), ("nobody", np.eye(4)), ("wall", at(1e5, 0.0, 0.0))):
        with pytest.raises(BadValueError, match="which no link carries|coordinates up to"):
            world.move(name, pose)
    np.testing.assert_array_equal(scene.objects["wall"].pose, at(0.65, 0.0, 0.3))
    assert world.version == 0


def test_postures_in_contact_are_struck_out_with_the_pair(scene):
    arm = ArmView(CHAIN, HERE)
    assert not any(arm.posture_contacts) and arm.faulty_links == ()
    arm.world = WorldView(scene)
    # Beside the forearm of some of the eight postures.
    middle = forward_kinematics(CHAIN, HERE)[:3, 3]
    arm.world.move("wall", at(*middle + [-0.1, 0.1, 0.15]))
    postures = arm.study.postures
    free = [scene.is_free(posture.q) for posture in postures]
    assert 0 < sum(free) < len(free)
    assert [not contact for contact in arm.posture_contacts] == free
    table = posture_table(postures, [(0, 0, 0)] * 8, arm.posture_contacts, arm.units, RADIANS)
    assert table.count("data-contact") == table.count("<s ") == 8 - sum(free)
    assert "&#x27;wall&#x27;" in table
    arm.world.move("wall", at(5.0, 0.0, 0.0))
    assert "&#x27;wall&#x27;" not in "".join(arm.posture_contacts)


def test_joints_beside_the_arm_move_what_hangs_on_them():
    # An arm of three joints, whose wrist is moved by joints that are none of it.
    upper = WorldView(PlanningScene(CHAIN.description.chain(tip="forearm_link")))
    positions = dict(zip(CHAIN.joint_names, HERE, strict=True))
    upper.place_others(positions)
    upper.place_others(positions)
    assert upper.version == 1
    wrist = PlanningScene(CHAIN).link_pose("wrist_3_link", HERE)
    np.testing.assert_allclose(
        upper.scene.link_pose("wrist_3_link", HERE[:3]), wrist, rtol=0.0, atol=1e-12
    )
    upper.replace(PlanningScene(upper.scene.chain))
    np.testing.assert_allclose(
        upper.scene.link_pose("wrist_3_link", HERE[:3]), wrist, rtol=0.0, atol=1e-12
    )


@pytest.mark.parametrize("kind", [AROUND, AROUND_TO_POSE])
def test_a_plan_leads_around_the_wall_and_is_certified(scene, kind):
    straight = plan_between(CHAIN, HERE, THERE, JOINTS, "poly345").motion
    verdict = judge_motion(scene, straight)
    times = np.linspace(0.0, straight.duration, 4001)
    first = times[np.argmin(scene.is_free(straight.at(times)))]
    assert verdict.warns and "'wall'" in verdict.sentence
    assert verdict.sentence.endswith(f" at {first:.2f} s.")
    made = plan_around(scene, HERE, THERE, kind, "time_optimal")
    assert made.complete and made.motion.duration > straight.duration
    assert judge_motion(scene, made.motion) == ("Certified free of contact.", False)
    assert scene.is_free(made.motion.at(np.linspace(0.0, made.motion.duration, 4001))).all()
    ends = made.motion.q[[0, -1]]
    np.testing.assert_allclose(ends[0], HERE, atol=1e-9)
    T = forward_kinematics(CHAIN, np.array([ends[1], THERE]))
    np.testing.assert_allclose(T[0], T[1], atol=1e-6)
    if kind == AROUND:
        np.testing.assert_allclose(ends[1], THERE, atol=1e-9)


def test_a_goal_in_contact_has_no_plan_and_says_why(scene):
    within = np.array([0.0, *HERE[1:]])
    made = plan_around(scene, HERE, within, AROUND, "poly345")
    assert made.motion is None and not made.complete
    assert made.sentence.startswith("The goal is in contact: ") and "'wall'" in made.sentence
    with pytest.raises(RobomechError, match="another posture"):
        plan_around(scene, HERE, HERE, AROUND, "poly345")


def test_a_robot_without_shapes_is_not_certified():
    chain = load_robot("ur5e")
    scene = PlanningScene(chain)
    motion = plan_between(chain, HERE, THERE, JOINTS, "poly345").motion
    verdict = judge_motion(scene, motion)
    assert verdict.warns and "No collisions were checked: 'ur5e'" in verdict.sentence
    assert WorldView(scene).nearest_text(HERE) == "nothing can touch"


def test_another_robot_of_the_page_keeps_the_objects(scene):
    scene.add("tool", Sphere(0.01))
    scene.attach("tool", "tool0", ["wrist_3_link"])
    scene.move("wall", at(0.7, 0.1, 0.3))
    other = load_robot("ur5e")
    made = scene_for(other, PlanningScene(CHAIN), scene)
    assert made.chain is other and tuple(made.objects) == ("wall", "tool")
    np.testing.assert_array_equal(made.objects["wall"].pose, at(0.7, 0.1, 0.3))
    assert made.objects["tool"].link == "tool0"
    back = scene_for(CHAIN, scene, made)
    assert back is not scene and back.clearance(HERE).distance == scene.clearance(HERE).distance
