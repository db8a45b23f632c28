"""Contacts, loads and postures of hands as requests give them."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from geometry_msgs.msg import Vector3

from robomech_ros.errors import BadValueError, NonFiniteError, WrongSizeError
from robomech_ros.hands import Contact, Hand
from robomech_ros.nodes.common.joints.joint_positions import is_empty
from robomech_ros.nodes.common.messages.error_codes import FrameUnavailableError
from robomech_ros.nodes.common.messages.joint_messages import positions_by_name
from robomech_ros.nodes.common.messages.pose_messages import point_vector
from robomech_ros.typing import Array

# The quality of more contacts takes longer than anyone wants to wait.
_MOST = 20


def read_points(positions: Sequence[Any]) -> Array:
    """Read positions of contacts, shape (k, 3), in m."""
    if not 1 <= len(positions) <= _MOST:
        raise WrongSizeError("positions", len(positions), f"1 to {_MOST}")
    return np.array([point_vector(one, f"positions[{k}]") for k, one in enumerate(positions)])


def read_contacts(request: Any) -> list[Contact]:
    """Read the contacts of a request.

    Raises BadValueError: the contact at fault is named by its number; one out of the plane of a
    planar grasp, too.
    """
    points = read_points(request.positions)
    count = len(points)
    if len(request.normals) != count:
        raise WrongSizeError("normals", len(request.normals), f"{count}, one for each position")
    models = _for_each("models", list(request.models), count, "point")
    friction = _for_each("friction", list(request.friction), count, 0.0)
    torsional = _for_each("torsional", list(request.torsional), count, 0.0)
    rows = zip(points, request.normals, models, friction, torsional, strict=True)
    return [_contact(k, request.planar, *row) for k, row in enumerate(rows)]


def _for_each(what: str, given: list[Any], count: int, default: object) -> list[Any]:
    """Return an entry for each contact: one stands for all, none for the default."""
    if len(given) not in (0, 1, count):
        raise WrongSizeError(what, len(given), f"0, 1 or {count}, one for each position")
    return given if len(given) == count else (given or [default]) * count


def _contact(
    k: int,
    planar: bool,
    point: Array,
    normal: Vector3,
    model: str,
    friction: float,
    torsional: float,
) -> Contact:
    pressed = np.array([normal.x, normal.y, normal.z])
    if planar:
        point = _in_plane(point, f"positions[{k}]")
        pressed = _in_plane(pressed, f"normals[{k}]")
    try:
        return Contact(point, pressed, model, friction, torsional)
    except BadValueError as error:
        raise BadValueError(_numbered(error.what, k), error.value, error.expected) from None
    except NonFiniteError as error:
        raise NonFiniteError(_numbered(error.what, k), error.value) from None


def _numbered(what: str, k: int) -> str:
    return what.replace("the contact", f"contact {k}")


def _in_plane(vector: Array, what: str) -> Array:
    """Return x and y of a vector without a part along z; NaN is for others to refuse."""
    if vector[2] != 0.0 and np.isfinite(vector[2]):
        raise BadValueError(f"{what}.z", float(vector[2]), "0, since planar is true")
    return vector[:2] if vector[2] == 0.0 else vector


def read_origin(request: Any) -> Array:
    """Read the point that moments are about, shape (3,), or (2,) of a planar request."""
    origin = point_vector(request.origin, "origin")
    return _in_plane(origin, "origin") if request.planar else origin


def load_wrench(request: Any) -> Array:
    """Read a load, shape (6,): torque (Nm), then force (N); of a planar request (3,)."""
    torque = point_vector(request.wrench.torque, "wrench.torque")
    force = point_vector(request.wrench.force, "wrench.force")
    if not request.planar:
        return np.concatenate([torque, force])
    for k, name in enumerate("xy"):
        if torque[k] != 0.0:
            expected = "0, since planar is true"
            raise BadValueError(f"wrench.torque.{name}", float(torque[k]), expected)
    return np.concatenate([torque[2:], _in_plane(force, "wrench.force")])


def in_space(wrench: Array) -> Array:
    """Return a wrench, shape (6,), moment first, from one in space or in the plane (3,)."""
    if len(wrench) == 6:
        return wrench
    return np.array([0.0, 0.0, wrench[0], wrench[1], wrench[2], 0.0])


class HandPosture(NamedTuple):
    """A hand that makes contacts, its joint positions (n,), and which finger makes each contact."""

    hand: Hand
    q: Array
    fingers: Sequence[int] | None


class GivenHand:
    """The hand of the node, for requests that name it.

    - ``hand``: None where the node has none.
    - ``frame_prefix``: prefix of the names of its frames.
    """

    def __init__(self, hand: Hand | None, frame_prefix: str) -> None:
        self._hand = hand
        self.palm = "" if hand is None else frame_prefix + hand.fingers[0].base
        self._prefix = frame_prefix

    def required(self) -> Hand:
        """Return the hand; refuse the request if the node has none."""
        if self._hand is None:
            expected = "a hand, given at the start: this request is about its fingers"
            raise BadValueError("the parameter robot_description", "", expected)
        return self._hand

    def frame(self, given: str) -> str:
        """Name the frame of an answer: that of the request, else the palm."""
        return given or self.palm

    def require_palm(self, given: str) -> None:
        """Refuse a frame that is not the palm's."""
        if given.removeprefix("/") not in {"", self.palm, self.palm.removeprefix(self._prefix)}:
            why = "contacts of a hand are taken in the frame of its palm alone"
            raise FrameUnavailableError(given, [self.palm], why)

    def posture(self, request: Any, count: int) -> HandPosture | None:
        """Read in which posture, given in the frame of the palm, the hand makes so many contacts.

        None where the request has no state.
        """
        if is_empty(request.state):
            # Wrong names of fingers are refused all the same.
            self.fingers(request.fingers, count)
            return None
        hand = self.required()
        self.require_palm(request.frame_id)
        q = positions_by_name(request.state, hand.joint_names, "state")
        return HandPosture(hand, q, self.fingers(request.fingers, count))

    def fingers(
        self, names: Sequence[str], count: int, *, each_once: bool = False
    ) -> list[int] | None:
        """Read which finger makes each of so many contacts; None = one after the other."""
        if not names:
            return None
        known = self.required().finger_names
        if len(names) != count:
            raise WrongSizeError("fingers", len(names), f"0 or {count}, one for each position")
        for k, name in enumerate(names):
            if name not in known:
                raise BadValueError(f"fingers[{k}]", name, f"one of {', '.join(known)}")
        if each_once and len(set(names)) < len(names):
            raise BadValueError("fingers", list(names), "each finger once: a finger has one tip")
        return [known.index(name) for name in names]
