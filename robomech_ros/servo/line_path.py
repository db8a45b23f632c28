"""The way of the joints while the tip follows one twist, laid as far as needed.

It is parametrised by its length in joint space, each joint over its acceleration limit, for this
is smooth where the way of the tip ends: before a singularity joints turn by more and more for the
same way of the tip.  So that no period takes long, only some postures are examined in each; what is
not laid in this period is in the next ones.
"""

import numpy as np

from robomech_ros._kernels.compiling.jit import direct
from robomech_ros._kernels.servo.look_ahead import postures_on_path
from robomech_ros.servo.line_laying import LineLaying
from robomech_ros.typing import Array

_postures_on_path = direct(postures_on_path)
_ONE = np.ones(1)

# How many postures are examined in a period at most.
_POSTURES = 10
# So many nodes are kept behind.
_KEPT = 64
# Newton steps to the nearest place.
_NEWTON = 3


class LinePath:
    """The way of n joints for a twist that is held, of which no more than the first node is laid.

    ``twist`` gives the twist for q in base axes, angular first (rad/s and m/s).
    """

    def __init__(self, way: LineLaying) -> None:
        self.twist, self._weights, self._way = way.twist, way.weights, way
        self._laying = way.lay()
        self._postures = _POSTURES
        self._tables: tuple[Array, ...] | None = None
        # Number of nodes of the tables, and node at which the path left a singularity.
        self._tabled = 0
        self._out = np.inf if way.leaving else -np.inf

    @property
    def singular(self) -> bool:
        """True if it ends before a singularity, or leads nowhere from one."""
        return self._way.singular

    @property
    def laid(self) -> float:
        """Path parameter up to which the line is laid."""
        return self._way.nodes[-1].place

    @property
    def hopeless(self) -> bool:
        """True if it leads nowhere at all."""
        return self._way.ended and len(self._way.nodes) == 1

    @property
    def unfinished(self) -> bool:
        """True if this period was too short to lay the required path."""
        return not self._postures and not self._way.ended

    def begin_period(self) -> None:
        """Allow for the postures of another period."""
        self._postures = _POSTURES

    def leaves(self, place: float) -> bool:
        """Return whether a place is beyond the hard stop, from where the way leads out."""
        return place < self._out

    def reach(self, place: float) -> bool:
        """Lay it as far as a place; False where it ends before, or the period does."""
        way = self._way
        while way.nodes[-1].place < place and not way.ended:
            if not self._postures:
                return False
            self._postures -= 1
            next(self._laying, None)
            if self._out == np.inf and not way.leaving:
                self._out = way.nodes[-1].place
        return way.nodes[-1].place >= place

    def forget_before(self, place: float) -> None:
        """Keep no more than some nodes behind a place."""
        behind = sum(node.place < place for node in self._way.nodes[:-2])
        if behind > 2 * _KEPT:
            del self._way.nodes[: behind - _KEPT]
            self._tables = None

    def at(self, places: Array, rates: Array) -> tuple[Array, Array]:
        """Return postures at places (k,), which do not decrease, and velocities.

        Both have the shape (k, n); rates (k,) are those with which the places change (1/s).
        """
        nodes, postures, slopes, _ = self._table()
        q, v = np.empty((2, len(places), postures.shape[1]))
        _postures_on_path(nodes, postures, slopes, places, rates, q, v)
        return q, v

    def slope(self, place: float) -> Array:
        """Return by how much the joints turn there by place."""
        return self.at(np.array([place]), _ONE)[1][0]

    def rate(self, place: float) -> float:
        """Return how fast the place changes with the whole twist (1/s)."""
        at, _, _, rates = self._table()
        return float(np.interp(place, at, rates))

    def nearest(self, q: Array) -> float:
        """Find the place near the beginning that is nearest to a posture (rad or m)."""
        place = 0.0
        for _ in range(_NEWTON):
            here, slope = self.at(np.array([place]), _ONE)
            along = self._weights**2 * slope[0]
            place += float(along @ (q - here[0])) / float(along @ slope[0])
        return place

    def _table(self) -> tuple[Array, ...]:
        nodes = self._way.nodes
        if self._tables is None or len(nodes) != self._tabled:
            self._tabled = len(nodes)
            names = ("place", "q", "direction", "rate")
            self._tables = tuple(
                np.array([getattr(node, name) for node in nodes]) for name in names
            )
        return self._tables
