"""The robot of a node: from a parameter, or from the latched topic ``robot_description``."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from rclpy.qos import DurabilityPolicy, QoSProfile

from robomech_ros.errors import BadValueError, UnknownLinkError
from robomech_ros.nodes.common.parameters import ParameterError, changeable, parameter
from robomech_ros.robots import (
    Group,
    RobotDescription,
    SemanticDescription,
    SerialChain,
    group_chain,
    main_chain,
)
from robomech_ros.robots.entry_checks import bare_link
from robomech_ros.robots.group_chains import group_of_chain
from robomech_ros.robots.semantic import HOME
from robomech_ros.trajectory.limits import JointLimits, Limits
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.parallel import Mechanism, ParallelRobot
    from robomech_ros.walking import LeggedRobot


TOPIC = "robot_description"
# Default group of joints, besides the name of the robot.
WHOLE_CHAIN = "manipulator"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# Quality of service of /tf_static, as in tf2_ros.
STATIC_FRAMES = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@dataclass(frozen=True)
class RobotSettings:
    """Parameters that every node with a robot has."""

    robot_description: str = parameter(
        "",
        "Robot: name in config/robots, path of a URDF or YAML file, or URDF text. Empty = wait "
        "for the latched topic robot_description",
    )
    base_link: str = parameter("", "First link of the chain. Empty = root of the description")
    tip_link: str = parameter(
        "",
        "Last link of the chain. Empty = tip of the parameter group, else the only leaf that "
        "joints move, else tool0 or flange, else the tip of the SRDF's only arm",
    )
    robot_description_semantic: str = parameter(
        "",
        "Groups of joints and named states: path or text of an SRDF. Empty = the latched topic "
        "robot_description_semantic, once it is published",
    )
    groups: tuple[str, ...] = parameter(
        (),
        "Additional groups of joints for requests, besides those of the SRDF, each as "
        "name:tip_link or name:base_link:tip_link",
    )
    group: str = parameter(
        "",
        "Group whose chain the node uses; base_link and tip_link override its ends. Empty = the "
        "chain from base_link to tip_link",
    )
    frame_prefix: str = parameter(
        "",
        "Prefix of this robot's tf frames in headers and on /tf, such as left/. Links keep their "
        "names, as in robot_state_publisher",
    )


@dataclass(frozen=True)
class FrameSettings(RobotSettings):
    """Parameters of a node whose requests may name frames that tf knows."""

    max_transform_age: float = changeable(
        10.0, "Largest age of a /tf transform for requests without a time stamp", (0.01, 1e9, "s")
    )


def check_frame_prefix(prefix: str) -> None:
    """Refuse a prefix of frames that begins with a slash, which tf does not allow."""
    if prefix.startswith("/"):
        expected = "a text without a slash in front, such as left/: tf has no such frames"
        raise ParameterError("frame_prefix", prefix, expected)


class RobotModel:
    """A robot, and the part that a node works with: a chain, the loops of a mechanism, or legs.

    - ``description``: the whole robot.
    - ``settings``: ends of the chain, group and prefix of frames; see :func:`main_chain`.
    - ``semantic``: groups and named postures of the robot; by default only ``home``.
    - ``robot``: the parallel robot; None for other robots.
    - ``legged``: the walking machine; None for other robots.
    - ``mechanism``: the mechanism of the parallel robot, with its loops.

    Raises ParameterError: the prefix begins with a slash, which tf does not allow. BadValueError:
    ends or a group that a parallel robot or a walking machine does not have.
    """

    def __init__(
        self,
        description: RobotDescription,
        settings: RobotSettings = RobotSettings(),
        semantic: SemanticDescription | None = None,
        *,
        robot: "ParallelRobot | Mechanism | None" = None,
        legged: "LeggedRobot | None" = None,
    ) -> None:
        ends, frame_prefix = (settings.base_link, settings.tip_link), settings.frame_prefix
        check_frame_prefix(frame_prefix)
        known = semantic or SemanticDescription(description.name)
        # The robot begins where the states home of its groups say.
        home = {k: at for k, at in known.home().items() if k not in description.followers}
        if home:
            description = replace(description, home={**description.home, **home})
        self.description = description
        self.frame_prefix = frame_prefix
        self.semantic = known
        self.robot = robot
        self.mechanism = mechanism = None if robot is None else robot.mechanism
        self.legged = legged
        #: Chain from base to tip: for a parallel robot the first limb, which ends at the platform;
        #: for a walking machine the first leg.
        self.chain: SerialChain
        #: Names and limits of the joints that trajectories move: those of the chain, the drives of
        #: a parallel robot, or the joints of all legs.
        self.commanded: JointLimits
        if legged is not None:
            _check_ends(legged.name, (legged.trunk, ""), (*ends, settings.group), "legs")
            self.chain, self.commanded = legged.legs[0], Limits.of(legged)
        elif mechanism is None:
            self.chain = main_chain(description, self.semantic, *ends, settings.group)
            self.commanded = self.chain
        else:
            own = mechanism.base_link, mechanism.platform_link
            _check_ends(mechanism.name, own, (*ends, settings.group), "limbs")
            self.chain = mechanism.limbs[0].chain
            self.commanded = Limits.of(mechanism).only(mechanism.drive_index.tolist())
        self._group_chains: dict[tuple[str, str], SerialChain] = {}
        #: Units of the positions of all joints, by name.
        self.units = {joint.name: joint.unit for joint in description.joints}
        self.joint_names = tuple(joint.name for joint in description.joints if joint.moves)
        self._chains = {self.chain.tip: self.chain, "": self.chain}
        self.fixed_frames = _fixed_frames(description, self.chain.base)

    @property
    def base_frame(self) -> str:
        """The frame of the base in tf."""
        return self.frame_of(self.chain.base)

    def frame_of(self, link: str) -> str:
        """Return the frame of a link in tf: the prefix and its name."""
        return f"{self.frame_prefix}{link}"

    def link_of(self, frame: str) -> str:
        """Return the link of a frame; frames of others are returned unchanged.

        - ``frame``: a link with or without the prefix, or something else.
        """
        frame = bare_link(frame)
        bare = frame.removeprefix(self.frame_prefix)
        links = self.description.links
        return bare if frame not in links and bare in links else frame

    def full_frame(self, frame: str) -> str:
        """Return the full tf name of a frame without prefix; "" is the base."""
        link = self.link_of(frame or self.chain.base)
        return self.frame_of(link) if link in self.description.links else link

    def chain_to(self, link: str) -> SerialChain:
        """Return the chain from the base to any link of the robot; "" is the configured tip.

        - ``link``: with or without the prefix of frames.

        Raises UnknownLinkError: the robot has no such link. RobotDescriptionError: there is no
        chain to it: it is above the base, or a joint between is of a kind that a chain cannot have.
        """
        link = self.link_of(link)
        if link not in self._chains:
            if link not in self.description.links:
                raise UnknownLinkError(link, self.description.links)
            try:
                self._chains[link] = self.chain.with_tip(link)
            except UnknownLinkError:
                self._chains[link] = self.description.chain(self.chain.base, link)
        return self._chains[link]

    @property
    def groups(self) -> Mapping[str, Group]:
        """The groups for requests; by default the configured chain alone."""
        if self.semantic.groups:
            return self.semantic.groups
        return {name: group_of_chain(name, self.chain) for name in (WHOLE_CHAIN, self.chain.name)}

    def chain_of(self, group: str, link: str = "") -> SerialChain:
        """Return the chain of a group, to its tip or to another link that it moves.

        Without the name of a group, and where none are given, it begins at the configured base.

        Raises BadValueError: there is no such group (the text lists all), or it does not move the
        link. UnknownLinkError, RobotDescriptionError: there is no such link, or no chain to it.
        """
        if group and group not in self.groups:
            if group in self.semantic.left_out:
                self.semantic.group(group)
            expected = f"one of {', '.join(self.groups)}, or empty for the configured chain"
            raise BadValueError("group", group, expected)
        if not group or not self.semantic.groups:
            return self.chain_to(link)
        link = self.link_of(link)
        if (group, link) not in self._group_chains:
            chain = group_chain(self.description, self.groups[group], link)
            same = (chain.base, chain.tip) == (self.chain.base, self.chain.tip)
            self._group_chains[group, link] = self.chain if same else chain
        return self._group_chains[group, link]

    def joints_of(self, group: str) -> tuple[str, ...]:
        """Name the joints of a group, "" being the configured chain."""
        return self.groups[group].joints if group else self.chain.joint_names

    def posture(self, chain: SerialChain, name: str) -> Array:
        """Find a named posture of the joints that move a link, shape (n,) (rad or m).

        If some of those go on behind the configured chain with no such posture of their own, it
        is one of the configured chain, and the joints outside it rest, or are at their own
        ``home``.
        """
        behind = set(self.chain.joint_names) < set(chain.joint_names)
        if not behind or self.semantic.gives(chain, name):
            return self.semantic.posture(chain, name)
        own = self.semantic.posture(self.chain, name)
        if name == HOME:
            at_home = dict(zip(chain.joint_names, chain.home().tolist(), strict=True))
            at_home |= self.semantic.home() | dict(zip(self.chain.joint_names, own, strict=True))
            q = np.array([at_home[joint] for joint in chain.joint_names])
            return np.clip(q, chain.lower, chain.upper)
        given = dict(zip(self.chain.joint_names, own.tolist(), strict=True))
        positions = self.description.joint_positions(given)
        return np.array([positions[joint] for joint in chain.joint_names])

    def learn(self, semantic: SemanticDescription) -> None:
        """Replace groups and named postures; the configured chain stays."""
        self.semantic = semantic
        self._group_chains = {}

    @property
    def virtual_frames(self) -> dict[str, Array]:
        """Poses (m) in the base of frames outside the robot that its SRDF fixes to a link of it."""
        fixed = self.fixed_frames
        held = [one for one in self.semantic.virtual_joints if one.type == "fixed"]
        return {one.parent_frame: fixed[one.child_link] for one in held if one.child_link in fixed}


def _check_ends(robot: str, ends: tuple[str, str], given: tuple[str, str, str], parts: str) -> None:
    """Reject ends of a chain, or a group, for a robot that is used as a whole."""
    whats = ("base_link", "tip_link", "group")
    for what, value, there in zip(whats, given, (*ends, ""), strict=True):
        if value not in ("", there):
            expected = f"'{there}' or empty" if there else "empty"
            raise BadValueError(what, value, f"{expected}: all {parts} of '{robot}' move")


def _fixed_frames(description: RobotDescription, base: str) -> dict[str, Array]:
    """Find all links fixed to the base, up or down the tree."""
    found = {base: np.eye(4)}
    waiting = [base]
    fixed = [joint for joint in description.joints if joint.type == "fixed"]
    while waiting:
        link = waiting.pop()
        for joint in fixed:
            step = joint.origin @ joint.after
            if joint.parent == link and joint.child not in found:
                found[joint.child] = found[link] @ step
                waiting.append(joint.child)
            elif joint.child == link and joint.parent not in found:
                found[joint.parent] = found[link] @ np.linalg.inv(step)
                waiting.append(joint.parent)
    return found
