"""Three parallel axes next to each other: recognition.

Covered is every arm of six joints in which three neighbouring revolute axes are parallel (in
either sense), whatever the other three revolute axes are, and those in which one of the other
three is prismatic.  Arms with a prismatic joint between the parallel axes, or with two prismatic
joints, are not: the first go to the iterative solver, the second cannot take a general pose.
"""

import itertools
from dataclasses import dataclass

import numpy as np

from robomech_ros._kernels.inverse.parallel import layout as at
from robomech_ros.kinematics.mobility import moves_in_all_directions
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC, unpack_chain
from robomech_ros.typing import Array

# Largest sine between axes taken as parallel: nine printed digits of an angle keep within it, a
# calibrated arm does not.  What is neglected here the polish on the true pose puts back.
PARALLEL_ANGLE = 1e-8
# Axes of the parallel three nearer to each other than this (of the arm's size), or other axes
# with a smaller sine to them, make an arm that loses a degree of freedom: not this family.
PARALLEL_DISTANCE = 1e-5


@dataclass(frozen=True, eq=False)
class AxisLine:
    """A joint axis in the base at q = 0: unit direction, a point (m), whether it is a slide."""

    direction: Array
    point: Array
    slides: bool


@dataclass(frozen=True, eq=False)
class ParallelAxes:
    """The axes in the order in which the solver takes them.

    ``axes`` are a, the three parallel ones, 5 and 6; ``joints`` their indices in the chain.
    """

    order: int
    from_tip: bool
    axes: tuple[AxisLine, ...]
    joints: tuple[int, ...]
    home: Array
    size: float

    @property
    def triple(self) -> tuple[AxisLine, ...]:
        """The three parallel axes."""
        return self.axes[1:4]


def find_parallel_axes(chain: SerialChain) -> ParallelAxes | None:
    """Find three parallel axes next to each other in an arm that can move in all directions."""
    sliding = chain.types == PRISMATIC
    if chain.n != 6 or sliding.sum() > 1:
        return None
    lines, home = _axes(chain)
    size = _size(lines, home)
    for order, from_tip in itertools.product((at.AXIS_BEFORE, at.AXIS_BETWEEN), (False, True)):
        joints = [0, 1, 2, 3, 4, 5] if order == at.AXIS_BEFORE else [3, 0, 1, 2, 4, 5]
        if from_tip:
            # The inverse motion: the axes in opposite order and sense.
            joints = [5 - j for j in joints]
        sense = -1.0 if from_tip else 1.0
        axes = tuple(
            AxisLine(sense * lines[j].direction, lines[j].point, lines[j].slides) for j in joints
        )
        arm = ParallelAxes(order, from_tip, axes, tuple(joints), home, size)
        if _are_parallel(arm) and moves_in_all_directions(chain, size):
            return arm
    return None


def _axes(chain: SerialChain) -> tuple[list[AxisLine], Array]:
    """Find the joint axes and the tip's pose in the base at q = 0."""
    pose = np.eye(4)
    lines = []
    for kind, step in zip(chain.packed[:, 0], unpack_chain(chain.packed), strict=True):
        pose = pose @ step
        lines.append(AxisLine(pose[:3, 2], pose[:3, 3], kind == PRISMATIC))
    return lines[:-1], pose


def _size(lines: list[AxisLine], home: Array) -> float:
    """Measure the arm: the sum of the distances between neighbouring axes' points (m)."""
    points = [line.point for line in lines] + [home[:3, 3]]
    return max(sum(float(np.linalg.norm(b - a)) for a, b in itertools.pairwise(points)), 1e-3)


def _are_parallel(arm: ParallelAxes) -> bool:
    """Tell whether the three axes are parallel and apart, and their neighbours are not so, too."""
    w = arm.triple[0].direction
    if any(line.slides or sine_between(w, line.direction) > PARALLEL_ANGLE for line in arm.triple):
        return False
    neighbours = [arm.axes[0]] if arm.order == at.AXIS_BETWEEN else [arm.axes[0], arm.axes[4]]
    if any(not n.slides and sine_between(w, n.direction) < PARALLEL_DISTANCE for n in neighbours):
        return False
    return all(
        float(np.linalg.norm(np.cross(w, b.point - a.point))) > PARALLEL_DISTANCE * arm.size
        for a, b in itertools.pairwise(arm.triple)
    )


def sine_between(u: Array, v: Array) -> float:
    """Return the sine of the angle between two unit vectors."""
    return float(np.linalg.norm(np.cross(u, v)))
