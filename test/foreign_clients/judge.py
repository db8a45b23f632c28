"""Contacts of the states that a robot has published with the objects that stood meanwhile."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from changer import Standing

from robomech_ros.collision import Box, PlanningScene
from robomech_ros.typing import Array


@dataclass
class Verdict:
    """Findings of the judge.

    Attributes
    ----------
    checked : int
        Pairs of a published state and an object that stood then, announced early enough.
    nearest : float
        The least distance of such a pair (m).
    faults : list of str
        Contacts with objects that were announced early enough, and of the robot with itself.
    late : int
        Contacts with objects that appeared in front of the robot, or on it.
    latest : float
        The longest time (s) from the announcement of an object to such a contact with it.
    """

    checked: int
    nearest: float
    faults: list[str]
    late: int
    latest: float


def judge(
    scene: PlanningScene, times: Array, q: Array, history: Sequence[Standing], early: float
) -> Verdict:
    """Look for contacts.

    Parameters
    ----------
    scene : PlanningScene
        Of the robot alone.
    times : ndarray, shape (m,)
        Of the states (ROS time, s).
    q : ndarray, shape (m, n)
        Joint values (rad or m).
    history : sequence of Standing
    early : float
        How long before a contact an object must be announced for it to be a fault (s).
    """
    found = Verdict(0, np.inf, [], 0, 0.0)
    own = ~np.asarray(scene.is_free(q))
    if own.any():
        found.faults.append(f"the robot touched itself in {own.sum()} states")
    for one in history:
        meanwhile = np.flatnonzero((times > one.since) & (times < one.until))
        if len(meanwhile):
            _judge_one(scene, times[meanwhile] - one.since, q[meanwhile], one, found, early)
    return found


def _judge_one(
    scene: PlanningScene, ages: Array, q: Array, one: Standing, found: Verdict, early: float
) -> None:
    """Look for contacts with an object, at times since it was announced (s)."""
    with_object, pose = scene.copy(), np.eye(4)
    pose[:3, 3] = one.position
    with_object.add("object", Box(*one.sizes), pose)
    touches = ~np.asarray(with_object.is_free(q))
    # A robot that came into contact before it could brake may stay there for a while.
    begins = np.flatnonzero(touches & ~np.append(False, touches[:-1]))
    for begin in begins.tolist():
        if ages[begin] < early:
            found.late, found.latest = found.late + 1, max(found.latest, float(ages[begin]))
        else:
            depth = with_object.clearance(q[begin])
            found.faults.append(
                f"contact of {depth.bodies}, {-depth.distance * 1e3:.2f} mm deep, "
                f"{ages[begin]:.3f} s after the object was announced"
            )
    settled = (ages >= early) & ~touches
    found.checked += int(settled.sum())
    # Neighbouring states are as near; one of ten is enough for what is only reported.
    for row in q[settled][::10]:
        found.nearest = min(found.nearest, with_object.clearance(row).distance)
