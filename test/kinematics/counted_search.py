"""The work of searches for joint values, counted, by a clock that goes by looks at it."""

from types import SimpleNamespace

from robomech_ros.kinematics.inverse import inverse_kinematics, nearest_posture, solve_by_search
from robomech_ros.kinematics.inverse.families import iterative_search
from robomech_ros.kinematics.inverse.result import reach

_WITH_CLOCK = (inverse_kinematics, iterative_search, nearest_posture, reach, solve_by_search)


class CountedSearch:
    """Counts what is done from now on: every look at the clock takes a second, all else none.

    Attributes
    ----------
    looks : int
        Looks at the clock.
    attempts, most_attempts : int
        Attempts at the whole pose: all, and the most between two looks.
    starts : int
        Starts of the search for the least distance.
    """

    def __init__(self, monkeypatch):
        self.forget()
        clock = SimpleNamespace(monotonic=self._look)
        for module in _WITH_CLOCK:
            monkeypatch.setattr(module, "time", clock)
        search, least_distance = iterative_search.search, reach.least_distance

        def counted_search(data, T, seed, done, count, *more):
            self.attempts += count
            self.most_attempts = max(self.most_attempts, count)
            return search(data, T, seed, done, count, *more)

        def counted_distance(packed, wanted, bounds, strides, counts, *more):
            self.starts += counts[1]
            return least_distance(packed, wanted, bounds, strides, counts, *more)

        monkeypatch.setattr(iterative_search, "search", counted_search)
        monkeypatch.setattr(reach, "least_distance", counted_distance)

    def forget(self):
        """Count from zero."""
        self.looks = self.attempts = self.most_attempts = self.starts = 0

    def _look(self):
        self.looks += 1
        return float(self.looks)
