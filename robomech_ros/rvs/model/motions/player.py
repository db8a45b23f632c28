"""Playback position in a motion, and its advance."""

import math

from robomech_ros.numerics.arrays import finite_number, real_within

# Times the speed of the motion.
SLOWEST, FASTEST = 0.1, 10.0


class Player:
    """Time within a motion, which advances while the motion plays.

    - ``duration``: duration of the motion (s).
    - ``time``: present time since its beginning (s).
    - ``speed``: multiple of the speed of the motion.
    - ``loop``: whether the motion begins again at its end.
    """

    def __init__(self) -> None:
        self.duration = self.time = 0.0
        self.speed = 1.0
        self.loop = self.playing = False

    def load(self, duration: float) -> None:
        """Begin a motion (s), at rest."""
        self.duration, self.time, self.playing = duration, 0.0, False

    def seek(self, time: float) -> None:
        """Go to a time (s), at most to an end."""
        self.time = min(max(finite_number("time", time, "s"), 0.0), self.duration)

    def set_speed(self, speed: float) -> None:
        """Set the speed as a multiple of the motion's."""
        self.speed = real_within("speed", speed, f"{SLOWEST:g} to {FASTEST:g}", SLOWEST, FASTEST)

    def play(self) -> None:
        """Play on, from the beginning after the end."""
        self.playing = self.duration > 0.0
        if self.time >= self.duration:
            self.time = 0.0

    def pause(self) -> None:
        """Pause."""
        self.playing = False

    def advance(self, seconds: float) -> None:
        """Advance the time (s)."""
        if not self.playing:
            return
        time = self.time + self.speed * max(seconds, 0.0)
        if self.loop:
            self.time = math.fmod(time, self.duration)
        else:
            self.time = min(time, self.duration)
            self.playing = time < self.duration
