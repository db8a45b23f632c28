"""Filter of a page's messages: only those that it has, with possible values."""

import sys
from typing import Annotated, Any, Union

from msgspec import DecodeError, Meta, Struct, defstruct
from msgspec.msgpack import Decoder

LONGEST_MESSAGE = 64 * 1024
LONGEST_TEXT = 4096
MOST_ENTRIES = 16

_Number = Annotated[float, Meta(ge=-sys.float_info.max, le=sys.float_info.max)]
_Count = Annotated[int, Meta(ge=0, lt=2**31)]
_Text = Annotated[str, Meta(max_length=LONGEST_TEXT)]
_Scalar = bool | _Number | _Text
_Pair = tuple[_Number, _Number]
_Vector = tuple[_Number, _Number, _Number]
_Quaternion = tuple[_Number, _Number, _Number, _Number]


class _Value(Struct, forbid_unknown_fields=True):
    """Only the value of a control may be set: viser would set any attribute of it."""

    value: _Scalar | Annotated[list[_Scalar], Meta(max_length=MOST_ENTRIES)]


_NODE = {"name": _Text, "owner": _Text}
_POSE = {"wxyz": _Quaternion, "position": _Vector}
# Messages that the page sends; viser's others are for other uses, such as its public tunnel.
_FIELDS: dict[str, dict[str, Any]] = {
    "GuiUpdateMessage": {"uuid": _Text, "updates": _Value},
    "SceneNodeClickMessage": {
        **_NODE,
        "instance_index": _Count | None,
        "ray_origin": _Vector,
        "ray_direction": _Vector,
        "screen_pos": _Pair,
        "modifier": _Text | None,
    },
    "TransformControlsDragEndMessage": _NODE,
    "TransformControlsDragStartMessage": _NODE,
    "TransformControlsUpdateMessage": {**_NODE, **_POSE},
    "ViewerCameraMessage": {
        **_POSE,
        **dict.fromkeys(("fov", "near", "far"), _Number),
        **dict.fromkeys(("image_height", "image_width"), _Count),
        **dict.fromkeys(("look_at", "up_direction"), _Vector),
    },
}
_MESSAGES: Any = tuple(
    defstruct(name, fields.items(), tag=name, forbid_unknown_fields=True)
    for name, fields in _FIELDS.items()
)
_DECODER = Decoder(Union[_MESSAGES])  # noqa: UP007


def is_acceptable(raw: object) -> bool:
    """Return whether a message is one that a page sends, all its numbers finite.

    - ``raw``: message from the connection: text, or bytes in msgpack.
    """
    if not isinstance(raw, bytes) or len(raw) > LONGEST_MESSAGE:
        return False
    try:
        _DECODER.decode(raw)
    except (DecodeError, ValueError, RecursionError):
        return False
    return True
