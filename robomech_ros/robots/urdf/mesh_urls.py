"""URLs of meshes for readers without the folder of a URDF."""

import re
from collections.abc import Iterator
from pathlib import Path

from robomech_ros.robots.documents.guarded_xml import XmlElement, parse_xml

_FILENAME = re.compile(rb"(\sfilename\s*=\s*)(\"[^\"]*\"|'[^']*')")


def with_mesh_urls(text: str, folder: Path) -> str:
    """Return a URDF in which paths of mesh files are URLs, file:///...; other URLs stay.

    - ``text``: the document.
    - ``folder``: folder of its relative paths. A path to a missing file stays as it is, too.
    """
    data = text.encode()
    parts, at = list[bytes](), 0
    for mesh in _meshes(parse_xml(text, "URDF")):
        found = _FILENAME.search(data, mesh.first_byte)
        url = _url(mesh.attributes["filename"], folder)
        if found is None or url is None:
            continue
        parts += data[at : found.start()], found[1], b'"', url.encode(), b'"'
        at = found.end()
    return b"".join([*parts, data[at:]]).decode()


def _meshes(root: XmlElement) -> Iterator[XmlElement]:
    """Find the meshes of links, in the order of the document."""
    for link in root.all("link"):
        for body in link.children:
            for geometry in body.all("geometry"):
                yield from (mesh for mesh in geometry.all("mesh") if "filename" in mesh.attributes)


def _url(path: str, folder: Path) -> str | None:
    if "://" in path:
        return None
    try:
        file = (folder / path).resolve()
        return file.as_uri() if file.is_file() else None
    except (OSError, ValueError):
        return None
