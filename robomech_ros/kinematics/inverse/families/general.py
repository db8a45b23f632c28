"""Any other arm of six joints: its closure equations, made once for each chain.

A form of elimination (see ``_kernels.inverse.general.layout``) needs nothing of the target in its
left side where the target is one of the two links next to joint FIRST.  Four of the twelve forms
are so, with joints 3, 4, 2 and 5 hidden; each fails for other arms with special geometry, such as
parallel or meeting neighbouring axes, and all are of very different worth: where the solutions of
an arm have nearly the same hidden angle, the determinant is near rounding between them and has to
be sampled again and again.  Which forms are good for an arm is found by trying all of them.  A
slide has to be joint FIRST, THIRD or FOURTH, as it is in six of the twelve.

With two or three slides there are as many forms as revolute joints to begin the loop at.
"""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from robomech_ros._kernels.chain.serial import forward_one
from robomech_ros._kernels.inverse.general import layout as at
from robomech_ros._kernels.inverse.general.equations import left_side
from robomech_ros._kernels.inverse.general.solutions import try_forms
from robomech_ros.kinematics.mobility import arm_size, moves_in_all_directions
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC, REVOLUTE, turn_about_z, unpack_chain
from robomech_ros.spatial.poses import rigid_inverse
from robomech_ros.typing import Array

Walks = tuple[tuple[int, int], ...]

# Start of the walk round the loop, and its sense; with the target next to joint FIRST, and others,
# of which the left side is made for every pose: a fifth of the time.
_WALKS = ((0, 1), (0, -1), (5, 1), (5, -1))
_OTHER_WALKS = tuple((start, sense) for start in range(1, 5) for sense in (1, -1))
# Added to the angles of joints THIRD and FOURTH: irrational parts of a turn.
_OFFSETS = {at.THIRD: 1.0, at.FOURTH: 0.7}
_TRIALS = 24
# A form that solves none of this many is dropped.
_HOPELESS = 3


def match(chain: SerialChain) -> Array | None:
    """Make the constants of an arm of six joints that ``_kernels.inverse.general`` reads.

    None for other chains, arms that cannot move in all directions, and arms for which no form of
    elimination works.
    """
    if chain.n != 6:
        return None
    size = arm_size(chain)
    if not moves_in_all_directions(chain, size):
        return None
    head = _head(chain, size)
    # Behind joint 6 the link is that of the target, as 1.
    loop = np.concatenate((_links(chain, size)[1:6], [np.eye(4)]))
    if chain.types.sum() > 1:
        good = _tried(chain, head, _slide_forms(chain, loop))
    else:
        good = _tried(chain, head, _forms(chain, loop, _WALKS + _OTHER_WALKS))
    if not good:
        return None
    good.sort(key=lambda one: (-one[0], one[1]))
    good = good[: at.MAX_FORMS]
    head[at.FORMS], head[at.CLEAN] = len(good), good[0][0] / _TRIALS
    data = np.concatenate((head, *(form for _, _, form in good)))
    data.setflags(write=False)
    return data


def _head(chain: SerialChain, size: float) -> Array:
    head = np.zeros(at.HEAD)
    head[at.SIZE], head[at.SLIDES] = size, chain.types.sum()
    links = _links(chain, size)
    for place, link in ((at.BASE, links[0]), (at.TIP, links[6])):
        head[place : place + 12] = np.linalg.inv(link)[:3].ravel()
    head[at.PACKED :] = chain.packed.ravel()
    return head


def _links(chain: SerialChain, size: float) -> Array:
    """Return C_0 .. C_6, shape (7, 4, 4), lengths over the size."""
    links = unpack_chain(chain.packed)
    links[:, :3, 3] /= size
    return links


def _forms(chain: SerialChain, loop: Array, walks: Walks) -> Iterator[Array]:
    """Lay out the forms of elimination that suit the types of the joints."""
    slides = np.flatnonzero(chain.types).tolist()
    for start, sense in walks:
        joints = _joints(start, sense)
        slide = joints.index(slides[0]) if slides else -1
        if slide in (-1, at.FIRST, at.THIRD, at.FOURTH):
            yield _form(loop, start, sense, slide)


def _joints(start: int, sense: int) -> list[int]:
    joints = list(range(6))[::sense]
    return joints[start:] + joints[:start]


def _slide_forms(chain: SerialChain, loop: Array) -> Iterator[Array]:
    """Lay out the forms of an arm with two or three slides, from each revolute joint on."""
    for first in np.flatnonzero(chain.types == REVOLUTE).tolist():
        order = [(first + k) % 6 for k in range(6)]
        form = np.zeros(at.FORM)
        form[at.TARGET_LINK] = order.index(5)
        form[at.JOINTS : at.JOINTS + 6] = order
        form[at.KINDS : at.KINDS + 6] = chain.types[order]
        form[at.LOOP : at.LOOP + 72] = loop[order, :3].ravel()
        yield form


def _form(loop: Array, start: int, sense: int, slide: int) -> Array:
    """Lay out a form of elimination, with a slide in a part, or -1."""
    links = list(loop)
    if sense < 0:
        # J_6^-1 L_5^-1 J_5^-1 ... L_1^-1 J_1^-1 L_6^-1 = 1
        links = [rigid_inverse(links[(4 - k) % 6]) for k in range(6)]
    links = links[start:] + links[:start]
    offsets = [0.0 if slide == role else _OFFSETS[role] for role in (at.THIRD, at.FOURTH)]
    links[2] = links[2] @ turn_about_z(offsets[0])
    links[3] = links[3] @ turn_about_z(offsets[1])
    form = np.zeros(at.FORM)
    form[at.TARGET] = (5 - start) % 6
    form[at.SENSE] = sense
    form[at.SLIDE] = slide
    form[at.JOINTS : at.JOINTS + 6] = _joints(start, sense)
    form[at.OFFSETS : at.OFFSETS + 2] = offsets
    form[at.BEFORE : at.BEFORE + 12] = rigid_inverse(links[5])[:3].ravel()
    form[at.BEHIND : at.BEHIND + 12] = rigid_inverse(links[0])[:3].ravel()
    form[at.LINKS : at.LINKS + 48] = np.array(links)[1:5, :3].ravel()
    if (start, sense) in _WALKS:
        left_side(form[at.LINKS : at.LINKS + 48], slide, form[at.EQUATIONS :])
    return form


def _tried(chain: SerialChain, head: Array, forms: Iterable[Array]) -> list[tuple[int, int, Array]]:
    """Try forms on some poses; give those that work for many, with how many and what effort."""
    target = np.empty((4, 4))
    alone = head.copy()
    alone[at.FORMS] = 1.0
    postures = np.random.default_rng(0).uniform(-math.pi, math.pi, (_TRIALS, 6))
    postures[:, chain.types == PRISMATIC] *= head[at.SIZE] / math.pi
    good = []
    for form in forms:
        data = np.concatenate((alone, form))
        count = effort = 0
        for number, posture in enumerate(postures):
            if count == 0 and number == _HOPELESS:
                break
            forward_one(chain.packed, posture, target)
            clean, spent = try_forms(data, target, posture)
            count += clean
            effort += spent
        if count >= _TRIALS // 4:
            good.append((count, effort, form))
    return good
