"""The world around a robot, for a servo that stops before contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from robomech_ros.collision.motion_proof import MotionProof
from robomech_ros.collision.planning import in_words
from robomech_ros.servo.contact_slowing import ContactAhead
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.collision.distances import Distances
    from robomech_ros.collision.scene import PlanningScene

# A motion leads out of a contact, or along it, if after this travel (rad or m) of a joint it is not
# deeper by more than this (m), which is the accuracy of depths.
_STEP, _SAME = 1e-3, 1e-6
# A contact before this part of a curve may be one that the curve leaves.
_HERE = 0.05


class ServoGuard:
    """Finds contacts ahead of a servo, and proves its plans to stop.

    Motion away from a contact, or along it, is free.

    Parameters
    ----------
    scene : PlanningScene
        Of the chain that the servo moves. Its padding is the distance kept to objects.
    self_proximity, scene_proximity : float
        Distances within which motion towards contact of two links, or of a link and an object, is
        slowed down (m).
    """

    def __init__(
        self, scene: PlanningScene, self_proximity: float = 0.01, scene_proximity: float = 0.02
    ) -> None:
        self._scene, self._distances = scene, scene.distances
        self._proximities = self_proximity, scene_proximity
        self._proof = MotionProof(self._distances, 0.0)
        # Pairs that touch, and what proves motions of all others.
        self._touching: set[tuple[str, str]] = set()
        self._others = self._distances, self._proof

    def contact(self, curve: Array) -> ContactAhead | None:
        """Find the first contact on a curve; see `ContactGuard`."""
        return self._first(curve[None], first=True)

    def obstruction(self, curves: Array) -> ContactAhead | None:
        """Return a contact on curves that cannot be proved free; see `ContactGuard`."""
        return self._first(curves, first=False)

    def _first(self, curves: Array, *, first: bool) -> ContactAhead | None:
        distances, proof, touching = self._distances, self._proof, dict[int, float]()
        for k, curve in enumerate(curves):
            found = proof.obstruction(np.ascontiguousarray(curve), first=first)
            if found is not None and not touching and (not first or found.at < _HERE):
                touching = self._distances.contacts(curves[0, 0])
                if touching:
                    distances, proof = self._without(touching)
                    found = proof.obstruction(np.ascontiguousarray(curve), first=first)
            if found is not None:
                return self._ahead(distances, curves[0, 0], found.pair, found.at + k)
            if touching:
                deeper = self._deeper(curve, touching, whole=not first)
                if deeper >= 0:
                    return self._ahead(self._distances, curves[0, 0], deeper, 0.0)
        return None

    def _deeper(self, curve: Array, touching: dict[int, float], *, whole: bool) -> int:
        """Return a pair that a curve drives deeper into each other than it was; -1 for none."""
        way = (curve[-1] if whole else curve[1]) - curve[0]
        moved = float(np.abs(way).max())
        if not moved:
            return -1
        q = curve[0] + (1.0 if whole else min(_STEP / moved, 1.0)) * way
        later = self._distances.contacts(q, touching.keys())
        return next((p for p, far in later.items() if far < touching[p] - _SAME), -1)

    def _without(self, touching: dict[int, float]) -> tuple[Distances, MotionProof]:
        """Return what proves motions of all pairs but those that touch."""
        pairs = {self._distances.names(pair) for pair in touching}
        if pairs != self._touching:
            others = self._scene.copy()
            for first, second in pairs:
                others.allow(first, second)
            proof = MotionProof(others.distances, 0.0)
            self._touching, self._others = pairs, (others.distances, proof)
        return self._others

    def _ahead(self, distances: Distances, q: Array, pair: int, at: float) -> ContactAhead:
        names = distances.names(pair)
        distance = distances.of_pair(pair, q)
        objects = self._scene.objects
        with_object = any(name in objects and not objects[name].link for name in names)
        far = distance + distances.padding[pair]
        return ContactAhead(at, distance, self._proximities[with_object], in_words(names, far))
