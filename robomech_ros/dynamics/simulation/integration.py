"""Steps of an integrator, to the end or to what ends a simulation before."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_SERVO_RATE
from robomech_ros.dynamics.simulation.equations_of_motion import EquationsOfMotion, RunAwayError
from robomech_ros.dynamics.simulation.event_detection import (
    Event,
    apply_impact,
    first_crossing,
    limit_events,
    note_events,
)
from robomech_ros.dynamics.simulation.midpoint import MidpointSolver
from robomech_ros.errors import BadValueError
from robomech_ros.typing import Array

FINISHED = "finished"
MOST_STEPS = 200_000
_MOST_BOUNCES = 1000
# A joint that comes to a stop slower than this (rad/s or m/s) would bounce for ever.
_REST = 1e-6


@dataclass(frozen=True)
class SolverChoice:
    """``"midpoint"`` or one of scipy's solvers, with its longest step (s) and its tolerances."""

    method: str
    step: float | None
    rtol: float
    atol: float

    def solver(self, motion: EquationsOfMotion, t: float, state: Array, end: float) -> Any:
        """Make a solver that starts from a state at a time and stops at the end (s)."""
        if self.method == "midpoint":
            assert self.step is not None
            return MidpointSolver(motion, t, state, end, self.step)
        from scipy import integrate

        kind = getattr(integrate, self.method)
        longest = np.inf if self.step is None else self.step
        return kind(motion.rates, t, state, end, rtol=self.rtol, atol=self.atol, max_step=longest)


class Record:
    """States at the increasing times (m,) asked for (s), or where those are None at the steps."""

    def __init__(self, times: Array | None) -> None:
        self.times = times
        self.t: list[float] = []
        self.states: list[Array] = []
        self.last: tuple[float, Array] = 0.0, np.empty(0)

    def close(self) -> None:
        """Add where the motion came to."""
        t, state = self.last
        if not self.t or self.t[-1] < t:
            self.t.append(t)
            self.states.append(state)

    def add(self, t: float, state: Array, dense: Any) -> None:
        """Add what a step to a time (s) passed; dense gives the states in it, if there is one."""
        self.last = t, np.array(state)
        if self.times is None:
            self.t.append(t)
            self.states.append(np.array(state))
            return
        for wanted in self.times[len(self.t) :]:
            if wanted > t:
                break
            self.t.append(float(wanted))
            self.states.append(np.array(state if dense is None else dense(wanted)))


class Integration:
    """One simulation under way; ``seen`` has time and number of each event that was met.

    At limits joints go on, end the simulation or bounce, with the ``restitution`` of their rate.
    """

    def __init__(
        self,
        motion: EquationsOfMotion,
        choice: SolverChoice,
        at_limits: str,
        restitution: float,
        watched: Sequence[Event],
        record: Record,
    ) -> None:
        self._motion, self._choice = motion, choice
        self._at_limits, self._restitution = at_limits, restitution
        self._watched, self._record = list(watched), record
        self._bounds = [] if at_limits == "ignore" else list(limit_events(motion.system))
        self._bounces = 0
        self.seen: list[tuple[float, int]] = []

    def run(self, state: Array, duration: float) -> str:
        """Step from a state (2 m + 2,) for a duration (s); returns why it ended."""
        start, n = self._motion.all_joints(state), len(self._motion.start)
        self._record.add(0.0, start, None)
        if any(crossing(start) < 0.0 for crossing in self._bounds):
            raise BadValueError("q0", start[:n].tolist(), "values within the position limits")
        try:
            solver = self._choice.solver(self._motion, 0.0, state, duration)
            for _ in range(MOST_STEPS):
                if solver.status == "finished":
                    return FINISHED
                reason, after = self._step(solver)
                if reason:
                    return reason
                if after is not None:
                    solver = self._choice.solver(self._motion, *after, duration)
        except RunAwayError as error:
            return str(error)
        return f"{MOST_STEPS} steps did not reach the end"

    def _step(self, solver: Any) -> tuple[str, tuple[float, Array] | None]:
        """Do one step; give why the simulation ends with it, empty where it goes on.

        After a bounce, give also the time and state from which a new solver goes on.
        """
        n, seen = len(self._motion.start), self._motion.all_joints
        before, y_before = solver.t, seen(solver.y)
        message = solver.step()
        if solver.status == "failed":
            return f"the integration failed at {before:.6g} s: {message}", None
        inside = solver.dense_output()
        _refuse_run_away(solver.t, solver.y, self._motion.m)
        y_after = seen(solver.y)

        def dense(t: float) -> Array:
            return seen(inside(t))

        hits = first_crossing(self._bounds, dense, (before, y_before), (solver.t, y_after))
        end, crossing = min(hits, default=(solver.t, -1))
        ended = note_events(self._watched, dense, before, end, n, self.seen)
        if ended is not None:
            self._record.add(ended[0], dense(ended[0]), dense)
            return f"event {ended[1]} at {ended[0]:.9g} s", None
        self._record.add(end, dense(end) if hits else y_after, dense)
        return self._at_limit(end, crossing, inside(end)) if hits else ("", None)

    def _at_limit(
        self, t: float, crossing: int, state: Array
    ) -> tuple[str, tuple[float, Array] | None]:
        """End the simulation at a limit, or bounce there; gives what :meth:`_step` gives."""
        system = self._motion.system
        joint, side = divmod(crossing, 2)
        name = system.joint_names[joint]
        where = f"its {('lower', 'upper')[side]} limit at {t:.9g} s"
        if self._at_limits == "end":
            return f"joint '{name}' came to {where}", None
        self._bounces += 1
        whole = self._motion.all_joints(state)
        q, rate = whole[: len(self._motion.start)], whole[len(self._motion.start) + joint]
        if self._bounces > _MOST_BOUNCES or abs(rate) < _REST:
            return f"joint '{name}' came to rest at {where}", None
        return "", (t, apply_impact(system, q, state, (joint, side), self._restitution))


def _refuse_run_away(t: float, state: Array, m: int) -> None:
    if not np.isfinite(state).all():
        raise RunAwayError(f"the motion ran away: the state at {t:.6g} s is not finite")
    fastest = float(np.abs(state[m : 2 * m]).max(initial=0.0))
    if fastest > LARGEST_SERVO_RATE:
        raise RunAwayError(
            f"the motion ran away: rates of up to {fastest:.3g} rad/s or m/s at {t:.6g} s; "
            f"{LARGEST_SERVO_RATE:g} is the most"
        )
