"""Visual and collision elements of links in a URDF: simple shapes and mesh files."""

from dataclasses import dataclass

import numpy as np

from robomech_ros.robots.documents.guarded_xml import XmlElement
from robomech_ros.robots.urdf.element_reader import ElementReader, parse_urdf
from robomech_ros.typing import Array

Colour = tuple[float, float, float, float]

# How many numbers each shape has, by tag and attribute.
_MEASURES = {"box": {"size": 3}, "cylinder": {"radius": 1, "length": 1}, "sphere": {"radius": 1}}
_WITH_CAPSULES = {**_MEASURES, "capsule": {"radius": 1, "length": 1}}


@dataclass(frozen=True, eq=False)
class Visual:
    """One visual or collision body of a link."""

    link: str
    pose: Array  #: Pose in the link (m), shape (4, 4).
    kind: str  #: One of "box", "cylinder", "sphere", "mesh", or "capsule" of a collision body.
    #: Edges of a box; radius and length of a cylinder or capsule; radius of a sphere (m).  The
    #: scales of a mesh along x, y and z.
    measures: tuple[float, ...]
    filename: str = ""  #: Name of the file of a mesh, as written.
    #: Red, green, blue and alpha from 0 to 1, where the document gives them.
    colour: Colour | None = None


def read_visuals(text: str, where: str = "URDF") -> list[Visual]:
    """Read the visual bodies of a URDF, those without a shape that is known left out.

    - ``text``: a document that :func:`description_from_urdf` accepts.
    - ``where``: name of the document in messages.
    """
    root = parse_urdf(text, where)
    links = root.all("link")
    inside = [visual for link in links for visual in link.all("visual")]
    named = {}
    for material in [
        *(one for body in inside for one in body.all("material")),
        *root.all("material"),
    ]:
        colour = _colour(ElementReader(root, where), material)
        if colour is not None:
            named[material.attributes.get("name", "")] = colour
    found = []
    for link in links:
        reader = ElementReader(link, where)
        read = [_visual(reader, one, named, _MEASURES) for one in link.all("visual")]
        found += [visual for visual in read if visual is not None]
    return found


def read_collisions(text: str, where: str = "URDF") -> list[Visual]:
    """Read the collision bodies of a URDF, as `read_visuals` does; capsules are among them."""
    found = []
    for link in parse_urdf(text, where).all("link"):
        reader = ElementReader(link, where)
        read = [_visual(reader, one, {}, _WITH_CAPSULES) for one in link.all("collision")]
        found += [body for body in read if body is not None]
    return found


def _visual(
    reader: ElementReader,
    given: XmlElement,
    named: dict[str, Colour],
    measured: dict[str, dict[str, int]],
) -> Visual | None:
    shapes = [shape for geometry in given.all("geometry") for shape in geometry.children]
    shape = next((one for one in shapes if one.tag in (*measured, "mesh")), None)
    if shape is None:
        return None
    name = reader.element.attributes["name"]
    material = next(iter(given.all("material")), None)
    colour = None
    if material is not None:
        own = _colour(reader, material)
        colour = own if own is not None else named.get(material.attributes.get("name", ""))
    pose = reader.origin(given)
    if shape.tag == "mesh":
        scale = reader.numbers(shape, "scale", 3) or [1.0, 1.0, 1.0]
        filename = shape.attributes.get("filename", "")
        return Visual(name, pose, "mesh", tuple(scale), filename, colour)
    measures: list[float] = []
    for attribute, count in measured[shape.tag].items():
        measures += reader.numbers(shape, attribute, count) or [0.0] * count
    return Visual(name, pose, shape.tag, tuple(measures), colour=colour)


def _colour(reader: ElementReader, material: XmlElement) -> Colour | None:
    for given in material.all("color"):
        rgba = reader.numbers(given, "rgba", 4)
        if rgba is not None:
            red, green, blue, alpha = np.clip(rgba, 0.0, 1.0).tolist()
            return red, green, blue, alpha
    return None
