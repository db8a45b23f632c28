"""Reading of numbers and names from the elements of a URDF, with messages that name the place."""

from collections.abc import Iterable
from typing import NoReturn

import numpy as np

from robomech_ros._kernels.tolerances import LARGEST_LENGTH
from robomech_ros.errors import RobotDescriptionError
from robomech_ros.robots.documents.guarded_xml import XmlElement, parse_xml
from robomech_ros.robots.documents.numbers_in_text import finite_number
from robomech_ros.robots.entry_checks import bare_link
from robomech_ros.typing import Array


def parse_urdf(text: str | bytes, where: str) -> XmlElement:
    """Parse a document, its links named without a leading slash: one link with and without it."""
    root = parse_xml(text, where)
    for link in root.all("link"):
        _bare(link, "name")
    for joint in root.all("joint"):
        for end in (*joint.all("parent"), *joint.all("child")):
            _bare(end, "link")
    return root


def _bare(element: XmlElement, key: str) -> None:
    if key in element.attributes:
        element.attributes[key] = bare_link(element.attributes[key])


class ElementReader:
    """Checks what is in one joint or link.

    - ``element``: element of the joint or link, which has a name.
    - ``where``: name of the document in messages.
    """

    def __init__(self, element: XmlElement, where: str) -> None:
        self.element = element
        name = element.attributes["name"]
        self.where = f"{where}: line {element.line}: {element.tag} '{name}'"

    def refuse(self, why: str) -> NoReturn:
        """Raise, naming this joint or link."""
        raise RobotDescriptionError(self.where, why)

    def child(
        self, tag: str, required: bool = False, parent: XmlElement | None = None
    ) -> XmlElement | None:
        """Find the one child with this tag, of the element or of one in it."""
        found = (parent or self.element).all(tag)
        if len(found) > 1:
            self.refuse(f"<{tag}> given {len(found)} times")
        if required and not found:
            self.refuse(f"<{tag}> is missing")
        return found[0] if found else None

    def first(
        self, tag: str, notes: list[str], parent: XmlElement | None = None
    ) -> XmlElement | None:
        """Find the first child with this tag, as urdfdom does; note that there are more."""
        found = (parent or self.element).all(tag)
        if len(found) > 1:
            notes.append(f"{self.where}: <{tag}> given {len(found)} times; the first one counts")
        return found[0] if found else None

    def numbers(self, element: XmlElement, attribute: str, count: int) -> list[float] | None:
        """Read this many finite numbers; None where there is no such attribute."""
        text = element.attributes.get(attribute)
        if text is None:
            return None
        try:
            values = [finite_number(word) for word in text.split()]
        except ValueError:
            values = []
        what = "a finite number" if count == 1 else f"{count} finite numbers"
        if len(values) != count:
            self.refuse(f"{attribute} of <{element.tag}> is '{text[:80]}', expected {what}")
        if element.tag == "origin" and max(map(abs, values)) > LARGEST_LENGTH:
            self.refuse(f"{attribute} of <origin> is '{text[:80]}', at most 1e6 is allowed")
        return values

    def origin(self, parent: XmlElement) -> Array:
        """Read the pose (4, 4) that an element in this one has, in m; without one the identity."""
        origin = self.child("origin", parent=parent)
        return self.pose([] if origin is None else [origin])

    def pose(self, origins: Iterable[XmlElement]) -> Array:
        """Read the pose (4, 4) of an origin, in m; of none the identity."""
        from robomech_ros.spatial import matrix_from_roll_pitch_yaw

        T = np.eye(4)
        for origin in origins:
            T[:3, :3] = matrix_from_roll_pitch_yaw(self.numbers(origin, "rpy", 3) or [0.0] * 3)
            T[:3, 3] = self.numbers(origin, "xyz", 3) or [0.0] * 3
        return T

    def link(self, tag: str) -> str:
        """Read which link a child names."""
        element = self.child(tag, required=True)
        name = element.attributes.get("link", "") if element else ""
        if not name:
            self.refuse(f"<{tag}> names no link")
        return name
