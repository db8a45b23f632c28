"""Chains with joints that mimic others."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.mimic import Follower

__all__ = ["FollowingChain", "following_chain"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FollowingChain:
    """The way to a link on which joints mimic others.

    The positions of the n joints on it are ``gain q + offset`` with those of the k that lead.

    Attributes
    ----------
    chain : SerialChain
        The way, as if each of its joints moved by itself.
    joint_names : tuple of str
        The joints that lead, which need not be on the way themselves.
    gain : ndarray, shape (n, k)
        1, or a ratio of rad and m.
    offset : ndarray, shape (n,)
        rad or m.
    """

    chain: SerialChain
    joint_names: tuple[str, ...]
    gain: Array
    offset: Array

    @property
    def n(self) -> int:
        """How many joints lead."""
        return len(self.joint_names)

    @property
    def tip(self) -> str:
        """The link."""
        return self.chain.tip

    def positions(self, leading: ArrayLike) -> Array:
        """Give the positions (..., n) of the joints on the way, at those (..., k) that lead."""
        found: Array = np.asarray(leading, dtype=np.float64) @ self.gain.T + self.offset
        return found


def following_chain(description: RobotDescription, base: str, tip: str) -> FollowingChain:
    """Find the way from one link to another below it, with joints that mimic others.

    Raises
    ------
    UnknownLinkError, RobotDescriptionError
        As :meth:`RobotDescription.chain`, other than for joints that mimic.
    """
    free = tuple(replace(joint, mimic=None) for joint in description.joints)
    chain = replace(description, joints=free).chain(base, tip)
    ways = [description.followers.get(name, Follower(name, 1.0, 0.0)) for name in chain.joint_names]
    leaders = tuple(dict.fromkeys(way.leader for way in ways))
    gain = np.zeros((chain.n, len(leaders)))
    for joint, way in enumerate(ways):
        gain[joint, leaders.index(way.leader)] = way.multiplier
    return FollowingChain(chain, leaders, gain, np.array([way.offset for way in ways]))
