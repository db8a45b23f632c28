"""Bytes written to the queue of requests of a service, past everything that would check them."""

import ctypes
import re
from ctypes import POINTER, Structure, byref, c_bool, c_char_p, c_int, c_size_t, c_uint8, c_void_p
from pathlib import Path
from typing import Any

from rclpy.node import Node

KEEP_LAST, RELIABLE, VOLATILE, AUTOMATIC = 1, 1, 2, 1
_TIME = ctypes.c_uint64 * 2


class _QoS(Structure):
    """rmw_qos_profile_t."""

    _fields_ = [
        ("history", c_int),
        ("depth", c_size_t),
        ("reliability", c_int),
        ("durability", c_int),
        ("deadline", _TIME),
        ("lifespan", _TIME),
        ("liveliness", c_int),
        ("lease", _TIME),
        ("avoid_ros_namespace_conventions", c_bool),
    ]


class _Options(Structure):
    """rmw_publisher_options_t."""

    _fields_ = [("payload", c_void_p), ("unique_flow", c_int)]


class _Bytes(Structure):
    """rmw_serialized_message_t."""

    _fields_ = [
        ("buffer", POINTER(c_uint8)),
        ("length", c_size_t),
        ("capacity", c_size_t),
        ("allocator", c_void_p * 5),
    ]


def _library(name: str) -> ctypes.CDLL:
    """Open a library that this process has loaded, wherever it was found and however named."""
    maps = Path("/proc/self/maps").read_text(encoding="utf-8")
    found = re.search(rf"\S*/{name}[-.]\S*\.so\S*|\S*/{name}\.so\S*", maps)
    assert found, f"{name} is not loaded"
    return ctypes.CDLL(found[0])


def type_support(kind: Any) -> int | None:
    """Return the address of what rmw knows of a type of messages."""
    meta = type(kind)
    meta.__import_type_support__()
    name, pointer = ctypes.pythonapi.PyCapsule_GetName, ctypes.pythonapi.PyCapsule_GetPointer
    name.restype, name.argtypes = c_char_p, [ctypes.py_object]
    pointer.restype, pointer.argtypes = c_void_p, [ctypes.py_object, c_char_p]
    return pointer(meta._TYPE_SUPPORT, name(meta._TYPE_SUPPORT))


class RawWriter:
    """Writes any bytes to the DDS topic that carries the requests of a service.

    A publisher of rclpy cannot: its topics begin with "rt/".
    """

    def __init__(self, node: Node, kind: Any, service: str) -> None:
        # Loaded already, by rclpy.
        rcl, self._rmw = _library("librcl"), _library("librmw_fastrtps_cpp")
        rcl.rcl_node_get_rmw_handle.restype = c_void_p
        rcl.rcl_node_get_rmw_handle.argtypes = [c_void_p]
        self._rmw.rmw_create_publisher.restype = c_void_p
        self._rmw.rmw_create_publisher.argtypes = [
            c_void_p, c_void_p, c_char_p, POINTER(_QoS), POINTER(_Options),
        ]  # fmt: skip
        self._rmw.rmw_publish_serialized_message.argtypes = [c_void_p, POINTER(_Bytes), c_void_p]
        self._rmw.rmw_destroy_publisher.argtypes = [c_void_p, c_void_p]
        self._rmw.rmw_publisher_count_matched_subscriptions.argtypes = [
            c_void_p, POINTER(c_size_t),
        ]  # fmt: skip
        types = type_support(kind.Request)
        qos = _QoS(KEEP_LAST, 100, RELIABLE, VOLATILE, liveliness=AUTOMATIC)
        qos.avoid_ros_namespace_conventions = True
        self._node = rcl.rcl_node_get_rmw_handle(node.handle.pointer)
        topic = f"rq{service}Request".encode()
        self._publisher = self._rmw.rmw_create_publisher(
            self._node, types, topic, byref(qos), byref(_Options())
        )
        assert self._publisher, f"no writer for {topic!r}"

    def readers(self) -> int:
        """Return how many services read from here."""
        count = c_size_t()
        self._rmw.rmw_publisher_count_matched_subscriptions(self._publisher, byref(count))
        return count.value

    def write(self, data: bytes) -> bool:
        """Send bytes as if they were a request; says whether the middleware sends such bytes."""
        buffer = (c_uint8 * max(1, len(data))).from_buffer_copy(data or b"\x00")
        message = _Bytes(buffer, len(data), len(buffer))
        failed = self._rmw.rmw_publish_serialized_message(self._publisher, byref(message), None)
        if failed:
            _library("librcutils").rcutils_reset_error()
        return not failed

    def close(self) -> None:
        """Take the writer off the graph."""
        self._rmw.rmw_destroy_publisher(self._node, self._publisher)
