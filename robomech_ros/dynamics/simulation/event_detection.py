"""Limit and event crossings of a simulated motion, and impacts."""

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from robomech_ros.dynamics.systems import DynamicSystem
from robomech_ros.errors import BadValueError
from robomech_ros.spatial.arrays import real_number
from robomech_ros.typing import Array

Event = Callable[[float, Array, Array], float]
Crossing = Callable[[Array], float]

# Parts of a step at whose ends limits are looked at: a joint may pass one and be back.
_PARTS = 8


def limit_events(system: DynamicSystem) -> Iterator[Crossing]:
    """Give, for the lower and upper limit of each joint, how far inside it a state is."""
    for i in range(len(system.joint_names)):
        yield partial(_inside, i, 1.0, float(system.lower[i]))
        yield partial(_inside, i, -1.0, float(system.upper[i]))


def _inside(joint: int, sign: float, limit: float, state: Array) -> float:
    return float(sign * (state[joint] - limit))


def apply_impact(
    system: DynamicSystem, q: Array, state: Array, limit: tuple[int, int], restitution: float
) -> Array:
    """Turn the rate of a joint at its limit; the others take what the blow gives them.

    The limit is the joint and 0 or 1, its lower or upper one.  With all joints at q (n,), returns
    the state (2 m + 2,) of the drives after the impact.
    """
    joint, side = limit
    m = len(system.drive_names)
    state = state.copy()
    rates = state[m : 2 * m].copy()
    state[:m][system.drives_at == joint] = (system.lower, system.upper)[side][joint]
    M, row = system.mass_matrix(q), system.complement(q)[joint]
    response = np.linalg.solve(M, row)
    change = -(1.0 + restitution) * (row @ rates) / (row @ response) * response
    state[m : 2 * m] = rates + change
    state[-1] += 0.5 * (rates @ M @ rates - (rates + change) @ M @ (rates + change))
    return state


def first_crossing(
    crossings: list[Crossing], dense: Any, before: tuple[float, Array], after: tuple[float, Array]
) -> list[tuple[float, int]]:
    """List when in a step, given its ends, functions of the state fall below zero, and which."""
    if not crossings:
        return []
    times = np.linspace(before[0], after[0], _PARTS + 1).tolist()
    states = [before[1], *(dense(t) for t in times[1:-1]), after[1]]
    found = []
    for number, crossing in enumerate(crossings):
        inside = [crossing(state) >= 0.0 for state in states]
        if inside[0] and not all(inside):
            k = inside.index(False)
            found.append((_zero(crossing, dense, times[k - 1], times[k]), number))
    return found


def _zero(crossing: Crossing, dense: Any, before: float, after: float) -> float:
    """Find when a function goes through zero, just before it does."""
    from scipy.optimize import brentq

    if crossing(dense(before)) < 0.0:
        return before
    if crossing(dense(after)) >= 0.0:
        return after
    return float(brentq(lambda t: crossing(dense(t)), before, after, xtol=1e-14, rtol=1e-14))


def note_events(
    watched: list[Event],
    dense: Any,
    before: float,
    after: float,
    n: int,
    seen: list[tuple[float, int]],
) -> tuple[float, int] | None:
    """Note the events of a step in order; returns the first that ends the simulation."""
    from scipy.optimize import brentq

    found = []
    for number, event in enumerate(watched):

        def value(t: float, event: Event = event, number: int = number) -> float:
            y = dense(t)
            expected = "a finite number"
            told = real_number(f"event {number}", event(t, y[:n], y[n : 2 * n]), expected)
            if not math.isfinite(told):
                raise BadValueError(f"event {number} at {t:.9g} s", told, expected)
            return told

        first, last = value(before), value(after)
        if first != 0.0 and (first < 0.0) != (last < 0.0):
            root = brentq(value, before, after, xtol=1e-14, rtol=1e-14) if last else after
            found.append((float(root), number))
    for at, number in sorted(found):
        seen.append((at, number))
        if getattr(watched[number], "terminal", False):
            return at, number
    return None
