"""The robot of a scene: its chain, its SRDF, and pairs of links that always touch."""

from __future__ import annotations

from typing import Any

import numpy as np

from robomech_ros.collision.distances import Distances
from robomech_ros.collision.robot_bodies import adjacent_links
from robomech_ros.errors import BadValueError
from robomech_ros.robots import load_robot, load_srdf
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.semantic import SemanticDescription

# A pair that touches at all of so many random postures counts as built that way.
_POSTURES = 64


def chain_of(robot: Any, base: str | None, tip: str | None) -> SerialChain:
    """Return the chain of a scene; see `PlanningScene`."""
    if isinstance(robot, SerialChain):
        if base or tip:
            raise BadValueError(
                "base and tip", (base, tip), "none beside a chain, which has its own"
            )
        return robot
    if isinstance(robot, RobotDescription):
        return robot.chain(base, tip)
    return load_robot(robot, base, tip)


def _semantic_of(given: Any, description: RobotDescription | None) -> SemanticDescription | None:
    """Return the SRDF of a scene, read for its robot; None if there is none."""
    if given is None or isinstance(given, SemanticDescription):
        return given
    if description is None:
        raise BadValueError("srdf", given, "none for a chain without a description")
    return load_srdf(given, description)


def ignored_links(
    description: RobotDescription | None, srdf: Any, with_shapes: set[str]
) -> dict[frozenset[str], str]:
    """Return the pairs of links to ignore, with the reasons: disabled in the SRDF, or adjacent."""
    semantic = _semantic_of(srdf, description)
    ignored: dict[frozenset[str], str] = {}
    for one in semantic.disabled_collisions if semantic else ():
        why = f"disabled in the SRDF ({one.reason or 'no reason given'})"
        ignored[frozenset((one.first, one.second))] = why
    for pair in adjacent_links(description, with_shapes):
        ignored.setdefault(pair, "adjacent")
    return ignored


def touching_pairs(chain: SerialChain, distances: Distances) -> dict[frozenset[str], str]:
    """Return the checked pairs of bodies that touch at all random postures, with the reason."""
    lower = np.where(np.isfinite(chain.lower), chain.lower, -np.pi)
    upper = np.where(np.isfinite(chain.upper), chain.upper, np.pi)
    always = set(range(len(distances.numbers)))
    for q in np.random.default_rng(0).uniform(lower, upper, (_POSTURES, chain.n)):
        if not always:
            break
        always &= distances.contacts(q, always).keys()
    why = f"in contact at all of {_POSTURES} random postures"
    return {frozenset(distances.names(number)): why for number in always}
