"""Requests and answers whose entries are counted before rclpy makes Python objects of them.

The Fast DDS layer of ROS 2 believes the length of a list in a corrupt request: from a kilobyte it
makes 20 million empty entries.  rclpy makes an object of each, for most of a minute in which the
node serves nobody, until memory is out; then the service is dead, or the process.  So the entries
are counted in the C message first.
"""

import ctypes
import importlib
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.type_support import check_for_type_support
from rosidl_parser.definition import AbstractSequence, Array, BasicType, NamespacedType

from robomech_ros.errors import WrongSizeError

__all__ = [
    "MOST_OBJECTS",
    "address_in",
    "bounded_action",
    "bounded_action_answers",
    "bounded_answers",
    "bounded_service",
    "count_objects",
]

# Objects that a request may become, made in one or two seconds; a point of a trajectory takes six.
MOST_OBJECTS = 1_000_000
# So many numbers of a list take no longer than one object.
_NUMBERS = 20
# A list is three words: a pointer to the entries, their number, and how many there is room for.
_WORD = 8
_LIST = 3 * _WORD
_SIZES = {
    "boolean": 1, "octet": 1, "char": 1, "int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "wchar": 2,
    "int32": 4, "uint32": 4, "float": 4, "int64": 8, "uint64": 8, "double": 8, "long double": 16,
}  # fmt: skip
_OWN_OBJECTS = ("boolean", "octet")
_Convert = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p)
_new_capsule = ctypes.pythonapi.PyCapsule_New
_new_capsule.restype = ctypes.py_object
_new_capsule.argtypes = (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)
_name_of = ctypes.pythonapi.PyCapsule_GetName
_name_of.restype, _name_of.argtypes = ctypes.c_char_p, (ctypes.py_object,)
_pointer_of = ctypes.pythonapi.PyCapsule_GetPointer
_pointer_of.restype, _pointer_of.argtypes = ctypes.c_void_p, (ctypes.py_object, ctypes.c_char_p)


@dataclass(frozen=True)
class _Layout:
    """A type of the C messages: bytes, alignment, objects that one becomes, and lists in it.

    Each list is given by its offset and the layout of its entries.
    """

    size: int
    align: int
    objects: float
    lists: tuple[tuple[int, "_Layout"], ...] = ()

    @cached_property
    def counts(self) -> NDArray[np.intp]:
        """Words that hold the numbers of entries of the lists, shape (m,)."""
        return np.array([offset // _WORD + 1 for offset, _ in self.lists], dtype=np.intp)

    @cached_property
    def weights(self) -> NDArray[np.float64]:
        """Objects that an entry of each list becomes, shape (m,); 0 where it has lists itself."""
        return np.array([0.0 if entry.lists else entry.objects for _, entry in self.lists])

    @cached_property
    def nested(self) -> tuple[tuple[int, "_Layout"], ...]:
        """Lists whose entries have lists: word of the number of entries, and their layout."""
        return tuple((at // _WORD + 1, entry) for at, entry in self.lists if entry.lists)


def bounded_service(kind: Any) -> Any:
    """Give a type of services whose requests are at most `MOST_OBJECTS` large.

    Any field of a larger request raises `WrongSizeError`, which the guard of the callback answers.
    """
    if isinstance(kind.Request, _Bounded):
        return kind
    check_for_type_support(kind)
    return type(kind)(kind.__name__, (kind,), {"Request": _bounded(kind.Request, _TooLarge)})


def bounded_action(kind: Any) -> Any:
    """Give a type of actions whose goals are at most `MOST_OBJECTS` large.

    A larger goal is taken as an empty one without an identity, and its client learns that it is
    unknown.
    """
    check_for_type_support(kind)
    send = kind.Impl.SendGoalService
    goal = type(send)(send.__name__, (send,), {"Request": _bounded(send.Request, send.Request)})
    implementation = type(kind.Impl.__name__, (kind.Impl,), {"SendGoalService": goal})
    return type(kind)(kind.__name__, (kind,), {"Impl": implementation})


def bounded_answers(kind: Any) -> Any:
    """Give a type of services whose answers are at most `MOST_OBJECTS` large, for a client.

    Any field of a larger answer raises `WrongSizeError`.
    """
    check_for_type_support(kind)
    parts = {"Response": _bounded(kind.Response, partial(_TooLarge, "the answer"))}
    return type(kind)(kind.__name__, (kind,), parts)


def bounded_action_answers(kind: Any) -> Any:
    """Give a type of actions for a client; what is too large of a server is taken as empty.

    So a goal is refused, a result is that of an unknown goal, and the status is that of no goal.
    """
    check_for_type_support(kind)
    parts: dict[str, Any] = {}
    for name in ("SendGoalService", "GetResultService", "CancelGoalService"):
        part = getattr(kind.Impl, name)
        answer = {"Response": _bounded(part.Response, part.Response)}
        parts[name] = type(part)(part.__name__, (part,), answer)
    for name in ("FeedbackMessage", "GoalStatusMessage"):
        part = getattr(kind.Impl, name)
        parts[name] = _bounded(part, part)
    implementation = type(kind.Impl.__name__, (kind.Impl,), parts)
    return type(kind)(kind.__name__, (kind,), {"Impl": implementation})


def address_in(capsule: Any) -> Any:
    """Give the address that a PyCapsule holds."""
    return _pointer_of(capsule, _name_of(capsule))


def count_objects(address: int, kind: Any, most: float = math.inf) -> float:
    """Count the objects that a C message becomes: messages, texts, lists and their entries.

    Parameters
    ----------
    address : int
        Of the message.
    kind : type
        Its class in Python, with its type support loaded.
    most : float, optional
        From more than these on, the count is any larger number.

    Returns
    -------
    float
        Numbers in a list count a twentieth each.
    """
    return _objects(address, 1, _message(kind), most)


class _Bounded:
    """Stands for a type of messages where rclpy takes them."""


class _TooLarge:
    """A request or an answer with too many entries, or with none that could be made."""

    def __init__(self, what: str = "the request") -> None:
        self._what = what

    def __getattr__(self, name: str) -> Any:
        raise WrongSizeError(self._what, "larger", f"at most {MOST_OBJECTS} entries in all")


def _bounded(kind: Any, refused: Callable[[], Any]) -> Any:
    """Make what rclpy takes messages by, which gives `refused()` in place of those too large."""
    meta = type(kind)
    convert = _Convert(address_in(meta._CONVERT_TO_PY))

    def checked(message: int) -> Any:
        try:
            if count_objects(message, kind, MOST_OBJECTS) <= MOST_OBJECTS:
                return convert(message)
        except Exception:  # out of memory, mostly; an error here would end the service
            print(f"a message could not be read: {sys.exc_info()[1]!r}", file=sys.stderr)
        return refused()

    callback = _Convert(checked)
    parts = {
        "_CREATE_ROS_MESSAGE": meta._CREATE_ROS_MESSAGE,
        "_DESTROY_ROS_MESSAGE": meta._DESTROY_ROS_MESSAGE,
        "_CONVERT_TO_PY": _new_capsule(ctypes.cast(callback, ctypes.c_void_p), None, None),
        "callback": callback,  # kept alive
    }
    return type("BoundedRequest", (_Bounded,), parts)()


def _objects(address: int, count: int, layout: _Layout, most: float) -> float:
    """Count the objects that C structures one behind the other become, up to more than `most`."""
    total = count * layout.objects
    if not layout.lists or total > most or not count:
        return total
    memory = (ctypes.c_char * (count * layout.size)).from_address(address)
    words = np.frombuffer(memoryview(memory), np.uint64).reshape(count, -1)
    total += float((words[:, layout.counts] @ layout.weights).sum())
    for at, entry in layout.nested:
        for k in np.flatnonzero(words[:, at]):
            if total > most:
                return total
            entries, number = int(words[k, at - 1]), int(words[k, at])
            total += _objects(entries, number, entry, most - total)
    return total


@cache
def _message(kind: Any) -> _Layout:
    """Lay out a message as the generator of its C code does."""
    fields, example = kind.get_fields_and_field_types(), kind()
    size, align, objects, lists = 0, 1, 1.0, list[tuple[int, _Layout]]()
    for name, slot in zip(fields, kind.SLOT_TYPES, strict=True):
        nested = isinstance(slot, NamespacedType)
        inner: Any = type(getattr(example, name))
        part = _message(inner) if nested else _part(slot)
        size = -(-size // part.align) * part.align
        lists += [(size + offset, entry) for offset, entry in part.lists]
        size, align = size + part.size, max(align, part.align)
        objects += 0.0 if isinstance(slot, BasicType) else part.objects
    # C knows no structure without a member.
    return _Layout(max(-(-size // align) * align, 1), align, objects, tuple(lists))


def _part(slot: Any) -> _Layout:
    """Lay out a field, or an entry of a list."""
    if isinstance(slot, BasicType):
        size = _SIZES[slot.typename]
        objects = 1.0 if slot.typename in _OWN_OBJECTS else 1.0 / _NUMBERS
        return _Layout(size, size, objects)
    if isinstance(slot, NamespacedType):
        return _message(getattr(importlib.import_module(".".join(slot.namespaces)), slot.name))
    if isinstance(slot, Array):
        one = _part(slot.value_type)
        lists = [(k * one.size + at, to) for k in range(slot.size) for at, to in one.lists]
        return _Layout(slot.size * one.size, one.align, slot.size * one.objects, tuple(lists))
    if isinstance(slot, AbstractSequence):
        return _Layout(_LIST, 8, 1.0, ((0, _part(slot.value_type)),))
    # A text is laid out as a list of characters.
    return _Layout(_LIST, 8, 1.0)
