"""The implicit midpoint rule for a system, in values and momenta of its drives: symplectic."""

from collections.abc import Callable

import numpy as np

from robomech_ros.dynamics.complement.stacking import solve
from robomech_ros.dynamics.simulation.equations_of_motion import EquationsOfMotion
from robomech_ros.errors import RobomechError
from robomech_ros.typing import Array

_ITERATIONS = 100
# Change (of values and momenta, relative to their size) at which an iteration has arrived.
_ARRIVED = 1e-14


class MidpointSolver:
    """Steps of a fixed length (s), the last one to the end, with the face of scipy's solvers.

    The state (2 m + 2,) has values and rates of the drives, work and heat.
    """

    def __init__(
        self, forces: EquationsOfMotion, t: float, state: Array, end: float, step: float
    ) -> None:
        self.forces, self.t, self.y, self.end, self.length = forces, t, state, end, step
        self.status = "running" if t < end else "finished"
        self._from = (t, state)

    def step(self) -> str | None:
        """Do a step; returns what went wrong, with ``status`` then "failed"."""
        h = min(self.length, self.end - self.t)
        m = self.forces.m
        q, qd = self.y[:m].copy(), self.y[m : 2 * m].copy()
        try:
            after = self._after(h, q, qd)
        except (RobomechError, np.linalg.LinAlgError) as error:
            self.status = "failed"
            return str(error)
        if after is None:
            self.status = "failed"
            return f"the midpoint is not found in {_ITERATIONS} iterations; the step is too long"
        q_after, qd_after, power, loss = after
        self._from = (self.t, self.y)
        self.t += h
        gains = self.y[2 * m :] + h * np.array([power, loss])
        self.y = np.concatenate((q_after, qd_after, gains))
        if self.t >= self.end * (1.0 - 1e-15):
            self.t, self.status = self.end, "finished"
        return None

    def _after(self, h: float, q: Array, qd: Array) -> tuple[Array, Array, float, float] | None:
        """Find the midpoint by iteration: ``q' = M^-1 p`` and ``p' = C^T q' - g + tau`` at it."""
        forces, system = self.forces, self.forces.system
        gravity, wrench = forces.gravity, forces.tip_wrench
        p, still = system.mass_matrix(forces.posture(q)) @ qd, np.zeros_like(qd)
        middle, momentum = q + 0.5 * h * qd, p
        reach, size = 1.0 + np.abs(middle).max(), 1.0 + np.abs(p).max()
        for _ in range(_ITERATIONS):
            posture = forces.posture(middle)
            rate = solve(system.mass_matrix(posture), momentum)
            tau = forces.drive_torque(self.t + 0.5 * h, posture, rate)
            lost = forces.friction_torque(posture, rate)
            held = system.inverse(posture, still, still, gravity=gravity, tip_wrench=wrench)
            force = system.coriolis_matrix(posture, rate).T @ rate - held + tau - lost
            q_next, p_next = q + 0.5 * h * rate, p + 0.5 * h * force
            change = max(
                float(np.abs(q_next - middle).max()) / reach,
                float(np.abs(p_next - momentum).max()) / size,
            )
            middle, momentum = q_next, p_next
            if not np.isfinite(change):
                return None
            if change < _ARRIVED:
                power = float(tau @ rate) + forces.tip_power(forces.posture(middle), rate)
                q_after, p_after = q + h * rate, p + h * force
                qd_after = solve(system.mass_matrix(forces.posture(q_after)), p_after)
                return q_after, qd_after, power, float(lost @ rate)
        return None

    def dense_output(self) -> Callable[[float], Array]:
        """Return the state in the last step, between its ends on a straight line."""
        (t0, y0), t1, y1 = self._from, self.t, self.y

        def line(t: float) -> Array:
            part = (t - t0) / (t1 - t0) if t1 > t0 else 1.0
            return y0 + part * (y1 - y0)

        return line
