"""Grasp study: closure, quality, forces for a load, and the effort of the fingers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robomech_ros.errors import RobomechError
from robomech_ros.hands import (
    Contact,
    ContactForces,
    ForceStatus,
    Hand,
    contact_forces,
    finger_torques,
    grasp_quality,
    is_force_closed,
    is_form_closed,
)
from robomech_ros.hands.contacts import span
from robomech_ros.typing import Array

Line = tuple[str, str]

# Fraction at which friction counts as fully used: forces are in their cones up to rounding.
USED_UP = 0.999


@dataclass(frozen=True, eq=False)
class Grasp:
    """Contacts of fingers with an object, and the load on the object."""

    hand: Hand
    #: Positions of all joints (rad or m), shape (n,).
    q: Array
    #: Contacts in the frame of the palm.
    contacts: tuple[Contact, ...]
    #: Index of the finger at each contact.
    fingers: tuple[int, ...]
    #: Centre of the object, in the palm (m), shape (3,).
    centre: Array
    #: Load on the object: moment about the centre (N m), then force (N), in the axes of the palm,
    #: shape (6,).
    load: Array


@dataclass(frozen=True, eq=False)
class GraspStudy:
    """Result of a grasp study."""

    #: Force of each finger on the object, in the palm (N), shape (k, 3); none if the load is not
    #: held.
    forces: Array
    #: A needed wrench that no contact can exert, moment first, shape (6,); None if the load is held
    #: or no forces were computed.
    separating: Array | None
    #: Results as lines of text.
    lines: tuple[Line, ...]


def study_grasp(grasp: Grasp) -> GraspStudy:
    """Test contacts for closure, and find the smallest forces that hold the load."""
    contacts = grasp.contacts
    if not contacts:
        return GraspStudy(np.empty((0, 3)), None, (("closure", "no finger touches the object"),))
    lines: list[Line] = [("closure", _closure(contacts))]
    try:
        found = contact_forces(contacts, grasp.load, origin=grasp.centre)
    except RobomechError as error:
        return GraspStudy(np.empty((0, 3)), None, (*lines, ("forces", f"{error}")))
    if found.status is not ForceStatus.HELD:
        lines.append(("forces", _not_held(found, grasp.load)))
        return GraspStudy(np.empty((0, 3)), found.separating_wrench, tuple(lines))
    text = f"held: {found.largest:.3f} N at most, {found.total:.3f} N of normal forces in all"
    lines.append(("forces", text))
    return GraspStudy(found.forces, None, (*lines, *_fingers(grasp, found)))


def quality_line(grasp: Grasp) -> Line:
    """Describe the quality of contacts; takes some 0.01 to 0.3 s."""
    if not grasp.contacts:
        return ("quality", "0")
    length = span(grasp.contacts, grasp.centre)
    found = grasp_quality(grasp.contacts, length=length, origin=grasp.centre)
    if not found.upper > 0.0:
        return ("quality", "0")
    return (
        "quality",
        f"{found.lower:.4f} to {found.upper:.4f} N in the weakest direction, for 1 N of normal "
        f"forces in all; moments over {length:.3f} m",
    )


def _closure(contacts: Sequence[Contact]) -> str:
    if not is_force_closed(contacts):
        return "not closed: some loads are not held"
    kind = "force and form closed" if is_form_closed(contacts) else "force closed"
    return f"{kind}: every load is held"


def _not_held(found: ContactForces, load: Array) -> str:
    s = found.separating_wrench
    if s is None:
        return "the solver found neither forces nor a proof that there are none"
    return (
        "not held: the contacts exert nothing along the wrench of force "
        f"{_numbers(s[3:])} and moment {_numbers(s[:3])}, and the load needs "
        f"{-float(s @ load):.3g}"
    )


def _fingers(grasp: Grasp, found: ContactForces) -> list[Line]:
    """Write the force of each finger, the share of its friction, and its greatest effort."""
    hand, parts = grasp.hand, dict(zip(grasp.fingers, found.forces, strict=True))
    efforts = finger_torques(hand, grasp.q, grasp.contacts, found.components, fingers=grasp.fingers)
    lines = []
    for k, effort in enumerate(hand.split(efforts)):
        if k not in parts:
            continue
        contact = grasp.contacts[grasp.fingers.index(k)]
        lines.append(
            (hand.finger_names[k], f"{_force(contact, parts[k])}; {_effort(hand, k, effort)}")
        )
    return lines


def _force(contact: Contact, force: Array) -> str:
    normal = float(contact.normal @ force)
    text = f"{np.linalg.norm(force):.3f} N"
    if contact.model == "frictionless" or not contact.friction * normal > 0.0:
        return text
    share = float(np.linalg.norm(force - normal * contact.normal)) / (contact.friction * normal)
    return f"{text}, {'all' if share > USED_UP else f'{share:.0%}'} of its friction"


def _effort(hand: Hand, k: int, effort: Array) -> str:
    """Write the effort that is nearest to its limit, or the greatest."""
    finger = hand.fingers[k]
    known = np.where(np.isnan(finger.effort), np.inf, finger.effort)
    share = np.abs(effort) / known
    j = int(np.argmax(share if share.any() else np.abs(effort)))
    unit = "N m" if finger.units[j] == "rad" else "N"
    most = f" of {known[j]:.3g}" if np.isfinite(known[j]) else ""
    over = ", too much" if share[j] > 1.0 else ""
    return f"{abs(effort[j]):.3g}{most} {unit} at {finger.joint_names[j]}{over}"


def _numbers(vector: Array) -> str:
    return "(" + ", ".join(f"{x:.3g}" for x in vector.round(6) + 0.0) + ")"
