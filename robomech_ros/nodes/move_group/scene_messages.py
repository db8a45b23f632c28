"""PlanningScene messages: what they name, what is refused, and how one is written."""

from collections.abc import Collection, Iterable
from typing import Any

from moveit_msgs.msg import (
    AllowedCollisionEntry,
    AllowedCollisionMatrix,
    AttachedCollisionObject,
    CollisionObject,
    LinkPadding,
    LinkScale,
    PlanningScene,
    PlanningSceneComponents as Components,
)

from robomech_ros.errors import BadValueError
from robomech_ros.nodes.move_group.shape_messages import has_shapes
from robomech_ros.nodes.move_group.world import World


def refuse_unserved(scene: Any) -> None:
    """Raise BadValueError for an octomap, or padding or scale of a link in a scene."""
    if size := len(scene.world.octomap.octomap.data):
        raise BadValueError("world.octomap", f"{size} bytes", "none: octomaps are not supported")
    for padding in scene.link_padding:
        if padding.padding:
            expected = "0; the parameter padding adds to all links"
            raise BadValueError(f"padding of '{padding.link_name}'", padding.padding, expected)
    for scale in scene.link_scale:
        if scale.scale != 1.0:
            raise BadValueError(f"scale of '{scale.link_name}'", scale.scale, "1")


def frames_of_scene(objects: Iterable[Any], attached: Iterable[Any], world: World) -> set[str]:
    """Return the frames and links whose present poses a change of the scene needs.

    - ``objects``: iterable of CollisionObject.
    - ``attached``: iterable of AttachedCollisionObject.
    - ``world``: the world before the change.
    """
    frames = {one.header.frame_id for one in objects if one.operation != CollisionObject.REMOVE}
    for message in attached:
        given, link = message.object, world.link_of(message.link_name)
        known = world.objects.get(given.id)
        if given.operation == CollisionObject.REMOVE:
            carried = world.attached.items()
            frames |= {one.link for name, one in carried if given.id in ("", name)}
        elif has_shapes(given):
            if world.link_of(given.header.frame_id) != link:
                frames |= {link, given.header.frame_id}
        elif known is not None and known.link != link:
            frames |= {link, known.link} - {""}
    return frames


def write_scene(
    world: World,
    joint_state: Any,
    bodies: Collection[str],
    ignored: Collection[frozenset[str]],
    wanted: int = 0,
) -> PlanningScene:
    """Write the parts of a scene that a client wants.

    - ``joint_state``: the present JointState.
    - ``bodies``: names of links with shapes, then of objects.
    - ``ignored``: pairs of bodies that are not checked.
    - ``wanted``: sum of constants of PlanningSceneComponents; 0 for all.
    """
    scene = PlanningScene()

    def has(*parts: int) -> bool:
        return not wanted or any(wanted & part for part in parts)

    if has(Components.ROBOT_STATE, Components.ROBOT_STATE_ATTACHED_OBJECTS):
        scene.robot_state.joint_state = joint_state
    if has(Components.ROBOT_STATE_ATTACHED_OBJECTS):
        scene.robot_state.attached_collision_objects = [
            AttachedCollisionObject(
                link_name=one.link,
                object=one.message,
                touch_links=list(one.touch_links),
                weight=one.weight,
            )
            for one in world.attached.values()
        ]
    if has(Components.WORLD_OBJECT_GEOMETRY):
        scene.world.collision_objects = [one.message for one in world.standing.values()]
    elif has(Components.WORLD_OBJECT_NAMES):
        scene.world.collision_objects = [
            CollisionObject(id=name, type=one.message.type) for name, one in world.standing.items()
        ]
    if has(Components.ALLOWED_COLLISION_MATRIX):
        scene.allowed_collision_matrix = AllowedCollisionMatrix(
            entry_names=list(bodies),
            entry_values=[
                AllowedCollisionEntry(enabled=[frozenset((a, b)) in ignored for b in bodies])
                for a in bodies
            ],
            default_entry_names=list(world.defaults),
            default_entry_values=list(world.defaults.values()),
        )
    if has(Components.LINK_PADDING_AND_SCALING):
        links = [name for name in bodies if name in world.links]
        scene.link_padding = [LinkPadding(link_name=link) for link in links]
        scene.link_scale = [LinkScale(link_name=link, scale=1.0) for link in links]
    if has(Components.OBJECT_COLORS):
        scene.object_colors = list(world.colors.values())
    return scene
