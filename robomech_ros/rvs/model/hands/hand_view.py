"""The displayed hand: its fingers follow the object that they touch."""

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.hands import Contact, Hand, grasp_postures, hand_postures
from robomech_ros.kinematics import InverseKinematicsResult, forward_kinematics
from robomech_ros.robots import SerialChain
from robomech_ros.rvs.model.bodies.solids import Solid, box, cylinder, sphere
from robomech_ros.rvs.model.bodies.visual_model import VisualModel
from robomech_ros.rvs.model.draggable import SliderRange
from robomech_ros.rvs.model.hands.ghosts import HandGhosts
from robomech_ros.rvs.model.hands.grasp import Grasp
from robomech_ros.rvs.model.hands.tree import OBJECT, OBJECT_JOINTS, finger_links, hand_tree
from robomech_ros.rvs.model.kinds.tree_view import TreeView
from robomech_ros.rvs.model.postures import MOST_POSTURES, PoseStudy, Posture, pose_summary
from robomech_ros.spatial import roll_pitch_yaw_from_matrix
from robomech_ros.typing import Array

SHAPES = ("ball", "cylinder", "box")
# First position of the object, as a fraction of the line from the middle of the fingers' bases to
# that of their tips at mid-range: short of the end, so that fingers can follow it.
OUT = 0.85
# First sizes of the object, relative to the distance of the tips from their middle.
SIZES = (0.7, 0.6, 0.5, 0.4, 0.3, 0.2)
# First contacts: friction, torsional friction in sizes of the object, and load (N).
FRICTION, TORSIONAL, WEIGHT = 0.6, 0.2, 2.0

# Range and unit of a contact's coordinates; range of the size relative to the first one.
SPOT = {"angle": (-math.pi, math.pi, "rad"), "height": (-0.95, 0.95, "times the size")}
SMALLEST, LARGEST = 0.2, 1.5
# End of reasons for tips with free orientation, as of all fingers here.
MASKED = "; only x, y and z"


@dataclass(frozen=True)
class HeldObject:
    """An object, its centre at the origin of its frame."""

    #: One of ``SHAPES``.
    shape: str
    #: Radius of a ball or of a cylinder, which is as high as it is wide, or half the side of a box,
    #: a cube (m).
    size: float

    @property
    def solid(self) -> Solid:
        """Its surface."""
        width = 2.0 * self.size
        if self.shape == "ball":
            return sphere(self.size)
        return cylinder(self.size, width) if self.shape == "cylinder" else box(width, width, width)

    def touched(self, angle: float, height: float) -> tuple[Array, Array]:
        """Return a point of the surface and the normal into the object, each shape (3,).

        - ``angle``: angle of the point about z, from x (rad).
        - ``height``: height of the point along z, from -1 to 1 times the size.
        """
        outwards = np.array([math.cos(angle), math.sin(angle), 0.0])
        if self.shape == "ball":
            outwards = math.sqrt(max(1.0 - height**2, 0.0)) * outwards + [0.0, 0.0, height]
            return self.size * outwards, -outwards
        place, normal = outwards, outwards
        if self.shape == "box":
            side = int(np.argmax(np.abs(outwards)))
            place = outwards / abs(outwards[side])
            normal = np.zeros(3)
            normal[side] = math.copysign(1.0, outwards[side])
        return self.size * (place + [0.0, 0.0, height]), -normal


@dataclass(frozen=True)
class Spot:
    """Point of the object for a finger to touch.

    - ``angle``, ``height``: as for ``HeldObject.touched``.
    """

    #: Whether the finger touches the object.
    touches: bool
    angle: float
    height: float = 0.0


class HandView(TreeView):
    """A hand, the object between its fingers, and a load; not for several threads at a time.

    - ``spots``: the contact point of each finger.
    - ``model``: model of all contacts, see :class:`~robomech_ros.hands.Contact`.
    - ``friction``, ``torsional``: coefficients of friction, the torsional one in m.
    - ``load``: load on the object, shape (6,): moment about its centre (N m), then force (N), in
      the axes of the palm.
    - ``sizes``: range of the size of the object (m).
    - ``reached``: the fingers that touch the object.
    """

    kind = "hand"
    lists_postures = True

    def __init__(self, hand: Hand) -> None:
        self.hand = hand
        tree, self._shapes = hand_tree(hand)
        bases = np.array([finger.packed[0, 10:13] for finger in hand.fingers])
        far = max(_length(finger) for finger in hand.fingers)
        far += float(np.linalg.norm(bases, axis=1).max())
        slide, turn = SliderRange(-far, far), SliderRange(-math.pi, math.pi)
        half = SliderRange(-0.5 * math.pi, 0.5 * math.pi)
        travels = dict(zip(OBJECT_JOINTS, (slide, slide, slide, turn, half, turn), strict=True))
        super().__init__(tree, travels, OBJECT)
        q = np.concatenate([finger.midrange() for finger in hand.fingers])
        super().place(self._named(q))
        tips = np.array(
            [
                forward_kinematics(finger, part)[:3, 3]
                for finger, part in zip(hand.fingers, hand.split(q), strict=True)
            ]
        )
        middle, begin = tips.mean(axis=0), bases.mean(axis=0)
        centre = begin + OUT * (middle - begin)
        super().place(dict(zip(OBJECT_JOINTS, centre.tolist(), strict=False)))
        self.spots = _spots(tips - middle)
        self.model, self.friction = "point", FRICTION
        self.load = np.array([0.0, 0.0, 0.0, 0.0, 0.0, -WEIGHT])
        self.reached: tuple[int, ...] = ()
        self._study = pose_summary(self.tip, "")
        apart = float(np.linalg.norm(tips - middle, axis=1).mean()) or far
        for part in SIZES:
            self.held = HeldObject("ball", float(f"{part * apart:.2g}"))
            self.torsional = TORSIONAL * self.held.size
            self.touch()
            if self._study.postures:
                break
        low, high = (float(f"{part * self.held.size:.2g}") for part in (SMALLEST, LARGEST))
        self.sizes = (low, high)
        self._home = self._q

    @property
    def state(self) -> Hashable:
        """State that determines the grasp."""
        contacts = (self.held, self.model, self.friction, self.torsional, *self.spots)
        return (self.q.tobytes(), self.load.tobytes(), *contacts)

    @property
    def fingers_q(self) -> Array:
        """All joints of the fingers (rad or m), shape (n,)."""
        at = self.positions
        return np.array([at[name] for name in self.hand.joint_names])

    @property
    def study(self) -> PoseStudy:
        """Study of the object's pose: all postures of the fingers."""
        return self._study

    @property
    def faulty_links(self) -> tuple[str, ...]:
        """The fingers that should touch the object but do not reach it."""
        missing = [k for k, spot in enumerate(self.spots) if spot.touches and k not in self.reached]
        return tuple(link for k in missing for link in finger_links(self.hand.fingers[k]))

    def contact(self, finger: int) -> Contact:
        """Return the contact of a finger, in the frame of the object."""
        spot = self.spots[finger]
        place, normal = self.held.touched(spot.angle, spot.height)
        return Contact(place, normal, self.model, self.friction, self.torsional)

    def contacts(self, fingers: Sequence[int]) -> tuple[Contact, ...]:
        """Return the contacts of fingers, in the palm."""
        T = self.tip
        found = []
        for one in map(self.contact, fingers):
            place = T[:3, :3] @ one.position + T[:3, 3]
            normal = T[:3, :3] @ one.normal
            found.append(Contact(place, normal, one.model, one.friction, one.torsional))
        return tuple(found)

    @property
    def grasp(self) -> Grasp:
        """Grasp by the fingers that reach the object."""
        contacts, centre = self.contacts(self.reached), self.tip[:3, 3]
        return Grasp(self.hand, self.fingers_q, contacts, self.reached, centre, self.load)

    def place(self, positions: Mapping[str, float]) -> None:
        """Set joints of fingers or object (rad or m); fingers follow."""
        super().place(positions)
        self.touch()

    def dragged(self, T: Array) -> Mapping[str, float]:
        """Return the joints that bring the object to a pose, at the ends of its travels at most."""
        roll, pitch, yaw = roll_pitch_yaw_from_matrix(T[:3, :3]).tolist()
        values = [*T[:3, 3].tolist(), yaw, pitch, roll]
        ends = [self.travel(k) for k in range(len(OBJECT_JOINTS))]
        inside = (min(max(x, e.low), e.high) for x, e in zip(values, ends, strict=True))
        return dict(zip(OBJECT_JOINTS, inside, strict=True))

    def ghosts(self, seen: VisualModel, radius_scale: float | None = None) -> HandGhosts:
        """Return the pieces of ghosts."""
        fingers = [seen.tree.chain(one.base, one.tip) for one in self.hand.fingers]
        return HandGhosts(fingers, self._shapes, lambda: self.q)

    def _named(self, q: Array) -> dict[str, float]:
        return dict(zip(self.hand.joint_names, q.tolist(), strict=True))

    def touch(self) -> None:
        """Move the fingers to their contacts, in the postures nearest to the present ones."""
        hand, T, q = self.hand, self.tip, self.fingers_q
        wanted = [k for k, spot in enumerate(self.spots) if spot.touches]
        self.reached = ()
        if not wanted:
            self._study = pose_summary(T, "No finger is to touch the object.")
            return
        contacts = [self.contact(k) for k in wanted]
        found = dict(
            zip(wanted, grasp_postures(hand, T, contacts, fingers=wanted, seed=q), strict=True)
        )
        self.reached = tuple(k for k in wanted if len(found[k].q))
        postures: tuple[Posture, ...] = ()
        if self.reached:
            results = [found[k] for k in self.reached]
            whole, _ = hand_postures(
                hand, results, fingers=self.reached, seed=q, most=MOST_POSTURES
            )
            lower, upper = (
                np.concatenate([getattr(finger, end) for finger in hand.fingers])
                for end in ("lower", "upper")
            )
            whole = np.clip(whole, lower, upper)
            super().place(self._named(whole[0]))
            postures = self._postures(whole, found)
        self._study = self._studied(T, postures, found)

    def _postures(
        self, whole: Array, found: Mapping[int, InverseKinematicsResult]
    ) -> tuple[Posture, ...]:
        """Describe postures of the hand (m, n) by those of its fingers."""
        placed = self.q[self.hand.n :]
        described = []
        for row in whole:
            part = self.hand.split(row)
            names, margins, conditions = [], [], []
            for k in self.reached:
                branch = int(np.argmin(np.abs(found[k].q - part[k]).max(axis=1)))
                names.append(found[k].branches[branch].removeprefix("posture-"))
                margins.append(float(found[k].limit_margin[branch]))
                conditions.append(float(found[k].condition_number[branch]))
            distance = float(np.abs(row - whole[0]).max())
            described.append(
                Posture(
                    np.concatenate([row, placed]),
                    " | ".join(names),
                    distance,
                    min(margins),
                    max(conditions),
                )
            )
        return tuple(sorted(described, key=lambda posture: posture.name))

    def _studied(
        self, T: Array, postures: tuple[Posture, ...], found: Mapping[int, InverseKinematicsResult]
    ) -> PoseStudy:
        missing = [k for k in found if k not in self.reached]
        if missing:
            names = self.hand.finger_names
            reasons = [f"{names[k]}: {found[k].reason.partition(MASKED)[0]}." for k in missing]
            return pose_summary(T, " ".join(reasons), found[missing[0]].status)
        count = math.prod(len(one.q) for one in found.values())
        complete = all(one.complete for one in found.values())
        noun = "posture touches" if count == 1 else "postures touch"
        rest = "these are all" if complete else "there may be more"
        if count == 1 and complete:
            rest = "this is the only one"
        if len(postures) < count:
            rest += f"; the nearest {len(postures)} are listed"
        text = f"{count} {noun} the object so; {rest}."
        return pose_summary(T, text, postures=postures, complete=complete)


def _length(finger: SerialChain) -> float:
    """Add up the lengths of a finger stretched out (m)."""
    fixed = float(np.linalg.norm(finger.packed[1:, 10:13], axis=1).sum())
    slides = [max(abs(finger.lower[k]), abs(finger.upper[k])) for k in range(finger.n)]
    slides = [one for one, unit in zip(slides, finger.units, strict=True) if unit == "m"]
    return fixed + float(sum(one for one in slides if math.isfinite(one)))


def _spots(directions: Array) -> list[Spot]:
    """Return contacts towards each tip, or evenly round if all tips are at one point."""
    if np.linalg.norm(directions[:, :2], axis=1).min() < 1e-6:
        n = len(directions)
        return [Spot(True, angle) for angle in 2.0 * np.pi * np.arange(n) / n]
    angles = np.arctan2(directions[:, 1], directions[:, 0]).tolist()
    return [Spot(True, round(angle, 6) + 0.0) for angle in angles]
