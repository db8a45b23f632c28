"""Poses of links, also of those that joints move which mimic others."""

import numpy as np
from numpy.typing import NDArray

from robomech_ros.kinematics import forward_kinematics
from robomech_ros.robots import SerialChain
from robomech_ros.robots.following_chain import FollowingChain

__all__ = ["poses_along"]

Array = NDArray[np.float64]


def poses_along(way: SerialChain | FollowingChain, q: Array) -> Array:
    """Give the poses (..., 4, 4) of a link in the base (m), at joint positions (..., n)."""
    if isinstance(way, FollowingChain):
        return forward_kinematics(way.chain, way.positions(q))
    return forward_kinematics(way, q)
