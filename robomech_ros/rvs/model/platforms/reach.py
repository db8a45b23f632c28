"""Where a platform can be with its present orientation, as a surface coloured by what ends it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robomech_ros.parallel import ParallelRobot, platform_position_workspace
from robomech_ros.rvs.model.ghosts import PALETTE, Rgb
from robomech_ros.rvs.model.solids import Solid, sphere

__all__ = ["PlatformReach", "platform_reach"]

Array = NDArray[np.float64]

# Directions in the plane.
ROUND = 240
# What ends nothing within what is looked at, and a colour for it; and for singularities.
FREE, FREE_COLOUR, SINGULAR_COLOUR = "nothing, as far as is looked", (170, 170, 170), (40, 40, 40)


@dataclass(frozen=True, eq=False)
class PlatformReach:
    """The boundary of the positions that a platform gets to from where it is.

    Parameters
    ----------
    parts : dict of str to ndarray, shape (k, 3, 3) or (k, 2, 3)
        Of each cause, triangles in the space, or lines in the plane, in the base (m).
    colours : dict of str to tuple of int
        Of each cause, 0 to 255.
    shares : dict of str to float
        Part of the directions that each cause ends, from 0 to 1, the largest first.
    least, greatest : float
        How far the platform gets from its position (m).
    """

    parts: dict[str, Array]
    colours: dict[str, Rgb]
    shares: dict[str, float]
    least: float
    greatest: float

    @property
    def flat(self) -> bool:
        """Whether it is a line in a plane."""
        return any(part.shape[1] == 2 for part in self.parts.values())


def platform_reach(robot: ParallelRobot, q: Array) -> PlatformReach:
    """Find how far the platform gets from where it is, its orientation kept; takes some 0.1 to 3 s.

    Parameters
    ----------
    robot : StewartGough, Delta, Planar3RPR or Planar3RRR
    q : ndarray, shape (n,)
        All joints (rad or m), loops closed.

    Raises
    ------
    BadValueError
        The platform does not move to places, or is outside its limits or singular where it is.
    """
    T = robot.mechanism.pose(q)
    if robot.mechanism.dof == 3 and _is_planar(robot):
        angles = np.linspace(0.0, 2.0 * np.pi, ROUND, endpoint=False)
        rays = np.stack((np.cos(angles), np.sin(angles), 0.0 * angles), axis=1)
        here = np.arange(ROUND)
        pieces = np.stack((here, (here + 1) % ROUND), axis=1)
    else:
        ball: Solid = sphere(1.0)
        rays, pieces = ball.vertices, ball.faces
    found = platform_position_workspace(robot, T, directions=rays)
    causes = np.where(found.causes == "", FREE, found.causes)
    points = found.points
    # A piece has the cause of its first corner.
    of_piece = causes[pieces[:, 0]]
    shares = {name or FREE: share for name, share in found.shares().items()}
    return PlatformReach(
        {name: points[pieces[of_piece == name]] for name in shares if (of_piece == name).any()},
        _colours(list(shares)),
        shares,
        float(found.distances.min()),
        float(found.distances.max()),
    )


def _is_planar(robot: ParallelRobot) -> bool:
    from robomech_ros.parallel import Planar3RPR, Planar3RRR

    return isinstance(robot, Planar3RPR | Planar3RRR)


def _colours(causes: list[str]) -> dict[str, Rgb]:
    """Give each limb one colour of the palette, lighter where it is too long."""
    colours: dict[str, Rgb] = {}
    for cause in causes:
        digits = "".join(filter(str.isdigit, cause.partition(":")[0]))
        if cause == FREE:
            colours[cause] = FREE_COLOUR
        elif ":" not in cause or not digits:
            colours[cause] = SINGULAR_COLOUR
        else:
            red, green, blue = PALETTE[(int(digits) - 1) % len(PALETTE)]
            part = 0.45 if "long" in cause else 0.0
            shade = [round(value + part * (255 - value)) for value in (red, green, blue)]
            colours[cause] = (shade[0], shade[1], shade[2])
    return colours
