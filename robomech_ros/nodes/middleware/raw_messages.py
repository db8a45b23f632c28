"""Messages unpacked by hand, so that bytes which are none disturb nobody."""

from typing import Any

from rclpy.serialization import deserialize_message

from robomech_ros.errors import RobomechError


class UnreadableMessageError(RobomechError):
    """Bytes from the middleware are no message of the type of their topic."""

    def __init__(self, data: bytes, kind: type) -> None:
        super().__init__(f"{len(data)} bytes are no message of the type {kind.__name__}")


def unpack(data: bytes, kind: type) -> Any:
    """Return the message of a type in the bytes of a raw subscription.

    Raises
    ------
    UnreadableMessageError
        The bytes are no such message.
    """
    try:
        return deserialize_message(data, kind)
    except Exception as error:  # which one depends on the middleware
        raise UnreadableMessageError(data, kind) from error
