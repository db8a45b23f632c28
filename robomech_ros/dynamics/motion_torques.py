"""Demands of a motion on the drives: peaks, energy, and saturated joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.dynamics.systems import DynamicSystem, dynamic_system
from robomech_ros.errors import BadValueError, WrongSizeError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.spatial.arrays import as_finite, of_shape, real_array
from robomech_ros.typing import Array, ArrayLike


@dataclass(frozen=True, eq=False)
class TorqueSummary:
    """Efforts of n drives along a motion.

    Attributes
    ----------
    peak_effort, peak_effort_time : ndarray, shape (n,)
        Greatest magnitude (N m or N), and when it is reached (s).
    rms_effort : ndarray, shape (n,)
        Root of the mean square over time (N m or N).
    peak_power : ndarray, shape (n,)
        Greatest magnitude of effort times rate (W).
    energy_out, energy_back : ndarray, shape (n,)
        Energy that the joint delivers and that it takes back (J), both not negative.
    effort_limit : ndarray, shape (n,)
        N m or N; infinite where there is none.
    saturation : ndarray, shape (n,)
        Peak over limit; 0 without a limit.
    saturation_time : ndarray, shape (n,)
        When the effort is first above the limit (s); NaN where it never is.
    """

    peak_effort: Array
    peak_effort_time: Array
    rms_effort: Array
    peak_power: Array
    energy_out: Array
    energy_back: Array
    effort_limit: Array
    saturation: Array
    saturation_time: Array

    def in_words(self, joint_names: Sequence[str]) -> str:
        """Tell the findings in one sentence."""
        over = np.flatnonzero(self.saturation > 1.0)
        if len(over):
            told = [
                f"'{joint_names[i]}' at {self.saturation_time[i]:.3f} s "
                f"(peak {self.peak_effort[i]:.4g}, limit {self.effort_limit[i]:.4g})"
                for i in over.tolist()
            ]
            return f"saturates: {', '.join(told)}"
        limited = np.isfinite(self.effort_limit)
        if not limited.any():
            return "no effort limits are known; nothing can saturate"
        worst = int(np.argmax(self.saturation))
        return (
            f"within all effort limits; nearest is '{joint_names[worst]}' at "
            f"{100.0 * self.saturation[worst]:.3g} % of {self.effort_limit[worst]:.4g}"
        )


def torque_summary(
    chain: SerialChain | DynamicSystem,
    times: ArrayLike,
    q: ArrayLike,
    qd: ArrayLike,
    qdd: ArrayLike,
    *,
    gravity: ArrayLike = (0.0, 0.0, -9.81),
    tip_wrench: ArrayLike | None = None,
) -> TorqueSummary:
    """Summarise the efforts along a sampled motion, by inverse dynamics: without friction.

    Parameters
    ----------
    chain : SerialChain or DynamicSystem
        Chain of n joints, with bodies.
    times : array_like, shape (k,)
        Instants (s), not decreasing, k >= 1; what lies between them is not seen.
    q : array_like, shape (k, n)
        Positions of all joints (rad or m).
    qd, qdd : array_like, shape (k, m)
        Rates and accelerations of the drives, which all joints of a chain have.
    gravity, tip_wrench
        As for :func:`inverse_dynamics`.
    """
    system = dynamic_system(chain)
    drives = len(system.drive_names)
    instants, rates = as_finite("times", times, ()), real_array("qd", qd)
    if instants.ndim != 1 or not len(instants):
        raise WrongSizeError("times", instants.shape, "(m,) with at least one instant")
    of_shape("qd", rates, (len(instants), drives))
    if not (np.diff(instants) >= 0.0).all():
        raise BadValueError("times", instants.tolist()[:5], "instants that do not decrease")
    effort = system.inverse(q, rates, qdd, gravity=gravity, tip_wrench=tip_wrench)
    size, power = np.abs(effort), effort * rates
    peak = size.argmax(axis=0)
    span = float(instants[-1] - instants[0])
    columns = np.arange(drives)
    limit = np.where(np.isnan(system.effort), np.inf, system.effort)
    beyond = size > limit
    first = np.where(beyond.any(axis=0), instants[beyond.argmax(axis=0)], np.nan)
    # Against the peak, whose square may overflow.
    part = size / np.maximum(size.max(axis=0), np.finfo(float).tiny)
    squares = _integral(part**2, instants) / span if span else part[0] ** 2
    return TorqueSummary(
        peak_effort=size[peak, columns],
        peak_effort_time=instants[peak],
        rms_effort=np.sqrt(squares) * size.max(axis=0),
        peak_power=np.abs(power).max(axis=0),
        energy_out=_integral(np.maximum(power, 0.0), instants),
        energy_back=_integral(np.maximum(-power, 0.0), instants),
        effort_limit=limit,
        saturation=size.max(axis=0) / limit,
        saturation_time=first,
    )


def _integral(rows: Array, times: Array) -> Array:
    """Integrate columns over time by trapezia."""
    return 0.5 * np.diff(times) @ (rows[1:] + rows[:-1])
