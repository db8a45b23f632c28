"""Limits that a URDF cannot hold, assumed where nobody gave them."""

from collections.abc import Callable
from dataclasses import dataclass

from robomech_ros.nodes.common.joints.joint_limits import with_assumed_rates
from robomech_ros.robots import SerialChain, load_description, load_semantics, main_chain


@dataclass(frozen=True)
class Which:
    """Robot of a demonstration, and its moving part."""

    #: Name or path.
    robot: str
    #: Path of an SRDF.
    srdf: str = ""
    #: Group of the SRDF.
    group: str = ""


def chain_with_limits(which: Which, say: Callable[[str], None]) -> SerialChain:
    """Load a robot with limits of acceleration and jerk, assumed as the planner assumes them.

    - ``say``: prints what was assumed.

    Raises MissingLimitsError: there are no velocity limits to assume others by.
    """
    description, notice, _ = with_assumed_rates(load_description(which.robot))
    chain = main_chain(description, load_semantics(description, which.srdf), group=which.group)
    chain.require_limits("velocity")
    if notice:
        say(notice)
    return chain
