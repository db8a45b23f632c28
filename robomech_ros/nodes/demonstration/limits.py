"""Limits that a URDF cannot hold, assumed where nobody gave them."""

from collections.abc import Callable
from dataclasses import dataclass

from robomech_ros.nodes.common.joint_limits import with_assumed_rates
from robomech_ros.robots import SerialChain, load_description, load_semantics, main_chain


@dataclass(frozen=True)
class Which:
    """Which robot, and what of it, moves.

    Parameters
    ----------
    robot : str
        Name or path.
    srdf : str, optional
        Path of an SRDF.
    group : str, optional
        Of the SRDF.
    """

    robot: str
    srdf: str = ""
    group: str = ""


def chain_with_limits(which: Which, say: Callable[[str], None]) -> SerialChain:
    """Load a robot with limits of acceleration and jerk, assumed as the planner assumes them.

    Parameters
    ----------
    say : callable
        Prints what was assumed.

    Returns
    -------
    SerialChain

    Raises
    ------
    MissingLimitsError
        There are no velocity limits to assume others by.
    """
    description, notice, _ = with_assumed_rates(load_description(which.robot))
    chain = main_chain(description, load_semantics(description, which.srdf), group=which.group)
    chain.require_limits("velocity")
    if notice:
        say(notice)
    return chain
