"""A robot as a tree of links and joints, and the serial chains in it."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from robomech_ros.errors import BadValueError, NonFiniteError, UnknownJointError, UnknownLinkError
from robomech_ros.printing import Printed
from robomech_ros.robots.bodies import Body, combine_bodies
from robomech_ros.robots.chain import SerialChain
from robomech_ros.robots.chain_layout import PRISMATIC, REVOLUTE, pack_chain
from robomech_ros.robots.dh_table import DHTable
from robomech_ros.robots.entry_checks import bare_link
from robomech_ros.robots.joint import Joint, rotation_from_z
from robomech_ros.robots.limit_arrays import KEYS
from robomech_ros.robots.link_frames import LinkFrame
from robomech_ros.robots.link_tree import LinkTree
from robomech_ros.robots.mimic import Coupling, MimicJoint, drive_limits, followers, joined_drive
from robomech_ros.typing import Array, IntArray


@dataclass(frozen=True, eq=False)
class RobotDescription(Printed):
    """A robot as a tree of links and joints.

    Parameters
    ----------
    name : str
        The robot.
    links : tuple of str
        All links.
    joints : tuple of Joint
        All joints; each link but one is the child of exactly one.
    where : str
        The file or string it came from, for messages.
    source : str
        Citation of where the numbers come from, empty where unknown.
    dh : DHTable or None
        The table the whole robot was given as.
    bodies : mapping of str to Body
        Masses and inertias of links, each in the link's own frame, where they are known.
    home : mapping of str to float
        Where joints stand to begin with (rad or m), of those that have a posture of their own.
    document : str
        The text of the URDF that it was read from, empty where there was none.
    notes : tuple of str
        Entries of the document that were passed over, and numbers that are hardly meant.
    floating_base : Body or None
        Free body that carries the robot, such as a spacecraft, in the frame of the root link.
    """

    name: str
    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    where: str
    source: str = ""
    dh: DHTable | None = None
    bodies: Mapping[str, Body] = field(default_factory=dict)
    home: Mapping[str, float] = field(default_factory=dict)
    document: str = ""
    notes: tuple[str, ...] = ()
    floating_base: Body | None = None

    @cached_property
    def root(self) -> str:
        """The link that is no joint's child."""
        return next(link for link in self.links if link not in self._tree.to_parent)

    @cached_property
    def _tree(self) -> LinkTree:
        return LinkTree(self.links, self.joints, self.where)

    @cached_property
    def _at_rest(self) -> dict[str, float]:
        return self.joint_positions()

    @cached_property
    def followers(self) -> dict[str, MimicJoint]:
        """The mimic joints by name; see :class:`MimicJoint`."""
        return followers(self.joints)

    def joint_positions(self, positions: Mapping[str, float] | None = None) -> dict[str, float]:
        """Complete joint positions: of every revolute, continuous and prismatic joint.

        Parameters
        ----------
        positions : mapping of str to float, optional
            rad or m, by joint.  Joints that are not named stand at 0 or at their limit next to
            it; those that mimic others follow them, unless they are named themselves, as
            robot_state_publisher has it.

        Returns
        -------
        dict
            rad or m, by joint, in the order of the joints.

        Raises
        ------
        UnknownJointError
            No joint of this name moves; the error lists those that do.
        """
        moving = {joint.name: joint for joint in self.joints if joint.moves}
        given = _checked_positions({} if positions is None else positions, moving)
        found = {name: given.get(name, joint.rest) for name, joint in moving.items()}
        for name, follower in self.followers.items():
            if name not in given:
                found[name] = follower.position(found[follower.leader])
                if not math.isfinite(found[name]):
                    raise NonFiniteError(f"position of joint '{name}'", found[name])
        return found

    def link_poses(self, positions: Mapping[str, float] | None = None) -> dict[str, Array]:
        """Compute the poses of all links of the tree, joints that mimic others following.

        Parameters
        ----------
        positions : mapping of str to float, optional
            As for :meth:`joint_positions`.  Planar and floating joints stand at their origin.

        Returns
        -------
        dict
            ``T_root_link`` of every link, shape (4, 4) (m), parents first.

        Examples
        --------
        >>> from robomech_ros.robots import load_description
        >>> poses = load_description("ur5e").link_poses({"shoulder_pan_joint": 1.0})
        >>> poses["tool0"].shape
        (4, 4)
        """
        at = self.joint_positions(positions)
        poses = {self.root: np.eye(4)}
        waiting = deque([self.root])
        while waiting:
            link = waiting.popleft()
            for joint in self._tree.to_children[link]:
                poses[joint.child] = poses[link] @ joint.pose(at.get(joint.name, 0.0))
                waiting.append(joint.child)
        return poses

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """The joints that move independently: all that move and mimic no other."""
        return tuple(joint.name for joint in self.joints if joint.moves and joint.mimic is None)

    @property
    def link_depths(self) -> Mapping[str, int]:
        """Number of joints above each link."""
        return self._tree.depths

    def links_below(self, link: str) -> Iterator[str]:
        """List the links below a link, parents first."""
        return self._tree.below(link)

    def joints_between(self, first: str, second: str) -> tuple[list[Joint], list[Joint]]:
        """List the joints on the way from one link to another, whatever their kind.

        Parameters
        ----------
        first, second : str
            Links; neither needs to be below the other.

        Returns
        -------
        tuple of list of Joint
            Those up from the first link, then those down to the second, in the order of the way.

        Raises
        ------
        UnknownLinkError
            No such link.
        """
        first, second = bare_link(first), bare_link(second)
        for link in (first, second):
            if link not in self._tree.to_children:
                raise UnknownLinkError(link, self.links)
        return self._tree.joints_between(first, second)

    def chain(self, base: str | None = None, tip: str | None = None) -> SerialChain:
        """Extract the chain from one link to a link below it, fixed joints folded.

        Parameters
        ----------
        base : str, optional
            Default (also for an empty string) the root link.  It may also be a link that fixed
            joints hold to one above the tip, as ``base`` of many arms is to ``base_link``.
        tip : str, optional
            Default (also for an empty string) the one leaf below the base that joints move;
            where there are several, the one link named ``tool0``, else ``flange`` (or with that
            ending, as in ``left_tool0``).

        Raises
        ------
        UnknownLinkError
            No such link.
        RobotDescriptionError
            The tip is not below the base, no joint moves between them, several links could be
            the tip, or a joint between them is of a kind that a chain cannot have (planar,
            floating): the joint is named.  Or no position of a joint keeps its followers inside
            their limits.
        """
        for what, link in (("base", base), ("tip", tip)):
            if link is not None and not isinstance(link, str):
                raise BadValueError(what, link, "the name of a link")
            if link and bare_link(link) not in self._tree.to_children:
                raise UnknownLinkError(link, self.links)
        base, tip = bare_link(base or self.root), bare_link(tip or "")
        above, pose = self._tree.branch(base, tip)
        path = self._tree.path(above, tip or self._tree.default_tip(above), base)
        return self._folded(base, above, pose, path)

    def _folded(self, base: str, above: str, pose: Array, path: list[Joint]) -> SerialChain:
        """Multiply out what lies between moving joints, each of them turned onto its z axis.

        The path begins at the link ``above``, whose pose in the base is given.
        """
        moving = [joint for joint in path if joint.moves]
        constants: list[Array] = []
        along = [LinkFrame(base, 0, np.eye(4))]
        if above != base:
            along.append(LinkFrame(above, 0, pose, base))
        C = pose
        for joint in path:
            C = C @ joint.origin
            if joint.moves:
                turn = rotation_from_z(joint.axis)
                constants.append(C @ turn)
                C = turn.T
            C = C @ joint.after
            along.append(LinkFrame(joint.child, len(constants), C, joint.parent))
        constants.append(C)
        frames = [*along, *self._attached(along)]
        types = _types(moving)
        couplings = [self.followers.get(one.name, MimicJoint(one.name, 1.0, 0.0)) for one in moving]
        leaders = list(dict.fromkeys(one.leader for one in couplings))
        by_name = {joint.name: joint for joint in self.joints}
        leading = [by_name[name] for name in leaders]
        coupling = None
        if leading != moving:
            indices = np.array([leaders.index(one.leader) for one in couplings])
            gain = np.array([one.multiplier for one in couplings])
            offset = np.array([one.offset for one in couplings])
            coupling = Coupling(tuple(joint.name for joint in moving), types, indices, gain, offset)
        pairs = list(zip(moving, couplings, strict=True))
        driven = [[pair for pair in pairs if pair[1].leader == name] for name in leaders]
        limits = [drive_limits(*pair) for pair in zip(leading, driven, strict=True)]
        whole = base == self.root and len(path) == len(self.joints)
        home = [self.home[name] for name in leaders if name in self.home]
        return SerialChain(
            name=self.name,
            base=base,
            tip=along[-1].name,
            joint_names=tuple(leaders),
            types=_types(leading),
            packed=pack_chain(np.array(constants), types),
            **{key: np.array([one[key] for one in limits]) for key in KEYS},
            frames=tuple(frames),
            dh_given=self.dh if whole else None,
            bodies=self._bodies(along, len(moving)),
            drives=tuple(map(joined_drive, leading, driven)),
            home_given=np.array(home) if len(home) == len(leaders) else None,
            coupling=coupling,
            description=self,
        )

    def _bodies(self, along: list[LinkFrame], n: int) -> tuple[Body | None, ...]:
        """Combine what moves with each joint of a chain, other joints standing where they rest."""
        parts: list[list[Body]] = [[] for _ in range(n + 1)]
        at_rest = self._at_rest
        on_chain = {frame.name for frame in along}
        waiting = [(frame.name, frame.joints, frame.offset) for frame in along]
        while waiting:
            link, joints, pose = waiting.pop()
            if link in self.bodies:
                parts[joints].append(self.bodies[link].expressed_in(pose))
            for joint in self._tree.to_children[link]:
                if joint.child not in on_chain:
                    beyond = pose @ joint.pose(at_rest.get(joint.name, 0.0))
                    waiting.append((joint.child, joints, beyond))
        return tuple(combine_bodies(part) for part in parts[1:])

    def _attached(self, along: list[LinkFrame]) -> Iterator[LinkFrame]:
        """Links that fixed joints hold to the links along a chain."""
        taken = {frame.name for frame in along}
        waiting = deque(along)
        while waiting:
            frame = waiting.popleft()
            for joint in self._tree.to_children[frame.name]:
                if joint.type == "fixed" and joint.child not in taken:
                    taken.add(joint.child)
                    offset = frame.offset @ joint.origin @ joint.after
                    attached = LinkFrame(joint.child, frame.joints, offset, frame.name)
                    yield attached
                    waiting.append(attached)


def _types(joints: list[Joint]) -> IntArray:
    kinds = [PRISMATIC if joint.type == "prismatic" else REVOLUTE for joint in joints]
    return np.array(kinds, dtype=np.int64)


def _checked_positions(
    positions: Mapping[str, float], moving: Mapping[str, Joint]
) -> dict[str, float]:
    if not isinstance(positions, Mapping):
        raise BadValueError("positions", positions, "a mapping of names of joints to numbers")
    checked = {}
    for name, value in positions.items():
        if name not in moving:
            raise UnknownJointError(name, moving)
        what = f"position of joint '{name}'"
        try:
            checked[name] = float(value)
        except (TypeError, ValueError):
            raise BadValueError(what, value, "a number, rad or m") from None
        if not math.isfinite(checked[name]):
            raise NonFiniteError(what, value)
    return checked
