"""Read XML from outside safely: it can only be read.

A document type declaration, and with it every entity, is refused before the parser acts on it;
size, depth and number of elements are capped.  Files that other readers of URDF accept are
accepted: Latin-1 text that declares no encoding, and double hyphens in comments.
"""

import codecs
import re
from dataclasses import dataclass, field
from typing import Any
from xml.parsers import expat

from robomech_ros.errors import RobotDescriptionError

# Bytes; the largest URDF seen in the wild (humanoids with inline data) is below 2 MiB.
LARGEST_XML = 8 * 1024 * 1024
MOST_ELEMENTS = 50_000
DEEPEST = 64


@dataclass
class XmlElement:
    """An element with its attributes, children and place; character data is dropped.

    The line counts from 1; the bytes at which its first and its last tag begin count from 0.  Of
    an element of one tag the last byte is the one after it.
    """

    tag: str
    attributes: dict[str, str]
    line: int
    first_byte: int = 0
    last_byte: int = 0
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
        line, byte = self.parser.CurrentLineNumber, self.parser.CurrentByteIndex
        element = XmlElement(tag, attributes, line, byte, byte)
        if self.open:
            self.open[-1].children.append(element)
        else:
            self.root = element
        self.open.append(element)

    def end(self, _: str) -> None:
        self.open.pop().last_byte = self.parser.CurrentByteIndex


def parse_xml(text: str | bytes, where: str) -> XmlElement:
    """Parse a document.

    - ``text``: the document; the encoding of bytes is detected.
    - ``where``: name of the document in messages.

    Returns the root.

    Raises RobotDescriptionError: the document is too large, too deep or not well-formed, or has a
    document type declaration.
    """
    if len(text) > LARGEST_XML:
        raise RobotDescriptionError(where, f"{len(text)} bytes, at most {LARGEST_XML} are allowed")
    try:
        data = _well_formed(text).encode("utf-8")
    except (LookupError, UnicodeError) as error:
        raise RobotDescriptionError(where, f"not valid text: {error}") from None
    # The text of a str is what counts, not the encoding that its declaration names.
    parser = expat.ParserCreate("utf-8")
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
    if builder.root is None:
        raise RobotDescriptionError(where, "no element")
    return builder.root


# Elements of xacro that had to be expanded, except definitions.
_XACRO = "xacro:"
_XACRO_DEFINITIONS = ("xacro:property", "xacro:arg", "xacro:macro")


def refuse_xacro(root: XmlElement, where: str) -> None:
    """Refuse a document in which something is still to be expanded."""
    for child in root.children:
        if child.tag.startswith(_XACRO) and child.tag not in _XACRO_DEFINITIONS:
            place = f"{where}: line {child.line}"
            why = f"<{child.tag[:80]}>: expand it first, with `xacro model.xacro > model.urdf`"
            raise RobotDescriptionError(place, why)


_DECLARATION = re.compile(r"\A<\?xml\s.*?\?>\s*", re.DOTALL)
_ENCODING = re.compile(rb"<\?xml\s[^>]*?encoding\s*=\s*[\"']([A-Za-z0-9._-]+)[\"']")
_MARKS = {codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}
_ENCODINGS = ("utf-8", "utf-16", "ascii", "iso8859", "cp", "gb", "big5", "euc", "shift", "koi8")
_HYPHENS = re.compile("--+")


def _well_formed(document: str | bytes) -> str:
    """Decode a document, without blanks in front of it, which are against the rules and common."""
    text = document if isinstance(document, str) else _decoded(document)
    return _with_plain_comments(text.lstrip("\ufeff \t\r\n"))


def _decoded(document: bytes) -> str:
    for mark, encoding in _MARKS.items():
        if document.startswith(mark):
            return document.decode(encoding)
    named = _ENCODING.match(document.removeprefix(codecs.BOM_UTF8).lstrip(b" \t\r\n"))
    encoding = named.group(1).decode() if named else "utf-8"
    if not codecs.lookup(encoding).name.startswith(_ENCODINGS):
        raise LookupError(f"unknown encoding: {encoding}")
    try:
        return document.decode(encoding)
    except UnicodeDecodeError:
        # Accepted by urdfdom: mostly a degree sign or an umlaut in a comment.
        return document.decode("latin-1")


def _with_plain_comments(text: str) -> str:
    """Blank out hyphens that XML does not allow in comments; no line or column moves."""
    parts, at = list[str](), 0
    while (start := text.find("<!--", at)) >= 0 and (end := text.find("-->", start + 4)) >= 0:
        inside = _HYPHENS.sub(lambda found: " " * len(found[0]), text[start + 4 : end])
        parts += text[at : start + 4], inside[:-1], inside[-1:].replace("-", " "), "-->"
        at = end + 3
    return "".join([*parts, text[at:]])


def is_xml(text: str) -> bool:
    """Tell the text of a document from a name or a path."""
    return text.lstrip("\ufeff \t\r\n").startswith("<")


def text_of_xml(document: str | bytes) -> str:
    """Return a document that :func:`parse_xml` accepts as text, declared to be UTF-8."""
    body = _DECLARATION.sub("", _well_formed(document), count=1)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{body}'
