"""Errors of files and of memory."""

from robomech_ros.errors.formatting import in_bytes
from robomech_ros.errors.values import RobomechError


class MapFileError(RobomechError):
    """The file of a map is damaged, belongs to another map or robot, or cannot be written.

    Parameters
    ----------
    path : str
        The file.
    why : str
        What is wrong with it, and what would be right.
    """

    def __init__(self, path: str, why: str) -> None:
        self.path = path
        self.why = why
        super().__init__(f"{path}: {why}")


class NotEnoughMemoryError(RobomechError):
    """The request needs more memory than this machine has.

    Parameters
    ----------
    what : str
        What was asked for.
    needed, available : int
        Bytes.
    """

    def __init__(self, what: str, needed: int, available: int) -> None:
        self.what = what
        self.needed = needed
        self.available = available
        super().__init__(
            f"{what} takes {in_bytes(needed)} of memory, of which {in_bytes(available)} "
            "are available"
        )
