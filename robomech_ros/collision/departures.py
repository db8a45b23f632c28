"""Check of motions that begin in contact and leave it."""

from __future__ import annotations

import numpy as np

from robomech_ros.collision.motion_proof import MotionCheck
from robomech_ros.collision.scene import PlanningScene
from robomech_ros.errors import BadValueError
from robomech_ros.numerics.arrays import check_kind
from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.typing import Array

# Joint travel between two samples on the path out of a contact (rad or m); tolerance of depths (m).
_STEP, _TOLERANCE = 2e-3, 1e-6
# Longest travel of a motion that begins in contact (rad or m): half a million samples.
_LONGEST = 1e3


def check_departure(scene: PlanningScene, motion: PiecewisePolynomial) -> MotionCheck:
    """Prove that a motion is free of contact once it has left its first contact.

    Until all bodies are apart, the sampled depth must not exceed that at the start.

    Parameters
    ----------
    scene : PlanningScene
    motion : PiecewisePolynomial
        Curve of the joints of the scene's chain (rad or m).

    Returns
    -------
    MotionCheck
        As from `PlanningScene.check_motion`. A motion that begins in contact is not certified.
    """
    check_kind("scene", scene, PlanningScene, "a PlanningScene")
    check_kind("motion", motion, PiecewisePolynomial, "a PiecewisePolynomial of the joints")
    start = scene.clearance(motion.sample(float(motion.breaks[0])).position)
    if start.distance > 0.0:
        return scene.check_motion(motion)
    times = _sample_times(motion)
    for t in times[1:].tolist():
        found = scene.clearance(motion.sample(t).position)
        if found.distance < start.distance - _TOLERANCE:
            return MotionCheck(False, False, t, found.bodies, found.distance)
        if found.distance > 0.0:
            return scene.check_motion(motion.after(t))._replace(certified=False)
    # A motion that ends in contact has not left it.
    return MotionCheck(False, False, float(times[-1]), found.bodies, found.distance)


def _sample_times(motion: PiecewisePolynomial) -> Array:
    """Return times (k,) between which no joint moves by more than a step."""
    fine = [
        np.linspace(begin, end, 10, endpoint=False)
        for begin, end in zip(motion.breaks[:-1], motion.breaks[1:], strict=True)
    ]
    times = np.concatenate([*fine, motion.breaks[-1:]])
    q = motion.sample(times).position
    travel = np.append(0.0, np.cumsum(np.abs(np.diff(q, axis=0)).max(axis=1)))
    if not travel[-1] <= _LONGEST:
        expected = f"at most {_LONGEST:g}: divide the motion"
        raise BadValueError("travel of the joints (rad or m)", float(travel[-1]), expected)
    count = int(travel[-1] / _STEP) + 2
    instants: Array = np.interp(np.linspace(0.0, travel[-1], count), travel, times)
    instants[0], instants[-1] = motion.breaks[0], motion.breaks[-1]
    return instants
