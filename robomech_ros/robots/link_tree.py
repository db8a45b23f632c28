"""The tree of links and joints: links below a link, paths between links, and tips."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.robots.joint import MOVING, Joint
from robomech_ros.spatial import inverse_pose
from robomech_ros.typing import Array

# Names of the frame at which tools are mounted, in order of preference (ROS-Industrial).
TIP_NAMES = ("tool0", "flange")
_MOST_NAMES = 20


@dataclass(frozen=True, eq=False)
class LinkTree:
    """Links and joints as a tree."""

    links: tuple[str, ...]
    joints: tuple[Joint, ...]  #: Each link but one is the child of one joint.
    where: str  #: Where they come from, for messages.

    @cached_property
    def to_parent(self) -> dict[str, Joint]:
        """The joint above each link but the root."""
        return {joint.child: joint for joint in self.joints}

    @cached_property
    def to_children(self) -> dict[str, list[Joint]]:
        """The joints below each link."""
        children: dict[str, list[Joint]] = {link: [] for link in self.links}
        for joint in self.joints:
            children[joint.parent].append(joint)
        return children

    @cached_property
    def depths(self) -> dict[str, int]:
        """Number of joints above each link."""
        root = next(link for link in self.links if link not in self.to_parent)
        depths = {root: 0}
        for link in self.below(root):
            depths[link] = depths[self.to_parent[link].parent] + 1
        return depths

    def joints_between(self, first: str, second: str) -> tuple[list[Joint], list[Joint]]:
        """List the joints up from one link to the common ancestor, and down to the other."""
        up: list[Joint] = []
        down: list[Joint] = []
        while first != second:
            if self.depths[first] >= self.depths[second]:
                up.append(self.to_parent[first])
                first = up[-1].parent
            else:
                down.append(self.to_parent[second])
                second = down[-1].parent
        down.reverse()
        return up, down

    def branch(self, base: str, tip: str | None) -> tuple[str, Array]:
        """Find the link above the tip that fixed joints hold the base to, and its pose in the base.

        It is the base itself where that is above the tip, and where there is none.
        """
        link, pose = base, np.eye(4)
        while not self._leads_to(link, tip):
            joint = self.to_parent.get(link)
            if joint is None or joint.type != "fixed":
                return base, np.eye(4)
            pose = pose @ inverse_pose(joint.origin @ joint.after)
            link = joint.parent
        return link, pose

    def _leads_to(self, link: str, tip: str | None) -> bool:
        """Tell whether a tip is a link or below it; without a tip, whether a joint below moves."""
        if not tip:
            below = (link, *self.below(link))
            return any(j.type != "fixed" for one in below for j in self.to_children[one])
        while tip != link and tip in self.to_parent:
            tip = self.to_parent[tip].parent
        return tip == link

    def path(self, above: str, tip: str, base: str) -> list[Joint]:
        """List the joints from a link down to the tip; the base, held to it, is for messages."""
        path: list[Joint] = []
        link = tip
        while link != above:
            if link not in self.to_parent:
                below = _listed(list(self.below(base)))
                why = f"link '{tip}' is not below link '{base}'; below it are: {below}"
                raise RobotDescriptionError(self.where, why)
            path.append(self.to_parent[link])
            link = path[-1].parent
        path.reverse()
        for joint in path:
            self._check_on_chain(joint, base, tip)
        if not any(joint.moves for joint in path):
            why = f"no joint moves between link '{base}' and link '{tip}'"
            raise RobotDescriptionError(self.where, why)
        return path

    def _check_on_chain(self, joint: Joint, base: str, tip: str) -> None:
        if joint.fault is not None:
            raise RobotDescriptionError(*joint.fault)
        where = f"{self.where}: joint '{joint.name}'"
        between = f"on the chain from '{base}' to '{tip}'"
        if not joint.moves and joint.type != "fixed":
            why = (
                f"type '{joint.type}' {between}; a chain takes {', '.join(MOVING)} and fixed: "
                f"begin behind it (base='{joint.child}', --base-link {joint.child}) or end before"
            )
            raise RobotDescriptionError(where, why)

    def below(self, base: str) -> Iterator[str]:
        """Links below a link, parents first."""
        waiting = [base]
        while waiting:
            for joint in self.to_children[waiting.pop()]:
                yield joint.child
                waiting.append(joint.child)

    def default_tip(self, base: str) -> str:
        """Find the one leaf below a link that joints move, or the one link where tools go."""
        moved: list[str] = []
        waiting = [(base, False)]
        while waiting:
            link, moves = waiting.pop()
            if moves:
                moved.append(link)
            for joint in self.to_children[link]:
                waiting.append((joint.child, moves or joint.type != "fixed"))
        leaves = [link for link in moved if not self.to_children[link]]
        if len(leaves) == 1:
            return leaves[0]
        for name in TIP_NAMES:
            named = [link for link in moved if link == name or link.endswith(f"_{name}")]
            if len(named) == 1:
                return named[0]
        if not leaves:
            raise RobotDescriptionError(self.where, f"no joint moves below link '{base}'")
        names = _listed(self._possible_tips(moved, leaves))
        why = f"several links could be the tip, name one with tip= or --tip-link: {names}"
        raise RobotDescriptionError(self.where, why)

    def _possible_tips(self, moved: list[str], leaves: list[str]) -> list[str]:
        """List where tools are mounted, and the leaves that can end a chain.

        Mounted is what lies behind the last link before the paths to the leaves part.
        """
        paths = [self._path_up(leaf) for leaf in leaves]
        shared = set(paths[0]).intersection(*paths[1:])
        forks = [link for link in paths[0] if link in shared][:1]
        tips = dict.fromkeys([*forks, *sorted(leaves)])
        return [link for link in tips if link in moved]

    def _path_up(self, link: str) -> list[str]:
        path = [link]
        while path[-1] in self.to_parent:
            path.append(self.to_parent[path[-1]].parent)
        return path


def _listed(names: list[str]) -> str:
    shown = ", ".join(names[:_MOST_NAMES])
    return shown + (f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else "")
