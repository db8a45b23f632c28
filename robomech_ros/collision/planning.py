"""Paths around obstacles: OMPL samples, and every piece of a path is proved."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from enum import Enum
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from robomech_ros.collision.distances import Clearance
from robomech_ros.collision.libraries import PLANNERS, ompl, seeded
from robomech_ros.collision.motion_proof import MotionProof
from robomech_ros.errors import RobomechError, SeedOutsideLimitsError, WrongSizeError
from robomech_ros.kinematics import inverse_kinematics
from robomech_ros.kinematics.joint_values import as_finite_values, as_posture
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial import as_pose
from robomech_ros.spatial.arrays import as_choice, finite_within, real_array, whole_number
from robomech_ros.typing import Array

# The longest step of a tree (rad and m together), of two that grow to each other and of others.
_RANGE, _FAR = 0.8, 1.5
# Most paths stay this near to the start and the goals (rad or m): samples come from there until
# so many motions have been tried.
_NEARBY, _NEARBY_MOTIONS = 1.75, 5000
# Fractions of a motion at which contact is tested first, one for each longer step.
_LOOKS = (0.5, 0.25, 0.75)
# Tolerance of the least distance (m).
_SLACK = 1e-6
# Excess over a joint limit that counts as rounding (rad or m): pi is 3e-6 more than 3.14159.
_ROUNDING = 1e-5
# Search out of a contact at the start: step (rad or m), most steps, random directions of each.
_STEP, _STEPS, _DIRECTIONS = 0.02, 60, 24


class PlanStatus(Enum):
    """The outcome of a plan."""

    SOLVED = "a path was found"
    START_IN_CONTACT = "the start is in contact or too near to it, and no way out was found"
    GOAL_IN_CONTACT = "every goal is in contact or too near to it"
    NO_POSTURE = "no posture reaches the pose"
    NO_PATH = "no path was found in time"


class PlanRequest(NamedTuple):
    """Options of a plan: time (s), seed of the random samples, clearance (m), planner of OMPL.

    Joints without limits take the short way to a goal unless its turns are kept.
    """

    timeout: float = 5.0
    seed: int = 0
    clearance: float = 0.0
    planner: str = PLANNERS[0]
    cancelled: Callable[[], bool] = bool
    keep_turns: bool = False


class PathPlan(NamedTuple):
    """A path around obstacles, or why there is none.

    Attributes
    ----------
    waypoints : ndarray, shape (m, n)
        Joint values (rad or m), joined by straight lines; no rows if there is no path.
    certified : bool
        The whole path is proved free of contact.  After a start in contact only the rest of the
        path is proved, and this is false.
    goal : int
        Index of the goal reached; for a pose, of its posture in the order of inverse kinematics.
        -1 if there is no path.
    status : PlanStatus
    reason : str
        The fault or a remark in words; else empty.
    seconds : float
        Planning time (s).
    """

    waypoints: Array
    certified: bool
    goal: int
    status: PlanStatus
    reason: str
    seconds: float


def plan_path(
    scene: Any, start: npt.ArrayLike, goals: npt.ArrayLike, request: PlanRequest
) -> PathPlan:
    """Plan a path; see `PlanningScene.plan`."""
    begin = time.monotonic()
    chain = scene.chain
    finite_within("timeout", request.timeout, "above 0, at most 3600 s", 1e-3, 3600.0)
    whole_number("seed", request.seed, "a whole number, 0 to 2^31 - 2", 0, 2**31 - 2)
    as_choice("planner", request.planner, PLANNERS)
    first = _within_limits(chain, as_posture(chain, start, "start"), "start")

    def ended(
        status: PlanStatus, reason: str, waypoints: Any = (), goal: int = -1, proved: bool = False
    ) -> PathPlan:
        path = np.array(waypoints).reshape(-1, chain.n)
        return PathPlan(path, proved, goal, status, reason, time.monotonic() - begin)

    postures, why = _postures(scene, goals, first)
    if not len(postures):
        return ended(PlanStatus.NO_POSTURE, why)
    if not request.keep_turns:
        postures = _nearest_turns(chain, postures, first)
    kept, why = _free_goals(scene, postures, request.clearance)
    if not kept:
        return ended(PlanStatus.GOAL_IN_CONTACT, why)
    leaving, note = [first], ""
    if not scene.is_free(first, clearance=request.clearance):
        leaving, note = _leave(scene, first, request)
        if not leaving:
            return ended(PlanStatus.START_IN_CONTACT, note)
    search = _Search(scene, request, begin + request.timeout)
    path, goal = search.path(leaving[-1], postures, kept)
    if goal < 0:
        return ended(PlanStatus.NO_PATH, _unreached(request, search, postures, kept))
    whole = np.concatenate([np.array(leaving[:-1]).reshape(-1, chain.n), path])
    return ended(PlanStatus.SOLVED, note, whole, goal, not note)


def _unreached(request: PlanRequest, search: _Search, postures: Array, kept: list[int]) -> str:
    nearest, least = search.nearest(postures[kept])
    near = ", ".join(f"{value:.4g}" for value in nearest)
    return (
        f"no path within {request.timeout:g} s and {search.tried} motions; the nearest posture "
        f"reached is [{near}], {least:.3g} (rad, m) from a goal; allow more time, or less clearance"
    )


class _Search:
    """A search by OMPL that samples motions, and proves those of the path that it finds."""

    def __init__(self, scene: Any, request: PlanRequest, deadline: float) -> None:
        self._scene, self._request, self._deadline = scene, request, deadline
        self._distances = scene.distances
        self._proof = MotionProof(self._distances, request.clearance)
        self._free: set[tuple[float, ...]] = set()
        # Those that motions from the start have come to.
        self._reached: dict[tuple[float, ...], None] = {}
        self._certain: set[frozenset[tuple[float, ...]]] = set()
        self._is_first = request.planner == PLANNERS[0]
        # Planners that use up their time leave none for detours, so they prove every motion.
        self._strict = not self._is_first
        self.tried = 0

    def path(self, start: Array, postures: Array, kept: list[int]) -> tuple[Array, int]:
        """Find a path from the start to one of the postures kept, and which; -1 for none."""
        order = sorted(kept, key=lambda k: float(np.abs(postures[k] - start).max()))
        self._free |= {tuple(q.tolist()) for q in (start, *postures[order])}
        self._reached = {tuple(start.tolist()): None}
        for k in order:
            if self._is_over():
                break
            straight = np.array([start, postures[k]])
            if self.passes(*straight.tolist()) and self._proves(straight):
                return straight, k
        path = self._proved(self._sampled(start, postures[order]), postures[order])
        if path is None:
            return np.empty((0, len(start))), -1
        return path, min(order, key=lambda k: float(np.abs(postures[k] - path[-1]).max()))

    def _proved(self, path: Array | None, goals: Array) -> Array | None:
        """Replace pieces of a path without a proof by detours to any waypoint behind, or a goal."""
        self._strict, k = True, 1
        while path is not None and k < len(path):
            if self._proves(path[k - 1 : k + 1]):
                self._reached[tuple(path[k].tolist())] = None
                k += 1
                continue
            # Thin bodies may enclose the next waypoint.
            ends = np.concatenate([path[k:], goals])
            around = None if self._is_over() else self._sampled(path[k - 1], ends)
            if around is None:
                return None
            reached = int(np.argmin(np.abs(ends - around[-1]).max(axis=1)))
            path = np.concatenate([path[: k - 1], around, path[k + reached + 1 :]])
        return path

    def _proves(self, motion: Array) -> bool:
        ends = frozenset(map(tuple, motion.tolist()))
        if ends not in self._certain and self._proof.obstruction(motion, first=False) is None:
            self._certain.add(ends)
        return ends in self._certain

    def passes(self, a: list[float], b: list[float]) -> bool:
        """Return whether a straight motion seems free or, in a strict search, is proved free."""
        self.tried += 1
        begin, end = tuple(a), tuple(b)
        if end in self._free:
            begin, end = end, begin
        curve = np.array([end, begin])
        contact, clearance = self._distances.contact, self._request.clearance
        if end not in self._free and contact(curve[0], clearance) is not None:
            return False
        step = curve[1] - curve[0]
        for share in _LOOKS[: math.ceil(math.dist(a, b) / _FAR)]:
            if contact(curve[0] + share * step, clearance) is not None:
                return False
        if not (self._proves(curve) if self._strict else self._proof.seems_free(curve)):
            return False
        self._free.add(end)
        if begin in self._reached or end in self._reached:
            self._reached |= {begin: None, end: None}
        return True

    def nearest(self, goals: Array) -> tuple[Array, float]:
        """Return the posture reached from the start that is nearest to a goal, and its distance."""
        start, *later = self._reached
        reached = np.array([start, *(q for q in later if not (goals == q).all(axis=1).any())])
        away = np.abs(reached[:, None] - goals).max(axis=2).min(axis=1)
        best = int(np.argmin(away))
        return reached[best], float(away[best])

    def _is_over(self) -> bool:
        return time.monotonic() > self._deadline or self._request.cancelled()

    def _sampled(self, start: Array, goals: Array) -> Array | None:
        base, geometric = ompl().base, ompl().geometric
        chain, known = self._scene.chain, np.vstack([start, goals])
        n, space = chain.n, base.RealVectorStateSpace(chain.n)
        space.setBounds(_bounds(chain, known, _NEARBY if self._is_first else math.inf))
        information = base.SpaceInformation(space)
        # The motions that end at a state check it.
        information.setStateValidityChecker(lambda _: True)
        search = self
        entries = range(n)

        class Proved(base.MotionValidator):  # type: ignore[misc, name-defined]
            def checkMotion(self, a: Any, b: Any, *_: Any) -> bool:
                return search.passes([a[i] for i in entries], [b[i] for i in entries])

        validator = Proved(information)
        information.setMotionValidator(validator)
        with seeded(self._request.seed + 1):
            information.setup()
            task, ends = base.ProblemDefinition(information), base.GoalStates(information)
            task.addStartState(_state(space, start))
            for goal in goals:
                ends.addState(_state(space, goal))
            task.setGoal(ends)
            planner = getattr(geometric, self._request.planner)(information)
            if hasattr(planner, "setRange"):
                planner.setRange(_RANGE if self._is_first else _FAR)
            planner.setProblemDefinition(task)
            planner.setup()
            if not self._solve(planner, task, space, known):
                return None
            states = task.getSolutionPath().getStates()
        return self._shortened([[state[i] for i in entries] for state in states])

    def _solve(self, planner: Any, task: Any, space: Any, ends: Array) -> bool:
        """Let a planner sample, RRT-Connect near the ends first; return whether it found a path."""
        condition = ompl().base.PlannerTerminationCondition
        if self._is_first:
            last = self.tried + _NEARBY_MOTIONS
            planner.solve(condition(lambda: self.tried > last or self._is_over()))
            space.setBounds(_bounds(self._scene.chain, ends))
        if not task.hasExactSolution():
            planner.solve(condition(self._is_over))
        return bool(task.hasExactSolution())

    def _shortened(self, rows: list[list[float]]) -> Array:
        """Go from each waypoint straight to the last one that can be reached."""
        kept, last = [0], len(rows) - 1
        while kept[-1] < last:
            here = kept[-1]
            later = (k for k in range(last, here + 1, -1) if self.passes(rows[here], rows[k]))
            kept.append(next(later, here + 1))
        return np.array([rows[k] for k in kept])


def _state(space: Any, q: Array) -> Any:
    state = space.allocState()
    for i, value in enumerate(q.tolist()):
        state[i] = value
    return state


def _bounds(chain: SerialChain, known: Array, margin: float = math.inf) -> Any:
    """Return the limits of all joints, at most a margin beyond known postures (k, n).

    Joints without limits turn at most half a turn beyond them.
    """
    low, high = known.min(axis=0), known.max(axis=0)
    lower = np.where(np.isfinite(chain.lower), chain.lower, low - np.pi)
    upper = np.where(np.isfinite(chain.upper), chain.upper, high + np.pi)
    lower = np.minimum(np.maximum(lower, low - margin), low)
    upper = np.maximum(np.minimum(upper, high + margin), high)
    bounds = ompl().base.RealVectorBounds(chain.n)
    for i, (least, most) in enumerate(zip(lower.tolist(), upper.tolist(), strict=True)):
        bounds.setLow(i, least)
        bounds.setHigh(i, most)
    return bounds


def _within_limits(chain: SerialChain, q: Array, what: str) -> Array:
    """Clip a posture (n,) to the limits; refuse it if it exceeds them by more than rounding."""
    for i, name in enumerate(chain.joint_names):
        if not chain.lower[i] - _ROUNDING <= q[i] <= chain.upper[i] + _ROUNDING:
            ends = float(chain.lower[i]), float(chain.upper[i])
            raise SeedOutsideLimitsError(name, float(q[i]), *ends, what, chain.units[i])
    return np.clip(q, chain.lower, chain.upper)


def _postures(scene: Any, goals: npt.ArrayLike, start: Array) -> tuple[Array, str]:
    """Return the goal postures (k, n), and the reason if there are none."""
    chain = scene.chain
    given = real_array("goals", goals)
    if given.shape == (4, 4) and (chain.n != 4 or _is_pose(given)):
        found = inverse_kinematics(chain, as_pose(given), seed=start)
        return found.q, found.reason
    rows = np.atleast_2d(as_finite_values(chain, given, "goals"))
    if rows.ndim > 2:
        raise WrongSizeError("goals", given.shape, f"({chain.n},), (k, {chain.n}) or (4, 4)")
    inside = [_within_limits(chain, as_posture(chain, row, "goal"), "goal") for row in rows]
    return np.array(inside).reshape(-1, chain.n), "there is no goal"


def _is_pose(given: Array) -> bool:
    try:
        as_pose(given)
    except RobomechError:
        return False
    return True


def _nearest_turns(chain: SerialChain, postures: Array, start: Array) -> Array:
    """Turn joints without limits to the goal the short way round."""
    moved: Array = postures.copy()
    turns = 2.0 * np.pi * np.round((start - moved) / (2.0 * np.pi))
    moved[:, chain.continuous] += turns[:, chain.continuous]
    return moved


def _free_goals(scene: Any, postures: Array, clearance: float) -> tuple[list[int], str]:
    """Return the numbers of the free goals, and the least depth in words if there are none."""
    kept = [k for k, q in enumerate(postures) if scene.is_free(q, clearance=clearance)]
    if kept:
        return kept, ""
    best = max((scene.clearance(q) for q in postures), key=lambda one: one.distance)
    which = "the goal is" if len(postures) == 1 else f"all {len(postures)} goals are"
    return [], f"{which} {_fault(best, clearance)}: {in_words(best.bodies, best.distance)}"


def _fault(found: Clearance, clearance: float) -> str:
    """Return whether a posture is in contact, or does not keep the clearance (m)."""
    if found.distance <= 0.0:
        return "in contact"
    return f"nearer to a body than the clearance of {clearance:g} m"


def in_words(bodies: tuple[str, str], distance: float) -> str:
    """Say which bodies are in contact, and how deep."""
    how = f"{-distance:.3g} m deep" if distance <= 0.0 else f"{distance:.3g} m apart"
    return f"'{bodies[0]}' and '{bodies[1]}', {how}"


def _leave(scene: Any, start: Array, request: PlanRequest) -> tuple[list[Array], str]:
    """Find steps out of a contact that increase the least distance; none if they fail."""
    found = scene.clearance(start)
    fault, words = _fault(found, request.clearance), in_words(found.bodies, found.distance)
    random = np.random.default_rng(request.seed)
    path, least = [start], found.distance
    lower, upper = np.minimum(scene.chain.lower, start), np.maximum(scene.chain.upper, start)
    for _ in range(_STEPS):
        directions = random.normal(size=(_DIRECTIONS, len(start)))
        directions /= np.abs(directions).max(axis=1, keepdims=True)
        steps = np.clip(path[-1] + _STEP * directions, lower, upper)
        distances = [scene.clearance(q).distance for q in steps]
        best = int(np.argmax(distances))
        if not distances[best] > least:
            break
        path.append(steps[best])
        least = distances[best]
        if least > request.clearance + _SLACK:
            return path, f"the start is {fault} and is left first: {words}"
    carried = [name for name in found.bodies if name in scene.objects and scene.objects[name].link]
    hint = f"; if it may touch '{carried[0]}', name it in touch_links" if carried else ""
    return [], f"the start is {fault}: {words}{hint}"
