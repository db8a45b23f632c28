"""Faults of nodes: killed, ended, stalled, started again, and steps of the clock."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["FAULTS", "Fault"]


@dataclass(frozen=True)
class Fault:
    """Something that happens to a node, or to the clock.

    Attributes
    ----------
    name : str
        In words.
    ends : bool
        Whether the process is gone.
    asked : bool
        Whether it was asked to go.
    at_once : bool
        Whether it is started again at once, and not only when the caller has heard of it.
    stop : float
        How long the process is stopped, s.
    jump : float
        By how much simulated time jumps, s.
    """

    name: str
    ends: bool = False
    asked: bool = False
    at_once: bool = False
    stop: float = 0.0
    jump: float = 0.0


FAULTS = (
    Fault("kill -9", ends=True),
    Fault("kill -9, restart at once", ends=True, at_once=True),
    Fault("SIGTERM", ends=True, asked=True),
    *(Fault(f"SIGSTOP {seconds:g} s", stop=seconds) for seconds in (0.1, 1.0, 5.0)),
    *(Fault(f"clock {jump:+g} s", jump=jump) for jump in (0.4, -0.4, 10.0, -10.0)),
)
