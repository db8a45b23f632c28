"""The names in an SRDF, checked against the robot's."""

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from typing import NoReturn

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.errors.names import did_you_mean
from robomech_ros.robots.description import RobotDescription
from robomech_ros.robots.documents.guarded_xml import XmlElement
from robomech_ros.robots.entry_checks import bare_link

_MOST_NAMES = 20
# More than an SRDF with another gripper has; finding similar names takes time.
_MOST_NOTES = 200


class SrdfNames:
    """Joints and links that a document may name.

    - ``root``: root element of the document.
    - ``where``: name of the document in messages.
    """

    def __init__(self, root: XmlElement, where: str, robot: RobotDescription) -> None:
        self.where = where
        self.robot = robot
        self.joints = {joint.name: joint for joint in robot.joints}  #: Joints of the robot by name.
        #: The joint above each link, except the root.
        self.to_parent = {joint.child: joint for joint in robot.joints}
        virtual = [one.attributes.get("name", "") for one in root.all("virtual_joint")]
        #: All joints, with the virtual ones of the document, in the order of messages.
        self.all_joints = dict.fromkeys([*self.joints, *virtual])
        self.links = dict.fromkeys(robot.links)  #: Links of the robot.
        self.notes: list[str] = []  #: Remarks for the user that are not errors.

    def place(self, element: XmlElement) -> str:
        """Say where an element is."""
        name = element.attributes.get("name", "")
        what = f" '{name[:80]}'" if name else ""
        return f"{self.where}: line {element.line}: {element.tag}{what}"

    def refuse(self, element: XmlElement, why: str) -> NoReturn:
        """Refuse the document for one of its elements."""
        raise RobotDescriptionError(self.place(element), why)

    @contextmanager
    def leaving_out(self, what: str) -> Iterator[None]:
        """Leave out an entry that cannot be read, as MoveIt does, and note why."""
        try:
            yield
        except RobotDescriptionError as error:
            if len(self.notes) >= _MOST_NOTES:
                why = f"more than {_MOST_NOTES} faults; expected the SRDF of this robot"
                raise RobotDescriptionError(self.where, why) from None
            self.notes.append(f"{error}; {what} is left out")

    def own(self, element: XmlElement, taken: Collection[str]) -> str:
        """Read the name of an element, which no other of its kind has."""
        name = element.attributes.get("name", "")
        if not name or name in taken:
            kind = element.tag.replace("_", " ")
            article = "an" if kind[0] in "aeiou" else "a"
            self.refuse(element, "given twice" if name else f"{article} {kind} without a name")
        return name

    def known(self, element: XmlElement, key: str, known: Collection[str], kind: str) -> str:
        """Read an attribute that names something known."""
        name = element.attributes.get(key, "")
        if kind == "link":
            name = bare_link(name)
        if name not in known:
            names = list(known)
            hint = did_you_mean(name[:80], names)
            listed = ", ".join(names[:_MOST_NAMES]) or "none"
            self.refuse(element, f"{key} is '{name[:80]}'{hint}, expected a {kind}: {listed}")
        return name
