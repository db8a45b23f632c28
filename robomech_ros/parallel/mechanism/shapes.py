"""Visual shapes of a mechanism: base and platform between their joints, bars, legs that extend.

Bars go from joint to joint, cylinder and rod along a slide, balls stand where joints are, and arcs
of a sphere where all axes meet in its centre.
"""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from robomech_ros.numerics.arrays import distinct
from robomech_ros.parallel.mechanism.tree import links_of_joints
from robomech_ros.robots import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC
from robomech_ros.robots.joint import rotation_from_z
from robomech_ros.robots.urdf.shapes import Shape, rounded
from robomech_ros.typing import Array, ArrayLike

# Radii in parts of the size of the mechanism.
_FRAME, _BAR, _ROD, _BALL, _PLATE = 0.014, 0.012, 0.01, 0.02, 0.006
# Parts of the shortest length of a leg that cylinder and rod have.
_CYLINDER_PART, _ROD_PART = 0.62, 0.92
# Radius (m) of the spheres on which arcs are seen where a mechanism has no lengths, of the arcs of
# the limbs in turn, and how many bars make a right angle.
_SPHERE, _NESTED, _BARS = 0.15, 0.12, 8
_GREY, _ORANGE, _WHITE, _BLUE = 0, 1, 2, 3
_SAME = 1e-6


def shapes_of_limbs(chains: Sequence[SerialChain], home: Array) -> dict[str, list[Shape]]:
    """Make shapes of all links, in the frames that :func:`tree_of_limbs` gives them.

    The home (n,) of all joints tells the lengths of legs without limits.
    """
    steps = [chain.transforms for chain in chains]
    size = max(float(np.linalg.norm(step[:, :3, 3], axis=1).max()) for step in steps)
    on_base = np.array([step[0, :3, 3] for step in steps])
    on_platform = np.array([-step[-1, :3, :3].T @ step[-1, :3, 3] for step in steps])
    shapes: dict[str, list[Shape]] = {}
    start = 0
    for k, (chain, step) in enumerate(zip(chains, steps, strict=True)):
        links = links_of_joints(chain)
        if size <= _SAME:
            shapes.update(_arcs(links, step, _SPHERE + _NESTED * _SPHERE * k))
        else:
            for i, link in enumerate(links):
                shapes[link] = list(_link(chain, step, i, size, home[start + i : start + i + 2]))
        start += chain.n
    if size <= _SAME:
        shapes[chains[0].base] = [_rod_between(np.zeros(3), [0.0, 0.0, -_SPHERE], 0.012, _GREY)]
        shapes[chains[0].tip] = [_ball(np.zeros(3), 0.3 * _SPHERE, _ORANGE)]
        return shapes
    # For planar limbs a plate of the base would hide the platform.
    first = np.array([step[0, :3, 2] for step in steps])
    planar = np.linalg.norm(np.cross(first, first[0]), axis=1).max() <= _SAME
    base = list(_frame(on_base, size, _GREY, plate=not planar))
    for chain, step in zip(chains, steps, strict=True):
        if chain.types[0] == PRISMATIC:
            base.append(_guide(chain, step, 0, size, 0.0))
    shapes[chains[0].base] = base
    shapes[chains[0].tip] = list(_frame(on_platform, size, _ORANGE, plate=True))
    return shapes


def _link(chain: SerialChain, steps: Array, i: int, size: float, home: Array) -> Iterator[Shape]:
    """Make the shapes of the link that joint i moves; home begins with its position."""
    way = steps[i + 1, :3, 3] if i + 1 < chain.n else np.zeros(3)
    if chain.types[i] == PRISMATIC:
        length = _telescope(chain, steps, i, float(home[0]))
        if length > 0.0:
            yield _rod_between(np.zeros(3), [0.0, 0.0, -_ROD_PART * length], _ROD * size, _WHITE)
    elif i + 1 < chain.n and chain.types[i + 1] == PRISMATIC:
        yield _guide(chain, steps, i + 1, size, float(home[1]))
    if np.linalg.norm(way) > _SAME * size:
        yield _rod_between(np.zeros(3), way, _BAR * size, _BLUE if i == 0 else _WHITE)
    yield _ball(np.zeros(3), _BALL * size, _GREY)


def _guide(chain: SerialChain, steps: Array, i: int, size: float, home: float) -> Shape:
    """Make what joint i slides in or on, in the frame of the link before it."""
    start, along = steps[i, :3, 3], steps[i, :3, 2]
    length = _telescope(chain, steps, i, home)
    if length > 0.0:
        end = start + _CYLINDER_PART * length * along
        return _rod_between(start, end, 1.6 * _ROD * size, _BLUE)
    low, high = float(chain.lower[i]), float(chain.upper[i])
    low, high = (x if math.isfinite(x) else 0.5 * y * size for x, y in ((low, -1), (high, 1)))
    return _rod_between(start + low * along, start + high * along, _ROD * size, _GREY)


def _telescope(chain: SerialChain, steps: Array, i: int, home: float) -> float:
    """Return the least length (m) of a leg that joint i extends, 0 for other slides."""
    reaches = i + 1 < chain.n and float(np.linalg.norm(steps[i + 1, :3, 3])) > _SAME * abs(home)
    low = float(chain.lower[i])
    if i == 0 or reaches or low < 0.0 or home <= 0.0:
        return 0.0
    return low if math.isfinite(low) and low > 0.1 * home else 0.6 * home


def _frame(points: Array, size: float, colour: int, *, plate: bool) -> Iterator[Shape]:
    """Make bars from point to point around their centre, and a plate if they lie in a plane."""
    points = np.array(distinct(points, _SAME * size))
    centre = points.mean(axis=0)
    around = points - centre
    axes = np.linalg.svd(around)[2]
    order = np.argsort(np.arctan2(around @ axes[1], around @ axes[0]))
    ring = points[order]
    for one, two in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        if np.linalg.norm(two - one) > _SAME * size:
            yield _rod_between(one, two, _FRAME * size, colour)
    for point in ring:
        yield _ball(point, _BALL * size, _GREY)
    if plate and np.abs(around @ axes[2]).max() <= _SAME * size:
        middles = 0.5 * (ring + np.roll(ring, -1, axis=0)) - centre
        inner = float(np.linalg.norm(middles, axis=1).min())
        if inner > _SAME * size:
            pose = rotation_from_z(axes[2])
            pose[:3, 3] = centre
            yield Shape(pose, rounded(inner), rounded(_PLATE * size), colour)


def _arcs(links: Sequence[str], steps: Array, radius: float) -> dict[str, list[Shape]]:
    """Make an arc of each link from its own axis to the next one."""
    shapes = {}
    for i, link in enumerate(links):
        shapes[link] = [_ball([0.0, 0.0, radius], 0.08 * _SPHERE, _GREY)]
        if i + 1 == len(links):
            # To the ball in the middle, which is the platform.
            shapes[link].append(_rod_between(np.zeros(3), [0.0, 0.0, radius], 0.007, _ORANGE))
            continue
        one, two = np.array([0.0, 0.0, 1.0]), steps[i + 1, :3, 2]
        angle = math.acos(max(-1.0, min(1.0, float(two[2]))))
        count = max(1, math.ceil(angle / (0.5 * math.pi) * _BARS))
        across = two - two[2] * one
        across /= np.linalg.norm(across) or 1.0
        turns = np.linspace(0.0, angle, count + 1)
        ends = [radius * (math.cos(x) * one + math.sin(x) * across) for x in turns]
        colour = _BLUE if i == 0 else _WHITE
        bars = pairwise(ends)
        shapes[link] += [_rod_between(a, b, 0.05 * _SPHERE, colour) for a, b in bars]
    return shapes


def _rod_between(start: ArrayLike, end: ArrayLike, radius: float, colour: int) -> Shape:
    one, two = np.asarray(start, float), np.asarray(end, float)
    length = float(np.linalg.norm(two - one))
    pose = rotation_from_z((two - one) / length)
    pose[:3, 3] = 0.5 * (one + two)
    return Shape(pose, rounded(radius), rounded(length), colour)


def _ball(point: ArrayLike, radius: float, colour: int) -> Shape:
    pose = np.eye(4)
    pose[:3, 3] = np.asarray(point, float)
    return Shape(pose, rounded(radius), 0.0, colour)
