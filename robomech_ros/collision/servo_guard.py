"""A guard that stops a servo before contact in a planning scene."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from robomech_ros.collision.motion_proof import MotionProof
from robomech_ros.collision.planning import in_words
from robomech_ros.collision.scene import PlanningScene
from robomech_ros.errors import WrongSizeError
from robomech_ros.numerics.arrays import check_finite, check_kind, finite_within, real_array
from robomech_ros.servo.contact_slowing import ContactAhead
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.collision.distances import Distances

# A motion deepens a contact if the depth grows by more than the tolerance (m) after this travel of
# a joint (rad or m).
_STEP, _TOLERANCE = 1e-3, 1e-6
# While bodies touch, other pairs within this distance (m) count as touching, too.
_NEAR = 2e-3

# Names of two bodies.
_Pair = tuple[str, str]


class ServoGuard:
    """Finds contacts ahead of a servo, and proves its plans to stop.

    Motion away from a contact or along it is allowed.

    Parameters
    ----------
    scene : PlanningScene
        Scene of the servo's chain. Its padding is the distance kept from objects.
    self_proximity, scene_proximity : float
        Distances within which motion towards contact of two links, or of a link and an object, is
        slowed down (m).
    """

    def __init__(
        self, scene: PlanningScene, self_proximity: float = 0.01, scene_proximity: float = 0.02
    ) -> None:
        check_kind("scene", scene, PlanningScene, "a PlanningScene")
        self._scene, self._distances = scene, scene.distances
        self._proximities = (
            finite_within("self_proximity", self_proximity, "0 to 10 m", 0.0, 10.0),
            finite_within("scene_proximity", scene_proximity, "0 to 10 m", 0.0, 10.0),
        )
        self._all = self._distances, MotionProof(self._distances, 0.0)
        # Touching pairs, with the distances and the proof of all other pairs.
        self._without = frozenset[_Pair](), self._all

    def contact(self, curve: Array) -> ContactAhead | None:
        """Find the first contact on a curve; see `ContactGuard`."""
        return self._first(self._checked("curve", curve, 2)[None], first=True)

    def obstruction(self, curves: Array) -> ContactAhead | None:
        """Return a contact on curves that cannot be proved free; see `ContactGuard`."""
        return self._first(self._checked("curves", curves, 3), first=False)

    def _checked(self, what: str, value: Array, axes: int) -> Array:
        """Check coefficients (..., d + 1, n) of one curve (2 axes) or of some (3 axes)."""
        array, n = real_array(what, value), self._scene.chain.n
        if array.ndim != axes or array.shape[-1] != n or min(array.shape[:-2], default=1) < 1:
            raise WrongSizeError(what, array.shape, f"({'s, ' * (axes - 2)}d + 1, {n})")
        if array.shape[-2] < 2:
            raise WrongSizeError(what, array.shape, "two or more coefficients for each curve")
        check_finite(what, array)
        return array

    def _first(self, curves: Array, *, first: bool) -> ContactAhead | None:
        start, touching, k = curves[0, 0], frozenset[_Pair](), 0
        while k < len(curves):
            curve = np.ascontiguousarray(curves[k])
            if touching and self._leads_deeper(curve, start, touching, whole=not first):
                deepest = min(touching, key=partial(self._distance, start))
                return self._ahead(start, deepest, 0.0)
            distances, proof = self._proof_without(touching)
            found = proof.obstruction(curve, first=first)
            if found is None:
                k += 1
                continue
            names = distances.names(found.pair)
            more = self._touching(start, touching, names)
            if more == touching:
                return self._ahead(start, names, found.at + k)
            touching = more
        return None

    def _touching(self, q: Array, known: frozenset[_Pair], names: _Pair) -> frozenset[_Pair]:
        """Return the pairs that touch at q (n,); to known ones, add the given one if it is near."""
        if not known:
            return frozenset(map(self._distances.names, self._distances.contacts(q)))
        return known | {names} if self._distance(q, names) <= _NEAR else known

    def _leads_deeper(
        self, curve: Array, start: Array, touching: frozenset[_Pair], *, whole: bool
    ) -> bool:
        """Return whether the least distance of pairs shrinks on a curve, at first or as a whole."""
        travel = (curve[-1] if whole else curve[1]) - curve[0]
        moved = float(np.abs(travel).max())
        if not moved:
            return False
        later = curve[0] + (1.0 if whole else min(_STEP / moved, 1.0)) * travel
        least = (min(self._distance(q, names) for names in touching) for q in (later, start))
        return next(least) < next(least) - _TOLERANCE

    def _distance(self, q: Array, names: _Pair) -> float:
        """Compute the padded distance of two links or objects (m)."""
        return min(
            self._distances.pair_distance(pair, q) for pair in self._distances.pairs_of(names)
        )

    def _proof_without(self, touching: frozenset[_Pair]) -> tuple[Distances, MotionProof]:
        """Return the distances and the proof of all pairs except the touching ones."""
        if not touching:
            return self._all
        if touching != self._without[0]:
            others = self._scene.copy()
            for first, second in touching:
                others.allow(first, second)
            proof = MotionProof(others.distances, 0.0)
            self._without = touching, (others.distances, proof)
        return self._without[1]

    def _ahead(self, q: Array, names: _Pair, at: float) -> ContactAhead:
        distance, objects = self._distance(q, names), self._scene.objects
        with_object = any(name in objects and not objects[name].link for name in names)
        padding = self._scene.padding if with_object else 0.0
        words = in_words(names, distance + padding)
        return ContactAhead(at, distance, self._proximities[with_object], words)
