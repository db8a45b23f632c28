"""Time several ways of doing the same work, in turn, in one process and one thread."""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Work:
    """Something to be timed: a call, and how many units of work it does.

    A call should take a fraction of a millisecond, so that on a busy machine most calls are over
    before the scheduler interrupts them.
    """

    call: Callable[[], object]
    units: int


@dataclass(frozen=True)
class Timing:
    """Microseconds per unit of work: the median of the rounds, and their spread.

    Attributes
    ----------
    median : float
        Median over the rounds, in microseconds.
    spread : float
        Half the distance between the first and third quartile, as a fraction of the median.
    """

    median: float
    spread: float


def interleave(
    works: Mapping[str, Work],
    *,
    rounds: int = 301,
    warmups: int = 5,
    clock: Callable[[], int] = time.perf_counter_ns,
) -> dict[str, Timing]:
    """Do every work once a round, and return the microseconds per unit of each.

    Whatever disturbs the machine for a while disturbs all alike, so that their ratio means more
    than their absolute figures. The order is reversed every second round.

    Parameters
    ----------
    works : mapping of str to Work
        What to time.
    rounds, warmups : int
        Measured rounds, and rounds before them that do not count.
    clock : callable
        Nanoseconds; ``time.process_time_ns`` for works that only compute, in however many
        threads: a round that others interrupt then takes no longer.

    Returns
    -------
    dict of str to Timing
        One entry for each work, in the order given.
    """
    samples: dict[str, list[float]] = {name: [] for name in works}
    order = list(works.items())
    collecting = gc.isenabled()
    gc.disable()
    try:
        for index in range(warmups + rounds):
            for name, work in order if index % 2 else reversed(order):
                begin = clock()
                work.call()
                elapsed = clock() - begin
                if index >= warmups:
                    samples[name].append(elapsed / 1e3 / work.units)
            gc.collect(0)
    finally:
        if collecting:
            gc.enable()
    return {name: summarise(values) for name, values in samples.items()}


def summarise(values: list[float]) -> Timing:
    """Return the median and the relative quartile spread of `values`."""
    median = statistics.median(values)
    if len(values) < 2:
        return Timing(median, 0.0)
    low, _, high = statistics.quantiles(values, n=4)
    return Timing(median, (high - low) / 2 / median)
