"""The planning scene of move_group: what clients put into it and get out of it."""

import math

import numpy as np
import pytest
from geometry_msgs.msg import Point, Pose
from move_group_client import HERE, UR5E, box, carried, state
from moveit_msgs.msg import (
    AllowedCollisionEntry,
    CollisionObject,
    LinkPadding,
    PlanningScene,
    PlanningSceneComponents as Components,
)
from moveit_msgs.srv import ApplyPlanningScene, GetStateValidity
from sensor_msgs.msg import JointState
from shape_msgs.msg import Mesh, MeshTriangle, Plane, SolidPrimitive

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.nodes.common.messages.joint_messages import joint_state
from robomech_ros.nodes.common.robot.robot_description import LATCHED
from robomech_ros.nodes.move_group.shape_messages import shapes_of

REMOVE, MOVE, APPEND = CollisionObject.REMOVE, CollisionObject.MOVE, CollisionObject.APPEND
TIP = forward_kinematics(UR5E, HERE)[:3, 3]
# In the tool, and a little in the link before the last joint.
PART = box("part", (0.06, 0.06, 0.3), (0.0, 0.0, 0.09))
PART.header.frame_id = "tool0"


def validity(client, q=HERE, **fields):
    return client.graph.ask(
        GetStateValidity, "check_state_validity", robot_state=state(q), **fields
    )


def names(client):
    return [one.id for one in client.scene().world.collision_objects]


def say_where_it_is(client, q=HERE):
    """Publish the state of the arm until the node knows it."""
    publisher = client.graph.client.create_publisher(JointState, "joint_states", 10)
    message = joint_state(UR5E.joint_names, q)
    timer = client.graph.client.create_timer(0.01, lambda: publisher.publish(message))
    while not client.scene().robot_state.joint_state.name:
        pass
    return timer


def test_an_object_is_added_moved_extended_and_removed(client):
    assert client.apply(box())
    (wall,) = client.scene().world.collision_objects
    assert (wall.id, wall.header.frame_id, wall.pose.position.x) == ("wall", "base_link", 0.5)
    assert list(wall.primitives[0].dimensions) == [1.0, 0.02, 1.0]
    moved = CollisionObject(id="wall", operation=MOVE)
    moved.pose.position.x = 0.7
    assert client.apply(moved)
    more = box(position=(0.7, 0.0, 2.0), operation=APPEND)
    assert client.apply(more)
    (wall,) = client.scene().world.collision_objects
    assert wall.pose.position.x == 0.7 and wall.pose.position.z == 0.0
    heights = [pose.position.z for pose in wall.primitive_poses]
    assert heights == pytest.approx([0.0, 2.0])
    assert client.apply(CollisionObject(id="wall", operation=REMOVE))
    assert names(client) == []


def test_a_state_in_contact_names_bodies_depth_and_place(client):
    assert validity(client).valid
    assert client.apply(box("block", (0.1, 0.1, 0.1), TIP))
    answer = validity(client)
    assert not answer.valid
    (contact,) = answer.contacts
    bodies = {contact.contact_body_1: contact.body_type_1}
    bodies[contact.contact_body_2] = contact.body_type_2
    assert bodies == {"wrist_3_link": contact.ROBOT_LINK, "block": contact.WORLD_OBJECT}
    assert 0.0 < contact.depth < 0.1 and contact.header.frame_id == "base_link"
    place = np.array([contact.position.x, contact.position.y, contact.position.z])
    assert np.abs(place - TIP).max() < 0.1


@pytest.mark.parametrize(
    ("kind", "shape"),
    [
        ("primitives", SolidPrimitive(type=SolidPrimitive.SPHERE, dimensions=[0.05])),
        ("primitives", SolidPrimitive(type=SolidPrimitive.CYLINDER, dimensions=[0.1, 0.05])),
        ("primitives", SolidPrimitive(type=SolidPrimitive.CONE, dimensions=[0.2, 0.2])),
        (
            "meshes",
            Mesh(
                vertices=[
                    Point(x=x, y=y, z=z)
                    for x in (-0.1, 0.1)
                    for y in (-0.1, 0.1)
                    for z in (-0.1, 0.1)
                ],
                triangles=[
                    MeshTriangle(vertex_indices=np.array(face, dtype=np.uint32))
                    for face in (
                        *((0, 1, 3), (0, 3, 2), (4, 7, 5), (4, 6, 7), (0, 5, 1), (0, 4, 5)),
                        *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
                    )
                ],
            ),
        ),
        # The half space below the tool's height.
        ("planes", Plane(coef=[0.0, 0.0, 2.0, 0.0])),
    ],
)
def test_every_shape_is_known(client, kind, shape):
    one = CollisionObject(id="thing", **{kind: [shape]})
    one.pose.position = Point(x=TIP[0], y=TIP[1], z=TIP[2])
    if kind == "planes":
        one.pose = Pose()
        one.pose.position.z = TIP[2]
    assert client.apply(one)
    assert not validity(client).valid
    moved = CollisionObject(id="thing", operation=MOVE)
    moved.pose.position.z = -2.0
    assert client.apply(moved)
    assert validity(client).valid


def test_a_plane_is_where_its_equation_has_it():
    """2 z - 1 = 0, with the coefficients of shape_msgs."""
    ((plane, _),) = shapes_of(CollisionObject(planes=[Plane(coef=[0.0, 0.0, 2.0, -1.0])]))
    np.testing.assert_allclose([*plane.normal, plane.offset], [0.0, 0.0, 1.0, 0.5])


def test_an_object_in_the_frame_of_a_link_stands_where_the_link_is(client):
    one = box("block", (0.05, 0.05, 0.05), (0.0, 0.0, 0.3))
    one.header.frame_id = "tool0"
    assert not client.apply(one)  # where the link is, nobody has said
    say_where_it_is(client)
    assert client.apply(one)
    (block,) = client.scene().world.collision_objects
    place = block.pose.position
    tool = forward_kinematics(UR5E, HERE)
    np.testing.assert_allclose([place.x, place.y, place.z], tool[:3, 3] + 0.3 * tool[:3, 2])


def test_an_attached_object_is_checked_against_the_world(client):
    assert client.apply(attached=[carried(PART)])
    (one,) = client.scene().robot_state.attached_collision_objects
    assert (one.link_name, one.object.id, one.object.header.frame_id) == ("tool0", "part", "tool0")
    (contact,) = validity(client).contacts
    assert {contact.contact_body_1, contact.contact_body_2} == {"part", "wrist_2_link"}
    assert client.apply(attached=[carried(PART, touch_links=["wrist_2_link"])])
    assert validity(client).valid
    below = forward_kinematics(UR5E, HERE) @ [0.0, 0.0, 0.22, 1.0]
    assert client.apply(box("table", (0.3, 0.3, 0.01), below[:3]))
    (contact,) = validity(client).contacts
    assert {contact.contact_body_1, contact.contact_body_2} == {"part", "table"}
    assert contact.ROBOT_ATTACHED in (contact.body_type_1, contact.body_type_2)


def test_an_object_is_attached_by_its_name_and_put_down_elsewhere(client):
    tool = forward_kinematics(UR5E, HERE)
    assert client.apply(box("part", (0.02, 0.02, 0.02), tool[:3, 3] + 0.1 * tool[:3, 2]))
    timer = say_where_it_is(client)
    assert client.apply(attached=[carried(CollisionObject(id="part"))])
    scene = client.scene()
    assert not scene.world.collision_objects
    place = scene.robot_state.attached_collision_objects[0].object.pose.position
    np.testing.assert_allclose([place.x, place.y, place.z], [0.0, 0.0, 0.1], atol=1e-12)
    timer.cancel()
    elsewhere = HERE + 0.3
    publisher = client.graph.client.create_publisher(JointState, "joint_states", 10)
    while not np.allclose(client.scene().robot_state.joint_state.position, elsewhere):
        publisher.publish(joint_state(UR5E.joint_names, elsewhere))
    gone = carried(CollisionObject(id="part", operation=REMOVE), link="")
    assert client.apply(attached=[gone])
    (part,) = client.scene().world.collision_objects
    there = forward_kinematics(UR5E, elsewhere)
    expected = there[:3, 3] + 0.1 * there[:3, 2]
    place = part.pose.position
    np.testing.assert_allclose([place.x, place.y, place.z], expected, atol=1e-9)


def test_a_client_may_allow_a_pair_to_touch_and_forbid_it_again(client):
    assert client.apply(box("block", (0.1, 0.1, 0.1), TIP))
    matrix = client.scene(Components.ALLOWED_COLLISION_MATRIX).allowed_collision_matrix
    assert "block" in matrix.entry_names and "wrist_3_link" in matrix.entry_names
    row = list(matrix.entry_names).index("block")
    for allow in (True, False):
        for i, entry in enumerate(matrix.entry_values):
            enabled = list(entry.enabled)
            enabled[row] = allow
            if i == row:
                enabled = [allow] * len(enabled)
            matrix.entry_values[i] = AllowedCollisionEntry(enabled=enabled)
        assert client.apply(allowed_collision_matrix=matrix)
        assert validity(client).valid is allow
        again = client.scene(Components.ALLOWED_COLLISION_MATRIX).allowed_collision_matrix
        column = [
            bool(entry.enabled[row]) for i, entry in enumerate(again.entry_values) if i != row
        ]
        assert any(column) is allow or not allow


def test_a_matrix_that_only_repeats_the_scene_decides_nothing(client):
    """What an object cannot touch where it stands it may touch when it is carried."""
    assert client.apply(box("part", (0.06, 0.06, 0.2), (0.4, 0.4, 0.1)))
    matrix = client.scene(Components.ALLOWED_COLLISION_MATRIX).allowed_collision_matrix
    assert client.apply(allowed_collision_matrix=matrix)
    inside = box("part", (0.1, 0.1, 0.1), (0.0, 0.0, 0.0))
    inside.header.frame_id = "tool0"
    assert client.apply(attached=[carried(inside, touch_links=["wrist_3_link", "wrist_2_link"])])
    folded = np.array([0.0, -0.2, 2.7, -1.0, -1.57, 0.0])
    answer = validity(client, folded)
    assert not answer.valid


def test_the_whole_scene_is_published_for_those_who_come_late(client):
    assert client.apply(box())
    found = client.graph.receive(
        PlanningScene,
        "monitored_planning_scene",
        LATCHED,
        lambda scene: [one.id for one in scene.world.collision_objects] == ["wall"],
    )
    assert not found.is_diff and found.robot_model_name == "ur5e"


def test_topics_change_the_scene(client):
    node = client.graph.client
    publisher = node.create_publisher(CollisionObject, "collision_object", 10)
    while not names(client):
        publisher.publish(box())
    scene = PlanningScene(is_diff=True)
    scene.world.collision_objects = [CollisionObject(id="wall", operation=REMOVE)]
    others = node.create_publisher(PlanningScene, "planning_scene", 10)
    while names(client):
        others.publish(scene)


def test_a_whole_scene_replaces_what_there_was(client):
    assert client.apply(box("old"))
    scene = PlanningScene(is_diff=False)
    scene.world.collision_objects = [box("new")]
    ask = client.graph.ask
    assert ask(ApplyPlanningScene, "apply_planning_scene", scene=scene).success
    assert names(client) == ["new"]


NOWHERE = box()
NOWHERE.header.frame_id = "nowhere"
NOT_A_NUMBER = box()
NOT_A_NUMBER.pose.position.x = math.nan
FAR = box(position=(1e300, 0.0, 0.0))
CORNERS = [Point(), Point(x=1.0), Point(y=1.0), Point(z=1.0)]
NO_AREA = MeshTriangle(vertex_indices=np.array([1, 1, 2], dtype=np.uint32))
BAD = {
    "far away": FAR,
    "no area": CollisionObject(id="x", meshes=[Mesh(vertices=CORNERS, triangles=[NO_AREA])]),
    "no shape": box(sizes=(1.0, 1.0, 1.0)),
    "flat": box(sizes=(0.0, 1.0, 1.0)),
    "too few sizes": box(sizes=(1.0, 1.0)),
    "not a number": NOT_A_NUMBER,
    "unknown frame": NOWHERE,
    "no name": box(""),
    "name of a link": box("tool0"),
    "removed twice": CollisionObject(id="nothing", operation=REMOVE),
    "moved": CollisionObject(id="nothing", operation=MOVE),
}
BAD["no shape"].primitives = []


@pytest.mark.parametrize("name", BAD)
def test_a_scene_with_a_fault_changes_nothing(client, name):
    assert client.apply(box("good"))
    assert not client.apply(box("other"), BAD[name])
    assert names(client) == ["good"]


def test_what_the_library_cannot_take_changes_nothing(client):
    floor = CollisionObject(id="floor", planes=[Plane(coef=[0.0, 0.0, 1.0, 0.0])])
    assert not client.apply(attached=[carried(floor)])
    corners = [Point(), Point(x=1.0), Point(y=1.0)]
    face = MeshTriangle(vertex_indices=np.array([0, 1, 2], dtype=np.uint32))
    flat = CollisionObject(id="flat", meshes=[Mesh(vertices=corners, triangles=[face])])
    flat_is_taken = client.apply(flat)
    assert names(client) == (["flat"] if flat_is_taken else [])
    assert client.apply(box("good"))
    assert "good" in names(client)


def test_what_a_link_carries_is_not_lost_to_another_object_of_its_name(client):
    assert client.apply(attached=[carried(PART)])
    assert not client.apply(box("part"))
    assert not client.apply(attached=[carried(PART, weight=math.nan)])
    (one,) = client.scene().robot_state.attached_collision_objects
    assert one.object.id == "part" and not names(client)


def test_other_faults_change_nothing(client):
    assert not client.apply(link_padding=[LinkPadding(link_name="tool0", padding=0.1)])
    assert not client.apply(attached=[carried(PART, link="nothing")])
    assert not client.apply(attached=[carried(CollisionObject(id="nothing"))])
    scene = PlanningScene(is_diff=True)
    scene.world.octomap.octomap.data = [1, 2, 3]
    ask = client.graph.ask
    assert not ask(ApplyPlanningScene, "apply_planning_scene", scene=scene).success
    scene = client.scene()
    assert not scene.world.collision_objects
    assert not scene.robot_state.attached_collision_objects
