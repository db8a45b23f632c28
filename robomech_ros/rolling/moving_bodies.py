"""Bodies of a base in motion, between the torques of its motors and its accelerations."""

from typing import NamedTuple

import numpy as np

from robomech_ros.dynamics.complement.constrained_bodies import ConstrainedBodies
from robomech_ros.errors import BadValueError
from robomech_ros.rolling.steering_motion import IndependentRates
from robomech_ros.typing import Array

# An acceleration that wheels cannot give misses by more than this part of it.
_OFF = 1e-9


class MovingBodies(NamedTuple):
    """A base with m independent rates, k driven and s steered wheels, at one moment.

    ``raw`` (6 r, 3 + s) leads from the twist and steering rates to the twists of the bodies, and
    ``motor_rates`` (k + s, m) from independent rates to those of the motors.
    """

    bodies: ConstrainedBodies
    independent: IndependentRates
    raw: Array
    motor_rates: Array

    def torques(self, accelerations: Array, wrench: Array) -> Array:
        """Return the torques (k + s,) for rates (3 + s,) of the twist and of steering rates.

        Raises BadValueError for accelerations that the wheels cannot give. ``wrench`` (3,) pushes
        the platform.
        """
        bias = self.independent.shape_rate @ self.independent.rates
        rates = np.linalg.pinv(self.independent.shape) @ (accelerations - bias)
        found = self.independent.shape @ rates + bias
        parts = [("acceleration", slice(3)), ("accelerations of steering", slice(3, None))]
        for what, part in parts:
            near, given = found[part], accelerations[part]
            if (np.abs(near - given) > _OFF * np.abs(accelerations).max()).any():
                expected = f"one that the wheels can give, such as {near.tolist()}"
                raise BadValueError(what, given.tolist(), expected)
        return self.torques_of(rates, wrench)

    def torques_of(self, rates: Array, wrench: Array) -> Array:
        """Return the torques (k + s,) for changes (m,) of the independent rates."""
        efforts = self.raw.T @ self.bodies.inertia_wrenches(rates)
        efforts[:3] -= wrench
        steered = len(efforts) - 3
        drives = self.motor_rates[: len(self.motor_rates) - steered].T
        driving = np.linalg.pinv(drives) @ (self.independent.shape[:3].T @ efforts[:3])
        return np.concatenate([driving, efforts[3:]])

    def accelerations(self, torques: Array, wrench: Array) -> Array:
        """Return the rates (3 + s,) of the twist and of steering rates under torques (k + s,)."""
        found = self.independent
        efforts = self.motor_rates.T @ torques + found.shape[:3].T @ wrench
        return np.asarray(
            found.shape @ self.bodies.forward(efforts) + found.shape_rate @ found.rates
        )
