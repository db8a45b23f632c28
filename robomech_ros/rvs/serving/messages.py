"""Which messages of a page are let through: those that it has, with values that can be."""

import math
from collections.abc import Callable

import msgspec

LONGEST_MESSAGE = 64 * 1024
LONGEST_TEXT = 4096
MOST_ENTRIES = 16

Check = Callable[[object], bool]


def _number(value: object) -> bool:
    return type(value) in (int, float) and math.isfinite(value)  # type: ignore[arg-type]


def _numbers(count: int) -> Check:
    def check(value: object) -> bool:
        return isinstance(value, list) and len(value) == count and all(map(_number, value))

    return check


def _text(value: object) -> bool:
    return isinstance(value, str) and len(value) <= LONGEST_TEXT


def _scalar(value: object) -> bool:
    return isinstance(value, bool) or _number(value) or _text(value)


def _optional(check: Check) -> Check:
    return lambda value: value is None or check(value)


def _count(value: object) -> bool:
    return type(value) is int and 0 <= value < 2**31


def _new_value(value: object) -> bool:
    """Only the value of a control may be set: viser would set any attribute of it."""
    if not isinstance(value, dict) or list(value) != ["value"]:
        return False
    given = value["value"]
    if isinstance(given, list):
        return len(given) <= MOST_ENTRIES and all(map(_scalar, given))
    return _scalar(given)


_NODE: dict[str, Check] = {"name": _text, "owner": _text}
_POSE: dict[str, Check] = {"wxyz": _numbers(4), "position": _numbers(3)}
# What the page sends; whatever else viser knows is for other uses, such as its public tunnel.
_FIELDS: dict[str, dict[str, Check]] = {
    "GuiUpdateMessage": {"uuid": _text, "updates": _new_value},
    "SceneNodeClickMessage": {
        **_NODE,
        "instance_index": _optional(_count),
        "ray_origin": _numbers(3),
        "ray_direction": _numbers(3),
        "screen_pos": _numbers(2),
        "modifier": _optional(_text),
    },
    "TransformControlsDragEndMessage": _NODE,
    "TransformControlsDragStartMessage": _NODE,
    "TransformControlsUpdateMessage": {**_NODE, **_POSE},
    "ViewerCameraMessage": {
        **_POSE,
        "fov": _number,
        "near": _number,
        "far": _number,
        "image_height": _count,
        "image_width": _count,
        "look_at": _numbers(3),
        "up_direction": _numbers(3),
    },
}


def is_acceptable(raw: object) -> bool:
    """Say whether a message is one that a page sends, all its numbers finite.

    - ``raw``: from the connection: text, or bytes in msgpack.
    """
    if not isinstance(raw, bytes) or len(raw) > LONGEST_MESSAGE:
        return False
    try:
        message = msgspec.msgpack.decode(raw)
    except (msgspec.DecodeError, ValueError, RecursionError):
        return False
    if not isinstance(message, dict):
        return False
    fields = _FIELDS.get(message.pop("type", None)) if _text(message.get("type")) else None
    if fields is None or set(message) != set(fields):
        return False
    return all(check(message[name]) for name, check in fields.items())
