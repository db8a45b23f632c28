"""Names of the joints of a rolling robot, as its tree and its ``joint_states`` have them."""

from __future__ import annotations

from dataclasses import dataclass

from robomech_ros.rolling.base import RollingBase


@dataclass(frozen=True)
class WheelJoints:
    """Names of the joints of a base.

    Attributes
    ----------
    rolling : tuple of (str, int)
        Joints that roll, each with the number of its wheel.  Several wheels of one side may count
        as one wheel; a wheel without a joint is not told to roll.
    steering : tuple of str
        Of the steered wheels.
    brackets : tuple of str
        Of the casters.

    Examples
    --------
    >>> from robomech_ros.rolling import WheelJoints, load_rolling
    >>> WheelJoints.of(load_rolling("tricycle")).names
    ('front', 'rear_right', 'rear_left', 'front_steering')
    """

    rolling: tuple[tuple[str, int], ...]
    steering: tuple[str, ...]
    brackets: tuple[str, ...] = ()

    @classmethod
    def of(cls, base: RollingBase) -> WheelJoints:
        """Name the joints of a base after its wheels.

        Parameters
        ----------
        base : RollingBase

        Returns
        -------
        WheelJoints
            Wheels roll by their own names; steering is ``<name>_steering``, the bracket of a
            caster ``<name>_bracket``.
        """
        rolling = tuple((name, number) for number, name in enumerate(base.names))
        steering = tuple(f"{name}_steering" for name in base.steered)
        return cls(rolling, steering, tuple(f"{name}_bracket" for name in base.casters))

    @property
    def names(self) -> tuple[str, ...]:
        """All of them: those that roll, steering, brackets."""
        return (*(name for name, _ in self.rolling), *self.steering, *self.brackets)
