"""Bodies of links and objects, each in the frame that it moves with."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros.collision.robot_bodies import LinkBody, LinkPlace
from robomech_ros.collision.scene_objects import SceneObject, around_object
from robomech_ros.collision.shapes import Body
from robomech_ros.typing import Array

_NO_SPHERES = np.empty((0, 8))


@dataclass(frozen=True, eq=False)
class PlacedBody:
    """A body of a link or an object.

    Attributes
    ----------
    owner : str
        The link or object.
    frame : int
        The frame that it moves with; 0 for the base.
    pose : ndarray, shape (4, 4)
        Pose in that frame (m).
    body : Body
    spheres : ndarray, shape (s, 8)
        Spheres that cover it, in the frame of the body; no rows for a body of the world.
    around : ndarray, shape (4,)
    is_carried : bool
        Whether it is an object that a link carries.
    """

    owner: str
    frame: int
    pose: Array
    body: Body
    spheres: Array
    around: Array
    is_carried: bool = False

    @cached_property
    def corners(self) -> Array:
        """Corners of the hull in the frame that the body moves with (k, 3), m."""
        corners: Array = self.body.corners @ self.pose[:3, :3].T + self.pose[:3, 3]
        return corners


def place_bodies(
    bodies: Sequence[LinkBody], links: Mapping[str, LinkPlace]
) -> Iterator[PlacedBody]:
    """Yield the bodies of links."""
    for link, body, pose, spheres, around in bodies:
        frame, place = links[link]
        yield PlacedBody(link, frame, place @ pose, body, spheres, around)


def place_objects(
    objects: Collection[SceneObject], links: Mapping[str, LinkPlace]
) -> Iterator[PlacedBody]:
    """Yield the bodies of the objects that links carry, then those of the others in the base."""
    for one in objects:
        if one.link:
            frame, place = links[one.link]
            for (_, body, pose), cover in zip(one.parts, one.covers, strict=True):
                yield PlacedBody(one.name, frame, place @ one.pose @ pose, body, *cover, True)
    for one in objects:
        if not one.link:
            for _, body, pose in one.parts:
                there = one.pose @ pose
                yield PlacedBody(one.name, 0, there, body, _NO_SPHERES, around_object(body))


def reason_to_ignore(
    first: str, second: str, objects: Mapping[str, SceneObject], links: Mapping[str, LinkPlace]
) -> str:
    """Return why a pair of links or objects needs no check as it is placed; empty if it does."""
    frames = []
    for name, other in ((first, second), (second, first)):
        one = objects.get(name)
        link = one.link if one is not None else name
        if one is not None and one.link and (other == one.link or other in one.touch_links):
            return "a link may touch what it carries"
        frames.append(links[link].frame if link else 0)
    return "nothing moves them against each other" if frames[0] == frames[1] else ""
