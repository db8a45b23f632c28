"""Any other arm of six joints: its closure equations, made once for a chain.

A form of elimination (see ``_kernels.general_layout``) needs nothing of the target in its left
side where the target is one of the two links next to joint FIRST.  Four of the twelve forms are
so, with joints 3, 4, 2 and 5 hidden; each fails for other arms with special geometry, such as
parallel or meeting neighbouring axes.  Which of them are good for an arm is found by trying.
A slide can be among them where it is joint FIRST, THIRD or FOURTH, as it is in one form at least.

With two or three slides there are as many forms as revolute joints to begin the loop at.
"""

import itertools
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from robomech_ros._kernels import general_layout as at
from robomech_ros._kernels.general_equations import quantities
from robomech_ros._kernels.inverse_general import DOUBT, MAX_SOLUTIONS, solve_general
from robomech_ros._kernels.serial import forward_one
from robomech_ros.kinematics.mobility import arm_size, moves_in_all_directions
from robomech_ros.robots.chain import PRISMATIC, REVOLUTE, SerialChain

__all__ = ["match"]

Array = NDArray[np.float64]

# Start of the walk round the loop, and its sense.
_WALKS = ((0, 1), (0, -1), (5, 1), (5, -1))
# Added to the angles of joints THIRD and FOURTH: irrational parts of a turn.
_OFFSETS = {at.THIRD: 1.0, at.FOURTH: 0.7}
_TRIALS = 12

_THIRDS = 2.0 * math.pi / 3.0 * np.arange(3)
# From values at three equally spaced angles to cosine, sine and constant part.
_PARTS = np.array([2.0 * np.cos(_THIRDS), 2.0 * np.sin(_THIRDS), np.ones(3)]) / 3.0
# From these to the coefficients of s s, s c, c c of the half angle, and of s s, sqrt(2) s c, c c.
_HALF = np.array([[-1.0, 0.0, 1.0], [0.0, 2.0, 0.0], [1.0, 0.0, 1.0]])
_EVEN = np.array([[1.0], [math.sqrt(2.0)], [1.0]])
# From values of a slide at 0, 1, -1 to the coefficients of its square, itself and 1.
_SLIDE = np.array([[-1.0, 0.5, 0.5], [0.0, 0.5, -0.5], [1.0, 0.0, 0.0]])


def match(chain: SerialChain) -> Array | None:
    """Make the constants of an arm of six joints.

    Parameters
    ----------
    chain : SerialChain

    Returns
    -------
    ndarray or None
        The constants that ``_kernels.inverse_general`` reads; None for other chains, arms that
        cannot move in all directions, and arms for which no form of elimination works.
    """
    if chain.n != 6:
        return None
    size = arm_size(chain)
    if not moves_in_all_directions(chain, size):
        return None
    head = _head(chain, size)
    loop = _loop(chain, size)
    forms, clean = _best_first(chain, head, list(_forms(chain, loop)))
    if not forms:
        return None
    head[at.FORMS] = len(forms)
    head[at.CLEAN] = clean
    data = np.concatenate((head, *forms))
    data.setflags(write=False)
    return data


def _head(chain: SerialChain, size: float) -> Array:
    head = np.zeros(at.HEAD)
    head[at.SIZE], head[at.SLIDES] = size, chain.types.sum()
    for place, row in ((at.BASE, 0), (at.TIP, 6)):
        pose = _pose(chain.packed[row], size)
        head[place : place + 12] = np.linalg.inv(pose)[:3].ravel()
    head[at.PACKED :] = chain.packed.ravel()
    return head


def _pose(row: Array, size: float) -> Array:
    pose = np.eye(4)
    pose[:3, :3] = row[1:10].reshape(3, 3)
    pose[:3, 3] = row[10:] / size
    return pose


def _loop(chain: SerialChain, size: float) -> Array:
    """Give the links behind joints 1 .. 6, the last one, the target's, as 1."""
    return np.array([_pose(row, size) for row in chain.packed[1:6]] + [np.eye(4)])


def _inverse(pose: Array) -> Array:
    result = np.eye(4)
    result[:3, :3] = pose[:3, :3].T
    result[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return result


def _turn(angle: float) -> Array:
    pose = np.eye(4)
    c, s = math.cos(angle), math.sin(angle)
    pose[:2, :2] = [[c, -s], [s, c]]
    return pose


def _forms(chain: SerialChain, loop: Array) -> Iterator[Array]:
    """Lay out the forms that suit the types of the joints."""
    slides = np.flatnonzero(chain.types).tolist()
    if len(slides) > 1:
        for first in np.flatnonzero(chain.types == REVOLUTE).tolist():
            yield _slide_form(chain, loop, first)
        return
    for start, sense in _WALKS:
        joints = _joints(start, sense)
        slide = joints.index(slides[0]) if slides else -1
        if slide in (-1, at.FIRST, at.THIRD, at.FOURTH):
            yield _form(loop, start, sense, slide)


def _joints(start: int, sense: int) -> list[int]:
    """List the joints in the order of a walk."""
    joints = list(range(6))[::sense]
    return joints[start:] + joints[:start]


def _slide_form(chain: SerialChain, loop: Array, first: int) -> Array:
    """Lay out a form of an arm with two or three slides, from a revolute joint on."""
    order = [(first + k) % 6 for k in range(6)]
    form = np.zeros(at.FORM)
    form[at.TARGET_LINK] = order.index(5)
    form[at.JOINTS : at.JOINTS + 6] = order
    form[at.KINDS : at.KINDS + 6] = chain.types[order]
    form[at.LOOP : at.LOOP + 72] = loop[order, :3].ravel()
    return form


def _shift(way: float) -> Array:
    pose = np.eye(4)
    pose[2, 3] = way
    return pose


def _form(loop: Array, start: int, sense: int, slide: int) -> Array:
    """Lay out a form of elimination, with a slide in a part, or -1."""
    links = list(loop)
    if sense < 0:
        # J_6^-1 L_5^-1 J_5^-1 ... L_1^-1 J_1^-1 L_6^-1 = 1
        links = [_inverse(links[(4 - k) % 6]) for k in range(6)]
    links = links[start:] + links[:start]
    offsets = [0.0 if slide == role else _OFFSETS[role] for role in (at.THIRD, at.FOURTH)]
    links[2] = links[2] @ _turn(offsets[0])
    links[3] = links[3] @ _turn(offsets[1])
    behind_target = start == 5
    form = np.zeros(at.FORM)
    form[at.TARGET] = at.TARGET_BEHIND if behind_target else at.TARGET_BEFORE
    form[at.SENSE] = sense
    form[at.SLIDE] = slide
    form[at.JOINTS : at.JOINTS + 6] = _joints(start, sense)
    form[at.OFFSETS : at.OFFSETS + 2] = offsets
    fixed = _inverse(links[5] if behind_target else links[0])
    form[at.FIXED : at.FIXED + 12] = fixed[:3].ravel()
    for k in range(4):
        form[at.LINKS + 12 * k : at.LINKS + 12 * (k + 1)] = links[k + 1][:3].ravel()
    form[at.EQUATIONS :] = _left_side(links, slide).ravel()
    return form


def _left_side(links: list[Array], slide: int) -> Array:
    """Coefficients of the fourteen quantities, shape (14, 3, 9), from their values.

    They are linear in cosine, sine and 1 of three joints, quadratic in a slide, so three values of
    each tell all.
    """
    motions, parts = [], []
    for role in (at.HIDDEN, at.THIRD, at.FOURTH):
        moved = [_turn(angle) for angle in _THIRDS]
        if role == slide:
            moved = [_shift(way) for way in (0.0, 1.0, -1.0)]
        motions.append(moved)
        part = _PARTS if role == at.HIDDEN else _SLIDE if role == slide else _HALF @ _PARTS
        parts.append(part / _EVEN if role == at.FOURTH else part)
    values = np.empty((3, 3, 3, at.N_EQUATIONS))
    out = np.empty(at.N_EQUATIONS)
    for i, j, k in itertools.product(range(3), repeat=3):
        pose = links[1] @ motions[0][i] @ links[2] @ motions[1][j] @ links[3] @ motions[2][k]
        pose = pose @ links[4]
        quantities(pose[:3, 2].copy(), pose[:3, 3].copy(), out)
        values[i, j, k] = out
    for part in parts:
        # Each time the next joint comes last of the three.
        values = np.moveaxis(np.tensordot(part, values, (1, 0)), 0, 2)
    coefficients: Array = np.moveaxis(values, 3, 0).reshape(at.N_EQUATIONS, 3, 9)
    return coefficients


def _best_first(
    chain: SerialChain, head: Array, forms: list[Array]
) -> tuple[list[Array], float]:
    """Try the forms on some poses: those that work for most of them, in order of how often.

    Returns the part of the poses that the first one solves, too.
    """
    q, branch = np.empty((MAX_SOLUTIONS, 6)), np.empty(MAX_SOLUTIONS, np.int64)
    target = np.empty((4, 4))
    alone = head.copy()
    alone[at.FORMS] = 1.0
    good = np.zeros(len(forms), int)
    postures = np.random.default_rng(0).uniform(-math.pi, math.pi, (_TRIALS, 6))
    postures[:, chain.types == PRISMATIC] *= head[at.SIZE] / math.pi
    for posture in postures:
        forward_one(chain.packed, posture, target)
        for k, form in enumerate(forms):
            data = np.concatenate((alone, form))
            good[k] += solve_general(data, target, posture, q, branch) < DOUBT
    order = sorted(range(len(forms)), key=lambda k: -good[k])
    kept = [forms[k] for k in order if good[k] >= _TRIALS // 2]
    return kept, float(good[order[0]]) / _TRIALS
