"""Masses and inertias of the links of a URDF."""

from collections.abc import Iterable

import numpy as np

from robomech_ros.errors import RobomechError
from robomech_ros.robots.bodies import Body
from robomech_ros.robots.documents.guarded_xml import XmlElement
from robomech_ros.robots.urdf.element_reader import ElementReader

_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_ORDER = ((0, 1, 2), (1, 3, 4), (2, 4, 5))


def link_bodies(links: Iterable[XmlElement], where: str, notes: list[str]) -> dict[str, Body]:
    """Read the bodies of those links that have any, in their own frames.

    Whether a body can have these numbers is asked where they are used (:meth:`Body.fault`), so
    that kinematics goes on without.

    Parameters
    ----------
    links : iterable of XmlElement
        Named.
    where : str
        What the document is called in messages.
    notes : list of str
        Gets what is given more than once.
    """
    bodies = {}
    for link in links:
        body = _body(ElementReader(link, where), notes)
        if body is not None:
            bodies[link.attributes["name"]] = body
    return bodies


def _body(reader: ElementReader, notes: list[str]) -> Body | None:
    inertial = reader.first("inertial", notes)
    if inertial is None:
        return None
    mass = reader.first("mass", notes, inertial)
    moments = reader.first("inertia", notes, inertial)
    if mass is None or moments is None:
        reader.refuse("<inertial> needs <mass> and <inertia>")
    six = np.array([_required(reader, moments, key) for key in _MOMENTS])
    T = reader.origin(inertial)
    # Our own attribute; other readers pass over it.
    measured = moments.attributes.get("as_measured") == "true"
    try:
        value = _required(reader, mass, "value")
        return Body(value, np.zeros(3), six[_ORDER,], measured).expressed_in(T)
    except RobomechError as error:
        reader.refuse(f"<inertial>: {error}")


def _required(reader: ElementReader, element: XmlElement, attribute: str) -> float:
    numbers = reader.numbers(element, attribute, 1)
    if numbers is None:
        reader.refuse(f"<{element.tag}> has no {attribute}")
    return numbers[0]
