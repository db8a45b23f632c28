"""Answers of any bytes: what a hostile server of a service sends to its clients."""

import ctypes
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import CFUNCTYPE, Structure, c_bool, c_char_p, c_uint8, c_uint32, c_void_p
from typing import Any

from raw_writer import type_support
from std_msgs.msg import UInt8

_IDENTIFIER = b"rosidl_typesupport_fastrtps_c"
_Serialise = CFUNCTYPE(c_bool, c_void_p, c_void_p)
_Size = CFUNCTYPE(c_uint32, c_void_p)
_kept: list[Any] = []


class _Callbacks(Structure):
    """message_type_support_callbacks_t, as far as it is needed."""

    _fields_ = [
        ("namespace", c_char_p),
        ("name", c_char_p),
        ("serialise", c_void_p),
        ("deserialise", c_void_p),
        ("size", c_void_p),
    ]


class _Handle(Structure):
    """rosidl_message_type_support_t, as far as it is needed."""

    _fields_ = [
        ("identifier", c_char_p),
        ("data", c_void_p),
        ("find", CFUNCTYPE(c_void_p, c_void_p, c_char_p)),
    ]


def _callbacks(kind: Any) -> _Callbacks:
    """Return what serialises a type of messages in this process; it can be written to."""
    address = type_support(kind)
    found = _Handle.from_address(address).find(address, _IDENTIFIER)
    return _Callbacks.from_address(_Handle.from_address(found).data)


@contextmanager
def raw_answers(kind: Any, data: bytes) -> Iterator[threading.Event]:
    """Have all messages of a type that this process sends consist of some bytes.

    The event that it gives is set when one has been made.

    Parameters
    ----------
    kind : type
        Of the answers, such as ``SolveIK.Response``.
    data : bytes
        Without the four bytes at the beginning that say how the others are to be read.  Of a type
        without texts and lists no more than a message has.
    """
    write_byte = _Serialise(_callbacks(UInt8).serialise)

    made = threading.Event()

    def serialise(message: int, stream: int) -> bool:
        written = all(write_byte(ctypes.addressof(c_uint8(byte)), stream) for byte in data)
        made.set()
        return written

    callbacks = _callbacks(kind)
    before = callbacks.serialise, callbacks.size
    ours = _Serialise(serialise), _Size(lambda message: len(data) + 8)
    # Another thread may be in there when this is over.
    _kept.append(ours)
    callbacks.serialise, callbacks.size = (ctypes.cast(each, c_void_p).value for each in ours)
    try:
        yield made
    finally:
        callbacks.serialise, callbacks.size = before
