"""Recorder of an arm's motion."""

import numpy as np

from robomech_ros.errors import BadValueError
from robomech_ros.robots import SerialChain
from robomech_ros.rvs.motion import Motion
from robomech_ros.typing import Array

# Postures nearer in time than this are one (s); without a posture for so long the arm stood still.
NEAREST, STOOD = 0.005, 0.1
# Most postures: some minutes of slider motion.
MOST_POSTURES_KEPT = 20_000


class Recorder:
    """Recorded postures and their times."""

    def __init__(self) -> None:
        self._times: list[float] = []
        self._q: list[Array] = []
        self.running = False

    def begin(self, now: float, q: Array) -> None:
        """Restart at a time (s) in a posture (n,), rad or m."""
        self._times, self._q, self.running = [now], [q.copy()], True

    def add(self, now: float, q: Array) -> bool:
        """Add a posture if it differs; return whether the recording goes on."""
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
        """End the recording, and return the motion."""
        self.running = False
        if len(self._times) < 2:
            raise BadValueError("recording", "empty", "an arm that moves")
        self._hold(now)
        return Motion(chain, np.array(self._times) - self._times[0], np.array(self._q))

    def _hold(self, now: float) -> bool:
        """Extend the last posture until just before now after a pause; return whether it did."""
        stood = now - self._times[-1] > STOOD
        if stood:
            self._times.append(now - NEAREST)
            self._q.append(self._q[-1])
        return stood
