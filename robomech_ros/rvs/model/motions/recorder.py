"""Recorder of an arm's motion."""

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.robots import SerialChain
from robomech_ros.rvs.motion import Motion
from robomech_ros.typing import Array

# Postures nearer in time than this are one (s); where nothing came for so long, the arm stood.
NEAREST, STOOD = 0.005, 0.1
# Some minutes of a hand at a slider.
MOST_POSTURES_KEPT = 20_000


class Recorder:
    """Postures and when they were taken."""

    def __init__(self) -> None:
        self._times: list[float] = []
        self._q: list[Array] = []
        self.running = False

    def begin(self, now: float, q: Array) -> None:
        """Begin anew, at a time (s) in a posture (n,), rad or m."""
        self._times, self._q, self.running = [now], [q.copy()], True

    def add(self, now: float, q: Array) -> bool:
        """Keep a posture if it is another one; says whether the recording goes on."""
        if not self.running or np.array_equal(q, self._q[-1]):
            return self.running
        if not self._hold(now) and now - self._times[-1] < NEAREST:
            self._q[-1] = q.copy()
        else:
            self._times.append(now)
            self._q.append(q.copy())
        self.running = len(self._times) < MOST_POSTURES_KEPT
        return self.running

    def end(self, now: float, chain: SerialChain) -> Motion:
        """End it, and give the motion."""
        self.running = False
        if len(self._times) < 2:
            raise BadValueError("recording", "empty", "an arm that moves")
        self._hold(now)
        return Motion(chain, np.array(self._times) - self._times[0], np.array(self._q))

    def _hold(self, now: float) -> bool:
        """Stay in the last posture until just before now, if it is a while ago; says whether."""
        stood = now - self._times[-1] > STOOD
        if stood:
            self._times.append(now - NEAREST)
            self._q.append(self._q[-1])
        return stood
