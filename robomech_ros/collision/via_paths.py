"""Paths around obstacles through via points."""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from robomech_ros.collision.distances import checked_clearance
from robomech_ros.collision.libraries import PLANNERS
from robomech_ros.collision.planning import PathPlan, PlanRequest, PlanStatus, plan_path
from robomech_ros.collision.scene import PlanningScene
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics.joint_values import as_finite_values

# Least time for a piece (s): a straight motion may still be free.
_LEAST = 1e-3


def path_through(
    scene: PlanningScene,
    points: npt.ArrayLike,
    *,
    timeout: float = 5.0,
    seed: int = 0,
    clearance: float = 0.0,
    planner: str = PLANNERS[0],
) -> PathPlan:
    """Plan a path through via points around all obstacles, every piece proved free of contact.

    Parameters
    ----------
    scene : PlanningScene
    points : array_like, shape (m, n)
        Start, via points and goal (rad or m), m >= 2.  Joints without limits keep their turns.
    timeout, seed, clearance, planner
        As for `PlanningScene.plan`; the time (s) is that of the whole path.

    Returns
    -------
    PathPlan
        Its waypoints include all points.

    Raises
    ------
    BadValueError, WrongSizeError, SeedOutsideLimitsError
        Fewer than two points, or a point or an option that is invalid.
    MissingLibraryError
        OMPL is not installed.
    """
    given = as_finite_values(scene.chain, points, "points")
    if given.ndim != 2 or len(given) < 2:
        raise BadValueError("points", given.shape, f"at least two, (m, {scene.chain.n})")
    request = PlanRequest(timeout, seed, checked_clearance(clearance), planner, keep_turns=True)
    notes: list[str] = []
    begin, whole, certified = time.monotonic(), given[:1], True
    for k, (a, b) in enumerate(pairwise(given), start=1):
        piece = plan_path(scene, a, b, request)
        spent = time.monotonic() - begin
        if piece.status is not PlanStatus.SOLVED:
            where = "" if len(given) == 2 else f"from point {k} to point {k + 1} of {len(given)}: "
            return piece._replace(reason=where + piece.reason, seconds=spent)
        whole = np.concatenate([whole, piece.waypoints[1:]])
        certified &= piece.certified
        notes += filter(None, [piece.reason])
        request = request._replace(timeout=max(timeout - spent, _LEAST))
    return PathPlan(whole, certified, 0, PlanStatus.SOLVED, "; ".join(notes), spent)
