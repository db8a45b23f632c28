"""Range of a platform from its present pose, as a surface coloured by the limiting limbs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomech_ros.parallel import (
    Mechanism,
    ParallelRobot,
    Planar3RPR,
    Planar3RRR,
    platform_orientation_workspace,
    platform_position_workspace,
)
from robomech_ros.parallel.kinetostatics.workspace import PlatformWorkspace
from robomech_ros.parallel.kinetostatics.workspace_surface import neighbours
from robomech_ros.rvs.model.ghosts import PALETTE, Rgb, mixed
from robomech_ros.typing import Array

# Numbers of directions in space, in the plane, and for limbs of any kind, each taking a hundred
# times as long; points of the arc of turns in the plane.
ALL_ROUND, ROUND, FEW, ARC = 256, 240, 48, 60
# Drawn length of a rotation by pi, and radius of the arc of rotations in the plane, in sizes.
HALF_TURN, RADIUS = 1.0, 0.4
# Label and colour of directions without an end in range; and of singularities.
FREE, FREE_COLOUR, SINGULAR_COLOUR = "nothing, as far as is looked", (170, 170, 170), (40, 40, 40)


@dataclass(frozen=True, eq=False)
class PlatformReach:
    """Boundary of the positions or orientations that a platform reaches from its pose.

    - ``least``, ``greatest``: least and greatest range (m, or rad).
    """

    #: Triangles in space, shape (k, 3, 3), or lines in the plane, shape (k, 2, 3), by their cause,
    #: in the base (m).
    parts: dict[str, Array]
    #: Colour of each cause, 0 to 255.
    colours: dict[str, Rgb]
    #: Part of the directions that each cause ends, from 0 to 1, the largest first.
    shares: dict[str, float]
    least: float
    greatest: float
    #: Whether the platform is turned; each turn is drawn along its axis, from the platform.
    turns: bool = False

    @property
    def flat(self) -> bool:
        """True if it is a line in a plane."""
        return any(part.shape[1] == 2 for part in self.parts.values())


def platform_reach(
    robot: ParallelRobot | Mechanism, q: Array, *, turns: bool = False
) -> PlatformReach:
    """Compute the range of the platform from its pose; takes some 0.1 to 5 s.

    - ``q``: all joints (rad or m), loops closed, shape (n,).
    - ``turns``: whether the platform is rotated at its position instead of translated.
    """
    T, planar = robot.mechanism.pose(q), isinstance(robot, Planar3RPR | Planar3RRR)
    if turns and planar:
        return _arc(robot, T)
    explore = platform_orientation_workspace if turns else platform_position_workspace
    if isinstance(robot, Mechanism):
        found = explore(robot, T, directions=FEW)
    else:
        found = explore(robot, T, directions=ROUND if planar else ALL_ROUND)
    points = found.points
    if turns:
        along = HALF_TURN * robot.mechanism.size / np.pi * found.distances
        points = T[:3, 3] + along[:, None] * found.directions
    pieces = neighbours(found.directions)
    corners = points[pieces]
    if pieces.shape[1] == 1:
        corners = np.concatenate([corners, np.broadcast_to(T[:3, 3], corners.shape)], axis=1)
    # A piece has the cause of its first corner.
    of_piece = _causes(found)[pieces[:, 0]]
    return _reach(found, {name: corners[of_piece == name] for name in np.unique(of_piece)})


def _arc(robot: ParallelRobot | Mechanism, T: Array) -> PlatformReach:
    """Draw the rotation range of a planar platform, from its present x axis."""
    found = platform_orientation_workspace(robot, T, directions=[[0, 0, 1], [0, 0, -1]])
    start = np.arctan2(T[1, 0], T[0, 0])
    radius, parts = RADIUS * robot.mechanism.size, dict[str, Array]()
    for sign, angle, cause in zip((1.0, -1.0), found.distances, _causes(found), strict=True):
        at = start + sign * np.linspace(0.0, angle, ARC)
        points = T[:3, 3] + radius * np.stack((np.cos(at), np.sin(at), 0.0 * at), axis=1)
        points = np.vstack([points, T[:3, 3]])
        lines = np.stack([points[:-1], points[1:]], axis=1)
        parts[cause] = np.concatenate([parts[cause], lines]) if cause in parts else lines
    return _reach(found, parts)


def _causes(found: PlatformWorkspace) -> NDArray[np.str_]:
    return np.where(found.causes == "", FREE, found.causes)


def _reach(found: PlatformWorkspace, parts: dict[str, Array]) -> PlatformReach:
    """Add colours and text to a drawing."""
    shares = {name or FREE: share for name, share in found.shares().items()}
    return PlatformReach(
        {name: parts[name] for name in shares if name in parts},
        _colours(list(shares)),
        shares,
        float(found.distances.min()),
        float(found.distances.max()),
        found.turns,
    )


def _colours(causes: list[str]) -> dict[str, Rgb]:
    """Return each limb one colour of the palette, lighter where it is too long."""
    colours: dict[str, Rgb] = {}
    for cause in causes:
        digits = "".join(filter(str.isdigit, cause.partition(":")[0]))
        if cause == FREE:
            colours[cause] = FREE_COLOUR
        elif ":" not in cause or not digits:
            colours[cause] = SINGULAR_COLOUR
        else:
            own, part = PALETTE[(int(digits) - 1) % len(PALETTE)], 0.45 if "long" in cause else 0.0
            colours[cause] = mixed(own, (255, 255, 255), part)
    return colours
