"""Frames of the links along a chain, and of links fixed to one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from robomech_ros.errors import UnknownLinkError
from robomech_ros.robots.entry_checks import bare_link, check_name
from robomech_ros.typing import Array


@dataclass(frozen=True, eq=False)
class LinkFrame:
    """A link's frame, fixed to the part of the chain that follows its first ``joints`` joints.

    Parameters
    ----------
    name : str
        The link.
    joints : int
        Number of joints of the chain between the base and this link.
    offset : ndarray, shape (4, 4)
        Pose of the link in the frame that moves with joint ``joints`` (m); in the base for 0.
    parent : str
        The link before it; empty for the base.
    """

    name: str
    joints: int
    offset: Array
    parent: str = ""


def find_frame(frames: Sequence[LinkFrame], link: str) -> LinkFrame:
    """Find the frame of a link by its name, with or without a leading slash."""
    check_name("link", link)
    found = next((frame for frame in frames if frame.name == bare_link(link)), None)
    if found is None:
        raise UnknownLinkError(bare_link(link), [frame.name for frame in frames])
    return found


def links_between(frames: Sequence[LinkFrame], base: str, tip: str) -> tuple[str, ...]:
    """Name the links along a chain, base to tip."""
    parents = {frame.name: frame.parent for frame in frames}
    names = [tip]
    while names[-1] != base and parents.get(names[-1]):
        names.append(parents[names[-1]])
    return tuple(reversed(names))


def links_moved(frames: Sequence[LinkFrame], joints: Sequence[str]) -> list[list[str]]:
    """Name the links that each joint moves directly; without frames say which joint it is."""
    moved = [[one.name for one in frames if one.joints == i + 1] for i in range(len(joints))]
    pairs = zip(moved, joints, strict=True)
    return [names or [f"what joint {joint} moves"] for names, joint in pairs]
