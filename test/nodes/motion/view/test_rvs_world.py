"""The planning scene of move_group on the page of a running robot, over real DDS."""

import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("viser")
pytest.importorskip("moveit_msgs")
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "rvs"))

from drivers import Driver
from move_group_client import HERE, UR5E, Client, box, carried
from moveit_msgs.msg import CollisionObject
from raw_client import wait_until
from shaped_arm import shaped_ur5e
from world_cases import drag_messages, world_layer

from robomech_ros.collision import Box, PlanningScene
from robomech_ros.nodes.move_group.node import MoveGroupNode
from robomech_ros.nodes.rvs.node import RvsNode

ROBOT = {"robot_description": shaped_ur5e()}
WALL = (0.65, 0.0, 0.3)


@pytest.fixture
def arm(graph):
    """A simulated UR5e with shapes."""
    return Driver(graph, graph.start, **ROBOT, initial_positions=HERE.tolist())


@pytest.fixture
def shown(graph, arm, browse):
    """Its page, whose robot stands where the simulated one does."""
    browser = browse(graph.start(RvsNode, **ROBOT, port=0))
    wait_until(lambda: np.allclose(browser.page._arm.q, HERE, atol=1e-6))
    return browser


@pytest.fixture
def client(graph):
    """A client of a move_group."""
    graph.start(MoveGroupNode, assume_limits=True, state_timeout=20.0, **ROBOT)
    return Client(graph)


def place(one):
    """Return where a collision object is (m)."""
    return np.array([one.pose.position.x, one.pose.position.y, one.pose.position.z])


def objects(client):
    """Return the objects of move_group by name."""
    return {one.id: one for one in client.scene().world.collision_objects}


def drag(shown, position):
    """Drag the chosen object to a position, and let it go."""
    for message in drag_messages(shown.page, position):
        shown.send(message)


def test_objects_of_move_group_are_seen_dragged_and_gone(graph, client, arm, shown):
    layer, moved = world_layer(shown.page), []
    graph.client.create_subscription(CollisionObject, "collision_object", moved.append, 10)
    tool = box("tool", (0.02, 0.02, 0.05), (0.0, 0.0, 0.04))
    tool.header.frame_id = "tool0"
    assert client.apply(box(sizes=(0.4, 0.02, 0.6), position=WALL), attached=[carried(tool)])
    page = shown.page
    wait_until(lambda: layer._choices() == ("nothing", "wall"))
    # They are drawn one after the other.
    drawn_objects = layer._nodes[0]._drawn
    wait_until(lambda: set(drawn_objects) == {"wall", "tool"})
    assert drawn_objects["tool"].frame.name.startswith(f"{page._stage.path('tool0')}/object_")
    wait_until(lambda: "wall" in layer._table.content)
    shown.set(layer._choice, "wall")
    wait_until(lambda: layer._gizmo.visible)
    drag(shown, (0.65, 0.1, 0.3))
    wait_until(lambda: any(one.operation == CollisionObject.MOVE for one in moved))
    assert moved[-1].id == "wall"
    np.testing.assert_allclose(place(moved[-1]), (0.65, 0.1, 0.3), atol=1e-9)
    wait_until(lambda: np.allclose(place(objects(client)["wall"]), (0.65, 0.1, 0.3), atol=1e-9))
    wait_until(lambda: np.allclose(page._arm.world.objects["wall"].pose[:3, 3], (0.65, 0.1, 0.3)))
    # Into the robot: the label follows, as do the postures of the goal.
    drag(shown, page._arm.tip[:3, 3])
    wait_until(lambda: "contact" in layer._nodes[1]._label.text)
    assert "data-contact" in page._stage._table.content
    assert client.apply(CollisionObject(id="wall", operation=CollisionObject.REMOVE))
    wait_until(lambda: set(layer._nodes[0]._drawn) == {"tool"})
    wait_until(lambda: layer._dragged == "nothing" and not layer._gizmo.visible)


def test_the_line_follows_the_robot_and_not_the_goal(client, arm, shown):
    layer, page = world_layer(shown.page), shown.page
    assert client.apply(box(sizes=(0.4, 0.02, 0.6), position=WALL))
    wait_until(lambda: "wall" in layer._choices())
    before = f"{page._arm.world.nearest(HERE).distance:.3f} m"
    wait_until(lambda: layer._nodes[1]._label.text == before)
    shown.set(page._panel._sliders[0], 0.0)
    wait_until(lambda: page._arm.q[0] == 0.0)
    assert "wall" in page._arm.world.contact(page._arm.q)
    assert layer._nodes[1]._label.text == before
    change = np.array([0.3, 0.0, 0.0, 0.0, 0.0, 0.0])
    there = HERE + change
    arm.execute(arm.trajectory((1.0, change)))
    expected = f"{page._arm.world.nearest(there).distance:.3f} m"
    wait_until(lambda: layer._nodes[1]._label.text == expected != before)


def test_without_a_move_group_the_page_says_who_is_missing(shown):
    layer, wall = world_layer(shown.page), PlanningScene(UR5E)
    assert "no planning scene" in layer._table.content
    wall.add("wall", Box(0.4, 0.02, 0.6))
    layer.show_scene(wall)
    wait_until(lambda: layer._choices() == ("nothing", "wall"))
    shown.set(layer._choice, "wall")
    wait_until(lambda: layer._gizmo.visible)
    drag(shown, (0.65, 0.1, 0.3))
    wait_until(lambda: "No move_group listens on '/collision_object'" in shown.said("world"))
