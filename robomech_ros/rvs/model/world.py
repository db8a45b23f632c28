"""The world around an arm: objects, the nearest pair of bodies, and plans around obstacles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from itertools import combinations
from typing import NamedTuple

import numpy as np

from robomech_ros.collision import Clearance, PlanningScene, SceneObject, timed_path
from robomech_ros.collision.planning import in_words
from robomech_ros.collision.shapes import LARGEST
from robomech_ros.errors import BadValueError
from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import SerialChain
from robomech_ros.rvs.model.motions.planning import MadePlan
from robomech_ros.rvs.motion import Motion
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.typing import Array

# Plans around obstacles: to the goal posture, or to the first posture found for its pose.
AROUND, AROUND_TO_POSE = "around obstacles", "around, any posture"
AROUND_KINDS = (AROUND, AROUND_TO_POSE)
# Smaller motions of joints outside the arm are ignored (rad or m).
STILL = 1e-4
# Postures whose clearance is remembered until the world changes.
MOST_KNOWN = 256


class WorldView:
    """A planning scene as a page shows it; not thread-safe.

    - ``scene``: only this object changes it.
    - ``version``: grows with every change.
    - ``ways``: kinds of plans around obstacles.
    """

    ways = AROUND_KINDS

    def __init__(self, scene: PlanningScene) -> None:
        self.scene, self.version = scene, 0
        self._others: dict[str, float] = {}
        self._known: dict[bytes, Clearance] = {}
        self._around: PlanningScene | None = None

    @property
    def objects(self) -> Mapping[str, SceneObject]:
        """The objects by name."""
        return self.scene.objects

    @property
    def movable(self) -> tuple[str, ...]:
        """Names of the objects that no link carries."""
        return tuple(name for name, one in self.objects.items() if not one.link)

    def replace(self, scene: PlanningScene) -> None:
        """Show another scene of the same arm, with joints outside the arm at known positions."""
        scene.set_other_joints(self._others)
        self.scene = scene
        self._change()

    def move(self, name: str, pose: Array) -> None:
        """Move an object that no link carries to a pose (4, 4) in the base (m)."""
        if name not in self.movable:
            expected = f"one of {', '.join(self.movable) or 'none'}, which no link carries"
            raise BadValueError("object", name, expected)
        if not np.abs(pose[:3, 3]).max() <= LARGEST:
            expected = f"coordinates up to {LARGEST:g} m"
            raise BadValueError(f"position of '{name}'", pose[:3, 3].tolist(), expected)
        self.scene.move(name, pose)
        self._change()

    def place_others(self, positions: Mapping[str, float]) -> None:
        """Set the positions of joints outside the arm (rad or m, by name); others are ignored."""
        own = self.scene.chain.joint_names
        moved = {
            name: value
            for name, value in positions.items()
            if name not in own and not abs(value - self._others.get(name, np.inf)) < STILL
        }
        if moved:
            self._others |= moved
            self.scene.set_other_joints(self._others)
            self._change()

    def nearest(self, q: Array) -> Clearance | None:
        """Return the nearest pair of bodies; None if nothing can touch.

        Pairs of links are left out, since some links of an arm are always near each other.  If
        anything touches, it is the deepest pair of all.
        """
        key = q.tobytes()
        if key not in self._known:
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
            self._known[key] = self._found(q)
        found = self._known[key]
        return found if np.isfinite(found.distance) else None

    def nearest_text(self, q: Array) -> str:
        """Name the nearest bodies at a posture (n,) (rad or m), with their distance."""
        found = self.nearest(q)
        return "nothing can touch" if found is None else in_words(found.bodies, found.distance)

    def touching(self, q: Array) -> tuple[str, ...]:
        """Return the two bodies that touch at a posture (n,) (rad or m), or none."""
        found = self.nearest(q)
        return found.bodies if found is not None and found.distance <= 0.0 else ()

    def contact(self, q: Array) -> str:
        """Name the bodies in contact at a posture (n,) (rad or m), and the depth; "" for none."""
        return self.nearest_text(q) if self.touching(q) else ""

    def judge(self) -> Callable[[Motion], MotionVerdict]:
        """Return `judge_motion` in the present world, for another thread."""
        return partial(judge_motion, self.scene.copy())

    def planner(self) -> Callable[[Array, Array, str, str], MadePlan]:
        """Return `plan_around` in the present world, for another thread."""
        return partial(plan_around, self.scene.copy())

    def _found(self, q: Array) -> Clearance:
        of_all = self.scene.clearance(q)
        if of_all.distance <= 0.0 or not self.movable:
            return of_all
        if self._around is None:
            self._around = _without_own_pairs(self.scene)
        around = self._around.clearance(q)
        return around if np.isfinite(around.distance) else of_all

    def _change(self) -> None:
        self.version += 1
        self._known.clear()
        self._around = None


def _without_own_pairs(scene: PlanningScene) -> PlanningScene:
    """Return a scene without checks among links and their attached objects."""
    bare = scene.copy()
    own = [name for name in bare.bodies if name not in bare.objects or bare.objects[name].link]
    for first, second in combinations(own, 2):
        bare.allow(first, second)
    return bare


class MotionVerdict(NamedTuple):
    """Sentence on the contacts of a motion, and whether it is a warning."""

    sentence: str
    warns: bool


def judge_motion(scene: PlanningScene, motion: Motion) -> MotionVerdict:
    """Prove that a motion is free of contact, or name the bodies in contact."""
    if not scene.has_geometry:
        return MotionVerdict(f"{_capital(scene.unchecked_text)}.", True)
    found = scene.check_motion(motion)
    pair, when = " and ".join(f"'{name}'" for name in found.bodies), f"{found.parameter:.2f} s"
    if not found.free:
        return MotionVerdict(f"Contact of {pair} at {when}.", True)
    if not found.certified:
        return MotionVerdict(f"Not proved free of contact: {pair} are too near at {when}.", True)
    rest = scene.unchecked_text
    return MotionVerdict(f"Certified free of contact{f'; {rest}' if rest else ''}.", bool(rest))


def plan_around(
    scene: PlanningScene, start: Array, goal: Array, kind: str, profile: str
) -> MadePlan:
    """Plan a motion around the objects of a scene, from rest to rest.

    - ``start``, ``goal``: postures of its chain (rad or m), shape (n,).
    - ``kind``: one of ``AROUND_KINDS``.
    - ``profile``: as for :func:`robomech_ros.collision.timed_path`.

    Raises BadValueError: the kind or profile is unknown, or the start is the goal. RobomechError:
    as for ``PlanningScene.plan`` and ``timed_path``.
    """
    as_choice("way", kind, AROUND_KINDS)
    if np.array_equal(start, goal):
        raise BadValueError("goal", "the start", "another posture")
    goals = forward_kinematics(scene.chain, goal) if kind == AROUND_TO_POSE else goal
    found = scene.plan(start, goals)
    if not len(found.waypoints):
        return MadePlan(None, f"{_capital(found.reason or found.status.value)}.", False)
    timed = timed_path(scene, found.waypoints, profile=profile).waypoints
    rates = timed.velocities, timed.accelerations
    motion = Motion(scene.chain, timed.times, timed.positions, (), *rates)
    between = len(found.waypoints) - 2
    way = f"around obstacles by {between} waypoints" if between else "straight to the goal"
    note = f"; {found.reason}" if found.reason else ""
    return MadePlan(motion, f"{profile} {way}: {motion.duration:.2f} s{note}", True)


def scene_for(chain: SerialChain, scene: PlanningScene, objects: PlanningScene) -> PlanningScene:
    """Return a scene of a chain with the objects of another scene.

    - ``scene``: if it is of this chain, its ignored pairs of links are kept.
    - ``objects``: the scene with the objects; those on unknown links are left out.
    """
    made = scene.copy() if scene.chain is chain else PlanningScene(chain)
    for name in made.objects:
        made.remove(name)
    links = chain.description.links if chain.description is not None else chain.links
    for name, one in objects.objects.items():
        shapes = [(shape, pose) for shape, _, pose in one.parts]
        if not one.link:
            made.add(name, shapes, one.pose)
        elif one.link in links:
            made.add(name, shapes)
            made.attach(name, one.link, sorted(one.touch_links & set(links)), pose=one.pose)
    return made


def _capital(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"
