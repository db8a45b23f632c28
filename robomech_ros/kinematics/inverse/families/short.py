"""Arms of one to five joints: completion to six joints.

Virtual joints are put where a closed form results if they can, mostly a spherical wrist about a
point of the last axis, after slides that let the first joints reach every point.  Solutions of the
arm are those in which they stay at zero, so that none is lost, whatever the arm: planar, spherical,
SCARA, with five axes or any other.  What fits neither read from the base nor from the tip is
completed by skew axes to an arm of six joints without special geometry.
"""

import itertools
import math
from collections.abc import Iterator

import numpy as np

from robomech_ros._kernels.inverse import short_layout as at
from robomech_ros._kernels.inverse.decoupled import layout as decoupled_layout
from robomech_ros._kernels.inverse.six_joints import DECOUPLED
from robomech_ros.kinematics.axis_points import nearest_points
from robomech_ros.kinematics.inverse.families.six_joints import (
    SixJointArm,
    match_general,
    match_six,
    reversed_transforms,
)
from robomech_ros.kinematics.mobility import scaled_jacobians
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import (
    PRISMATIC,
    REVOLUTE,
    pack_chain,
    shift,
    turn_about_z,
    unpack_chain,
)
from robomech_ros.typing import Array

# A completed arm with at least this determinant (lengths over the size) is taken at once.
SHORT_REGULAR = 0.02
# With less (lengths over the size) wherever virtual joints are at zero, it serves as the last one.
SHORT_SINGULAR = 1e-3

# Transforms, types, and which joint of the arm each is (-1 for virtual ones).
Completed = tuple[list[Array], list[int], list[int]]

_VIRTUAL = -1


def match(chain: SerialChain) -> Array | None:
    """Complete an arm of one to five joints to the constants that ``_kernels.inverse.short`` reads.

    None where no completion moves in all directions.
    """
    if not 1 <= chain.n <= 5:
        return None
    size = max(float(np.linalg.norm(chain.packed[:, 10:], axis=1).sum()), 1e-3)
    found = _with_closed_form(chain, size) or _without_closed_form(chain, size)
    if found is None:
        return None
    arm, (_, types, places) = found
    head = np.zeros(at.PARTS)
    head[at.JOINTS], head[at.SIX], head[at.BACKWARDS] = chain.n, arm.family, arm.backwards
    head[at.EXACT] = arm.family != DECOUPLED or arm.data[decoupled_layout.EXACT] == 1.0
    head[at.SIZE] = size
    head[at.ARM_JOINTS : at.ARM_JOINTS + 6], head[at.SLIDES : at.SLIDES + 6] = places, types
    return np.concatenate((head, chain.packed.ravel(), arm.data))


def _with_closed_form(chain: SerialChain, size: float) -> tuple[SixJointArm, Completed] | None:
    """Complete an arm to one with a closed form, as regular as possible."""
    best: tuple[float, SixJointArm, Completed] | None = None
    for completed in _completions(chain, size):
        arm = match_six(np.array(completed[0]), completed[1])
        if arm is None:
            continue
        regular = 1.0
        if arm.family == DECOUPLED:
            regular = float(arm.data[decoupled_layout.REGULAR])
        if _regularity(completed, size) < SHORT_SINGULAR:
            regular = 0.0
        if best is None or regular > best[0]:
            best = regular, arm, completed
        if regular >= SHORT_REGULAR:
            break
    return None if best is None else best[1:]


def _regularity(completed: Completed, size: float) -> float:
    """Return the largest determinant among some postures, virtual joints at zero.

    A completed arm that is singular wherever they are at zero loses solutions of the real one.
    """
    links, kinds, places = completed
    own = np.array(places) != _VIRTUAL
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (8, len(kinds))) * own
    J = scaled_jacobians(pack_chain(np.array(links), np.array(kinds)), q, size)
    return float(np.abs(np.linalg.det(J)).max())


def _without_closed_form(chain: SerialChain, size: float) -> tuple[SixJointArm, Completed] | None:
    """Complete an arm of four or five joints to one of no special geometry."""
    if chain.n < 4:
        return None
    arms = []
    for turned, links, kinds in _both_ways(chain):
        completed = (links, kinds, list(range(chain.n)))
        for placed in _SKEW[chain.n - 6 :]:
            placed = placed.copy()
            placed[:3, 3] *= size
            completed = _with_last(completed, placed)
        arms.append(_turned(completed, chain.n) if turned else completed)
    found = match_general((np.array(links), kinds) for links, kinds, _ in arms)
    return None if found is None else (found[1], arms[found[0]])


def _completions(chain: SerialChain, size: float) -> Iterator[Completed]:
    """List completed arms, the most natural first; not all have a closed form."""
    n = chain.n
    for wrist in (3, 2, 1, 0):
        for turned, links, kinds in _both_ways(chain):
            if not max(0, n - 3) <= wrist <= n or any(kinds[n - wrist :]):
                continue
            for points, slides in itertools.product(
                _centres(wrist, links, size), _slides(wrist, n)
            ):
                completed = _with_wrist((links, kinds, list(range(n))), wrist, points)
                completed = _with_slides(completed, n - wrist, slides)
                yield _turned(completed, n) if turned else completed
    if n == 5:
        for turned, links, kinds in _both_ways(chain):
            completed = _with_last((links, kinds, list(range(n))), turn_about_z(0.7) @ _turn_x(1.3))
            yield _turned(completed, n) if turned else completed


def _both_ways(chain: SerialChain) -> Iterator[tuple[bool, list[Array], list[int]]]:
    """Read an arm from its base, and turned: from its tip."""
    C, types = unpack_chain(chain.packed), chain.types.tolist()
    yield False, list(C), types
    yield True, list(reversed_transforms(C)), types[::-1]


def _turned(completed: Completed, n: int) -> Completed:
    """Read a completed inverse motion from the base again."""
    links, kinds, places = completed
    own = [n - 1 - place if place >= 0 else place for place in reversed(places)]
    return list(reversed_transforms(np.array(links))), kinds[::-1], own


def _centres(wrist: int, links: list[Array], size: float) -> list[Array]:
    """List places for the centre of a wrist, in the frame of the last joint, else of the tip."""
    if wrist == 3:
        return [np.zeros(3)]
    if wrist == 2:
        near = nearest_points(links[-2])
        return [np.array([0.0, 0.0, 0.0 if near is None else near[1]])]
    if wrist == 1:
        tip = float(links[-1][2, 3])
        return [
            np.array([0.0, 0.0, height]) for height in (tip, tip + 0.5 * size, tip - 0.7 * size)
        ]
    offsets = ((0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (0.0, 0.4, 0.0), (0.3, 0.2, 0.6))
    return [size * np.array(offset) for offset in offsets]


def _slides(wrist: int, n: int) -> list[tuple[Array, ...]]:
    """Directions of the slides that complete three positioning joints."""
    missing = 3 - (n - wrist)
    if missing == 0:
        return [()]
    frame = [_turn_x(0.0), _turn_x(-0.5 * math.pi), _turn_y(0.5 * math.pi)]
    if missing == 3:
        return [tuple(frame)]
    return list(itertools.combinations(frame, missing))


def _with_slides(completed: Completed, index: int, slides: tuple[Array, ...]) -> Completed:
    """Insert slides before joint ``index``, just behind the joint before it."""
    links, kinds, places = completed
    between, inserted = np.eye(4), []
    for direction in slides:
        inserted.append(between.T @ direction)
        between = direction
    after = between.T @ links[index]
    new = [*links[:index], *inserted, after, *links[index + 1 :]]
    count = len(slides)
    return (
        new,
        [*kinds[:index], *[PRISMATIC] * count, *kinds[index:]],
        [*places[:index], *[_VIRTUAL] * count, *places[index:]],
    )


def _with_wrist(completed: Completed, wrist: int, centre: Array) -> Completed:
    """Complete the last joints to a spherical wrist about a centre, regular at zero."""
    quarter = 0.5 * math.pi
    if wrist == 3:
        return completed
    if wrist == 2:
        sine = math.hypot(*completed[0][-2][:2, 2])
        other = math.atan2(sine, completed[0][-2][2, 2])
        # Another angle than between the real axes, so that the first and the last never align.
        angle = 0.5 * quarter if abs(other - 0.5 * quarter) > 0.3 else quarter
        return _with_last(completed, shift(centre) @ turn_about_z(0.7) @ _turn_x(angle))
    if wrist == 1:
        completed = _with_last(completed, shift(centre) @ _turn_x(quarter))
        return _with_last(completed, turn_about_z(quarter) @ _turn_x(quarter))
    completed = _with_last(completed, completed[0][-1] @ shift(centre))
    completed = _with_last(completed, _turn_x(quarter))
    return _with_last(completed, turn_about_z(quarter) @ _turn_x(quarter))


def _with_last(completed: Completed, placed: Array) -> Completed:
    """Append a virtual revolute joint, placed in the frame of the last joint."""
    links, kinds, places = completed
    rest = np.linalg.inv(placed) @ links[-1]
    return [*links[:-1], placed, rest], [*kinds, REVOLUTE], [*places, _VIRTUAL]


def _turn_x(angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    result = np.eye(4)
    result[1:3, 1:3] = [[c, -s], [s, c]]
    return result


def _turn_y(angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    result = np.eye(4)
    result[0, 0], result[0, 2], result[2, 0], result[2, 2] = c, s, -s, c
    return result


# Places of skew virtual joints behind the last one, lengths over the arm's size.
_SKEW = (
    shift(np.array([0.31, 0.22, -0.17])) @ turn_about_z(0.7) @ _turn_x(1.3),
    shift(np.array([0.23, -0.34, 0.19])) @ turn_about_z(-1.9) @ _turn_x(1.1),
)
