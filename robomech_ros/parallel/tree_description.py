"""Any robot as a tree of links, and with the loops of the tree where it is parallel.

A URDF knows no loops.  That of a parallel robot has an element, which others pass over, with the
document that the robot was made from::

    <parallel_robot document="{...}"/>
"""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.robots import RobotDescription, load_description
from robomech_ros.robots.documents.guarded_xml import parse_xml
from robomech_ros.robots.documents.guarded_yaml import parse_yaml
from robomech_ros.robots.robot_kinds import ARM, KINDS, check_name, yaml_source
from robomech_ros.robots.urdf.document import description_from_urdf
from robomech_ros.robots.urdf.elements import element

if TYPE_CHECKING:
    from robomech_ros.parallel.library import ParallelRobot
    from robomech_ros.parallel.mechanism.model import Mechanism

_TAG, _DOCUMENT = "parallel_robot", "document"
_END = "</robot>"
_CUT = (
    "<!-- Loops are cut: each limb but the first ends in a link that belongs at the platform. -->"
)


@dataclass(frozen=True, eq=False)
class DescribedRobot:
    """A robot as a tree of links and joints, and its loops.

    Parameters
    ----------
    description : RobotDescription
        The tree.  Of a parallel robot it is a URDF with cut loops, from which the robot can be
        loaded again, loops included, and ``home`` closes them.
    robot : ParallelRobot, Mechanism or None
        The robot with the loops, where there are some.
    """

    description: RobotDescription
    robot: ParallelRobot | Mechanism | None = None

    @property
    def mechanism(self) -> Mechanism | None:
        """The loops; None where there are none."""
        return None if self.robot is None else self.robot.mechanism


def load_tree_description(robot: str | os.PathLike[str]) -> DescribedRobot:
    """Load a robot of any kind.

    Parameters
    ----------
    robot : str or path
        The name of a robot (see :func:`robomech_ros.robots.list_robots` and
        :func:`robomech_ros.parallel.list_parallel`), the path of a ``.urdf`` or ``.yaml`` file, or
        the text of either.

    Raises
    ------
    UnknownRobotError
        No robot of this name; the error lists those there are.
    RobotDescriptionError
        The description cannot be used: the message says where and why.

    Examples
    --------
    >>> from robomech_ros.parallel import load_tree_description
    >>> load_tree_description("puma560").mechanism is None
    True
    >>> load_tree_description("delta").mechanism.actuated
    ('leg1_base', 'leg2_base', 'leg3_base')
    """
    check_name(robot, (ARM, "parallel"))
    found = yaml_source(robot)
    if found is not None:
        text, where = found
        kind = parse_yaml(text, where).get("kind")
        if kind == "parallel":
            return _parallel(text, where)
        if isinstance(kind, str) and kind in KINDS:
            why = f"'{kind}', expected an arm or a parallel robot"
            raise RobotDescriptionError(f"{where}: kind", why)
    description = load_description(robot)
    if description.document:
        for one in parse_xml(description.document, description.where).all(_TAG):
            return _from_element(description, one.attributes)
    return DescribedRobot(description)


def _parallel(text: str | bytes, where: str) -> DescribedRobot:
    """Make a parallel robot of its document, and the URDF of its tree."""
    from robomech_ros.parallel.library import parallel_from_yaml

    robot = parallel_from_yaml(text, where)
    document = parse_yaml(text, where)
    own = element(_TAG, {_DOCUMENT: json.dumps(document)})
    head, end, rest = robot.mechanism.urdf().rpartition(_END)
    description = description_from_urdf(f"{head}  {_CUT}\n  {own}\n{end}{rest}", where)
    return _at_home(replace(description, source=document["source"]), robot)


def _from_element(description: RobotDescription, attributes: dict[str, str]) -> DescribedRobot:
    """Make the parallel robot of a URDF with its document."""
    from robomech_ros.parallel.library import parallel_from_yaml

    where = f"{description.where}: <{_TAG}>"
    if _DOCUMENT not in attributes:
        raise RobotDescriptionError(where, f"missing attribute '{_DOCUMENT}'")
    robot = parallel_from_yaml(attributes[_DOCUMENT], where)
    tree = {joint.name for joint in description.joints}
    missing = [name for name in robot.mechanism.joint_names if name not in tree]
    if missing:
        raise RobotDescriptionError(where, f"joint '{missing[0]}' is not in the tree of links")
    return _at_home(description, robot)


def _at_home(description: RobotDescription, robot: ParallelRobot | Mechanism) -> DescribedRobot:
    names, home = robot.mechanism.joint_names, robot.mechanism.home().tolist()
    closed: dict[str, Any] = dict(zip(names, home, strict=True))
    return DescribedRobot(replace(description, home=closed), robot)
