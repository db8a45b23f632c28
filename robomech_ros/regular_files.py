"""Files from elsewhere, opened without waiting for anybody."""

import os
import stat
from pathlib import Path
from typing import IO

# Windows has only the last one, POSIX only the others.
_FLAGS = os.O_RDONLY | sum(getattr(os, name, 0) for name in ("O_CLOEXEC", "O_NONBLOCK", "O_BINARY"))


def open_regular(path: Path) -> IO[bytes]:
    """Open a regular file for reading; a pipe or a device could let the reader wait for ever.

    Parameters
    ----------
    path : Path

    Raises
    ------
    OSError
        There is no such file, it is not a regular one, or cannot be read; ``strerror`` says which.
    ValueError
        The path has a null character.
    """
    descriptor = os.open(path, _FLAGS)
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise OSError(None, "not a regular file", str(path))
        return os.fdopen(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def read_regular(path: Path, largest: int) -> bytes:
    """Read a regular file of at most `largest` bytes.

    Raises
    ------
    OSError
        As `open_regular`, or the file is larger.
    ValueError
        The path has a null character.
    """
    with open_regular(path) as file:
        data = file.read(largest + 1)
    if len(data) > largest:
        raise OSError(None, f"more than {largest} bytes, the most allowed", str(path))
    return data
