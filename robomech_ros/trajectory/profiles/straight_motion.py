"""The common part of motions from rest to rest on a straight line in joint space."""

from abc import ABC, abstractmethod
from typing import Any, ClassVar, TypeVar

from robomech_ros.errors import DurationTooShortError
from robomech_ros.trajectory.limits import Limits, Rate
from robomech_ros.trajectory.tolerances import DURATION_ROUNDING, SHORTEST_TRAJECTORY
from robomech_ros.typing import Array

_M = TypeVar("_M", bound="StraightMotion")


class StraightMotion(ABC):
    """A motion of all joints together, whose shortest duration within limits is known."""

    REQUIRED: ClassVar[tuple[Rate, ...]] = ("velocity", "acceleration")
    STARTS_MOVING: ClassVar[bool] = False
    ACCELERATION_STEPS: ClassVar[bool] = False

    @classmethod
    def plan(
        cls: type[_M], start: Array, goal: Array, limits: Limits, duration: float | None = None
    ) -> _M:
        """Plan the fastest motion within the limits, or the one that takes a wanted time (s).

        The limits of ``REQUIRED`` count; except where accelerations step, jerk limits that are
        finite do as well. Raises DurationTooShortError if the wanted duration would break a limit.
        """
        least, shape = cls._fastest(start, goal, limits)
        shortest = SHORTEST_TRAJECTORY
        lasting = least if least > shortest else shortest
        if duration is not None:
            slack = DURATION_ROUNDING * (1.0 + lasting)
            if duration < lasting - slack and least > duration:
                rate, joint = cls._binding(start, goal, limits)
                raise DurationTooShortError(duration, lasting, limits.joint_names[joint], rate)
            lasting = max(lasting, duration)
        return cls._lasting(start, goal, lasting, shape)

    @classmethod
    @abstractmethod
    def _fastest(cls, start: Array, goal: Array, limits: Limits) -> tuple[float, Any]:
        """Return the shortest duration (s), 0 for no way at all, and what `_lasting` needs."""

    @classmethod
    @abstractmethod
    def _binding(cls, start: Array, goal: Array, limits: Limits) -> tuple[Rate, int]:
        """Find which limit of which joint makes the motion last as long as it does."""

    @classmethod
    @abstractmethod
    def _lasting(cls: type[_M], start: Array, goal: Array, duration: float, shape: Any) -> _M:
        """Make the motion of a duration (s) that is possible."""
