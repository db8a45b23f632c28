"""The planning scene of the node: objects, attached objects, and pairs that may touch."""

from collections.abc import Callable, Container, Iterable, Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any

from moveit_msgs.msg import CollisionObject
from std_msgs.msg import Header

from robomech_ros.errors import BadValueError, UnknownLinkError, WrongSizeError
from robomech_ros.nodes.common.messages.message_fields import not_negative
from robomech_ros.nodes.common.messages.pose_messages import pose_from_matrix
from robomech_ros.nodes.move_group.shape_messages import (
    PlacedShape,
    append_shapes,
    has_shapes,
    pose_of,
    shapes_of,
)
from robomech_ros.spatial import inverse_pose
from robomech_ros.typing import Array

_NAMES = ("ADD", "REMOVE", "APPEND", "MOVE")
_ADD, _REMOVE, _APPEND, _MOVE = (getattr(CollisionObject, name) for name in _NAMES)
# Names that an error lists.
_MOST_LISTED = 20
# Frame or link to its present pose in the base, (4, 4) (m).
Poses = Mapping[str, Array]


@dataclass(frozen=True, eq=False)
class SceneObject:
    """An object of the planning scene."""

    #: The received CollisionObject, with its pose in the base, or in the link that carries it.
    message: Any
    #: Shapes of the library, and their poses in the object, shape (4, 4) (m).
    shapes: tuple[PlacedShape, ...]
    pose: Array  #: Pose in the base, or in the link that carries it (m), shape (4, 4).
    link: str = ""  #: The link that carries it; empty for none.
    touch_links: tuple[str, ...] = ()  #: Further links that may touch it.
    weight: float = 0.0  #: Its mass (kg); 0 if it is not known.

    def at(self, pose: Array, frame: str, link: str = "") -> "SceneObject":
        """Return the object at another pose (4, 4) (m) in a frame, carried by a link or by none."""
        message = copy(self.message)
        message.header, message.operation = Header(frame_id=frame), _ADD
        message.pose = pose_from_matrix(pose)
        return SceneObject(message, self.shapes, pose, link)


@dataclass
class World:
    """The planning scene, as clients have made it."""

    base_frame: str  #: The frame of the base, as messages name it.
    links: tuple[str, ...]  #: All links of the robot.
    link_of: Callable[[str], str]  #: Returns the link of a frame.
    objects: dict[str, SceneObject] = field(default_factory=dict)  #: Objects by name.
    #: Whether the two bodies of a pair may touch, for the pairs that a client has decided.
    allowed: dict[frozenset[str], bool] = field(default_factory=dict)
    #: Whether a body may touch all others, for the bodies that a client has decided.
    defaults: dict[str, bool] = field(default_factory=dict)
    colors: dict[str, Any] = field(default_factory=dict)  #: Colours of objects, as messages.

    def copy(self, empty: bool = False) -> "World":
        """Return a copy that may be changed, or an empty scene of the same robot."""
        bare = World(self.base_frame, self.links, self.link_of)
        if not empty:
            bare.objects, bare.allowed = dict(self.objects), dict(self.allowed)
            bare.defaults, bare.colors = dict(self.defaults), dict(self.colors)
        return bare

    @property
    def standing(self) -> dict[str, SceneObject]:
        """The objects that no link carries."""
        return {name: one for name, one in self.objects.items() if not one.link}

    @property
    def attached(self) -> dict[str, SceneObject]:
        """The objects that links carry."""
        return {name: one for name, one in self.objects.items() if one.link}

    def apply_object(self, message: Any, poses: Poses, attached: Iterable[str] = ()) -> None:
        """Add, remove, extend or move an object.

        - ``message``: CollisionObject.
        - ``poses``: pose of its frame, by name.
        - ``attached``: names of objects that the same scene attaches; a message that removes one
          of them from the world is accepted and changes nothing.

        Raises RobomechError: a part of the message is invalid, or there is no such object.
        """
        name, operation, standing = message.id, message.operation, self.standing
        if operation == _REMOVE:
            if name and name not in standing and name not in attached:
                raise BadValueError("id", name, _one_of(standing))
            for one in [name] if name else standing:
                if one in standing:
                    del self.objects[one]
            return
        self._check_operation(operation, (_ADD, _APPEND, _MOVE))
        if not name or name in self.links:
            raise BadValueError("id", name, "a name that no link has")
        if operation != _ADD and name not in standing:
            raise BadValueError("id", name, _one_of(standing))
        if name in self.attached:
            link = self.attached[name].link
            raise BadValueError("id", name, f"another name: '{link}' carries it; detach it first")
        pose = poses[message.header.frame_id] @ pose_of(message.pose, "pose")
        if operation == _MOVE:
            self.objects[name] = standing[name].at(pose, self.base_frame)
        else:
            one = _object(message, pose, standing[name] if operation == _APPEND else None)
            self.objects[name] = one.at(one.pose, self.base_frame)

    def keep(self, message: Any, before: "World") -> bool:
        """Reuse an object of an earlier world with the same shapes; return whether there is one.

        Comparing meshes is much faster than reading them.

        - ``message``: CollisionObject; in the base.
        """
        known = before.standing.get(message.id)
        if known is None:
            return False
        unmoved = copy(message)
        unmoved.pose = known.message.pose
        if unmoved != known.message:
            return False
        if message.pose != known.message.pose:
            known = known.at(pose_of(message.pose, "pose"), self.base_frame)
        self.objects[message.id] = known
        return True

    def apply_attached(self, message: Any, poses: Poses) -> None:
        """Attach an object to a link, or detach it.

        - ``message``: AttachedCollisionObject.
        - ``poses``: poses of its frame, of the link, and of all links that carry objects, by name.

        Raises RobomechError: a part of the message is invalid, or there is no such object or link.
        """
        given, name = message.object, message.object.id
        if given.operation == _REMOVE:
            self._detach(name, self.link_of(message.link_name), poses)
            return
        self._check_operation(given.operation, (_ADD, _APPEND))
        link = self._link(message.link_name)
        weight = not_negative("weight", message.weight, "a mass that is not negative (kg)")
        touching = tuple(map(self._link, message.touch_links))
        known = self.objects.get(name)
        if has_shapes(given):
            pose = pose_of(given.pose, "pose")
            if self.link_of(given.header.frame_id) != link:
                pose = inverse_pose(poses[link]) @ poses[given.header.frame_id] @ pose
            extended = given.operation == _APPEND and known is not None and known.link == link
            one = _object(given, pose, known if extended else None)
        elif known is None:
            raise BadValueError("id", name, f"{_one_of(self.objects)}, or a shape")
        else:
            one = known
            if known.link != link:
                in_base = poses[known.link] @ known.pose if known.link else known.pose
                one = replace(known, pose=inverse_pose(poses[link]) @ in_base)
        attached = one.at(one.pose, link, link)
        self.objects[name] = replace(attached, touch_links=touching, weight=weight)

    def allow(self, matrix: Any, ignored: Container[frozenset[str]]) -> None:
        """Apply the entries of an AllowedCollisionMatrix that differ from the present scene.

        A client sends back the whole matrix that it has read. Entries that only repeat the scene
        decide nothing: a pair that cannot touch now may be able to later.

        - ``matrix``: AllowedCollisionMatrix.
        - ``ignored``: pairs of bodies that are not checked now.

        Raises WrongSizeError: the matrix is not square, or does not have a row for each name.
        """
        names, rows = matrix.entry_names, matrix.entry_values
        sizes = [len(rows), *(len(row.enabled) for row in rows)]
        wrong = next((size for size in sizes if size != len(names)), None)
        if wrong is not None:
            raise WrongSizeError("entry_values", wrong, f"{len(names)} in both directions")
        for row, one in zip(rows, names, strict=True):
            for may, other in zip(row.enabled, names, strict=True):
                pair = frozenset((one, other))
                if one != other and may != (pair in ignored):
                    self.allowed[pair] = bool(may)
        defaults, values = matrix.default_entry_names, matrix.default_entry_values
        if len(defaults) != len(values):
            raise WrongSizeError("default_entry_values", len(values), len(defaults))
        self.defaults |= dict(zip(defaults, map(bool, values), strict=True))

    def may_touch(self, one: str, other: str, otherwise: bool) -> bool:
        """Return whether two bodies may touch; `otherwise` if no client has decided it."""
        decided = self.allowed.get(frozenset((one, other)))
        if decided is not None:
            return decided
        known = [self.defaults[name] for name in (one, other) if name in self.defaults]
        return all(known) if known else otherwise

    def _check_operation(self, operation: bytes, known: Iterable[bytes]) -> None:
        if operation not in known:
            words = [name for name in _NAMES if getattr(CollisionObject, name) in known]
            raise BadValueError("operation", operation, f"{', '.join(words)} or REMOVE")

    def _link(self, frame: str) -> str:
        link = self.link_of(frame)
        if link not in self.links:
            raise UnknownLinkError(link, self.links)
        return link

    def _detach(self, name: str, link: str, poses: Poses) -> None:
        """Put objects that are attached to a link, "" being any, back into the world."""
        chosen = {n: one for n, one in self.attached.items() if link in ("", one.link)}
        if name and name not in chosen:
            raise BadValueError("id", name, _one_of(chosen))
        for own in [name] if name else chosen:
            one = chosen[own]
            self.objects[own] = one.at(poses[one.link] @ one.pose, self.base_frame)


def _object(message: Any, pose: Array, known: SceneObject | None) -> SceneObject:
    """Read an object at a pose (4, 4) (m), or add its shapes to a known one."""
    shapes = shapes_of(message)
    if not shapes:
        raise BadValueError("shapes", [], "a primitive, a mesh or a plane")
    if known is None:
        return SceneObject(message, tuple(shapes), pose)
    extended, between = copy(known.message), inverse_pose(known.pose) @ pose
    append_shapes(extended, message, between)
    moved = [(shape, between @ own) for shape, own in shapes]
    return SceneObject(extended, (*known.shapes, *moved), known.pose)


def _one_of(names: Iterable[str]) -> str:
    listed = ", ".join(f"'{name}'" for name in list(names)[:_MOST_LISTED])
    return f"one of {listed}" if listed else "none: there are no such objects"
