"""Postures of fingers that touch an object in given contacts."""

from __future__ import annotations

import heapq
from collections.abc import Sequence

import numpy as np

from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.hands.contacts import Contact, check_coordinates
from robomech_ros.hands.hand import Hand, finger_numbers, fingers_of
from robomech_ros.kinematics import InverseKinematicsResult, inverse_kinematics
from robomech_ros.spatial.arrays import (
    as_finite,
    as_flag,
    check_kind,
    listed,
    of_shape,
    whole_number,
)
from robomech_ros.spatial.poses import as_pose
from robomech_ros.typing import Array, ArrayLike

_POSITION = (True, True, True, False, False, False)
# More whole postures than anyone looks at.
MOST_POSTURES = 10_000


def grasp_postures(
    hand: Hand,
    T: ArrayLike,
    contacts: Sequence[Contact],
    *,
    fingers: Sequence[int] | None = None,
    seed: ArrayLike | None = None,
    respect_limits: bool = True,
) -> tuple[InverseKinematicsResult, ...]:
    """Find all postures of the fingers in which their tips are in the contacts.

    Parameters
    ----------
    hand : Hand
        Hand of n joints.
    T : array_like, shape (4, 4)
        Pose of the object in the frame of the palm (m).
    contacts : sequence of Contact
        In the frame of the object, one for a finger.
    fingers : sequence of int, optional
        The number of the finger of each contact, each once; default one after the other.
    seed : array_like, shape (n,), optional
        Joint values, finger by finger (rad or m), to measure distances from, by the root of the sum
        of squared moves; default the middle of the ranges.
    respect_limits : bool, optional
        Whether postures outside the joint limits are left out.

    Returns
    -------
    tuple of InverseKinematicsResult
        Contact by contact: all branches of its finger, nearest to the seed first, or the reason why
        there is none.  Fingers with more than three joints get samples.

    Examples
    --------
    >>> import numpy as np
    >>> from robomech_ros.hands import Contact, grasp_postures, load_hand
    >>> hand, T = load_hand("three_fingered"), np.eye(4)
    >>> T[2, 3] = 0.08
    >>> tip = Contact([0.04, 0.0, 0.0], [-1.0, 0.0, 0.0], "point", 0.5)
    >>> [len(found.q) for found in grasp_postures(hand, T, [tip])]
    [2]
    """
    given, owners = fingers_of(hand, contacts, fingers)
    pose = of_shape("pose", as_pose(T), (4, 4))
    points = np.array([one.position for one in given]) @ pose[:3, :3].T + pose[:3, 3]
    return tip_postures(hand, points, fingers=owners, seed=seed, respect_limits=respect_limits)


def tip_postures(
    hand: Hand,
    points: ArrayLike,
    *,
    fingers: Sequence[int] | None = None,
    seed: ArrayLike | None = None,
    respect_limits: bool = True,
) -> tuple[InverseKinematicsResult, ...]:
    """Find all postures of the fingers in which their tips are in given points.

    Parameters
    ----------
    hand, fingers, seed, respect_limits
        As for :func:`grasp_postures`.
    points : array_like, shape (k, 3)
        In the frame of the palm (m).

    Returns
    -------
    tuple of InverseKinematicsResult
        As for :func:`grasp_postures`, point by point.
    """
    start = _seed(hand, seed)
    places = as_finite("points", points, (3,))
    if places.ndim != 2 or not len(places):
        raise WrongSizeError("points", places.shape, "(k, 3), with k from 1 on")
    check_coordinates("points", places)
    owners = _distinct(finger_numbers(hand, len(places), fingers))
    respected = as_flag("respect_limits", respect_limits)
    parts = hand.split(start)
    found = []
    for place, k in zip(places, owners, strict=True):
        target = np.eye(4)
        target[:3, 3] = place
        found.append(
            inverse_kinematics(
                hand.fingers[k],
                target,
                task_mask=_POSITION,
                seed=None if seed is None else parts[k],
                metric="l2",
                respect_limits=respected,
            )
        )
    return tuple(found)


def hand_postures(
    hand: Hand,
    found: Sequence[InverseKinematicsResult],
    *,
    fingers: Sequence[int] | None = None,
    seed: ArrayLike | None = None,
    most: int = 100,
) -> tuple[Array, Array]:
    """Combine postures of fingers to postures of the whole hand, nearest to the seed first.

    Parameters
    ----------
    hand, fingers, seed
        As they were for :func:`grasp_postures`; fingers without a contact stay at the seed.
    found : sequence of InverseKinematicsResult
        What it gave, k branches of one finger, l of the next, ...
    most : int, optional
        How many of the k l ... combinations are wanted.

    Returns
    -------
    q : ndarray, shape (m, n)
        Joint values, finger by finger (rad or m); m = 0 where a finger has no posture.
    distance : ndarray, shape (m,)
        Root of the sum of squared moves from the seed (rad; m for prismatic joints).
    """
    start = _seed(hand, seed)
    results = listed("found", found, "results of grasp_postures")
    owners = _distinct(finger_numbers(hand, len(results), fingers))
    expected = f"a whole number from 1 to {MOST_POSTURES}"
    count = whole_number("most", most, expected, 1, MOST_POSTURES)
    parts = hand.split(start)
    branches, costs = [], []
    for one, k in zip(results, owners, strict=True):
        if not isinstance(one, InverseKinematicsResult) or one.q.shape[1] != hand.fingers[k].n:
            raise BadValueError("found", one, f"a posture of {hand.fingers[k].n} joints")
        cost = ((one.q - parts[k]) ** 2).sum(axis=1)
        order = np.argsort(cost, kind="stable")
        branches.append(one.q[order])
        costs.append(cost[order])
    chosen = _cheapest([cost.tolist() for cost in costs], count)
    q = np.tile(start, (len(chosen), 1))
    starts = np.cumsum([0, *(one.n for one in hand.fingers)])
    for j, k in enumerate(owners):
        q[:, starts[k] : starts[k + 1]] = branches[j][[pick[j] for pick in chosen]]
    return q, np.sqrt(((q - start) ** 2).sum(axis=1))


def _seed(hand: Hand, seed: ArrayLike | None) -> Array:
    """Check a posture of the whole hand; None is the middle of the ranges."""
    check_kind("hand", hand, Hand, "a Hand")
    if seed is None:
        return np.concatenate([one.midrange() for one in hand.fingers])
    return np.concatenate(hand.split(seed))


def _distinct(owners: tuple[int, ...]) -> tuple[int, ...]:
    if len(set(owners)) < len(owners):
        raise BadValueError("fingers", list(owners), "each finger once: a finger has one tip")
    return owners


def _cheapest(costs: list[list[float]], most: int) -> list[tuple[int, ...]]:
    """List the choices of one from each list, ascending, with the least sums, least first."""
    if not all(costs):
        return []
    first = (0,) * len(costs)
    waiting = [(sum(one[0] for one in costs), first)]
    seen, chosen = {first}, list[tuple[int, ...]]()
    while waiting and len(chosen) < most:
        cost, pick = heapq.heappop(waiting)
        chosen.append(pick)
        for j, k in enumerate(pick):
            if k + 1 < len(costs[j]):
                other = (*pick[:j], k + 1, *pick[j + 1 :])
                if other not in seen:
                    seen.add(other)
                    more = cost + costs[j][k + 1] - costs[j][k]
                    heapq.heappush(waiting, (more, other))
    return chosen
