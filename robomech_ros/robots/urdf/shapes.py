"""Visual bodies for the parts of a robot that have none.

Drums lie on the axes of joints, rods along slides, and bars between the frames.
"""

import math
from collections import deque
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.robots.joint import Joint, rotation_from_z
from robomech_ros.typing import Array

# Measures of drums and bars, in parts of the robot's reach; bars shorter than the last are left
# out, since the drum of a joint hides them.
DRUM_RADIUS, DRUM_LENGTH, BAR_RADIUS, SHORTEST_BAR = 0.045, 0.12, 0.028, 0.02
# Placeholder for a part without joints and lengths.
_UPRIGHT = Joint("", "fixed", "", "", np.eye(4))
# Part of the thickness at the base that the last part of an arm still has.
THINNEST = 0.55
# Reach (m) that is assumed of a robot without any length.
NO_REACH = 1.0
# Red, green, blue and alpha of the parts of an arm, base first, then over again.
COLOURS = (
    (0.35, 0.38, 0.42, 1.0),
    (0.93, 0.55, 0.14, 1.0),
    (0.85, 0.87, 0.89, 1.0),
    (0.20, 0.47, 0.70, 1.0),
)


@dataclass(frozen=True, eq=False)
class Shape:
    """A cylinder or, where it slides, a box, along z of its own frame; or a ball.

    ``pose`` is that of its middle in the link, shape (4, 4); radius or half the width, and length
    in m, 0 of a ball; ``colour`` counts in ``COLOURS``.
    """

    pose: Array
    radius: float
    length: float
    colour: int
    box: bool = False

    @property
    def rgba(self) -> tuple[float, float, float, float]:
        """Red, green, blue and alpha, from 0 to 1."""
        return COLOURS[self.colour]


@dataclass(frozen=True)
class _Part:
    """Links that fixed joints hold together, and how many moving joints are above them."""

    links: tuple[str, ...]
    above: int


def generated_shapes(
    root: str, joints: Sequence[Joint], with_geometry: Collection[str]
) -> dict[str, list[Shape]]:
    """Make shapes for the rigid parts in which no link has geometry.

    - ``root``: the link that is no joint's child.
    - ``joints``: a tree; the child link's frame is that of the joint (``after`` is the identity).
    - ``with_geometry``: links that are seen already.

    Returns shapes in the frame of a link, by its name; a part always gets at least one.
    """
    children: dict[str, list[Joint]] = {}
    for joint in joints:
        children.setdefault(joint.parent, []).append(joint)
    to_parent = {joint.child: joint for joint in joints}
    reach = _reach(root, children) or NO_REACH
    parts = list(_parts(root, children))
    most = max(part.above for part in parts) or 1
    shapes: dict[str, list[Shape]] = {}
    for part in parts:
        if any(link in with_geometry for link in part.links):
            continue
        scale = reach * (1.0 - (1.0 - THINNEST) * part.above / most)
        colour = part.above % len(COLOURS)
        for link in part.links:
            found = list(_bars(children.get(link, ()), scale, reach, colour))
            above = to_parent.get(link)
            if above is not None and above.moves:
                slides = above.type == "prismatic"
                found.append((_rod if slides else _drum)(above, scale, colour))
            if found:
                shapes[link] = found
        if not any(link in shapes for link in part.links):
            shapes[part.links[0]] = [_drum(_UPRIGHT, scale, colour)]
    return shapes


def _parts(root: str, children: dict[str, list[Joint]]) -> Iterator[_Part]:
    heads = deque([(root, 0)])
    while heads:
        head, above = heads.popleft()
        links = [head]
        for link in links:
            for joint in children.get(link, ()):
                if joint.type == "fixed":
                    links.append(joint.child)
                else:
                    heads.append((joint.child, above + 1))
        yield _Part(tuple(links), above)


def _reach(root: str, children: dict[str, list[Joint]]) -> float:
    """Add up lengths (m) from the root to where they add up to most."""
    longest = 0.0
    waiting = [(root, 0.0)]
    while waiting:
        link, length = waiting.pop()
        longest = max(longest, length)
        for joint in children.get(link, ()):
            step = float(np.linalg.norm(joint.origin[:3, 3]))
            if joint.type == "prismatic":
                step += max(_travel(joint.upper, 0.0), _travel(-joint.lower, 0.0))
            waiting.append((joint.child, length + step))
    return longest


def _bars(joints: Sequence[Joint], scale: float, reach: float, colour: int) -> Iterator[Shape]:
    for joint in joints:
        offset = joint.origin[:3, 3]
        length = float(np.linalg.norm(offset))
        if length > SHORTEST_BAR * reach:
            pose = rotation_from_z(offset / length)
            pose[:3, 3] = 0.5 * offset
            yield Shape(pose, rounded(BAR_RADIUS * scale), length, colour)


def _drum(joint: Joint, scale: float, colour: int) -> Shape:
    radius, length = rounded(DRUM_RADIUS * scale), rounded(DRUM_LENGTH * scale)
    return Shape(rotation_from_z(joint.axis), radius, length, colour)


def _rod(joint: Joint, scale: float, colour: int) -> Shape:
    """Make a rod along a slide that leads back to its origin from wherever it is."""
    back = max(_travel(joint.upper, scale), BAR_RADIUS * scale)
    forth = max(_travel(-joint.lower, scale), BAR_RADIUS * scale)
    pose = rotation_from_z(joint.axis)
    pose[:3, 3] = 0.5 * (forth - back) * joint.axis
    return Shape(pose, rounded(BAR_RADIUS * scale), rounded(back + forth), colour, box=True)


def _travel(limit: float, scale: float) -> float:
    return limit if math.isfinite(limit) else 0.5 * scale


def rounded(length: float) -> float:
    """Keep as many digits as are worth reading of what is only looked at."""
    return float(f"{length:.6g}")
