"""The world around an arm on its page: drawn, dragged, and planned around; with raw clients."""

import sys

import msgspec.msgpack
import numpy as np
import pytest

pytest.importorskip("viser")

from raw_client import inside_limits, send_value, wait_until
from world_cases import HERE, ROBOT, SCENE, THERE, WALL, drag_messages, world_layer

from robomech_ros.collision import MissingLibraryError, PlanningScene, Sphere, libraries
from robomech_ros.errors import BadValueError
from robomech_ros.robots import load_description, load_robot
from robomech_ros.rvs import view
from robomech_ros.rvs.page.object_nodes import APART
from robomech_ros.rvs.page.robot_nodes import MARKED

PACK = msgspec.msgpack.encode


@pytest.fixture
def page():
    """A page of a UR5e with shapes among objects, beside the wall."""
    with view(ROBOT, port=0, scene=SCENE) as served:
        served._ask("posture", lambda: served._arm.move_to(HERE))
        wait_until(lambda: np.array_equal(served._arm.q, HERE))
        yield served


@pytest.fixture
def layer(page, commander):
    """The layer of the world, which a client commands."""
    return world_layer(page)


def drag(page, commander, position):
    """Drag the chosen object to a position, and let it go."""
    for message in drag_messages(page, position):
        commander.send(PACK(message))


def chosen(commander, layer, name):
    """Choose an object to be dragged."""
    send_value(commander, layer._choice._impl.uuid, name)
    wait_until(lambda: layer._dragged == name and layer._gizmo.visible)


def label(layer):
    """Return the text of the label at the line between the nearest bodies."""
    return layer._nodes[1]._label.text


def test_objects_are_drawn_in_the_base_and_in_the_link_that_carries_them(page, layer):
    wait_until(lambda: layer._nodes[0]._drawn)
    drawn = layer._nodes[0]._drawn
    assert set(drawn) == {"wall", "ball", "floor", "tool"}
    np.testing.assert_allclose(drawn["wall"].frame.position, WALL)
    assert drawn["wall"].frame.name.startswith("/base/object_")
    # It moves with its link, whose node is moved with the arm.
    assert drawn["tool"].frame.name.startswith(f"{page._stage.path('tool0')}/object_")
    assert layer._choices() == ("nothing", "wall", "ball", "floor")
    assert drawn["floor"].bodies[0].opacity < 1.0


def test_a_dragged_object_moves_the_line_the_label_and_the_struck_out_rows(page, layer, commander):
    arm, scene = page._arm, page._arm.world.scene
    distance = page._arm.world.nearest(HERE).distance
    assert label(layer) == f"{distance:.3f} m"
    assert tuple(layer._nodes[1]._line.colors[0, 0]) == APART
    chosen(commander, layer, "wall")
    np.testing.assert_allclose(layer._gizmo.position, WALL, atol=1e-9)
    tip = arm.tip[:3, 3]
    drag(page, commander, tip)
    wait_until(lambda: "contact" in label(layer))
    np.testing.assert_allclose(scene.objects["wall"].pose[:3, 3], tip, atol=1e-9)
    found = scene.clearance(HERE)
    assert label(layer) == f"contact, {-found.distance:.3f} m deep"
    assert tuple(layer._nodes[1]._line.colors[0, 0]) == MARKED
    np.testing.assert_allclose(layer._nodes[1]._line.points[0], found.points, atol=1e-6)
    np.testing.assert_allclose(layer._nodes[0]._drawn["wall"].frame.position, tip, atol=1e-9)
    assert tuple(layer._nodes[0]._drawn["wall"].bodies[0].color) == MARKED
    struck = [not scene.is_free(posture.q) for posture in arm.study.postures]
    assert any(struck)
    assert page._stage._table.content.count("data-contact") == sum(struck)
    ghosts = {one.number: one for one in page._stage.ghosts._shown}
    assert all(one.struck == struck[k] for k, one in ghosts.items())
    assert all((one.colour == MARKED) == one.struck for one in ghosts.values())
    red = {link for link in found.bodies if link in page._arm.chain.description.links}
    assert page._stage._arm._marked & red == red
    drag(page, commander, WALL)
    wait_until(lambda: "contact" not in label(layer))


def test_what_cannot_be_dragged_is_refused_and_the_page_goes_on(page, layer, commander):
    before = page._arm.world.version
    for name in ("tool", "nobody", 7, True, ""):
        send_value(commander, layer._choice._impl.uuid, name)
    # Nothing is chosen: a gizmo that is not seen moves nothing.
    drag(page, commander, (0.1, 0.1, 0.1))
    chosen(commander, layer, "ball")
    drag(page, commander, (1e300, 0.0, 0.0))
    wait_until(lambda: "Refused: position" in page._stage._notice.content)
    assert page._arm.world.version == before and inside_limits(page)


def test_nothing_is_sent_while_nothing_changes(page, layer, monkeypatch):
    shown = []
    monkeypatch.setattr(layer._nodes[1], "show", shown.append)
    monkeypatch.setattr(layer._nodes[0], "show", lambda *given: shown.append(given))
    page._ask("again", lambda: None)
    done = []
    page._ask("done", lambda: done.append(True))
    wait_until(lambda: done)
    assert not shown
    page.set_joint(0, 0.7)
    wait_until(lambda: len(shown) == 2)


def test_a_plan_around_the_wall_is_certified_until_the_wall_is_dragged_into_it(
    page, layer, commander
):
    motions = next(one for one in page._layers if type(one).__name__ == "MotionLayer")
    wait_until(lambda: "around obstacles" in motions._way_choice.options)
    motions._ends = {"start": HERE, "goal": THERE}
    page._ask("plan", lambda: motions.choose_plan("joints", "poly345"))
    wait_until(lambda: motions.verdict is not None and motions.verdict.warns)
    assert "Contact of " in motions._status.content and "wall" in motions._status.content
    page._ask("plan", lambda: motions.choose_plan("around obstacles", "poly345"))
    wait_until(lambda: "Certified free of contact." in motions._status.content)
    assert "around obstacles by" in motions.status
    motion = page._plan.motion
    assert page._arm.world.scene.check_motion(motion.curve).certified
    middle = motion.at(motion.duration / 2.0)
    chosen(commander, layer, "ball")
    drag(page, commander, page._arm.world.scene.link_pose("wrist_3_link", middle)[:3, 3])
    wait_until(lambda: "Contact of " in motions._status.content)
    assert "ball" in motions._status.content


def test_joints_beside_the_arm_change_the_table_once_they_rest():
    chain = load_description(ROBOT).chain()
    scene = PlanningScene(ROBOT, tip="forearm_link")
    pose = PlanningScene(chain).link_pose("wrist_3_link", HERE)
    scene.add("ball", Sphere(0.01), pose)
    with view(ROBOT, port=0, scene=scene) as page:
        page._ask("posture", lambda: page._arm.move_to(HERE[:3]))
        wait_until(lambda: "data-postures" in page._stage._table.content)
        assert not any("ball" in contact for contact in page._arm.posture_contacts)
        positions = dict(zip(chain.joint_names, HERE.tolist(), strict=True))
        for _ in range(2):
            done = []
            world_layer(page)._follow(positions)
            page._worker.submit("done", lambda done=done: done.append(True))
            wait_until(lambda done=done: done)
        wait_until(lambda: "&#x27;ball&#x27;" in page._stage._table.content)


def test_another_robot_of_the_page_keeps_what_was_dragged(page, layer, commander):
    chosen(commander, layer, "wall")
    drag(page, commander, (0.7, 0.1, 0.3))
    wait_until(lambda: page._arm.world.version == 1)
    other = load_description("ur5e")
    page.replace(other, other.chain())
    wait_until(lambda: page._arm.chain.description is other and page._panel is not None)
    world = page._arm.world
    np.testing.assert_allclose(world.objects["wall"].pose[:3, 3], (0.7, 0.1, 0.3), atol=1e-9)
    assert set(world.objects) == {"wall", "ball", "floor", "tool"}
    wait_until(lambda: "no collision geometry" in world_layer(page)._table.content)


def test_a_scene_of_the_library_is_shown_and_stays_as_it_is():
    scene = PlanningScene(ROBOT)
    scene.load(SCENE)
    with view(ROBOT, port=0, scene=scene) as page:
        assert page._arm.chain is scene.chain and page._arm.world.scene is not scene
        page._arm.world.move("wall", np.eye(4))
    np.testing.assert_array_equal(scene.objects["wall"].pose[:3, 3], WALL)


@pytest.mark.parametrize("robot", ["mecanum", "hexapod", "puma560"])
def test_a_scene_of_another_robot_is_refused(robot):
    scene = PlanningScene(load_robot("ur5e"))
    with pytest.raises(BadValueError, match="scene is"):
        view(robot, port=0, scene=scene)


def test_without_the_library_of_collisions_only_a_scene_is_refused(monkeypatch):
    monkeypatch.setitem(sys.modules, "coal", None)
    libraries.coal.cache_clear()
    try:
        with pytest.raises(MissingLibraryError, match="pip install"):
            view(ROBOT, port=0, scene=SCENE)
        with view(ROBOT, port=0) as page:
            assert page._arm.world is None
    finally:
        libraries.coal.cache_clear()
