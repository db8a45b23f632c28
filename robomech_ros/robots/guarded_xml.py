"""Read XML from outside safely: it can only be read.

A document type declaration, and with it every entity, is refused before the parser acts on it;
size, depth and number of elements are capped.
"""

from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

from robomech_ros.errors import RobotDescriptionError

__all__ = ["LARGEST_XML", "XmlElement", "parse_xml"]

# Bytes; the largest URDF seen in the wild (humanoids with inline data) is below 2 MiB.
LARGEST_XML = 8 * 1024 * 1024
MOST_ELEMENTS = 50_000
DEEPEST = 64


@dataclass
class XmlElement:
    """An element with its attributes, children and line; character data is dropped."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list["XmlElement"] = field(default_factory=list)

    def all(self, tag: str) -> list["XmlElement"]:
        """Children with this tag."""
        return [child for child in self.children if child.tag == tag]


class _Builder:
    """Handlers of one parse."""

    def __init__(self, where: str, parser: Any) -> None:
        self.where = where
        self.parser = parser
        self.count = 0
        self.root: XmlElement | None = None
        self.open: list[XmlElement] = []

    def refuse(self, why: str) -> RobotDescriptionError:
        return RobotDescriptionError(f"{self.where}: line {self.parser.CurrentLineNumber}", why)

    def doctype(self, *_: object) -> None:
        raise self.refuse("a document type declaration (and with it entities) is not allowed")

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.count += 1
        if self.count > MOST_ELEMENTS:
            raise self.refuse(f"more than {MOST_ELEMENTS} elements")
        if len(self.open) >= DEEPEST:
            raise self.refuse(f"elements nested deeper than {DEEPEST}")
        element = XmlElement(tag, attributes, self.parser.CurrentLineNumber)
        if self.open:
            self.open[-1].children.append(element)
        else:
            self.root = element
        self.open.append(element)

    def end(self, _: str) -> None:
        self.open.pop()


def parse_xml(text: str | bytes, where: str) -> XmlElement:
    """Parse a document.

    Parameters
    ----------
    text : str or bytes
        The document; of bytes the encoding is detected.
    where : str
        What it is called in messages.

    Returns
    -------
    XmlElement
        The root.

    Raises
    ------
    RobotDescriptionError
        Too large, too deep, not well-formed, or with a document type declaration.
    """
    data = _encoded(text, where)
    if len(data) > LARGEST_XML:
        raise RobotDescriptionError(where, f"{len(data)} bytes, at most {LARGEST_XML} are allowed")
    # The text of a str is what counts, not the encoding that its declaration names.
    parser = expat.ParserCreate("utf-8" if isinstance(text, str) else None)
    builder = _Builder(where, parser)
    parser.StartDoctypeDeclHandler = builder.doctype
    parser.EntityDeclHandler = builder.doctype
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        place = f"{where}: line {error.lineno}, column {error.offset + 1}"
        why = f"not well-formed XML: {expat.ErrorString(error.code)}"
        raise RobotDescriptionError(place, why) from None
    except (LookupError, ValueError) as error:
        if isinstance(error, RobotDescriptionError):
            raise
        raise RobotDescriptionError(where, f"unreadable encoding: {error}") from None
    if builder.root is None:
        raise RobotDescriptionError(where, "no element")
    return builder.root


def _encoded(text: str | bytes, where: str) -> bytes:
    if isinstance(text, bytes):
        return text
    try:
        return text.lstrip("\ufeff \t\r\n").encode("utf-8")
    except UnicodeEncodeError as error:
        raise RobotDescriptionError(where, f"not valid text: {error.reason}") from None
