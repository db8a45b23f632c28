"""The bodies of a robot: poses of its links, their shapes, and pairs that need no check."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from robomech_ros._kernels.collision.shapes import TREE_WIDTH
from robomech_ros.collision.meshes import Mesh
from robomech_ros.collision.scene_objects import MOST_SPHERES, covered
from robomech_ros.collision.shapes import Body, Box, Capsule, Cylinder, Shape, Sphere
from robomech_ros.errors import RobomechError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.joint import rotation_from_z
from robomech_ros.robots.mimic import MimicJoint
from robomech_ros.robots.urdf.mesh_files import mesh_file
from robomech_ros.robots.urdf.visuals import Visual, read_collisions
from robomech_ros.spatial import inverse_pose
from robomech_ros.typing import Array

# The fewest spheres that cover a part of a link.
_FEWEST_SPHERES = 3
_known_bodies: WeakKeyDictionary[RobotDescription, tuple[list[LinkBody], dict[str, str]]]
_known_bodies = WeakKeyDictionary()


class LinkPlace(NamedTuple):
    """The frame that a link moves with (0 for the base), and its pose (4, 4) there (m)."""

    frame: int
    pose: Array


class LinkPlaces(NamedTuple):
    """The tree of joints (m, 17) that the drives of a chain move, and the places of the links."""

    joints: Array
    links: dict[str, LinkPlace]


def place_links(chain: SerialChain, others: Mapping[str, float]) -> LinkPlaces:
    """Find the links that the drives of a chain move, on the chain and beside it.

    Parameters
    ----------
    chain : SerialChain
        Its base is the frame of all links that do not move.
    others : mapping of str to float
        Values of joints other than its drives (rad or m); the remaining ones are at rest.
    """
    if chain.description is None:
        return _along_chain(chain)
    description = chain.description
    at = description.joint_positions(others)
    rest = description.link_poses(others)
    drives = {name: k for k, name in enumerate(chain.joint_names)}
    rows: list[Array] = []
    places = {description.root: LinkPlace(0, inverse_pose(rest[chain.base]))}
    children: dict[str, list] = {}
    for joint in description.joints:
        children.setdefault(joint.parent, []).append(joint)
    waiting = deque([description.root])
    while waiting:
        link = waiting.popleft()
        frame, pose = places[link]
        for joint in children.get(link, ()):
            follower = description.followers.get(joint.name, MimicJoint(joint.name, 1.0, 0.0))
            if joint.moves and follower.leader in drives and joint.name not in others:
                turn = rotation_from_z(joint.axis)
                slides = float(joint.type == "prismatic")
                drive = drives[follower.leader]
                gains = (drive, follower.multiplier, follower.offset)
                rows.append(_row(frame, slides, gains, pose @ joint.origin @ turn))
                places[joint.child] = LinkPlace(len(rows), turn.T @ joint.after)
            else:
                places[joint.child] = LinkPlace(frame, pose @ joint.pose(at.get(joint.name, 0.0)))
            waiting.append(joint.child)
    return LinkPlaces(np.array(rows).reshape(-1, TREE_WIDTH), places)


def _along_chain(chain: SerialChain) -> LinkPlaces:
    """Place the links of a chain that comes from no description."""
    rows = []
    coupling = chain.coupling
    for i in range(len(chain.packed) - 1):
        gains = (i, 1.0, 0.0)
        if coupling is not None:
            gains = (int(coupling.drive[i]), coupling.gain[i], coupling.offset[i])
        pose = np.eye(4)
        pose[:3, :3] = chain.packed[i, 1:10].reshape(3, 3)
        pose[:3, 3] = chain.packed[i, 10:13]
        rows.append(_row(i, float(chain.packed[i, 0] == PRISMATIC), gains, pose))
    links = {frame.name: LinkPlace(frame.joints, frame.offset) for frame in chain.frames}
    return LinkPlaces(np.array(rows).reshape(-1, TREE_WIDTH), links)


def _row(frame: int, slides: float, gains: tuple[int, float, float], pose: Array) -> Array:
    return np.array([frame, slides, *gains, *pose[:3, :3].ravel(), *pose[:3, 3]])


def pose_of_link(places: LinkPlaces, link: str, q: Array) -> Array:
    """Return the pose (4, 4) of a link in the base at drives q (n,) (m)."""
    from robomech_ros._kernels.collision.bounds import frames_at

    place = places.links[link]
    frames = np.empty((len(places.joints) + 1, 12))
    frames_at(places.joints, q, frames)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = frames[place.frame, :9].reshape(3, 3), frames[place.frame, 9:]
    result: Array = pose @ place.pose
    return result


class LinkShape(NamedTuple):
    """A shape of a link, and its pose (4, 4) in the link (m)."""

    link: str
    shape: Shape
    pose: Array


class LinkBody(NamedTuple):
    """A body of a link, its pose (4, 4) in the link (m), and its spheres; see `covered`."""

    link: str
    body: Body
    pose: Array
    spheres: Array
    around: Array


def link_bodies(
    description: RobotDescription | None,
) -> tuple[Sequence[LinkBody], Mapping[str, str]]:
    """Return the bodies of all links, and the reason for each link without usable geometry.

    The result is cached: all chains of a robot share it.
    """
    if description is None:
        return (), {}
    if description not in _known_bodies:
        found: list[LinkBody] = []
        faults: dict[str, str] = {}
        # Only one mesh at a time is in memory: it takes far more than its convex bodies.
        for link, shape, pose in _link_shapes(description, faults):
            try:
                bodies = shape.parts() if isinstance(shape, Mesh) else [shape.body()]
            except RobomechError as error:
                faults[link] = str(error)
                continue
            most = max(MOST_SPHERES // len(bodies), _FEWEST_SPHERES)
            found += [LinkBody(link, body, pose, *covered(body, most)) for body in bodies]
        _known_bodies[description] = found, faults
    return _known_bodies[description]


def link_shapes(description: RobotDescription | None) -> tuple[list[LinkShape], dict[str, str]]:
    """Read the shapes of all links, and the reason for each link with an unusable shape."""
    faults: dict[str, str] = {}
    return list(_link_shapes(description, faults)), faults


def _link_shapes(
    description: RobotDescription | None, faults: dict[str, str]
) -> Iterator[LinkShape]:
    """Yield the shapes of all links, and record the faults by link."""
    if description is None or not description.document:
        return
    path = Path(description.where)
    folder = path.resolve().parent if path.suffix and path.is_file() else None
    for given in read_collisions(description.document, description.where):
        try:
            yield LinkShape(given.link, _shape(given, folder), given.pose)
        except RobomechError as error:
            faults[given.link] = str(error)


def _shape(given: Visual, folder: Path | None) -> Shape:
    if given.kind == "mesh":
        file = mesh_file(given.filename, folder, anywhere=True)
        return Mesh(file, scale=given.measures)
    kinds: dict[str, Any] = {"box": Box, "cylinder": Cylinder, "capsule": Capsule, "sphere": Sphere}
    shape: Shape = kinds[given.kind](*given.measures)
    return shape


def adjacent_links(description: RobotDescription | None, with_shapes: set[str]) -> set[frozenset]:
    """Find pairs of links with shapes that one joint holds together, or links without shapes."""
    pairs: set[frozenset] = set()
    if description is None:
        return pairs
    to_parent = {joint.child: joint.parent for joint in description.joints}
    for link in with_shapes:
        above = to_parent.get(link)
        while above is not None and above not in with_shapes:
            above = to_parent.get(above)
        if above is not None:
            pairs.add(frozenset((link, above)))
    return pairs
