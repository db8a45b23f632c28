"""Files with descriptions of robots, read with a bound on their size."""

from pathlib import Path

from robomech_ros.errors import RobotDescriptionError

__all__ = ["read_source"]


def read_source(path: Path, largest: int) -> bytes:
    """Read a regular file of at most this many bytes.

    Raises
    ------
    RobotDescriptionError
        There is no such file, it is no regular one, too large, or cannot be read.
    """
    try:
        if not path.exists():
            raise RobotDescriptionError(str(path), "no such file")
        if not path.is_file():
            raise RobotDescriptionError(str(path), "not a regular file")
        with path.open("rb") as file:
            data = file.read(largest + 1)
    except RobotDescriptionError:
        raise
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else None
        raise RobotDescriptionError(str(path), reason or str(error)) from None
    if len(data) > largest:
        raise RobotDescriptionError(str(path), f"more than {largest} bytes, the most allowed")
    return data
