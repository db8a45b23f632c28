"""Files with descriptions of robots, read with a bound on their size."""

from pathlib import Path

from robomech_ros.errors import RobotDescriptionError
from robomech_ros.regular_files import read_regular

__all__ = ["read_source"]


def read_source(path: Path, largest: int) -> bytes:
    """Read a regular file of at most this many bytes.

    Raises
    ------
    RobotDescriptionError
        There is no such file, it is no regular one, too large, or cannot be read.
    """
    try:
        return read_regular(path, largest)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise RobotDescriptionError(str(path), reason) from None
