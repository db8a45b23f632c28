"""Effects of a joint's drive beyond the rigid bodies: friction, and inertia of its rotor."""

import math
from dataclasses import dataclass, fields

from robomech_ros.errors import BadValueError


@dataclass(frozen=True)
class Drive:
    """The drive of a joint, at the joint's side of its gear, except for the rotor.

    The friction opposes the rate v with ``viscous v + coulomb sign(v)``, and while the joint
    breaks away with ``(static - coulomb) exp(-(v / stribeck_velocity)^2) sign(v)`` besides.

    Parameters
    ----------
    viscous : float
        N m s/rad or N s/m.
    coulomb : float
        N m or N.
    static : float
        N m or N, at least ``coulomb``; 0 stands for ``coulomb``: no Stribeck effect.
    stribeck_velocity : float
        rad/s or m/s; positive where ``static`` is above ``coulomb``.
    rotor_inertia : float
        Of rotor and gear about the motor's own axis (kg m^2).
    gear_ratio : float
        Turns of the motor for one turn of the joint, or rad of the motor for a metre.

    Raises
    ------
    BadValueError
        A number is negative or not finite, the ratio is 0, or the static friction is not above
        that of motion.
    """

    viscous: float = 0.0
    coulomb: float = 0.0
    static: float = 0.0
    stribeck_velocity: float = 0.0
    rotor_inertia: float = 0.0
    gear_ratio: float = 1.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, bool) or not isinstance(value, int | float):
                raise BadValueError(field.name, value, "a number")
            signed = field.name == "gear_ratio"
            if not math.isfinite(value) or (value < 0.0 and not signed):
                expected = "a finite number" if signed else "a finite number, not negative"
                raise BadValueError(field.name, value, expected)
        if self.gear_ratio == 0.0:
            raise BadValueError("gear_ratio", self.gear_ratio, "a number other than 0")
        if self.static and self.static < self.coulomb:
            raise BadValueError("static", self.static, f"at least coulomb, {self.coulomb:g}, or 0")
        if self.static > self.coulomb and not self.stribeck_velocity:
            raise BadValueError(
                "stribeck_velocity", 0.0, "a positive number beside static friction"
            )

    @property
    def reflected_inertia(self) -> float:
        """Inertia that the rotor adds to the joint (kg m^2, or kg for a prismatic joint)."""
        return self.rotor_inertia * self.gear_ratio**2


DRIVE_KEYS = tuple(one.name for one in fields(Drive))
