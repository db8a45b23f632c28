"""Double-S profiles over a way of 1 in a time of 1, by the shape of their ramps."""

import numpy as np

from robomech_ros.trajectory.curves.piecewise import PiecewisePolynomial
from robomech_ros.trajectory.profiles.velocity_profiles import along_line
from robomech_ros.typing import Array


def unit_double_s(ramp: float, rounding: float) -> PiecewisePolynomial:
    """Return a double-S profile of one joint over a way of 1 in a time of 1.

    `ramp` is the part of the duration in which the speed rises, and in which it falls, up to 1/2;
    `rounding` the part of half a ramp in which the jerk acts at each of its ends, above 0 and up to
    1.
    """
    step = 0.5 * ramp * rounding
    return along_line(np.zeros(1), np.ones(1), (step, ramp - 2.0 * step), 1.0)


def unit_double_s_samples(ramps: Array, roundings: Array, inside: Array) -> Array:
    """Sample k profiles of `unit_double_s`: way, velocity, acceleration and jerk, (4, k, 7 p).

    `inside` (p,) is which parts of each of the seven phases are over.
    """
    lengths, jerks = _unit_phases(ramps, roundings)
    samples = np.empty((4, *lengths.shape, len(inside)))
    state = np.zeros((3, len(ramps)))
    for phase in range(lengths.shape[1]):
        jerk = jerks[:, phase, None]
        s, v, a = state[:, :, None]
        for t, out in (
            (lengths[:, phase, None] * inside, samples[:, :, phase]),
            (lengths[:, phase, None], state[:, :, None]),
        ):
            rates = (
                s + t * (v + t * (a / 2.0 + t * jerk / 6.0)),
                v + t * (a + t * jerk / 2.0),
                a + t * jerk,
                jerk + 0.0 * t,
            )
            out[:] = np.stack(rates[: len(out)])
    return samples.reshape(4, len(ramps), -1)


def _unit_phases(ramps: Array, roundings: Array) -> tuple[Array, Array]:
    """Return lengths and jerks of the seven phases of profiles over a way and a time of 1."""
    step = 0.5 * ramps * roundings
    jerk = 1.0 / ((1.0 - ramps) * (ramps - step) * step)
    up, none = [step, ramps - 2.0 * step, step], np.zeros_like(jerk)
    lengths = np.stack([*up, 1.0 - 2.0 * ramps, *up], axis=1)
    return lengths, np.stack([jerk, none, -jerk, none, -jerk, none, jerk], axis=1)
