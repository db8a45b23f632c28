"""A goal that follows the robot until it is moved, and again once the robot has reached it."""

import threading

import numpy as np

from robomech_ros.typing import Array

# Distance of a joint from a reached goal, and move of a joint at rest (rad or m); the tolerance
# of the controller is larger than the first.
THERE, STILL = 2e-3, 1e-4
# Time without motion after which a robot is at rest (s).
REST = 0.3


class FollowingGoal:
    """Present and goal positions of a robot; for several threads.

    - ``q``: the goal at first (rad or m), shape (n,).
    """

    def __init__(self, q: Array) -> None:
        self._lock = threading.Lock()
        self._goal, self._follows = q, True
        self._robot: Array | None = None
        # Position and time (s) of the robot's last motion, and its position when the goal
        # was last put elsewhere.
        self._moved_to: Array | None = None
        self._moved_at = 0.0
        self._left: Array | None = None
        self._brought: Array | None = None

    @property
    def is_apart(self) -> bool:
        """True if the goal was moved away from the robot."""
        with self._lock:
            return not self._follows and not _near(self._robot, self._goal, THERE)

    @property
    def is_behind(self) -> bool:
        """True if the goal follows the robot, which has left the position of the goal."""
        with self._lock:
            known = self._robot is not None and self._brought is not None
            return self._follows and known and not _near(self._robot, self._brought, THERE)

    def put(self, q: Array, *, followed: bool = False) -> None:
        """Move the goal; unless it followed the robot, it stays there."""
        with self._lock:
            if not followed and not np.array_equal(q, self._goal):
                self._follows, self._left = False, self._robot
            self._goal = q

    def robot_is_at(self, q: Array, now: float) -> bool:
        """Update the robot's position (rad or m) at a time (s); return whether the goal moves."""
        with self._lock:
            self._robot = q
            if not _near(self._moved_to, q, STILL):
                self._moved_to, self._moved_at = q, now
            if now - self._moved_at < REST:
                return False
            came = _near(q, self._goal, THERE) and not _near(self._left, q, THERE)
            self._follows = self._follows or came
            if not self._follows or _near(self._brought, q, STILL):
                return False
            self._brought = q
            return True

    def follow(self) -> None:
        """Keep the goal with the robot from now on."""
        with self._lock:
            self._follows = True

    def followed(self) -> Array | None:
        """Return the new position of the goal (rad or m); None if it stays."""
        with self._lock:
            if not self._follows:
                return None
            self._brought = self._robot
            return self._robot


def _near(a: Array | None, b: Array | None, tolerance: float) -> bool:
    """Return whether both are known and all joints are within a tolerance (rad or m)."""
    if a is None or b is None:
        return False
    return bool((np.abs(a - b) <= tolerance).all())
