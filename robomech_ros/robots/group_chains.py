"""Chains of groups of joints, and groups that are given by their links alone."""

from __future__ import annotations

import os
from collections.abc import Iterable

from robomech_ros.errors import BadValueError, RobotDescriptionError
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.semantic import Group, SemanticDescription
from robomech_ros.robots.srdf.document import load_srdf


def group_chain(description: RobotDescription, group: Group, link: str = "") -> SerialChain:
    """Return the chain of a group, or the one by which it moves a link.

    Parameters
    ----------
    description : RobotDescription
        The robot.
    group : Group
        Of it.
    link : str, optional
        A link that joints of the group move; default its tip.

    Returns
    -------
    SerialChain
        From the base of the group; where it is no one chain, from the link above the first of its
        joints on the way to the link.

    Raises
    ------
    UnknownLinkError
        No such link.
    BadValueError
        The group is no one chain and no link is named, or the group does not move the link, or
        joints of others move it, too.
    RobotDescriptionError
        A joint on the way is of a kind that a chain cannot have.

    See Also
    --------
    load_srdf : where groups come from.

    Examples
    --------
    >>> from robomech_ros.robots import group_chain, groups_by_links, load_description
    >>> ur5e = load_description("ur5e")
    >>> arm = groups_by_links(ur5e, ["arm:base_link:tool0"])["arm"]
    >>> group_chain(ur5e, arm).n, group_chain(ur5e, arm, "forearm_link").n
    (6, 3)
    """
    if not link and group.ends is None:
        moved = ", ".join(group.links) or "none"
        expected = f"a link that it moves, since it is no one chain: {moved}"
        raise BadValueError(f"tip of group '{group.name}'", link, expected)
    tip = link or (group.ends or ("", ""))[1]
    _, path = description.joints_between(description.root, tip)
    own = [joint for joint in path if joint.name in group.joints]
    if not own:
        expected = f"one that joints of group '{group.name}' move: {', '.join(group.links)}"
        raise BadValueError("link", tip, expected)
    base = own[0].parent
    if group.ends is not None and any(joint.parent == group.ends[0] for joint in path):
        base = group.ends[0]
    chain = description.chain(base, tip)
    others = [name for name in chain.joint_names if name not in group.joints]
    if others:
        expected = f"one that no joints but those of group '{group.name}' move: not {others[0]}"
        raise BadValueError("link", tip, expected)
    return chain


def main_chain(
    description: RobotDescription,
    semantic: SemanticDescription,
    base: str = "",
    tip: str = "",
    group: str = "",
) -> SerialChain:
    """Return the chain that is meant where a user names links, a group, or nothing.

    Parameters
    ----------
    description : RobotDescription
        The robot.
    semantic : SemanticDescription
        Its groups and named postures.
    base, tip : str, optional
        Links; they go before the ends of the group.
    group : str, optional
        A group.  Where neither it nor a tip is named and the robot has several possible tips, it
        is the one group that is a chain and no end effector.

    Returns
    -------
    SerialChain
        Whose :meth:`SerialChain.home` is the state ``home`` of the group, if that can be used.

    Raises
    ------
    RobomechError
        There is no such group or link, or it is not clear which chain is meant.
    """
    if group:
        base, tip = _with_ends(semantic.group(group), base, tip)
    elif not tip and semantic.groups:
        base, tip = _sole_arm(description, semantic, base)
    return semantic.at_home(description.chain(base, tip))


def _with_ends(group: Group, base: str, tip: str) -> tuple[str, str]:
    if group.ends is None and not tip:
        raise BadValueError("group", group.name, "one that is a chain, or the name of its tip, too")
    ends = group.ends or ("", "")
    return base or ends[0], tip or ends[1]


def _sole_arm(
    description: RobotDescription, semantic: SemanticDescription, base: str
) -> tuple[str, str]:
    """Find the ends that are meant: those of the robot, else those of its one arm."""
    try:
        return base, description.chain(base).tip
    except RobotDescriptionError as error:
        tools = {one.group for one in semantic.end_effectors.values()}
        arms = {
            name: group.ends
            for name, group in semantic.groups.items()
            if group.ends is not None and group.joints and name not in tools
        }
        if len(set(arms.values())) != 1:
            more = f"; or name one of the groups {', '.join(semantic.groups)}, with group"
            raise RobotDescriptionError(error.where, f"{error.why}{more}") from None
        ends = next(iter(arms.values()))
        return base or ends[0], ends[1]


def load_semantics(
    description: RobotDescription, srdf: str | os.PathLike[str] = "", groups: Iterable[str] = ()
) -> SemanticDescription:
    """Return what is known of a robot's groups and named postures.

    Parameters
    ----------
    description : RobotDescription
        The robot.
    srdf : str or path, optional
        The text or the path of an SRDF; default none: the robot has no posture but ``home``.
    groups : iterable of str, optional
        More groups, as for :func:`groups_by_links`.

    Examples
    --------
    >>> from robomech_ros.robots import load_description, main_chain, load_semantics
    >>> ur5e = load_description("ur5e")
    >>> known = load_semantics(ur5e, groups=["arm:base_link:tool0"])
    >>> chain = main_chain(ur5e, known, group="arm")
    >>> known.postures(chain)
    ('home',)
    """
    known = load_srdf(srdf, description) if srdf else SemanticDescription(description.name)
    return known.with_groups(groups_by_links(description, groups))


def groups_by_links(description: RobotDescription, entries: Iterable[str]) -> dict[str, Group]:
    """Make groups from the names of their links.

    Parameters
    ----------
    description : RobotDescription
        The robot.
    entries : iterable of str
        Each ``name:tip_link`` or ``name:base_link:tip_link``; the base is the root by default.

    Raises
    ------
    BadValueError
        An entry of another form, or a name that stands twice.
    UnknownLinkError, RobotDescriptionError
        There is no such link, or no chain between them.
    """
    groups: dict[str, Group] = {}
    for entry in entries:
        name, *ends = (part.strip() for part in entry.split(":"))
        if not name or name in groups or len(ends) not in (1, 2) or not all(ends):
            expected = "name:tip_link or name:base_link:tip_link, each name once"
            raise BadValueError("entry of groups", entry, expected)
        chain = description.chain("" if len(ends) == 1 else ends[0], ends[-1])
        groups[name] = group_of_chain(name, chain)
    return groups


def group_of_chain(name: str, chain: SerialChain) -> Group:
    """Make the group of a chain's joints."""
    return Group(name, chain.joint_names, chain.links[1:], (chain.base, chain.tip))
